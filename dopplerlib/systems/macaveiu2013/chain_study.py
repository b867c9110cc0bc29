"""The scheme of Fig 6 on many records: what becomes of the target, of the clutter, of the tracks.

The document shows one record of each path and states no number for its scheme. ``make study
NAME=vehicle_tracking`` runs the study; what it found is in ``results`` and read here.
"""

import csv
from dataclasses import fields
from functools import cache

import numpy as np
from scipy.special import ndtr

from ... import _checks, _records
from ..._data import read_lines, results
from ...model.polar_radar import polar_radar_h
from ...tracking.association import gnn_assign
from ...tracking.management import TrackManager
from . import chain, polar
from .published import paths, settings

RUNS = 200
SEED = 6
NEAR = chain.LENGTH  # m: a track that is farther from the middle of the target has lost it
VARIANTS = {
    "as in Fig 6": {},
    "rule for new tracks only": {"rule": "new tracks only"},
    "no clutter rule": {"rule": "never"},
    "Hungarian": {"assign": gnn_assign},
    "8 hits of 10": {"manager": TrackManager(hits=8, window=10, delete_after=13)},
    "pedestrian as in Fig 6": {"points": 1},
    "pedestrian with rule for new tracks only": {"points": 1, "rule": "new tracks only"},
}
# Figures that a variant is run on, if not on all: those whose target moves at 5 km/h and may be a
# pedestrian, and one that the clutter rule leaves alone.
ONLY = {
    "no clutter rule": (9,),
    "8 hits of 10": (9,),
    "pedestrian as in Fig 6": (8, 11),
    "pedestrian with rule for new tracks only": (8, 11),
}


@_records.record
class Outcome:
    """What the scheme made of one record.

    Attributes
    ----------
    held : int
        Scans in which the target has a confirmed track, no farther from it than `NEAR`.
    first : int
        Number of the first of these scans; that of the scans if there is none.
    breaks : int
        How often the target lost its track, or the last of several.
    tracks : int
        Confirmed tracks of the target. A track is the target's if most of its detections are.
    error : float
        Root mean square distance in m of its oldest track from the middle of the target, in the
        scans in which it is held. NaN if there are none.
    false : int
        Confirmed tracks that are not of the target.
    false_scans : int
        How many scans these were confirmed for, together.
    begun : int
        Tracks begun, most of which are never confirmed.
    """

    held: int
    first: int
    breaks: int
    tracks: int
    error: float
    false: int
    false_scans: int
    begun: int


@_records.record
class Counts:
    """How many detections of one record there are, and how many the clutter rule calls clutter.

    Attributes
    ----------
    target, target_deleted : int
        Detections of the target.
    clutter, clutter_deleted : int
        Detections of what stands still.
    """

    target: int
    target_deleted: int
    clutter: int
    clutter_deleted: int


def variants(figure):
    """Return the names of the variants that are run on a path.

    Parameters
    ----------
    figure : int
        Number of the figure, 7 to 11.

    Returns
    -------
    list of str
    """
    return [name for name in VARIANTS if figure in ONLY.get(name, (figure,))]


def record(figure, run, variant="as in Fig 6"):
    """Return the scans of one record of the study.

    Parameters
    ----------
    figure : int
        Number of the figure, 7 to 11.
    run : int
        Number of the run.
    variant : str
        One of `VARIANTS`. All that have the same target get the same scans.

    Returns
    -------
    list of Scan
    """
    rng = np.random.default_rng([SEED, figure, run])
    points = VARIANTS[variant].get("points", chain.POINTS)
    return chain.simulate(paths()[figure].truth, rng=rng, points=points)


