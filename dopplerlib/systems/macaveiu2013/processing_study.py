"""The scheme of Fig 6 on many records: outcomes for the target, the clutter and the tracks.

The document shows one record of each path and states no number for its scheme. ``make study
NAME=vehicle_tracking`` runs the study; what it found is in ``results`` and read here.
"""

import csv
from collections.abc import Iterable
from dataclasses import fields
from functools import cache, partial
from typing import Annotated, Any, Literal

import numpy as np
from scipy.special import ndtr

from ... import _checks
from ..._data import read_lines, results
from ..._hints import Index, Positive, checked
from ..._records import record
from ..._typing import FloatArray
from ...model.polar_radar import polar_radar_h
from ...tracking.association import gnn_assign
from ...tracking.management import TrackManager
from . import processing
from .processing import VehicleScan
from .published import reported
from .settings import automotive_settings
from .truth import Truth, vehicle_paths

RUNS = 200
SEED = 6
NEAR = processing.LENGTH  # m: a track that is farther from the middle of the target has lost it
VARIANTS: dict[str, dict[str, Any]] = {
    "as in Fig 6": {},
    "rule for new tracks only": {"rule": "new tracks only"},
    "no clutter rule": {"rule": "never"},
    "Hungarian": {"assign": gnn_assign},
    "8 hits of 10": {"manager": TrackManager(hits=8, window=10, delete_after=13)},
    "pedestrian as in Fig 6": {"points": 1},
    "pedestrian with rule for new tracks only": {"points": 1, "rule": "new tracks only"},
}
Figure = Literal[7, 8, 9, 10, 11]
Variant = Literal[
    "as in Fig 6", "rule for new tracks only", "no clutter rule", "Hungarian", "8 hits of 10",
    "pedestrian as in Fig 6", "pedestrian with rule for new tracks only",
]  # fmt: skip
# Figures that a variant is run on, if not on all: those whose target moves at 5 km/h and may be a
# pedestrian, and one that the clutter rule leaves alone.
ONLY = {
    "no clutter rule": (9,),
    "8 hits of 10": (9,),
    "pedestrian as in Fig 6": (8, 11),
    "pedestrian with rule for new tracks only": (8, 11),
}


@checked
@record
class SchemeOutcome:
    """Outcome of the scheme for one record.

    held: Scans in which the target has a confirmed track, no farther from it than `NEAR`.
    first: Number of the first of these scans; that of the scans if there is none.
    breaks: How often the target lost its track, or the last of several.
    tracks: Confirmed tracks of the target. A track is the target's if most of its detections are.
    error: Root mean square distance in m of its oldest track from the middle of the target, in the
        scans in which it is held. NaN if there are none.
    false: Confirmed tracks that are not of the target.
    false_scans: How many scans these were confirmed for, together.
    begun: Tracks begun, most of which are never confirmed.
    """

    held: Index
    first: Index
    breaks: Index
    tracks: Index
    error: Annotated[float, partial(_checks.one_number, check=_checks.real)]
    false: Index
    false_scans: Index
    begun: Index


@checked
@record
class DetectionCounts:
    """Numbers of detections in one record, and of those that the clutter rule deletes.

    target, target_deleted: Detections of the target.
    clutter, clutter_deleted: Detections of what stands still.
    """

    target: Index
    target_deleted: Index
    clutter: Index
    clutter_deleted: Index


@checked
def study_variants(figure: Figure) -> list[str]:
    """Return the names of the variants that are run on a path.

    figure: Number of the figure, 7 to 11.

    Examples
    --------
    >>> study_variants(7)
    ['as in Fig 6', 'rule for new tracks only', 'Hungarian']
    """
    return [name for name in VARIANTS if figure in ONLY.get(name, (figure,))]


