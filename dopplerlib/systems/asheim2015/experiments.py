"""Comparisons of trackers beyond those of the thesis."""

import numpy as np

from ... import _checks
from .in_the_plane import central_filter
from .measures import distance_error
from .published import scenario, settings
from .resampling import over_runs, usable_interval
from .scene import simulate, straight_track
from .two_radars import filter_then_triangulate


def usable_ranges(records, tracks, *, rng):
    """Return the usable range of several trackers on the same records.

    Parameters
    ----------
    records : Records
        What both radars measured.
    tracks : dict of str to PositionTrack
        Trackers by label.
    rng : numpy.random.Generator
        Source of the resampling.

    Returns
    -------
    dict of str to Estimate
        In m; infinite if the error stays below the limit.
    """
    return {
        label: usable_interval(
            distance_error(track.p, records.truth), records.time, records.distance, rng=rng
        )
        for label, track in tracks.items()
    }


def late_radar(offsets, runs, *, rng, window=(25.0, 30.0)):
    """Return position errors if the second radar measures later, known to the tracker or not.

    Parameters
    ----------
    offsets : array_like, shape (M,)
        How much later, in s, from 0 to one scan.
    runs : int
        Number of records for each offset.
    rng : numpy.random.Generator
        Source of the noise and of the resampling.
    window : tuple of float
        Time interval over which errors are averaged, in s.

    Returns
    -------
    dict of str to list of Estimate
        Root mean square errors in m by tracker, one for each offset, with one scan a second.
        Errors are taken at the time of the second radar's measurement if the tracker knows it,
        and of the first one's if not.
    """
    offsets = _checks.finite("offsets", offsets, (None,))
    T = scenario()["real"]["T"]
    own = settings("modern", T)
    names = (
        "apart, delay ignored",
        "one filter, delay ignored",
        "apart, first estimate moved on",
        "one filter, each detection at its time",
    )
    found = {name: [] for name in names}
    for offset, child in zip(offsets, rng.spawn(len(offsets)), strict=True):
        records = simulate(runs, rng=child, T=T, offset=float(offset), rate="exact")
        ignorant = records.with_offset(0.0)
        then = (records.time >= window[0]) & (records.time <= window[1])
        later = straight_track(records.time + offset)
        for name, track, truth in zip(
            names,
            (
                filter_then_triangulate(records, own),
                central_filter(ignorant, own),
                filter_then_triangulate(records, own, advance=True),
                central_filter(records, own),
            ),
            (records.truth, records.truth, later, later),
            strict=True,
        ):
            squares = np.mean(distance_error(track.p, truth)[:, then] ** 2, axis=1)
            found[name].append(over_runs(lambda s: np.sqrt(s.mean()), squares, rng=child))
    return found
