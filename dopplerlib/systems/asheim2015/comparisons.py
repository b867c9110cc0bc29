"""Comparisons of trackers beyond those of the thesis."""

from dataclasses import replace
from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Positive, Real, Runs, checked, exactly
from ..._typing import FloatArray
from ...evaluation.bootstrap import bootstrap_interval
from ...evaluation.intervals import ConfidenceInterval
from .cartesian_tracker import central_filter
from .measures import position_errors, rmse_interval, usable_interval
from .noise import _near
from .position_tracker import PositionTrack, filter_then_bilaterate
from .published import reported
from .scene import RadarRecords, simulate_radars, straight_track
from .settings import filter_settings


def _positive(name, value, shape):
    return _checks.positive(name, _near(name, value, shape))


Values = Annotated[FloatArray, exactly(None, check=_near)]
Positives = Annotated[FloatArray, exactly(None, check=_positive)]


@checked
def usable_ranges(
    records: RadarRecords, tracks: dict[str, PositionTrack], *, rng: np.random.Generator
) -> dict[str, ConfidenceInterval]:
    """Return the usable range of several trackers on the same records.

    records: What both radars measured.
    tracks: Trackers by label.
    rng: Source of the resampling.
    Returns: In m; infinite if the error stays below the limit.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import raw_positions
    >>> records = simulate_radars(2, rng=np.random.default_rng(1))
    >>> tracks = {"measured": raw_positions(records)}
    >>> print(usable_ranges(records, tracks, rng=np.random.default_rng(2))["measured"])
    4.33 (4.23 to 4.33)
    """
    return {
        label: usable_interval(
            position_errors(track.p, records.truth), records.time, records.distance, rng=rng
        )
        for label, track in tracks.items()
    }


@checked
def late_radar(
    offsets: Values,
    runs: Runs,
    *,
    rng: np.random.Generator,
    window: tuple[Real, Real] = (25.0, 30.0),
) -> dict[str, list[ConfidenceInterval]]:
    """Return position errors if the second radar measures later, known to the tracker or not.

    offsets (M,): How much later, in s, from 0 to one scan.
    runs: Number of records for each offset.
    rng: Source of the noise and of the resampling.
    window: Time interval over which errors are averaged, in s.
    Returns: Root mean square errors in m by tracker, one for each offset, with one scan a second.
        Errors are taken at the time of the second radar's measurement if the tracker knows it, and
        of the first one's if not.

    Examples
    --------
    >>> found = late_radar([0.5], 2, rng=np.random.default_rng(1))
    >>> len(found)
    4
    """
    T = reported().scenario.real.T
    if (offsets < 0).any() or (offsets > T).any():
        raise ValueError(f"offsets must lie between 0 and {T} s, got {offsets.tolist()}")
    own = filter_settings("modern", T)
    names = (
        "apart, delay ignored",
        "one filter, delay ignored",
        "apart, first estimate moved on",
        "one filter, each detection at its time",
    )
    found = {name: [] for name in names}
    for offset, child in zip(offsets, rng.spawn(len(offsets)), strict=True):
        records = simulate_radars(runs, rng=child, T=T, offset=float(offset), rate="exact")
        ignorant = records.with_offset(0.0)
        then = (records.time >= window[0]) & (records.time <= window[1])
        later = straight_track(records.time + offset)
        for name, track, truth in zip(
            names,
            (
                filter_then_bilaterate(records, own),
                central_filter(ignorant, own),
                filter_then_bilaterate(records, own, advance=True),
                central_filter(records, own),
            ),
            (records.truth, records.truth, later, later),
            strict=True,
        ):
            squares = np.mean(position_errors(track.p, truth)[:, then] ** 2, axis=1)
            found[name].append(bootstrap_interval(np.sqrt, [squares], rng=child))
    return found


@checked
def baseline_sweep(
    baselines: Positives,
    runs: Runs,
    *,
    rng: np.random.Generator,
    at: Positive = 28.0,
    half_width: Positive = 2.0,
) -> dict[str, list[ConfidenceInterval]]:
    """Return position errors of two trackers for several distances between the radars.

    baselines (M,): In m.
    runs: Number of records for each.
    rng: Source of the noise and of the resampling.
    at, half_width: Errors are averaged from `at` - `half_width` to `at` + `half_width`, in s.
    Returns: Root mean square errors in m by tracker, one for each baseline, with one scan a second
        and "modern" settings.

    Examples
    --------
    >>> found = baseline_sweep([0.6], 2, rng=np.random.default_rng(1), at=5.0)
    >>> list(found)
    ['filter then bilaterate', 'one filter for both']
    """
    T = reported().scenario.real.T
    own = filter_settings("modern", T)
    found = {"filter then bilaterate": [], "one filter for both": []}
    for baseline, child in zip(baselines, rng.spawn(len(baselines)), strict=True):
        records = simulate_radars(
            runs, rng=child, T=T, duration=at + half_width, baseline=float(baseline), rate="exact"
        )
        tracks = filter_then_bilaterate(records, own), central_filter(records, own)
        for values, track in zip(found.values(), tracks, strict=True):
            error = position_errors(track.p, records.truth)
            values.append(rmse_interval(error, records.time, at, half_width, rng=child))
    return found


@checked
def rejected_scans(
    starts: Values,
    densities: Positives,
    runs: Runs,
    *,
    rng: np.random.Generator,
    duration: Positive = 10.0,
    floor: tuple[Real, Real] | None = (0.0, 0.0),
) -> list[list[ConfidenceInterval]]:
    """Return the fraction of scans that the gate of a single filter rejects after a start at rest.

    starts (M,): How far in front of the origin the filter starts, in m; the person starts at the
        origin.
    densities (J,): Spectral densities of the acceleration in m^2/s^3.
    runs: Number of records; all combinations see the same.
    rng: Source of the noise and of the resampling.
    duration: Length of the records in s.
    floor: Least standard deviations in m and m/s; that of the scenario if None.
    Returns: Fractions of the scans of radar 2 that the gate rejected, for each start and density.

    Examples
    --------
    >>> (row,) = rejected_scans([0.1], [1e-3, 1e-2], 2, rng=np.random.default_rng(1), duration=1.0)
    >>> len(row)
    2
    """
    records = simulate_radars(runs, rng=rng, duration=duration, rate="exact")
    # All starts are filtered together.
    many = replace(records, z=np.tile(records.z, (len(starts), 1, 1, 1)))
    begin = np.zeros((len(many.z), 4))
    begin[:, 1] = np.repeat(starts, runs)
    rejected = []
    for q in densities:
        own = filter_settings("modern", q=float(q), floor=floor)
        used = central_filter(many, own, start=begin).updated[:, 1]
        rejected.append(np.split((~used).mean(axis=1), len(starts)))
    return [
        [bootstrap_interval(np.positive, [row[m]], rng=rng) for row in rejected]
        for m in range(len(starts))
    ]
