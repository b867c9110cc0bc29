"""Faults of sensors, targets and settings, made on purpose in the records of targets.

A fault adds to a record what differs, and keeps its noise: records with and without a fault, or
with two faults, may be compared run by run.
"""

from collections.abc import Callable
from functools import partial
from types import MappingProxyType
from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Positive, between, checked
from .._records import record
from .._typing import FloatArray
from ..model.doppler import doppler_shift
from ..model.radar_array import RadarArray
from .targets import ARRAY, INTERVAL, SIGMA_F, _ended, draw_targets

BAND = 320.0  # Hz: shifts of targets up to the 2 m/s of the paper's drive; a search ends there

Kind = Literal[
    "dead", "biased", "noisier", "exchanged", "outliers", "dropouts", "other target",
    "acceleration", "turn", "positions", "late", "each late", "none",
]  # fmt: skip
_Records = Annotated[FloatArray, partial(_checks.bounded, shape=(None, None, None))]
_Paths = Annotated[FloatArray, partial(_checks.bounded, shape=(None, None, 6))]


@checked
@record
class Fault:
    """Description of one thing that is wrong.

    Attributes
    ----------
    kind : str
        See `with_fault`.
    size : float
        See `with_fault`.
    assumed : float
        Standard deviation that a tracker is given, over that of the noise.
    why : str
        Where a thing of this size comes from.

    Examples
    --------
    >>> hammer = Fault("positions", 0.01, 1.0, "a module that was hit")
    """

    kind: Kind
    size: Annotated[float, between(0, 1e60)]
    assumed: Positive
    why: str


_PLAIN = "what the trackers expect"
_ECHO = "an echo weaker by 10 dB has a deviation larger by the root of ten"
_SEARCH = "a window whose echo is below its noise has its highest peak anywhere in the band"
_MOTION = "from a slow walk's change of pace to a hand that strikes"
_BEND = "from a bend of a sixth of a circle in a second to one of half a circle"
_PLACES = "from a drilled board to a bracket that is bent"
_WINDOW = "half of the 25 ms that the book's windows last"

# The faults of the study, by name. Sizes are stated before any tracker has seen them.
FAULTS = MappingProxyType(
    {
        "none": Fault("none", 0.0, 1.0, _PLAIN),
        "one sensor dead": Fault("dead", 0.1, 1.0, "a plug works loose after 0.1 s"),
        "one biased by 0.5 Hz": Fault(
            "biased", 0.5, 1.0, "a module's carrier 0.4 % beside the others', at 0.75 m/s"
        ),
        "one biased by 5 Hz": Fault("biased", 5.0, 1.0, "a line of interference beside the echo"),
        "one noisier": Fault("noisier", 10**0.5, 1.0, _ECHO),
        "two exchanged": Fault("exchanged", 0.0, 1.0, "two plugs"),
        "outliers, 1 %": Fault("outliers", 0.01, 1.0, _SEARCH),
        "outliers, 10 %": Fault("outliers", 0.1, 1.0, _SEARCH),
        "dropouts, 20 %": Fault("dropouts", 0.2, 1.0, "windows that a detector finds empty"),
        "other target, 5 %": Fault("other target", 0.05, 1.0, "a second target, at times louder"),
        "20 mm from point to point": Fault(
            "positions", 0.02, 1.0, "a body of which each sensor sees another point"
        ),
        "acceleration 1 m/s²": Fault("acceleration", 1.0, 1.0, _MOTION),
        "acceleration 3 m/s²": Fault("acceleration", 3.0, 1.0, _MOTION),
        "acceleration 10 m/s²": Fault("acceleration", 10.0, 1.0, _MOTION),
        "turn 1 rad/s": Fault("turn", 1.0, 1.0, _BEND),
        "turn 3 rad/s": Fault("turn", 3.0, 1.0, _BEND),
        "deviation taken as half": Fault("none", 0.0, 0.5, "a deviation from another distance"),
        "deviation taken as twice": Fault("none", 0.0, 2.0, "a deviation from another distance"),
        "sensors off by 1 mm": Fault("positions", 0.001, 1.0, _PLACES),
        "sensors off by 5 mm": Fault("positions", 0.005, 1.0, _PLACES),
        "all late by 12.5 ms": Fault("late", 0.0125, 1.0, _WINDOW),
        "each late by up to 12.5 ms": Fault("each late", 0.0125, 1.0, _WINDOW),
    }
)


