"""From two radars to a position: two circles, of ranges as measured or as filtered."""

import numpy as np

from ..._records import record
from ...tracking.bilateration import bilaterate
from .one_radar import filter_radar


@record
class PositionTrack:
    """Estimated positions, and what they come from.

    Attributes
    ----------
    p : ndarray, shape (runs, K, 2)
        Estimated positions in m.
    valid : ndarray of bool, shape (runs, K)
        Whether the circles met; always True for a filter in the plane.
    updated : ndarray of bool, shape (runs, 2, K)
        Whether each radar's detection was used.
    x : ndarray, shape (runs, K, 4), or None
        States of the filter in the plane, if there is one.
    P : ndarray, shape (runs, K, 4, 4), or None
        Their covariances.
    nis : ndarray, shape (runs, 2, K), or None
        Normalized innovation squared for each radar.
    """

    p: np.ndarray
    valid: np.ndarray
    updated: np.ndarray
    x: np.ndarray | None = None
    P: np.ndarray | None = None
    nis: np.ndarray | None = None


def triangulate(d1, d2, baseline):
    """Return positions from two ranges, with y = 0 where the circles do not meet.

    Parameters
    ----------
    d1, d2 : array_like, shape (...)
        Ranges in m.
    baseline : float
        Distance between the radars in m.

    Returns
    -------
    p : ndarray, shape (..., 2)
        In m; NaN where a range is missing.
    valid : ndarray of bool, shape (...)
        Whether the circles met.

    Notes
    -----
    Åsheim (2015), Eq 5.8 with Appendix A.8, which takes the real part of the root of a negative
    number: zero, without a word. `bilaterate` tells the two cases apart.
    """
    x, y, valid = bilaterate(d1, d2, baseline)
    return np.stack([x, np.where(valid | np.isnan(x), y, 0.0)], axis=-1), valid


def filter_then_triangulate(records, settings, *, advance=False, track=None, **options):
    """Filter each radar by itself and triangulate the estimates: the thesis's system.

    Parameters
    ----------
    records : Records
        What both radars measured.
    settings : Settings
        How each filter is set.
    advance : bool
        Whether the first radar's estimate is moved on to the time of the second one's.
    track : RadarTrack, optional
        What `filter_radar` returned for these records, if that is known already.
    **options
        See `filter_radar`.

    Returns
    -------
    PositionTrack
    """
    if track is None:
        track = filter_radar(records.z[..., None, :], settings, **options)
    d = track.x[..., 0].copy()
    if advance:
        d[:, 0] += records.offset * track.x[:, 0, :, 1]
    p, valid = triangulate(d[:, 0], d[:, 1], records.baseline)
    return PositionTrack(p, valid, track.updated, nis=track.nis)


def raw_positions(records, updated=None):
    """Triangulate the measurements as they are, without a filter.

    Parameters
    ----------
    records : Records
        What both radars measured.
    updated : ndarray of bool, shape (runs, 2, K), optional
        Take only these detections: the blue curves of Fig 5.10 have been through the gate.

    Returns
    -------
    PositionTrack
    """
    d = records.z[..., 0]
    if updated is None:
        updated = np.ones(d.shape, bool)
    d = np.where(updated, d, np.nan)
    p, valid = triangulate(d[:, 0], d[:, 1], records.baseline)
    return PositionTrack(p, valid, updated)
