"""Decisions of several trackers to stop on the same courses: runs, statistics, a saved study.

``SCENES`` are the targets: those of the workspace, and at 2 m/s; ``SCENES[name].trackers`` are the
names in ``LABELS`` of the trackers that follow them.
"""

from functools import cache, partial
from io import BytesIO
from typing import Annotated, Literal, NamedTuple

import numpy as np

from .. import _checks
from .._data import results
from .._hints import Array, Count, Index, Probability, checked
from .._records import record
from .._typing import FloatArray, IntArray
from ..estimation.gaussian_sum import gaussian_sum
from ..evaluation.intervals import ConfidenceInterval, proportion_interval, quantile_interval
from .comparison import PRIORS
from .stopping import (
    RULES,
    SAMPLES,
    Courses,
    draw_courses,
    judge_stops,
    stop_times,
)
from .targets import ARRAY, INTERVAL, PRIOR_COVARIANCE, PRIOR_MEAN, SIGMA_A, SIGMA_F, draw_records
from .trackers import track_targets

EVERY = 5  # samples from one decision to the next
THRESHOLDS = 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95, 0.98
_MEMBERS, _LIGHT = 40, 1e-3  # of the mixture: those that weigh less are left out
_NONE = 255  # number of a decision that is never taken

LABELS = {
    "truth": "truth known",
    "bank": "Gaussian sum",
    "moments": "Gaussian sum, its mean and covariance only",
    "paper": "EKF, ML start, P = 0.1 I (paper)",
    "ekf_bayes": "EKF, Bayes start",
    "ekf": "EKF from the prior",
    "ukf": "UKF from the prior",
    "ring_iekf": "IEKF in ring coordinates",
    "bank_half": "Gaussian sum, half of sigma_a",
    "bank_double": "Gaussian sum, twice sigma_a",
    "bank_broad": "Gaussian sum, broad prior",
}
# What a sum of Gaussians believes that is not so: factor of sigma_a, and its prior.
_BELIEFS = {
    "bank": (),
    "bank_half": (0.5, "own"),
    "bank_double": (2.0, "own"),
    "bank_broad": (1.0, "broad"),
}


def _edges(name, value):
    edges = _checks.one_row(name, value, least=2)
    if not (np.diff(edges) > 0).all():
        raise ValueError(f"{name} must ascend, got {edges.tolist()}")
    return edges


class _Scene(NamedTuple):
    """Targets, and who tracks them."""

    place: int  # of the targets, part of the seed
    speed: float  # mean of the prior, towards the ring, in m/s
    samples: int
    trackers: tuple[str, ...]