@checked
def with_fault(
    paths: _Paths,
    z: _Records,
    kind: Kind,
    size: Annotated[float, between(0, 1e60)],
    *,
    rng: np.random.Generator,
    array: RadarArray = ARRAY,
    sigma_f: Positive = SIGMA_F,
) -> tuple[FloatArray, FloatArray]:
    """Return true paths and records with a fault.

    Parameters
    ----------
    paths : array_like, shape (runs, K, 6)
        True states in m and m/s, see `draw_targets`.
    z : array_like, shape (runs, K, N)
        Their shifts in Hz, see `draw_records`.
    kind : str
        One sensor, drawn in each run: "dead": missing from `size` s on; "biased" by `size` Hz;
        "noisier": `size` times the deviation, at least once. "exchanged": two sensors, drawn, each
        in the other's place. Samples of each sensor on their own, a share `size` of them:
        "outliers" anywhere in the band; "dropouts"; "other target": shifts of a second target from
        the prior, while it is there. The target: "acceleration" of `size` m/s^2 in a drawn
        direction; "turn" by `size` rad/s about the vertical, to a drawn side. The array:
        "positions" off by `size` m on each axis (standard deviation); "late": shifts are those of
        `size` s ago; "each late": of up to `size` s ago or ahead, each sensor by its own. "none".
    size : float
        Size of the fault, not negative.
    rng : numpy.random.Generator
        Source of randomness, a child for each run; another one than those of paths and records.
    array : RadarArray
        The N sensors, where the tracker takes them to be.
    sigma_f : float
        Standard deviation of the shifts in Hz.

    Returns
    -------
    paths : ndarray, shape (runs, K, 6)
        As they were but for "acceleration" and "turn", whose paths may end earlier.
    z : ndarray, shape (runs, K, N)

    Examples
    --------
    Each sensor misses half of its samples:

    >>> truths, noise, faults = np.random.default_rng(1).spawn(3)
    >>> from dopplerlib.workspace.targets import draw_records
    >>> paths = draw_targets(2, rng=truths, samples=200)
    >>> z = draw_records(paths, rng=noise)
    >>> _, holes = with_fault(paths, z, "dropouts", 0.5, rng=faults)
    >>> round(float(np.isnan(holes).mean()), 1)
    0.5
    """
    if z.shape != (*paths.shape[:2], len(array)):
        wanted = (*paths.shape[:2], len(array))
        raise ValueError(f"z must have shape {wanted} for these paths and sensors, got {z.shape}")
    if not paths.size:
        return paths.copy(), z.copy()
    change = _CHANGES[kind]
    runs = zip(paths, z, rng.spawn(len(paths)), strict=True)
    changed = [change(path, one, size, child, array, sigma_f) for path, one, child in runs]
    paths, z = map(np.stack, zip(*changed, strict=True))
    return paths, np.where(np.isnan(paths[..., :1]), np.nan, z)


# Each takes path (K, 6), record (K, N), size, rng, array and deviation, and returns the former two.


def _dead(path, z, size, rng, array, sigma_f):
    here = np.arange(len(array)) == rng.integers(len(array))
    late = INTERVAL * np.arange(1, len(z) + 1) >= size
    return path, np.where(here & late[:, None], np.nan, z)


def _biased(path, z, size, rng, array, sigma_f):
    return path, z + size * (np.arange(len(array)) == rng.integers(len(array)))


def _noisier(path, z, size, rng, array, sigma_f):
    here = np.arange(len(array)) == rng.integers(len(array))
    more = sigma_f * np.sqrt(max(size**2 - 1, 0.0))
    return path, z + here * more * rng.standard_normal((len(z), 1))


