"""Courses past and into a machine, and when it decides to stop.

``RADIUS`` is that of the ball about the center of the ring into which no target may come. The
machine brakes at ``DECELERATION``, ``LATENCY`` after the decision; the rule "must stop now" leaves
``MARGIN`` to both. ``RULES`` has for each rule the time ahead in s, and the deceleration that adds
speed / (2 deceleration) to it.
"""

from collections.abc import Sequence
from functools import partial
from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Array, Booleans, Count, Covariance, Runs, State, between, checked
from .._records import record
from .._typing import ArrayLike, FloatArray
from ..chain.collision import collision_probability
from ..evaluation.alarms import first_alarm
from .targets import INTERVAL, PRIOR_COVARIANCE, PRIOR_MEAN, SIGMA_A, draw_targets

RADIUS = 0.1  # in m
LATENCY, MARGIN = 0.02, 0.01  # in s
DECELERATION = 10.0  # in m/s^2
RULES = {
    "must stop now": (LATENCY + MARGIN, DECELERATION),
    "within 0.2 s": (0.2, np.inf),
    "within 0.3 s": (0.3, np.inf),
    "within 0.5 s": (0.5, np.inf),
    "ever": (np.inf, np.inf),
}
NEAR_MISS = 0.085, 0.115  # in m: closest approach of courses that are neither
KINDS: dict[str, tuple[float, float]] = {
    "collision": (0.0, NEAR_MISS[0]),
    "near miss": NEAR_MISS,
    "passing": (NEAR_MISS[1], 0.3),
}
SAMPLES = 1200  # of a course: those that are in at 1 s are whole
FIRST = 20  # samples before the first decision

_Kind = Literal["collision", "near miss", "passing", "any"]
_Rule = Literal["must stop now", "within 0.2 s", "within 0.3 s", "within 0.5 s", "ever"]
_FIELDS = "paths", "entry", "need", "closest"
_BATCH, _MOST = 100, 20  # targets drawn at once; batches without a course of the kind


def _thresholds(name, value):
    array = _checks.one_row(name, np.reshape(_checks.real(name, value), -1))
    for one in array:
        _checks.probability(name, one)
    return _checks.real(name, value)


@checked
@record
class Courses:
    """True courses of targets.

    Attributes
    ----------
    paths : ndarray, shape (R, K, 6)
        States in m and m/s, see `draw_targets`; NaN after the end of a record.
    entry : ndarray, shape (R,)
        Time in s at which the target is in the ball; infinite if never.
    need : ndarray, shape (R,)
        Time in s before `entry` at which the machine has to decide; NaN if there is no entry.
    closest : ndarray, shape (R,)
        Distance in m from the center at the closest approach. After the end of a record the target
        goes straight on; NaN if it is still coming nearer when the samples end.

    Examples
    --------
    >>> courses = draw_courses(2, "collision", rng=np.random.default_rng(1))
    >>> bool((courses.entry > courses.need).all())
    True
    """

    paths: Array
    entry: Array
    need: Array
    closest: Array

    def __post_init__(self):
        """Check the fields."""
        _checks.check_shape("paths", self.paths, (None, None, 6))
        for name in ("entry", "need", "closest"):
            _checks.exact_shape(name, getattr(self, name), self.paths.shape[:1])

    @property
    def kind(self) -> np.ndarray:
        """Kinds of the courses by `KINDS`, shape (R,), or "other".

        Other is also a course through the ball whose record ends before, at a sensor.
        """
        kind = np.full(self.closest.shape, "other", dtype="<U9")
        for name, (low, high) in KINDS.items():
            kind[(low <= self.closest) & (self.closest < high)] = name
        kind[(kind == "collision") & np.isinf(self.entry)] = "other"
        return kind

    @checked
    def part(self, rows: Booleans) -> "Courses":
        """Return some of the courses.

        Parameters
        ----------
        rows : ndarray of bool, shape (R,)
            Which ones.

        Returns
        -------
        Courses

        Examples
        --------
        >>> courses = draw_courses(20, "any", rng=np.random.default_rng(1))
        >>> len(courses.part(courses.kind == "passing").entry)
        2
        """
        _checks.exact_shape("rows", rows, self.entry.shape)
        return Courses(*(getattr(self, name)[rows] for name in _FIELDS))


