"""Trackers of one radar for scans with many detections: tracks that live and die, and PDA."""

import numpy as np

from ... import _checks
from ...estimation import gaussian, recursion
from ...tracking.association import gnn_assign
from ...tracking.gates import chi2_gate
from ...tracking.management import CONFIRMED, DELETED, TrackManager
from ...tracking.pda import pda_update
from .published import scenario


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
            track["state"], track["P"] = gaussian.predict(track["state"], track["P"], F, settings.Q)
            track["R"] = settings.R(track["state"][0]) * np.eye(2)
            nu = found - track["state"]
            nis = gaussian.quadratic_forms(nu, track["P"] + track["R"])
            cost[i] = np.where(chi2_gate(nis, 2, settings.gate_probability), nis, np.inf)
        taken = gnn_assign(cost, gate=1e3) if alive and len(found) else [-1] * len(alive)
        for track, j in zip(alive, taken, strict=True):
            if j >= 0:
                nu = found[j] - track["state"]
                track["state"], track["P"], _ = gaussian.update(
                    track["state"], track["P"], nu, H, track["R"]
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
            nis = gaussian.quadratic_forms(nu, S)
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


def on_track(tracks, truth, scans, limit):
    """Return whether one confirmed track follows the target through some scans.

    Parameters
    ----------
    tracks : list of dict
        As `managed_tracks` returns them.
    truth : array_like, shape (K,)
        True range at each scan in m.
    scans : array_like of int
        The scans, in increasing order.
    limit : float
        Largest error of a range in m.

    Returns
    -------
    bool
    """
    truth, scans = np.asarray(truth), np.asarray(scans)
    for track in tracks:
        there = np.isin(track["scan"], scans)
        off = np.abs(track["x"][there, 0] - truth[track["scan"][there]])
        if there.sum() == len(scans) and (off < limit).all():
            return True
    return False


def false_tracks(tracks, truth, limit):
    """Return how many confirmed tracks follow something else than the target.

    Parameters
    ----------
    tracks : list of dict
        As `managed_tracks` returns them.
    truth : array_like, shape (K,)
        True range at each scan in m.
    limit : float
        A track is false if the median error of its range is larger than this, in m.

    Returns
    -------
    int
    """
    truth = np.asarray(truth)
    off = [np.median(np.abs(track["x"][:, 0] - truth[track["scan"]])) for track in tracks]
    return int(np.sum(np.array(off) > limit))


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

    def step(k, state):
        x, P = gaussian.predict(*state, F, settings.Q)
        R = settings.R(x[..., 0])[..., None] * np.eye(2)
        after = pda_update(
            x, P, z[..., k, :, :], np.eye(2), R,
            detection=own["detection"], density=density, gate=settings.gate_probability,
        )  # fmt: skip
        return (after.x, after.P), (after.x, after.missed)

    first = x, np.full(batch, np.nan)
    return recursion.scan(step, (x, P), range(1, z.shape[-3]), len(batch), first=first)