@checked
def study_record(figure: Figure, run: Index, variant: Variant = "as in Fig 6") -> list[VehicleScan]:
    """Return the scans of one record of the study.

    figure: Number of the figure, 7 to 11.
    run: Number of the run.
    variant: One of `study_variants` of any figure. All that have the same target get the same
        scans.

    Examples
    --------
    >>> len(study_record(7, 0))
    500
    """
    rng = np.random.default_rng([SEED, figure, run])
    points = VARIANTS[variant].get("points", processing.POINTS)
    return processing.simulate_scans(vehicle_paths()[figure].truth, rng=rng, points=points)


@checked
def study_outcome(
    scans: Iterable[VehicleScan], truth: Truth, variant: Variant = "as in Fig 6"
) -> SchemeOutcome:
    """Process a record and return the outcome for the target.

    scans: From `simulate_scans`.
    truth (K, 4): True states of the target.
    variant: See `study_variants`.
    Returns: Its error is NaN where the target has no track.
    Raises ValueError if an argument is not of the kind described, or there is not one scan for each
        true state.

    Examples
    --------
    >>> truth = np.linspace([0.0, 0.0, 5.0, 2.0], [0.0, 0.0, 5.8, 2.0], 11)
    >>> scans = processing.simulate_scans(truth, rng=np.random.default_rng(1))
    >>> study_outcome(scans, truth).tracks
    1
    """
    scans = tuple(scans)
    if len(scans) != len(truth):
        raise ValueError(f"scans must be {len(truth)} as true states, got {len(scans)}")
    options = {name: value for name, value in VARIANTS[variant].items() if name != "points"}
    tracks = processing.track_objects(scans, **options)
    kept = processing.after_clutter_rule(scans, options.get("rule", "always"))
    own = [_of_target(scan) for scan in kept]
    good, false = [], []
    for track in tracks:
        if track.confirmed.any():
            (good if _mostly(track, own) else false).append(track)
    distance = np.full((len(good) + 1, len(scans)), np.inf)
    for row, track in zip(distance, good, strict=False):
        scan = track.scan[track.confirmed]
        off = track.x[track.confirmed, ::2] - truth[scan, ::2]
        row[scan] = np.hypot(*off.T)
    near = distance <= NEAR
    held = near.any(axis=0)
    oldest = distance[near.argmax(axis=0), np.arange(len(scans))][held]
    return SchemeOutcome(
        held=int(held.sum()),
        first=int(held.argmax()) if held.any() else len(scans),
        breaks=int(np.sum(held[:-1] & ~held[1:])),
        tracks=len(good),
        error=float(np.sqrt(np.mean(oldest**2))) if held.any() else np.nan,
        false=len(false),
        false_scans=int(sum(track.confirmed.sum() for track in false)),
        begun=len(tracks),
    )


def _of_target(scan):
    """Return which objects of a scan hold more detections of the target than others."""
    means, member = processing.group_detections(scan.z)
    votes = np.bincount(member, scan.source == processing.TARGET, len(means))
    return votes > np.bincount(member, minlength=len(means)) / 2


def _mostly(track, own):
    """Return whether most detections of a track are of the target."""
    seen = track.detection >= 0
    pairs = zip(track.scan[seen], track.detection[seen], strict=True)
    return np.mean([own[scan][detection] for scan, detection in pairs]) > 0.5


@checked
def count_detections(scans: Iterable[VehicleScan]) -> DetectionCounts:
    """Count the detections of a record, and those that the clutter rule deletes.

    scans: From `simulate_scans`.
    Raises ValueError if there is no scan.

    Examples
    --------
    >>> scan = VehicleScan([[5.0, 0.0, 1.0], [5.0, 0.0, 0.1]], [0, 1])
    >>> count_detections([scan])
    DetectionCounts(target=1, target_deleted=0, clutter=1, clutter_deleted=1)
    """
    scans = tuple(scans)
    if not scans:
        raise ValueError("scans must be one or more, got none")
    z = np.concatenate([scan.z for scan in scans])
    source = np.concatenate([scan.source for scan in scans])
    slow = ~processing.is_moving(z)
    target, clutter = source == processing.TARGET, source == processing.CLUTTER
    numbers = (target, target & slow, clutter, clutter & slow)
    return DetectionCounts(*(int(one.sum()) for one in numbers))


