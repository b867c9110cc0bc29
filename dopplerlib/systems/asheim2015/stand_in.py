"""SIMULATED stand-in for the recordings of Chapter 6, which are not published."""

from dataclasses import dataclass

import numpy as np

from ... import _checks
from ...estimation.linear_kalman import _predict, _update
from ...model.range_rate import range_rate
from ...tracking.association import gnn_assign
from ...tracking.gates import chi2_gate
from ...tracking.management import CONFIRMED, DELETED, TrackManager
from ...tracking.pda import pda_update
from .published import deviations, resolutions, scenario, snr
from .scene import radars

WALKS = ("turns outside", "stops at the edge")
ECHOES, CLUTTER, GHOSTS = 3, 3, 4  # most false or further detections of a kind in one scan


@dataclass(frozen=True)
class Walk:
    """A simulated walk and what the radars report of it.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time of each scan in s.
    truth : ndarray, shape (K, 4)
        True states in m and m/s.
    sensors : ndarray, shape (N, 2)
        Positions of the radars in m.
    ranges : ndarray, shape (N, K, 2)
        True range and range rate for each radar.
    visible : ndarray of bool, shape (N, K)
        Whether the target is inside the window of the radar, and moves.
    detections : ndarray, shape (runs, N, K, M, 2)
        Range and range rate of each detection; NaN where there is none.
    """

    time: np.ndarray
    truth: np.ndarray
    sensors: np.ndarray
    ranges: np.ndarray
    visible: np.ndarray
    detections: np.ndarray


def walk(runs, *, rng, radar_count=2, variant="turns outside"):
    """Simulate a walk away from the radars and back, with gaps, further echoes and ghosts.

    Nothing here is measured. The walk is made to look as the prose of Chapter 6 tells: the target
    is lost at 25 s and found at 42 s, false detections come in clusters, and a scan may hold
    several detections. Every number that the thesis does not give stands in the table `stand_in`
    of the scenario.

    Parameters
    ----------
    runs : int
        Number of independent records of the same walk.
    rng : numpy.random.Generator
        Source of randomness; every run draws from a child of its own.
    radar_count : {1, 2}
        1: one radar, and a walk that starts close to it (Figs 6.1 to 6.3); 2: both radars, and a
        walk that starts at (0, 2) (Fig 6.4).
    variant : {"turns outside", "stops at the edge"}
        Why nothing is seen between 25 and 42 s: the target walks on beyond the window and turns
        there, or it stops at the far edge, where a radar that looks for motion does not see it.

    Returns
    -------
    Walk

    Raises
    ------
    ValueError
        If an argument is not of the kind described.
    """
    runs = _checks.whole_number("runs", runs)
    _checks.generator("rng", rng)
    _checks.one_of("radar_count", radar_count, (1, 2))
    _checks.one_of("variant", variant, WALKS)
    s = scenario()
    real, own = s["real"], s["stand_in"]
    time = np.arange(round(own["duration"] / real["T"]) + 1) * real["T"]
    sensors = np.zeros((1, 2)) if radar_count == 1 else radars(real["baseline"])
    start = own["walk_start"] if radar_count == 1 else real["start"][1]
    y, v = _there_and_back(time, start, variant, real, own)
    truth = np.stack([0 * y, y, 0 * v, v], axis=-1)
    ranges = np.moveaxis(range_rate(truth, sensors), 1, 0)
    near, far = real["window"]
    d = ranges[..., 0]
    visible = (near <= d) & (d <= far) & (np.abs(ranges[..., 1]) > resolutions()[1])
    draws = (_scans(child, ranges, visible, s) for child in rng.spawn(runs))
    return Walk(time, truth, sensors, ranges, visible, np.stack(list(draws)))


def _there_and_back(time, start, variant, real, own):
    """Return distance and speed of a walk that leaves the window at `gone`, back in at `back`."""
    gone, back, far = real["gone"], real["back"], real["window"][1]
    middle = (gone + back) / 2
    if variant == "turns outside":
        speed = (far - start) / gone
        v = np.where(time < middle, speed, -speed)
        y = start + speed * np.minimum(time, 2 * middle - time)
    else:
        slow = own["slow_down"]
        speed = (far - start) / (gone - slow / 2)
        # The way back mirrors the way there about the middle of the stop.
        way = np.minimum(time, 2 * middle - time)
        braking = np.clip(way - (gone - slow), 0, slow)
        y = start + speed * (np.minimum(way, gone - slow) + braking - braking**2 / (2 * slow))
        v = speed * (1 - braking / slow) * np.where(time < middle, 1, -1)
    end = own["walk_start"] / 2  # nobody walks into the radar
    stopped = y < end
    return np.where(stopped, end, y), np.where(stopped, 0.0, v)


def _scans(rng, ranges, visible, s):
    """Return the detections of one run, shape (N, K, M, 2)."""
    own, (near, far) = s["stand_in"], s["real"]["window"]
    shape = visible.shape
    d = ranges[..., 0]
    sigma = deviations(d, lambda d: snr(d) - own["snr_loss"])
    target = ranges + sigma * rng.standard_normal(ranges.shape)
    target = np.where((visible & (rng.random(shape) < own["detection"]))[..., None], target, np.nan)

    spread = np.array([own["body"], own["limb"]])
    echoes = target[..., None, :] + spread * rng.standard_normal((*shape, ECHOES, 2))
    clutter = np.stack(
        [
            rng.uniform(near, far, (*shape, CLUTTER)),
            own["clutter_velocity"] * rng.uniform(-1, 1, (*shape, CLUTTER)),
        ],
        axis=-1,
    )
    ghosts = np.stack(
        [
            rng.uniform(*own["ghost_range"], (*shape, GHOSTS)),
            own["ghost_velocity"] * rng.standard_normal((*shape, GHOSTS)),
        ],
        axis=-1,
    )
    parts = [target[..., None, :]]
    for points, mean in (
        (echoes, own["echoes"]),
        (clutter, own["clutter"]),
        (ghosts, np.where(d < near, own["ghosts"], 0.0)),
    ):
        count = rng.poisson(mean, shape)
        there = np.arange(points.shape[-2]) < count[..., None]
        parts.append(np.where(there[..., None], points, np.nan))
    found = np.concatenate(parts, axis=-2)
    outside = (found[..., 0] < near) | (found[..., 0] > far)
    found = np.where(outside[..., None], np.nan, found)
    found[:, 0] = np.nan if shape[0] == 1 else found[:, 0]  # one radar: begin with an empty scan
    return found


