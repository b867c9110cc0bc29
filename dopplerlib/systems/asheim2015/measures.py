"""Definitions behind the numbers: departure, usable range, error at a time."""

from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Booleans, Count, Positive, Real, checked, exactly, shaped
from ..._typing import FloatArray
from ...evaluation.bootstrap import bootstrap_interval
from ...evaluation.intervals import ConfidenceInterval

Times = Annotated[FloatArray, exactly(None)]  # of scans; distances at them
Errors = Annotated[FloatArray, exactly(None, None, check=_checks.bounded)]

# A position is of use as long as its root mean square error, averaged over a second, is below a
# meter, unless a caller says otherwise. The first seconds do not count: there the filter settles.
LIMIT, AFTER, WINDOW = 1.0, 5.0, 1.0  # m, s, s


@checked
def departure_times(updated: Booleans, time: Times, scans: Count = 10) -> FloatArray:
    """Return the time at which a track begins to lack accepted detections for many scans in a row.

    updated (..., K): Whether a detection was used.
    time (K,): Time of each scan in s.
    scans: How many scans in a row make a departure.
    Returns (...): Time of the first of these scans in s; infinite if there is no departure.

    Examples
    --------
    >>> float(departure_times([True, True, False, False], [0.0, 1.0, 2.0, 3.0], scans=2))
    2.0
    """
    _checks.check_shape("updated", updated, time.shape)
    if updated.shape[-1] < scans:
        return np.full(updated.shape[:-1], np.inf)
    windows = np.lib.stride_tricks.sliding_window_view(~updated, scans, axis=-1)
    gone = windows.all(axis=-1)
    return np.where(gone.any(axis=-1), time[np.argmax(gone, axis=-1)], np.inf)


@checked
def position_errors(
    p: Annotated[FloatArray, shaped(None, 2, check=_checks.measured)],
    truth: Annotated[FloatArray, exactly(None, None)],
) -> FloatArray:
    """Return the distance between estimated and true positions.

    p (..., K, 2): Estimates in m; NaN where there is none.
    truth (K, 2 or more): True states, position first.
    Returns (..., K): In m; NaN where there is no estimate.

    Examples
    --------
    >>> position_errors([[3.0, 4.0], [1.0, 0.0]], [[0.0, 0.0], [0.0, 0.0]]).tolist()
    [5.0, 1.0]
    """
    _checks.check_shape("p", p, truth[:, :2].shape)
    _checks.check_shape("truth[:, :2]", truth[:, :2], (2,))
    return np.hypot(*np.moveaxis(p - truth[:, :2], -1, 0))


@checked
def rmse(error: Errors, time: Times, at: Real, half_width: Positive = 0.5) -> float:
    """Return the root mean square error over runs and half a second before and after a time.

    error (runs, K): Errors; NaN where there is no estimate.
    time (K,): Time of each scan in s.
    at: Time in s.
    half_width: In s.
    Raises ValueError if an argument is not of the kind described, or there is no error so near.

    Examples
    --------
    >>> rmse([[0.3, 0.1], [0.4, 0.2]], [0.0, 2.0], 0.0).__round__(3)
    0.354
    """
    return float(np.sqrt(np.nanmean(np.square(_near("error", error, time, at, half_width)))))


@checked
def rmse_interval(
    error: Errors, time: Times, at: Real, half_width: Positive = 0.5, *, rng: np.random.Generator
) -> ConfidenceInterval:
    """Return `rmse` and its interval when runs are drawn with replacement.

    error, time, at, half_width: See `rmse`.
    rng: Source of the draws.

    Examples
    --------
    >>> error, rng = [[0.3, 0.1], [0.4, 0.2]], np.random.default_rng(1)
    >>> print(rmse_interval(error, [0.0, 2.0], 0.0, rng=rng))
    0.354 (0.3 to 0.4)
    """
    sums = [part.sum(axis=1) for part in _squares(_near("error", error, time, at, half_width))]
    return bootstrap_interval(lambda s, n: np.sqrt(s / n), sums, rng=rng)


@checked
def rmse_ratio(
    a: Errors,
    b: Errors,
    time: Times,
    at: Real,
    half_width: Positive = 0.5,
    *,
    rng: np.random.Generator,
) -> ConfidenceInterval:
    """Return the root mean square error of one tracker over that of another on the same runs.

    a, b (runs, K): Errors of both.
    time, at, half_width: See `rmse`.
    rng: Source of the draws, in which both keep their runs together.
    Returns: Infinite where the errors of `b` are zero.
    Raises ValueError: See `rmse`; or if `a` and `b` have different shapes.

    Examples
    --------
    >>> error, rng = np.array([[0.3, 0.1], [0.4, 0.2]]), np.random.default_rng(1)
    >>> rmse_ratio(2 * error, error, [0.0, 2.0], 0.0, rng=rng).value
    2.0
    """
    if a.shape != b.shape:
        raise ValueError(f"b must have the shape {a.shape} of a, got {b.shape}")
    near = _near("a", a, time, at, half_width), _near("b", b, time, at, half_width)
    sums = [part.sum(axis=1) for e in near for part in _squares(e)]
    return bootstrap_interval(lambda sa, na, sb, nb: np.sqrt(sa / na / (sb / nb)), sums, rng=rng)