@checked
def deleted_fraction(
    truth: Truth | None = None, limit: Positive | None = None, sigma_rate: Positive | None = None
) -> float:
    """Predict the fraction of the detections that the clutter rule deletes.

    truth (K, 4): True states of the middle of the target; if None, that of what stands still.
    limit: Range rate in m/s below which a detection is deleted; that of the data file if None.
    sigma_rate: Standard deviation of a measured range rate in m/s; that of the data file if None.
    Returns: Mean, over scans and reflection points, of the probability that the noise leaves the
        range rate within the limit.
    Raises ValueError if an argument is not of the kind described, or a point is on the radar.

    Examples
    --------
    >>> round(deleted_fraction(), 2)
    0.9
    """
    radar = reported().scenario.polar
    limit = radar.v_min if limit is None else limit
    sigma_rate = radar.sigma_rate if sigma_rate is None else sigma_rate
    rate = (
        np.zeros(1) if truth is None else polar_radar_h(processing.reflection_points(truth))[..., 2]
    )
    ends = [(sign * limit - rate) / sigma_rate for sign in (1, -1)]
    return float(np.mean(ndtr(ends[0]) - ndtr(ends[1])))


@cache
def saved_outcomes() -> dict[tuple[int, str], dict[str, FloatArray]]:
    """Return the saved outcomes of the study.

    Returns (runs,): For each attribute of `SchemeOutcome` its values in all runs, as floats; an
        error may be NaN.

    Examples
    --------
    >>> len(saved_outcomes()[7, "Hungarian"]["held"])
    200
    """
    return _read("vehicle_tracking.tracks.csv", ("figure", "variant"), SchemeOutcome)


@cache
def saved_detections() -> dict[int, dict[str, FloatArray]]:
    """Return the saved detection counts of the study.

    Returns (runs,): For each figure and each attribute of `DetectionCounts` its values in all runs,
        as floats.

    Examples
    --------
    >>> len(saved_detections()[7]["target"])
    200
    """
    by_figure = _read("vehicle_tracking.detections.csv", ("figure",), DetectionCounts)
    return {figure: values for (figure,), values in by_figure.items()}


@checked
def outcome_summary(figure: Figure, variant: Variant) -> dict[str, np.ndarray]:
    """Return the columns of a table of the study, run by run.

    figure: Number of the figure, 7 to 11.
    variant: One of `study_variants` of it.
    Returns (runs,): Numbers, and booleans where the fraction of records is of interest. Errors are
        those of the records in which the target was tracked at all.
    Raises ValueError if an argument is not of the kind described, or the variant is none of the
        figure.

    Examples
    --------
    >>> len(outcome_summary(7, "Hungarian"))
    7
    """
    _checks.one_of("variant", variant, tuple(study_variants(figure)))
    s, one = automotive_settings(), saved_outcomes()[figure, variant]
    return {
        "no track (% of scans)": 100 * (1 - one["held"] / s.samples),
        "track within 1 s": one["first"] * s.T <= 1,
        "track lost": one["breaks"] > 0,
        "tracks on target": one["tracks"],
        "error (m)": one["error"][np.isfinite(one["error"])],
        "false tracks": one["false"],
        "their life (s)": s.T * one["false_scans"],
    }


def _read(name, keys, kind):
    found = {}
    for row in csv.DictReader(read_lines(name, folder=results)):
        numbers = [int(row[key]) for key in keys]
        key = (numbers[0], *(list(VARIANTS)[number - 1] for number in numbers[1:]))
        found.setdefault(key, []).append([float(row[f.name]) for f in fields(kind)])
    names = [field.name for field in fields(kind)]
    return {key: dict(zip(names, np.array(rows).T, strict=True)) for key, rows in found.items()}