@checked
def courses_along(
    paths: Annotated[FloatArray, partial(_checks.bounded, shape=(None, None, 6))],
) -> Courses:
    """Return the courses of true paths: when they enter the ball, and how near they come.

    Parameters
    ----------
    paths : array_like, shape (R, K, 6)
        States in m and m/s, the first one `INTERVAL` after time zero; NaN after the end of a
        record, which holds one sample at least.

    Returns
    -------
    Courses

    Examples
    --------
    From 0.2 m straight on at 1 m/s: 30 ms less than in 0.1 s the machine has to decide.

    >>> path = np.array([[0.2 - 0.001 * k, 0, 0, -1, 0, 0] for k in range(1, 121)])
    >>> one = courses_along(path[None])
    >>> one.entry.round(3).tolist(), one.need.tolist()
    ([0.101], [0.07])
    """
    if paths.ndim != 3:
        raise ValueError(f"paths must have shape (R, K, 6), got shape {paths.shape}")
    there = ~np.isnan(paths).any(axis=-1)
    if not (there[:, :1].all() and paths.shape[1]):
        raise ValueError("paths must hold a sample of each course, got one without any")
    runs, last = np.arange(len(paths)), there.shape[1] - 1 - there[:, ::-1].argmax(axis=1)
    distance = np.where(there, np.linalg.norm(paths[..., :3], axis=-1), np.inf)
    inside = distance < RADIUS
    first, entered = inside.argmax(axis=1), inside.any(axis=1)
    speed = np.linalg.norm(paths[runs, first, 3:], axis=-1)
    p, v = paths[runs, last, :3], paths[runs, last, 3:]
    towards = -np.sum(p * v, axis=-1)
    with np.errstate(invalid="ignore"):  # at rest
        ahead = np.where(towards > 0, towards / np.sum(v * v, axis=-1), 0.0)
    closest = np.minimum(distance.min(axis=1), np.linalg.norm(p + ahead[:, None] * v, axis=-1))
    coming = (last == paths.shape[1] - 1) & (towards > 0) & ~entered
    return Courses(
        paths,
        np.where(entered, (first + 1) * INTERVAL, np.inf),
        np.where(entered, LATENCY + speed / (2 * DECELERATION), np.nan),
        np.where(coming, np.nan, closest),
    )


@checked
def draw_courses(
    runs: Runs,
    kind: _Kind,
    *,
    rng: np.random.Generator,
    sigma_a: Annotated[float, between(0, 1e60)] = SIGMA_A,
    prior: tuple[State, Covariance] = (PRIOR_MEAN, PRIOR_COVARIANCE),
    samples: Count = SAMPLES,
) -> Courses:
    """Draw targets as `draw_targets` does, and keep the courses of one kind.

    Parameters
    ----------
    runs : int
        Number of courses.
    kind : {"collision", "near miss", "passing", "any"}
        Which ones, by the closest approach, see `KINDS`: a collision enters the ball, up to
        0.085 m; a near miss comes as near as 0.085 to 0.115 m, in or not; a passing course 0.115
        to 0.3 m.
    rng : numpy.random.Generator
        Source of randomness. The courses are the same whether more or fewer are asked for.
    sigma_a, prior, samples
        See `draw_targets`.

    Returns
    -------
    Courses

    Raises
    ------
    ValueError
        If an argument is not as described, or 2000 targets in a row have no course of this kind.

    Examples
    --------
    >>> draw_courses(2, "passing", rng=np.random.default_rng(1)).closest.round(2).tolist()
    [0.23, 0.17]
    """
    parts, missing, without = [], runs, 0
    while missing > 0:
        size = min(missing, _BATCH) if kind == "any" else _BATCH
        paths = draw_targets(size, rng=rng, sigma_a=sigma_a, prior=prior, samples=samples)
        some = courses_along(paths)
        if kind != "any":
            some = some.part(some.kind == kind)
        without = 0 if len(some.entry) else without + 1
        if without == _MOST:
            raise ValueError(f"prior must lead to courses of the kind {kind!r}, got none")
        parts.append(some.part(np.arange(len(some.entry)) < missing))
        missing -= len(parts[-1].entry)
    return Courses(*(np.concatenate([getattr(part, name) for part in parts]) for name in _FIELDS))


