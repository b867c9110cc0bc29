"""Comparisons of trackers beyond those of the thesis."""

import numpy as np

from ... import _checks
from ...evaluation.bootstrap import bootstrap_interval
from .in_the_plane import central_filter
from .measures import distance_error, rmse_interval, usable_interval
from .published import scenario, settings
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
    dict of str to ConfidenceInterval
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
    dict of str to list of ConfidenceInterval
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
            found[name].append(bootstrap_interval(np.sqrt, [squares], rng=child))
    return found


def baseline_sweep(baselines, runs, *, rng, at=28.0, half_width=2.0):
    """Return position errors of two trackers for several distances between the radars.

    Parameters
    ----------
    baselines : array_like, shape (M,)
        In m.
    runs : int
        Number of records for each.
    rng : numpy.random.Generator
        Source of the noise and of the resampling.
    at, half_width : float
        Errors are averaged from `at` - `half_width` to `at` + `half_width`, in s.

    Returns
    -------
    dict of str to list of ConfidenceInterval
        Root mean square errors in m by tracker, one for each baseline, with one scan a second and
        "modern" settings.
    """
    baselines = _checks.finite("baselines", baselines, (None,))
    T = scenario()["real"]["T"]
    own = settings("modern", T)
    found = {"filter then triangulate": [], "one filter for both": []}
    for baseline, child in zip(baselines, rng.spawn(len(baselines)), strict=True):
        records = simulate(
            runs, rng=child, T=T, duration=at + half_width, baseline=float(baseline), rate="exact"
        )
        tracks = filter_then_triangulate(records, own), central_filter(records, own)
        for values, track in zip(found.values(), tracks, strict=True):
            error = distance_error(track.p, records.truth)
            values.append(rmse_interval(error, records.time, at, half_width, rng=child))
    return found


def refused_scans(starts, densities, runs, *, rng, duration=10.0, floor=(0.0, 0.0)):
    """Return how much of a radar the gate of a single filter refuses after a start at rest.

    Parameters
    ----------
    starts : array_like, shape (M,)
        How far in front of the origin the filter starts, in m; the person starts at the origin.
    densities : array_like, shape (J,)
        Spectral densities of the acceleration in m^2/s^3.
    runs : int
        Number of records; all combinations see the same.
    rng : numpy.random.Generator
        Source of the noise and of the resampling.
    duration : float
        Length of the records in s.
    floor : tuple of float, or None
        Least standard deviations in m and m/s; that of the scenario if None.

    Returns
    -------
    list of list of ConfidenceInterval
        Shares of the scans of radar 2 that the gate dropped, for each start and density.
    """
    starts, densities = (
        _checks.finite(name, values, (None,))
        for name, values in (("starts", starts), ("densities", densities))
    )
    records = simulate(runs, rng=rng, duration=duration, rate="exact")
    found = []
    for y in starts:
        row = []
        for q in densities:
            own = settings("modern", q=float(q), floor=floor)
            used = central_filter(records, own, start=[0.0, y, 0.0, 0.0]).updated[:, 1]
            row.append(bootstrap_interval(np.positive, [(~used).mean(axis=1)], rng=rng))
        found.append(row)
    return found