def outcome(scans, truth, variant="as in Fig 6"):
    """Process a record and say what became of the target.

    Parameters
    ----------
    scans : sequence of Scan
        From `chain.simulate`.
    truth : ndarray, shape (K, 4)
        True states of the target.
    variant : str
        One of `VARIANTS`.

    Returns
    -------
    Outcome

    Raises
    ------
    ValueError
        If `variant` is unknown.
    """
    _checks.one_of("variant", variant, tuple(VARIANTS))
    options = {name: value for name, value in VARIANTS[variant].items() if name != "points"}
    tracks = chain.run(scans, **options)
    kept = chain.after_rule(scans, options.get("rule", "always"))
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
    return Outcome(
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
    means, member = chain.objects(scan.z)
    votes = np.bincount(member, scan.source == chain.TARGET, len(means))
    return votes > np.bincount(member, minlength=len(means)) / 2


def _mostly(track, own):
    """Return whether most detections of a track are of the target."""
    seen = track.detection >= 0
    pairs = zip(track.scan[seen], track.detection[seen], strict=True)
    return np.mean([own[scan][detection] for scan, detection in pairs]) > 0.5


def counts(scans):
    """Count the detections of a record, and those that the clutter rule deletes.

    Parameters
    ----------
    scans : sequence of Scan
        From `chain.simulate`.

    Returns
    -------
    Counts
    """
    z = np.concatenate([scan.z for scan in scans])
    source = np.concatenate([scan.source for scan in scans])
    slow = ~chain.moves(z)
    target, clutter = source == chain.TARGET, source == chain.CLUTTER
    numbers = (target, target & slow, clutter, clutter & slow)
    return Counts(*(int(one.sum()) for one in numbers))


def deleted_share(truth=None, limit=None):
    """Predict the share of the detections that the clutter rule deletes.

    Parameters
    ----------
    truth : ndarray, shape (K, 4), optional
        True states of the middle of the target; if None, that of what stands still.
    limit : float, optional
        Range rate in m/s below which a detection is deleted; that of the data file if None.

    Returns
    -------
    float
        Mean, over scans and reflection points, of the probability that the noise leaves the range
        rate within the limit.
    """
    radar = polar.sensor()
    limit = radar["v_min"] if limit is None else limit
    rate = np.zeros(1) if truth is None else polar_radar_h(chain.reflection_points(truth))[..., 2]
    ends = [(sign * limit - rate) / radar["sigma_rate"] for sign in (1, -1)]
    return float(np.mean(ndtr(ends[0]) - ndtr(ends[1])))


@cache
def outcomes():
    """Return what the study found.

    Returns
    -------
    dict of tuple (figure, variant) to dict of str to ndarray, shape (runs,)
        For each attribute of `Outcome` its values in all runs, as floats.
    """
    return _read("vehicle_tracking.tracks.csv", ("figure", "variant"), Outcome)


@cache
def detections():
    """Return what the study counted.

    Returns
    -------
    dict of int to dict of str to ndarray, shape (runs,)
        For each figure and each attribute of `Counts` its values in all runs, as floats.
    """
    by_figure = _read("vehicle_tracking.detections.csv", ("figure",), Counts)
    return {figure: values for (figure,), values in by_figure.items()}


def summary(figure, variant):
    """Return what a table of the study shows, run by run.

    Parameters
    ----------
    figure : int
        Number of the figure, 7 to 11.
    variant : str
        One of `variants` of it.

    Returns
    -------
    dict of str to ndarray, shape (runs,)
        Numbers, and booleans where the share of the records is of interest. Errors are those of
        the records in which the target was tracked at all.
    """
    s, one = settings(), outcomes()[figure, variant]
    return {
        "no track, % of scans": 100 * (1 - one["held"] / s.samples),
        "track within 1 s": one["first"] * s.T <= 1,
        "track lost": one["breaks"] > 0,
        "tracks on target": one["tracks"],
        "error in m": one["error"][np.isfinite(one["error"])],
        "false tracks": one["false"],
        "their life in s": s.T * one["false_scans"],
    }


def _read(name, keys, kind):
    found = {}
    for row in csv.DictReader(read_lines(name, folder=results)):
        numbers = [int(row[key]) for key in keys]
        key = (numbers[0], *(list(VARIANTS)[number - 1] for number in numbers[1:]))
        found.setdefault(key, []).append([float(row[f.name]) for f in fields(kind)])
    names = [field.name for field in fields(kind)]
    return {key: dict(zip(names, np.array(rows).T, strict=True)) for key, rows in found.items()}