@checked
def stop_times(
    paths: Annotated[FloatArray, partial(_checks.bounded, shape=(None, None, 6))],
    x: ArrayLike,
    P: ArrayLike,
    rule: _Rule | Sequence[_Rule] = "within 0.3 s",
    threshold: Annotated[ArrayLike, _thresholds] = 0.5,
    *,
    weights: ArrayLike | None = None,
    every: Count = 5,
) -> FloatArray:
    """Return when a machine decides to stop: the first time that a collision is likely.

    Parameters
    ----------
    paths : array_like, shape (R, K, 6)
        True states, of which only the end of the record is used.
    x : array_like, shape (R, O, 6)
        Estimates after `every`, 2 `every`, ... samples, in m and m/s; NaN where there is none,
        which stops nothing. Of a mixture (R, O, M, 6).
    P : array_like, shape (R, O, 6, 6)
        Covariances; of a mixture (R, O, M, 6, 6).
    rule : str or sequence of str
        Names in `RULES`: what is probable.
    threshold : array_like, scalar or shape (H,)
        Probability from which on the machine stops.
    weights : array_like, shape (R, O, M), optional
        Weights of a mixture.
    every : int
        Samples from one decision to the next. The first one is after `FIRST` samples.

    Returns
    -------
    ndarray, shape (R,)
        Time in s, infinite where the machine does not stop; with several rules, thresholds or both
        more axes follow, in this order.

    Examples
    --------
    A tracker that knows the truth:

    >>> courses = draw_courses(1, "collision", rng=np.random.default_rng(1))
    >>> x = courses.paths[:, 4::5]
    >>> lead = courses.entry - stop_times(courses.paths, x, np.zeros((1, 1, 6, 6)))
    >>> bool(abs(lead[0] - 0.3) < 0.01)
    True
    """
    ends = every * np.arange(1, paths.shape[1] // every + 1)
    x = _checks.bounded("x", x, (6,))
    if x.shape[:2] != (len(paths), len(ends)):
        raise ValueError(
            f"x must be estimates of {len(paths)} courses at {len(ends)} times, got shape {x.shape}"
        )
    names = [rule] if isinstance(rule, str) else list(rule)
    within, deceleration = np.array([RULES[name] for name in names]).reshape(-1, 2).T
    probable = collision_probability(
        x, P, RADIUS, within, weights=weights, deceleration=deceleration
    )
    judged = (ends >= FIRST) & ~np.isnan(paths[:, ends - 1]).any(axis=-1)
    probable = np.where(judged[..., None], probable, 0.0)
    levels = np.reshape(threshold, -1)
    alarms = probable[..., None] >= levels  # of NaN: no
    first = INTERVAL * first_alarm(np.moveaxis(alarms, 1, -1), ends)
    shape = () if isinstance(rule, str) else (len(names),)
    return first.reshape(len(paths), *shape, *np.shape(threshold))


@checked
@record
class Judged:
    """Decisions to stop, judged by the courses.

    Attributes
    ----------
    in_time : ndarray of bool, shape (R, ...)
        Whether the machine stands before the target enters the ball.
    lead : ndarray, shape (R, ...)
        Time in s from the decision to the entry; minus infinite without one, NaN without an entry.
    false : ndarray of bool, shape (R, ...)
        Whether the machine stops for a target that never enters.

    Examples
    --------
    >>> courses = draw_courses(2, "collision", rng=np.random.default_rng(1))
    >>> judge_stops(courses, [0.1, np.inf]).in_time.tolist()
    [True, False]
    """

    in_time: Booleans
    lead: Array
    false: Booleans


@checked
def judge_stops(courses: Courses, alarm: Annotated[FloatArray, _checks.real]) -> Judged:
    """Judge when a machine decides to stop.

    Parameters
    ----------
    courses : Courses
        True courses.
    alarm : array_like, shape (R, ...)
        Time of each decision in s, see `stop_times`; infinite where there is none.

    Returns
    -------
    Judged

    Examples
    --------
    >>> courses = draw_courses(2, "passing", rng=np.random.default_rng(1))
    >>> judge_stops(courses, [0.1, np.inf]).false.tolist()
    [True, False]
    """
    if alarm.shape[:1] != courses.entry.shape:
        raise ValueError(f"alarm must have shape ({len(courses.entry)}, ...), got {alarm.shape}")
    entry, need = (
        value.reshape(-1, *(1,) * (alarm.ndim - 1)) for value in (courses.entry, courses.need)
    )
    enters, stopped = np.isfinite(entry), alarm < np.inf
    with np.errstate(invalid="ignore"):
        lead = np.where(enters, np.where(stopped, entry - alarm, -np.inf), np.nan)
        return Judged(enters & (alarm <= entry - need), lead, stopped & ~enters)