SCENES = {
    "workspace": _Scene(0, -PRIOR_MEAN[3], SAMPLES, tuple(LABELS)),
    "2 m/s": _Scene(1, 2.0, SAMPLES // 2, ("truth", "bank", "ekf")),
}


@record
class StopSummary:
    """Statistics of decisions to stop, each with its 95 % interval.

    Attributes
    ----------
    in_time : ConfidenceInterval
        Fraction of the collisions before which the machine stands.
    lead, early : ConfidenceInterval
        Median, and 5 % quantile, of the time in s from the decision to a collision; minus infinite
        if there is none.
    false : ConfidenceInterval
        Fraction of the passing courses for which the machine stops.
    """

    in_time: ConfidenceInterval
    lead: ConfidenceInterval
    early: ConfidenceInterval
    false: ConfidenceInterval


@checked
@record
class StopStudy:
    """Courses, and when each tracker decides to stop.

    Attributes
    ----------
    courses : Courses
        R true courses; a saved study has no paths.
    alarm : dict of str to ndarray, shape (R, 5, 11)
        By tracker, time of the decision in s for each of `RULES` and `THRESHOLDS`; infinite where
        there is none.

    Examples
    --------
    >>> study = saved_stops("workspace")
    >>> print(study.summary("truth", "within 0.3 s", 0.5).false)
    0 (0 to 0.00267)
    """

    courses: Courses
    alarm: dict[str, Array]

    def __post_init__(self):
        """Check the fields."""
        shape = len(self.courses.entry), len(RULES), len(THRESHOLDS)
        for name, alarm in self.alarm.items():
            _checks.exact_shape(f"alarm[{name!r}]", alarm, shape)

    @checked
    def of(self, tracker: str, rule: str, threshold: Probability) -> FloatArray:
        """Return when one tracker decides to stop.

        Parameters
        ----------
        tracker : str
            One of those in `alarm`.
        rule : str
            One of `RULES`.
        threshold : float
            One of `THRESHOLDS`.

        Returns
        -------
        ndarray, shape (R,)
            Time in s; infinite where it does not.

        Examples
        --------
        >>> study = saved_stops("workspace")
        >>> bool((study.of("bank", "ever", 0.5) <= study.of("bank", "ever", 0.9)).all())
        True
        """
        _checks.one_of("tracker", tracker, tuple(self.alarm))
        place = [
            tuple(known).index(_checks.one_of(name, value, tuple(known)))
            for name, value, known in (
                ("rule", rule, RULES),
                ("threshold", threshold, THRESHOLDS),
            )
        ]
        return self.alarm[tracker][:, *place]

    @checked
    def summary(self, tracker: str, rule: str, threshold: Probability) -> StopSummary:
        """Return statistics of the decisions of a tracker.

        Parameters
        ----------
        tracker, rule, threshold
            See `of`.

        Returns
        -------
        StopSummary

        Examples
        --------
        >>> found = saved_stops("workspace").summary("bank", "within 0.3 s", 0.5)
        >>> found.in_time.value > 0.99
        True
        """
        judged = judge_stops(self.courses, self.of(tracker, rule, threshold))
        kind = self.courses.kind
        hits, passes = kind == "collision", kind == "passing"
        lead = judged.lead[hits]
        return StopSummary(
            proportion_interval(judged.in_time[hits]),
            quantile_interval(lead),
            quantile_interval(lead, 0.05),
            proportion_interval(judged.false[passes]),
        )

    @checked
    def curve(self, tracker: str, rule: str, quantile: Probability = 0.05) -> FloatArray:
        """Return false alarms and lead of a tracker for each of `THRESHOLDS`.

        Parameters
        ----------
        tracker, rule
            See `of`.
        quantile : float
            Fraction of the collisions whose lead is shorter.

        Returns
        -------
        ndarray, shape (11, 2)
            Fraction of the passing courses for which the machine stops, and that quantile of the
            lead in s; minus infinite if so many collisions are not foreseen at all.

        Examples
        --------
        >>> false, lead = saved_stops("workspace").curve("truth", "within 0.2 s").T
        >>> bool(false.max() == 0), bool(0.19 < lead.min() < 0.2)
        (True, True)
        """
        kind, points = self.courses.kind, []
        for threshold in THRESHOLDS:
            judged = judge_stops(self.courses, self.of(tracker, rule, threshold))
            lead = quantile_interval(judged.lead[kind == "collision"], quantile)
            points.append((judged.false[kind == "passing"].mean(), lead.value))
        return np.array(points)

    @checked
    def stopped(
        self, tracker: str, rule: str, threshold: Probability, edges: Annotated[FloatArray, _edges]
    ) -> FloatArray:
        """Return the fraction of courses for which the machine stops, by closest approach.

        Parameters
        ----------
        tracker, rule, threshold
            See `of`.
        edges : array_like, shape (B + 1,)
            Distances in m from one class of courses to the next, ascending.

        Returns
        -------
        ndarray, shape (B, 3)
            Fraction of the courses for which the machine stops, in time if they enter the ball,
            and the ends of its 95 % interval; NaN where there is no course.

        Examples
        --------
        >>> study = saved_stops("workspace")
        >>> study.stopped("truth", "ever", 0.5, [0.05, 0.085])[:, 0]
        array([1.])
        """
        judged = judge_stops(self.courses, self.of(tracker, rule, threshold))
        hits = judged.in_time | judged.false
        place = np.digitize(self.courses.closest, edges)
        found = np.full((len(edges) - 1, 3), np.nan)
        for b in range(len(found)):
            if (place == b + 1).any():
                share = proportion_interval(hits[place == b + 1])
                found[b] = share.value, share.low, share.high
        return found


@checked
def stop_runs(
    scene: Literal["workspace", "2 m/s"],
    part: Index,
    targets: Count,
    passing: Index,
    *,
    seed: Index,
    trackers: tuple[str, ...] | None = None,
) -> StopStudy:
    """Let trackers decide on the courses among some targets.

    Parameters
    ----------
    scene : str
        See `SCENES`.
    part : int
        Number of the part of the study, which has its own random numbers.
    targets : int
        Number of targets of which collisions and near misses are taken. Fewer give the first of
        the same courses.
    passing : int
        Number of passing courses, at most, that are taken.
    seed : int
        Source of all randomness.
    trackers : sequence of str, optional
        Names in `LABELS`; those of the scene if None.

    Returns
    -------
    StopStudy

    Examples
    --------
    >>> study = stop_runs("workspace", 0, 40, 1, seed=1, trackers=["truth"])
    >>> study.courses.kind.tolist()
    ['passing', 'collision']
    """
    s = SCENES[scene]
    names = s.trackers if trackers is None else trackers
    for name in names:
        _checks.one_of("trackers", name, tuple(LABELS))
    truths, noise = np.random.default_rng([seed, s.place, part]).spawn(2)
    mean = np.array([*PRIOR_MEAN[:3], -s.speed, 0, 0])
    prior = mean, PRIOR_COVARIANCE
    courses = draw_courses(targets, "any", rng=truths, prior=prior, samples=s.samples)
    passes = courses.kind == "passing"
    rows = np.isin(courses.kind, ["collision", "near miss"])
    courses = courses.part(rows | (passes & (np.cumsum(passes) <= passing)))
    if not len(courses.entry):
        raise ValueError(f"targets must have a course that is wanted, got none in {targets}")
    z = draw_records(courses.paths, rng=noise)
    alarm = {}
    sums = cache(partial(_sum, z, prior))
    for name in names:
        estimates = _estimates(name, courses.paths, z, prior, sums)
        alarm[name] = stop_times(
            courses.paths, *estimates[:2], list(RULES), THRESHOLDS, weights=estimates[2],
            every=EVERY,
        )  # fmt: skip
    return StopStudy(courses, alarm)


def _estimates(name, paths, z, prior, sums):
    """Return states, covariances and weights, or None, at the times of decisions."""
    if name == "truth":
        return paths[:, EVERY - 1 :: EVERY], np.zeros((1, 1, 6, 6)), None
    if name == "moments":
        return sums().x, sums().P, None
    if name.startswith("bank"):
        found = sums(*_BELIEFS[name])
        weights = np.where(found.weights < _LIGHT, 0.0, found.weights)
        return found.means, found.covariances, weights
    return *track_targets(z, name, every=EVERY, prior=prior), None


def _sum(z, prior, factor=1.0, believed="own"):
    """Return the track of a sum of Gaussians that believes what need not be so."""
    prior = prior if believed == "own" else PRIORS[believed]
    sigma_a = factor * SIGMA_A
    return gaussian_sum(z, ARRAY, *prior, INTERVAL, sigma_a, SIGMA_F, every=EVERY, mixture=_MEMBERS)


@checked
def decision_numbers(alarm: Annotated[FloatArray, _checks.real]) -> IntArray:
    """Return the numbers of decisions as they are saved.

    Parameters
    ----------
    alarm : array_like, shape (...)
        Times of decisions in s; infinite where there is none.

    Returns
    -------
    ndarray of int, shape (...)
        From 1 to 254; 255 where there is none.

    Examples
    --------
    >>> decision_numbers([0.02, np.inf]).tolist()
    [4, 255]
    """
    found = np.where(np.isinf(alarm), _NONE, np.rint(alarm / (EVERY * INTERVAL)))
    if not ((found > 0) & ((found < _NONE) | np.isinf(alarm))).all():
        raise ValueError(f"alarm must be times up to {_NONE * EVERY * INTERVAL} s, got {alarm}")
    return found.astype(int)


@checked
def saved_stops(scene: Literal["workspace", "2 m/s"]) -> StopStudy:
    """Return the study of decisions that is saved in ``results``.

    Parameters
    ----------
    scene : str
        See `SCENES`.

    Returns
    -------
    StopStudy

    Notes
    -----
    Made by ``make study NAME=stopping``; see the README of ``results``.

    Examples
    --------
    >>> list(saved_stops("2 m/s").alarm)
    ['truth', 'bank', 'ekf']
    """
    with np.load(BytesIO(results("stopping.npz").read_bytes())) as file:
        entry, need, closest = file[f"{scene}: courses"].T
        decisions = file[f"{scene}: decisions"].cumsum(axis=-1, dtype=np.uint8)
    alarm = np.where(decisions == _NONE, np.inf, EVERY * INTERVAL * decisions)
    courses = Courses(np.empty((len(entry), 0, 6)), entry, need, closest)
    return StopStudy(courses, dict(zip(SCENES[scene].trackers, alarm, strict=True)))