def _exchanged(path, z, size, rng, array, sigma_f):
    order = np.arange(len(array))
    one, other = rng.choice(len(array), 2, replace=False) if len(array) > 1 else (0, 0)
    order[[one, other]] = other, one
    return path, z[:, order]


def _outliers(path, z, size, rng, array, sigma_f):
    hit, wrong = rng.random(z.shape) < size, rng.uniform(-BAND, BAND, z.shape)
    return path, np.where(hit, wrong, z)


def _dropouts(path, z, size, rng, array, sigma_f):
    return path, np.where(rng.random(z.shape) < size, np.nan, z)


def _other_target(path, z, size, rng, array, sigma_f):
    (other,) = draw_targets(1, rng=rng, samples=len(path), array=array)
    wrong = z + _shifts(other, array) - _shifts(path, array)
    hit = (rng.random(z.shape) < size) & ~np.isnan(wrong)
    return path, np.where(hit, wrong, z)


def _accelerated(path, z, size, rng, array, sigma_f):
    direction = rng.standard_normal(3)
    a = size * direction / np.linalg.norm(direction)
    t = INTERVAL * np.arange(1, len(path) + 1)[:, None]
    return _on_another_path(path, path + np.hstack([a * t**2 / 2, a * t]), z, array)


def _turned(path, z, size, rng, array, sigma_f):
    angle = size * rng.choice([-1, 1]) * INTERVAL * np.arange(len(path))
    c, s = np.cos(angle), np.sin(angle)
    v = np.stack(
        [c * path[:, 3] - s * path[:, 4], s * path[:, 3] + c * path[:, 4], path[:, 5]], axis=-1
    )
    steps = INTERVAL * (v[:-1] + v[1:]) / 2
    p = path[0, :3] + np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    return _on_another_path(path, np.hstack([p, v]), z, array)


def _displaced(path, z, size, rng, array, sigma_f):
    moved = array.positions + size * rng.standard_normal(array.positions.shape)
    actual = RadarArray(moved, array.wavelength)
    return path, z + _shifts(path, actual) - _shifts(path, array)


def _late(path, z, size, rng, array, sigma_f):
    return path, _delayed(path, z, np.full(len(array), size), array)


def _each_late(path, z, size, rng, array, sigma_f):
    return path, _delayed(path, z, rng.uniform(-size, size, len(array)), array)


def _delayed(path, z, delays, array):
    """Return the record if sensor n measures what has been `delays[n]` s ago.

    Beyond the ends of the path the target goes straight on.
    """
    there = ~np.isnan(path).any(axis=-1)
    known = path[there]
    if not len(known):
        return z
    t = INTERVAL * np.arange(len(known))
    z = z - _shifts(path, array)
    for n, delay in enumerate(delays):
        at = np.clip(t - delay, t[0], t[-1])
        state = np.stack([np.interp(at, t, one) for one in known.T], axis=-1)
        state[:, :3] += (t - delay - at)[:, None] * state[:, 3:]
        z[there, n] += doppler_shift(state, array)[:, n]
    return z


def _on_another_path(path, other, z, array):
    other = other.copy()
    ended = np.isnan(other).any(axis=-1)
    ended |= _ended(np.where(ended[:, None], 1.0, other), array)
    other[np.maximum.accumulate(ended)] = np.nan
    return other, z + _shifts(other, array) - _shifts(path, array)


def _shifts(path, array):
    z = np.full((len(path), len(array)), np.nan)
    there = ~np.isnan(path).any(axis=-1)
    if there.any():
        z[there] = doppler_shift(path[there], array)
    return z


_CHANGES: dict[str, Callable[..., tuple[FloatArray, FloatArray]]] = {
    "none": lambda path, z, *_: (path, z),
    "dead": _dead, "biased": _biased, "noisier": _noisier, "exchanged": _exchanged,
    "outliers": _outliers, "dropouts": _dropouts, "other target": _other_target,
    "acceleration": _accelerated, "turn": _turned, "positions": _displaced, "late": _late,
    "each late": _each_late,
}  # fmt: skip