@checked
def usable_range(
    error: Annotated[FloatArray, shaped(None, None, check=_checks.bounded)],
    time: Times,
    distance: Times,
    limit: Positive = LIMIT,
    average: Positive = WINDOW,
) -> FloatArray:
    """Return the distance from the origin at which the error of all runs exceeds a limit.

    error (..., runs, K): Position errors in m; NaN where there is no estimate.
    time (K,): Time of each scan in s.
    distance (K,): True distance from the origin in m.
    limit: Error in m up to which a position is of use.
    average: Time in s over which errors are averaged.
    Returns (...): The distance at which the moving average of the root mean square error over runs
        first is above the limit; infinite if it never is.
    Raises ValueError if an argument is not of the kind described, or there are fewer than two
        scans.

    Examples
    --------
    >>> time = np.arange(10.0)
    >>> float(usable_range([time / 6], time, 2 * time))
    14.0
    """
    _check_scans(time, distance, error=error)
    if not error.shape[-2]:
        raise ValueError(f"error must have a run, got shape {error.shape}")
    squares, there = (part.mean(axis=-2) for part in _squares(error))
    return _first_above(squares, there, time, distance, limit, average)


@checked
def usable_interval(
    error: Errors, time: Times, distance: Times, *, rng: np.random.Generator
) -> ConfidenceInterval:
    """Return `usable_range` and its interval when runs are drawn with replacement.

    error, time, distance: See `usable_range`.
    rng: Source of the draws.
    Returns: In m; infinite where the error stays below the limit to the end.

    Examples
    --------
    >>> time, rng = np.arange(10.0), np.random.default_rng(1)
    >>> usable_interval([time / 6, time / 6], time, 2 * time, rng=rng).value
    14.0
    """
    _check_scans(time, distance, error=error)
    return bootstrap_interval(
        lambda s, n: _first_above(s, n, time, distance), _squares(error), rng=rng
    )


@checked
def usable_ratio(
    a: Errors,
    b: Errors,
    time: Times,
    distance: Times,
    limit: Positive = LIMIT,
    average: Positive = WINDOW,
    *,
    rng: np.random.Generator,
) -> ConfidenceInterval:
    """Return the usable range of one tracker over that of another on the same runs.

    a, b (runs, K): Errors of both in m.
    time, distance, limit, average: See `usable_range`.
    rng: Source of the draws, in which both keep their runs together.
    Returns: A range beyond the record counts as the last distance.
    Raises ValueError: See `usable_range`; or if a usable range of `b` is zero.

    Examples
    --------
    >>> time, rng = np.arange(10.0), np.random.default_rng(1)
    >>> usable_ratio([time / 8], [time / 6], time, 2 * time, rng=rng).value.__round__(2)
    1.29
    """
    _check_scans(time, distance, a=a, b=b)
    if a.shape != b.shape:
        raise ValueError(f"b must have the shape {a.shape} of a, got {b.shape}")

    def reach(squares, there):
        first = _first_above(squares, there, time, distance, limit, average)
        return np.minimum(first, distance[-1])

    def ratio(a, some_a, b, some_b):
        return reach(a, some_a) / reach(b, some_b)

    return bootstrap_interval(ratio, [*_squares(a), *_squares(b)], rng=rng)


def _near(name, error, time, at, half_width):
    _checks.check_shape(name, error, time.shape)
    near = error[:, np.abs(time - at) <= half_width + 1e-9]
    if not np.isfinite(near).any():
        raise ValueError(f"at must have errors within {half_width} s, got {at}")
    return near


def _check_scans(time, distance, **errors):
    """Raise unless there are two scans or more, and a value at each."""
    if len(time) < 2 or time[0] >= time[1]:
        raise ValueError(f"time must have two scans or more and rise, got {time.tolist()}")
    for name, values in {"distance": distance, **errors}.items():
        _checks.check_shape(name, values, time.shape)


def _squares(error):
    """Return the squares of all errors, 0 where there is none, and where there is one."""
    there = np.isfinite(error)
    return np.where(there, error, 0.0) ** 2, there.astype(float)


def _first_above(squares, there, time, distance, limit=LIMIT, average=WINDOW):
    """Return the distance at which root mean squares (..., K) are first above the limit."""
    # A scan without any estimate counts as unusable.
    mean = np.divide(squares, there, out=np.full(np.shape(squares), np.inf), where=there > 0)
    curve = np.sqrt(mean)
    scans = max(1, round(average / (time[1] - time[0])))
    # The average is over those of the scans around that are there: at the ends there are fewer.
    before, behind = scans // 2, (scans - 1) // 2
    K, smooth = curve.shape[-1], np.empty_like(curve)
    for k in (*range(min(before, K)), *range(max(before, K - behind), K)):
        smooth[..., k] = curve[..., max(0, k - before) : k + behind + 1].mean(axis=-1)
    if scans <= K:
        windows = np.lib.stride_tricks.sliding_window_view(curve, scans, axis=-1)
        smooth[..., before : K - behind] = windows.mean(axis=-1)
    above = (smooth > limit) & (time >= AFTER)
    return np.where(above.any(axis=-1), distance[np.argmax(above, axis=-1)], np.inf)