def managed_tracks(time, detections, settings, manager=None):
    """Track one record with tracks that are started, confirmed and deleted.

    Parameters
    ----------
    time : array_like, shape (K,)
        Time of each scan in s.
    detections : array_like, shape (K, M, 2)
        Range and range rate of each detection; NaN where there is none.
    settings : Settings
        How the filter of each track is set; its gate is that on NIS.
    manager : TrackManager, optional
        Rules; those of the scenario if None.

    Returns
    -------
    list of dict
        For each track that was ever confirmed: `scan`, the numbers of its scans from the start on;
        `x`, shape (its scans, 2), the estimates; `detected`, whether a detection was used.

    Notes
    -----
    Detections go to tracks by least total NIS (`gnn_assign`). One that no track takes starts a
    track, unless it is inside the gate of another, be it one that this scan has started: a body
    gives several echoes.
    """
    s = scenario()["stand_in"]
    manager = manager or TrackManager(s["hits"], s["window"], s["delete_after"])
    z = _checks.real("detections", detections)
    F, H = np.array([[1.0, settings.T], [0.0, 1.0]]), np.eye(2)
    alive, all_tracks = [], []
    for k in range(len(time)):
        found = z[k][np.isfinite(z[k]).all(axis=-1)]
        cost = np.full((len(alive), len(found)), np.inf)
        for i, track in enumerate(alive):
            track["state"], track["P"] = _predict(track["state"], track["P"], F, settings.Q)
            track["R"] = settings.R(track["state"][0]) * np.eye(2)
            nu = found - track["state"]
            S = track["P"] + track["R"]
            nis = np.sum(nu * np.linalg.solve(S, nu.T).T, axis=-1)
            cost[i] = np.where(chi2_gate(nis, 2, settings.gate_probability), nis, np.inf)
        taken = gnn_assign(cost, gate=1e3) if alive and len(found) else [-1] * len(alive)
        for track, j in zip(alive, taken, strict=True):
            if j >= 0:
                track["state"], track["P"], _, _ = _update(
                    track["state"], track["P"], found[j], H, track["R"]
                )
            track["life"] = manager.advance(track["life"], j >= 0)
            track["confirmed"] |= track["life"].status == CONFIRMED
            track["scan"].append(k)
            track["x"].append(track["state"])
            track["detected"].append(bool(j >= 0))
        alive = [track for track in alive if track["life"].status != DELETED]
        started = []
        for j in np.flatnonzero(~np.isfinite(cost).any(axis=0)):
            S = settings.P0 + settings.R(found[j, 0]) * np.eye(2)
            nu = np.reshape([found[j] - other for other in started], (-1, 2))
            nis = np.sum(nu * np.linalg.solve(S, nu.T).T, axis=-1)
            if chi2_gate(nis, 2, settings.gate_probability).any():
                continue
            started.append(found[j])
            track = {
                "state": found[j], "P": settings.P0, "life": manager.start(), "confirmed": False,
                "scan": [k], "x": [found[j]], "detected": [True],
            }  # fmt: skip
            alive.append(track)
            all_tracks.append(track)
    return [
        {name: np.array(track[name]) for name in ("scan", "x", "detected")}
        for track in all_tracks
        if track["confirmed"]
    ]


def pda_radar(detections, settings, *, x0):
    """Run probabilistic data association in place of the nearest neighbor.

    Parameters
    ----------
    detections : array_like, shape (..., K, M, 2)
        Range and range rate of each detection; NaN where there is none.
    settings : Settings
        How the filter is set; its gate is that on NIS.
    x0 : array_like, shape (..., 2)
        State at the first scan.

    Returns
    -------
    x : ndarray, shape (..., K, 2)
        Estimates.
    missed : ndarray, shape (..., K)
        Chance that no detection is of the target; NaN at the first scan.
    """
    z = _checks.real("detections", detections)
    s = scenario()
    own, (near, far) = s["stand_in"], s["real"]["window"]
    density = own["clutter"] / ((far - near) * 2 * own["clutter_velocity"])
    batch = z.shape[:-3]
    x = np.broadcast_to(_checks.finite("x0", x0, (2,)), (*batch, 2))
    P = np.broadcast_to(settings.P0, (*batch, 2, 2))
    F = np.array([[1.0, settings.T], [0.0, 1.0]])
    steps = [(x, np.full(batch, np.nan))]
    for k in range(1, z.shape[-3]):
        x, P = _predict(x, P, F, settings.Q)
        R = settings.R(x[..., 0])[..., None] * np.eye(2)
        step = pda_update(
            x, P, z[..., k, :, :], np.eye(2), R,
            detection=own["detection"], density=density, gate=settings.gate_probability,
        )  # fmt: skip
        x, P = step.x, step.P
        steps.append((x, step.missed))
    x, missed = zip(*steps, strict=True)
    return np.stack(x, axis=len(batch)), np.stack(missed, axis=len(batch))
