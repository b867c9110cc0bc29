"""From two radars to a position: two circles, of ranges as measured or as filtered."""

from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Array, Booleans, Positive, checked, exactly, shaped
from ..._records import record
from ..._typing import BoolArray, FloatArray
from ...tracking.bilateration import bilaterate
from .range_tracker import RangeTrack, track_ranges
from .scene import RadarRecords
from .settings import FilterSettings

Used = Annotated[BoolArray, exactly(None, 2, None, check=_checks.booleans)]


@checked
@record
class PositionTrack:
    """Estimated positions, and what they come from.

    p (runs, K, 2): Estimated positions in m.
    valid (runs, K): Whether the circles met; always True for a filter in the plane.
    updated (runs, 2, K): Whether each radar's detection was used.
    x (runs, K, 4): States of the filter in the plane, if there is one.
    P (runs, K, 4, 4): Their covariances.
    nis (runs, 2, K): Normalized innovation squared for each radar.
    """

    p: Annotated[FloatArray, shaped(None, 2, check=_checks.measured)]
    valid: Booleans
    updated: Booleans
    x: Annotated[FloatArray, shaped(None, 4)] | None = None
    P: Annotated[FloatArray, shaped(None, 4, 4)] | None = None
    nis: Array | None = None


@checked
def clipped_bilateration(d1: Array, d2: Array, baseline: Positive) -> tuple[FloatArray, BoolArray]:
    """Return positions from two ranges, with y = 0 where the circles do not meet.

    d1, d2 (...): Ranges in m.
    baseline: Distance between the radars in m.
    Returns p (..., 2): In m; NaN where a range is missing.
        valid (...): Whether the circles met.

    Notes
    -----
    Åsheim (2015), Eq 5.8 with Appendix A.8, which takes the real part of the root of a negative
    number: zero, without a word. `bilaterate` tells the two cases apart.

    Examples
    --------
    >>> p, valid = clipped_bilateration([2.0, 1.0], [2.0, 4.0], 1.0)
    >>> p.round(2).tolist(), valid.tolist()
    ([[0.0, 1.94], [-7.5, 0.0]], [True, False])
    """
    x, y, valid = bilaterate(d1, d2, baseline)
    return np.stack([x, np.where(valid | np.isnan(x), y, 0.0)], axis=-1), valid


@checked
def filter_then_bilaterate(
    records: RadarRecords,
    settings: FilterSettings,
    *,
    advance: bool = False,
    track: RangeTrack | None = None,
    doppler: bool = True,
) -> PositionTrack:
    """Filter each radar by itself and bilaterate the estimates: the thesis's system.

    records: What both radars measured.
    settings: How each filter is set.
    advance: Whether the first radar's estimate is moved on to the time of the second one's.
    track: What `track_ranges` returned for these records, if that is known already.
    doppler: See `track_ranges`.
    Raises ValueError if an argument is not of the kind described, or `track` is that of other
        records.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import filter_settings, simulate_radars
    >>> records = simulate_radars(2, rng=np.random.default_rng(1), duration=1.0)
    >>> filter_then_bilaterate(records, filter_settings("code")).p.shape
    (2, 11, 2)
    """
    if track is None:
        track = track_ranges(records.z[..., None, :], settings, doppler=doppler)
    if track.x.shape != records.z.shape:
        raise ValueError(f"track must have x of shape {records.z.shape}, got {track.x.shape}")
    d = track.x[..., 0].copy()
    if advance:
        d[:, 0] += records.offset * track.x[:, 0, :, 1]
    p, valid = clipped_bilateration(d[:, 0], d[:, 1], records.baseline)
    return PositionTrack(p, valid, track.updated, nis=track.nis)


@checked
def raw_positions(records: RadarRecords, updated: Used | None = None) -> PositionTrack:
    """Bilaterate the measurements as they are, without a filter.

    records: What both radars measured.
    updated (runs, 2, K): Take only these detections: the blue curves of Fig 5.10 have been through
        the gate.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import simulate_radars
    >>> records = simulate_radars(2, rng=np.random.default_rng(1), duration=1.0)
    >>> raw_positions(records).p.shape
    (2, 11, 2)
    """
    d = records.z[..., 0]
    if updated is None:
        updated = np.ones(d.shape, bool)
    if updated.shape != d.shape:
        raise ValueError(f"updated must have shape {d.shape}, got {updated.shape}")
    d = np.where(updated, d, np.nan)
    p, valid = clipped_bilateration(d[:, 0], d[:, 1], records.baseline)
    return PositionTrack(p, valid, updated)
