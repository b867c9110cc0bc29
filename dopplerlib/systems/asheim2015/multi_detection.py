"""Trackers of one radar for scans with many detections: track management, and PDA."""

from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Positive, Reals, checked, exactly
from ..._typing import FloatArray
from ...estimation import gaussian, recursion
from ...model.motion import ncv_transition
from ...tracking.management import TrackManager
from ...tracking.multi_target import ManagedTrack, track_scans
from ...tracking.pda import pda_update
from .published import reported
from .range_tracker import Detections, Starts
from .settings import FilterSettings

Scans = Annotated[FloatArray, exactly(None)]


@checked
def managed_tracks(
    detections: Annotated[FloatArray, exactly(None, None, 2, check=_checks.bounded)],
    settings: FilterSettings,
) -> list[ManagedTrack]:
    """Track one record with tracks that are started, confirmed and deleted.

    detections (K, M, 2): Range and range rate of each detection; NaN where there is none.
    settings: Settings of the filter of each track; the gate is that on NIS.
    Returns: Those that were ever confirmed.

    Notes
    -----
    `track_scans` with a noise that depends on the range, and with `exclusive` starts: a body gives
    several echoes.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import filter_settings
    >>> scans = [[[2.0, 0.1]], [[2.1, 0.1]], [[2.2, 0.1]]]
    >>> [track.scan.tolist() for track in managed_tracks(scans, filter_settings("modern", 1.0))]
    [[0, 1, 2]]
    """
    s = reported().scenario.surrogate
    tracks = track_scans(
        detections,
        ncv_transition(settings.T, dim=1),
        settings.Q,
        lambda x: x,
        lambda x: np.eye(2),
        lambda x: settings.R(x[..., 0])[..., None] * np.eye(2),
        lambda z: (z, np.broadcast_to(settings.P0, (len(z), 2, 2))),
        TrackManager(s.hits, s.window, s.delete_after),
        gate_probability=settings.gate_probability,
        exclusive=True,
    )
    return [track for track in tracks if track.confirmed.any()]


@checked
def on_track(tracks: list[ManagedTrack], truth: Scans, scans: Reals, limit: Positive) -> bool:
    """Return whether one confirmed track follows the target through some scans.

    tracks: As `managed_tracks` returns them.
    truth (K,): True range at each scan in m.
    scans: The scans, in increasing order.
    limit: Largest error of a range in m.
    Raises ValueError if an argument is not of the kind described, or a track is longer than the
        truth.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import filter_settings
    >>> scans = [[[2.0, 0.1]], [[2.1, 0.1]], [[2.2, 0.1]]]
    >>> tracks = managed_tracks(scans, filter_settings("modern", 1.0))
    >>> on_track(tracks, [2.0, 2.1, 2.2], [1, 2], 0.5)
    True
    """
    for track in tracks:
        there = np.isin(track.scan, scans)
        off = np.abs(track.x[:, 0] - _of(track, truth))[there]
        if there.sum() == np.size(scans) and (off < limit).all():
            return True
    return False


@checked
def false_tracks(tracks: list[ManagedTrack], truth: Scans, limit: Positive) -> int:
    """Return the number of confirmed tracks that do not follow the target.

    tracks: As `managed_tracks` returns them.
    truth (K,): True range at each scan in m.
    limit: A track is false if the median error of its range is larger than this, in m.
    Raises ValueError if an argument is not of the kind described, or a track is longer than the
        truth.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import filter_settings
    >>> scans = [[[2.0, 0.1]], [[2.1, 0.1]], [[2.2, 0.1]]]
    >>> false_tracks(managed_tracks(scans, filter_settings("modern", 1.0)), [4.0, 4.0, 4.0], 0.5)
    1
    """
    off = [np.median(np.abs(track.x[:, 0] - _of(track, truth))) for track in tracks]
    return int(np.sum(np.array(off) > limit))


@checked
def pda_ranges(
    detections: Detections, settings: FilterSettings, *, x0: Starts
) -> tuple[FloatArray, FloatArray]:
    """Run probabilistic data association in place of the nearest neighbor.

    detections (..., K, M, 2): Range and range rate of each detection; NaN where there is none.
    settings: Settings of the filter; the gate is that on NIS.
    x0 (..., 2): State at the first scan.
    Returns x (..., K, 2): Estimates.
        missed (..., K): Probability that no detection is of the target; NaN at the first scan.
    Raises ValueError if an argument is not of the kind described, or there is no scan.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import filter_settings
    >>> detections = [[[2.0, 0.1]], [[2.1, 0.1]], [[np.nan, np.nan]]]
    >>> x, missed = pda_ranges(detections, filter_settings("modern", 1.0), x0=[2.0, 0.1])
    >>> x.shape, float(missed[-1])
    ((3, 2), 1.0)
    """
    z, s = detections, reported().scenario
    own, (near, far) = s.surrogate, s.real.window
    density = own.clutter / ((far - near) * 2 * own.clutter_velocity)
    batch = z.shape[:-3]
    if not z.shape[-3]:
        raise ValueError(f"detections must have a scan, got shape {z.shape}")
    x = _checks.each_run("x0", x0, batch, (2,))
    P = np.broadcast_to(settings.P0, (*batch, 2, 2))
    F = ncv_transition(settings.T, dim=1)

    def step(k, state):
        x, P = gaussian.predict(*state, F, settings.Q)
        R = settings.R(x[..., 0])[..., None] * np.eye(2)
        after = pda_update(
            x, P, z[..., k, :, :], np.eye(2), R,
            detection=own.detection, density=density, gate=settings.gate_probability,
        )  # fmt: skip
        return (after.x, after.P), (after.x, after.missed)

    first = x, np.full(batch, np.nan)
    times = range(1, z.shape[-3])
    x, missed = recursion.scan(step, (x, P), times, len(batch), first=first)
    return x, missed


def _of(track, truth):
    """Return the truth at the scans of a track."""
    if track.scan[-1] >= len(truth):
        raise ValueError(f"truth must have the scans of all tracks, got {len(truth)}")
    return truth[track.scan]
