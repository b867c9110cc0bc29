"""SIMULATED surrogate for the recordings of Chapter 6, which are not published."""

from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Booleans, Runs, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...model.range_rate import range_rate
from .noise import noise_std, resolutions, snr
from .published import reported
from .scene import radar_positions

WALKS = ("turns outside", "stops at the edge")
ECHOES, CLUTTER, GHOSTS = 3, 3, 4  # most false or further detections of a kind in one scan


@checked
@record
class SurrogateWalk:
    """A simulated walk and the detections of the radars.

    time (K,): Time of each scan in s.
    truth (K, 4): True states in m and m/s.
    sensors (N, 2): Positions of the radars in m.
    ranges (N, K, 2): True range and range rate for each radar.
    visible (N, K): Whether the target is inside the window of the radar, and moves.
    detections (runs, N, K, M, 2): Range and range rate of each detection; NaN where there is none.
    """

    time: Annotated[FloatArray, exactly(None)]
    truth: Annotated[FloatArray, exactly(None, 4)]
    sensors: Annotated[FloatArray, exactly(None, 2)]
    ranges: Annotated[FloatArray, exactly(None, None, 2)]
    visible: Booleans
    detections: Annotated[FloatArray, exactly(None, None, None, None, 2, check=_checks.measured)]


@checked
def simulate_walk(
    runs: Runs,
    *,
    rng: np.random.Generator,
    radar_count: Literal[1, 2] = 2,
    variant: Literal["turns outside", "stops at the edge"] = "turns outside",
) -> SurrogateWalk:
    """Simulate a walk away from the radars and back, with gaps, further echoes and ghosts.

    Nothing here is measured. The walk is made to look as the prose of Chapter 6 tells: the target
    is lost at 25 s and found at 42 s, false detections come in clusters, and a scan may hold
    several detections. Every number that the thesis does not give stands in the table `surrogate`
    of the scenario.

    runs: Number of independent records of the same walk.
    rng: Source of randomness; every run draws from a child of its own.
    radar_count: 1: one radar, and a walk that starts close to it (Figs 6.1 to 6.3); 2: both radars,
        and a walk that starts at (0, 2) (Fig 6.4).
    variant: Why nothing is seen between 25 and 42 s: the target walks on beyond the window and
        turns there, or it stops at the far edge, where a radar that looks for motion does not see
        it.

    Examples
    --------
    >>> simulate_walk(2, rng=np.random.default_rng(1), radar_count=1).detections.shape
    (2, 1, 69, 11, 2)
    """
    s = reported().scenario
    real, own = s.real, s.surrogate
    time = np.arange(round(own.duration / real.T) + 1) * real.T
    sensors = np.zeros((1, 2)) if radar_count == 1 else radar_positions(real.baseline)
    start = own.walk_start if radar_count == 1 else real.start[1]
    y, v = _there_and_back(time, start, variant, real, own)
    truth = np.stack([0 * y, y, 0 * v, v], axis=-1)
    ranges = np.moveaxis(range_rate(truth, sensors), 1, 0)
    near, far = real.window
    d = ranges[..., 0]
    visible = (near <= d) & (d <= far) & (np.abs(ranges[..., 1]) > resolutions()[1])
    draws = (_scans(child, ranges, visible, s) for child in rng.spawn(runs))
    return SurrogateWalk(time, truth, sensors, ranges, visible, np.stack(list(draws)))


def _there_and_back(time, start, variant, real, own):
    """Return distance and speed of a walk that leaves the window at `gone`, back in at `back`."""
    gone, back, far = real.gone, real.back, real.window[1]
    middle = (gone + back) / 2
    if variant == "turns outside":
        speed = (far - start) / gone
        v = np.where(time < middle, speed, -speed)
        y = start + speed * np.minimum(time, 2 * middle - time)
    else:
        slow = own.slow_down
        speed = (far - start) / (gone - slow / 2)
        # The way back mirrors the way there about the middle of the stop.
        way = np.minimum(time, 2 * middle - time)
        braking = np.clip(way - (gone - slow), 0, slow)
        y = start + speed * (np.minimum(way, gone - slow) + braking - braking**2 / (2 * slow))
        v = speed * (1 - braking / slow) * np.where(time < middle, 1, -1)
    end = own.walk_start / 2  # nobody walks into the radar
    stopped = y < end
    return np.where(stopped, end, y), np.where(stopped, 0.0, v)


def _scans(rng, ranges, visible, s):
    """Return the detections of one run, shape (N, K, M, 2)."""
    own, (near, far) = s.surrogate, s.real.window
    shape = visible.shape
    d = ranges[..., 0]
    sigma = noise_std(d, lambda d: snr(d) - own.snr_loss)
    target = ranges + sigma * rng.standard_normal(ranges.shape)
    target = np.where((visible & (rng.random(shape) < own.detection))[..., None], target, np.nan)

    spread = np.array([own.body, own.limb])
    echoes = target[..., None, :] + spread * rng.standard_normal((*shape, ECHOES, 2))
    clutter = np.stack(
        [
            rng.uniform(near, far, (*shape, CLUTTER)),
            own.clutter_velocity * rng.uniform(-1, 1, (*shape, CLUTTER)),
        ],
        axis=-1,
    )
    ghosts = np.stack(
        [
            rng.uniform(*own.ghost_range, (*shape, GHOSTS)),
            own.ghost_velocity * rng.standard_normal((*shape, GHOSTS)),
        ],
        axis=-1,
    )
    parts = [target[..., None, :]]
    for points, mean in (
        (echoes, own.echoes),
        (clutter, own.clutter),
        (ghosts, np.where(d < near, own.ghosts, 0.0)),
    ):
        count = rng.poisson(mean, shape)
        there = np.arange(points.shape[-2]) < count[..., None]
        parts.append(np.where(there[..., None], points, np.nan))
    found = np.concatenate(parts, axis=-2)
    outside = (found[..., 0] < near) | (found[..., 0] > far)
    found = np.where(outside[..., None], np.nan, found)
    found[:, 0] = np.nan if shape[0] == 1 else found[:, 0]  # one radar: begin with an empty scan
    return found
