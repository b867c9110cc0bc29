"""Definitions behind the numbers: departure, usable range, error at a time."""

import numpy as np

from ... import _checks
from ...evaluation.bootstrap import bootstrap_interval

# A position is of use as long as its root mean square error, averaged over a second, is below a
# meter. The first seconds do not count: there the filter settles.
LIMIT, AFTER, WINDOW = 1.0, 5.0, 1.0  # m, s, s


def departure(updated, time, scans=10):
    """Return when a track is left: the first run of scans in a row without an accepted detection.

    Parameters
    ----------
    updated : array_like of bool, shape (..., K)
        Whether a detection was used.
    time : array_like, shape (K,)
        Time of each scan in s.
    scans : int
        How many scans in a row make a departure.

    Returns
    -------
    ndarray, shape (...)
        Time of the first of these scans in s; infinite if there is no departure.
    """
    updated = np.asarray(updated, bool)
    time = _checks.finite("time", time)
    scans = _checks.whole_number("scans", scans)
    if updated.shape[-1] < scans:
        return np.full(updated.shape[:-1], np.inf)
    windows = np.lib.stride_tricks.sliding_window_view(~updated, scans, axis=-1)
    gone = windows.all(axis=-1)
    return np.where(gone.any(axis=-1), time[np.argmax(gone, axis=-1)], np.inf)


def distance_error(p, truth):
    """Return the distance between estimated and true positions.

    Parameters
    ----------
    p : array_like, shape (..., K, 2)
        Estimates in m; NaN where there is none.
    truth : array_like, shape (K, 2 or more)
        True states, position first.

    Returns
    -------
    ndarray, shape (..., K)
        In m.
    """
    return np.hypot(*np.moveaxis(np.asarray(p) - np.asarray(truth)[:, :2], -1, 0))


def rmse(error, time, at, half_width=0.5):
    """Return the root mean square error over runs and half a second before and after a time.

    Parameters
    ----------
    error : array_like, shape (runs, K)
        Errors; NaN where there is no estimate.
    time : array_like, shape (K,)
        Time of each scan in s.
    at : float
        Time in s.
    half_width : float
        In s.

    Returns
    -------
    float
    """
    return float(np.sqrt(np.nanmean(np.square(_near(error, time, at, half_width)))))


def rmse_interval(error, time, at, half_width=0.5, *, rng):
    """Return `rmse` and its interval when runs are drawn with replacement.

    Parameters
    ----------
    error, time, at, half_width
        See `rmse`.
    rng : numpy.random.Generator
        Source of the resampling.

    Returns
    -------
    ConfidenceInterval
    """
    sums = [part.sum(axis=1) for part in _squares(_near(error, time, at, half_width))]
    return bootstrap_interval(lambda s, n: np.sqrt(s / n), sums, rng=rng)


def rmse_ratio(a, b, time, at, half_width=0.5, *, rng):
    """Return the root mean square error of one tracker over that of another on the same runs.

    Parameters
    ----------
    a, b : array_like, shape (runs, K)
        Errors of both.
    time, at, half_width
        See `rmse`.
    rng : numpy.random.Generator
        Source of the resampling, in which both keep their runs together.

    Returns
    -------
    ConfidenceInterval
    """
    sums = [part.sum(axis=1) for e in (a, b) for part in _squares(_near(e, time, at, half_width))]
    return bootstrap_interval(lambda sa, na, sb, nb: np.sqrt(sa / na / (sb / nb)), sums, rng=rng)


def usable_range(error, time, distance):
    """Return the distance from the origin at which the error of all runs exceeds a meter.

    Parameters
    ----------
    error : array_like, shape (..., runs, K)
        Position errors in m; NaN where there is no estimate.
    time : array_like, shape (K,)
        Time of each scan in s.
    distance : array_like, shape (K,)
        True distance from the origin in m.

    Returns
    -------
    ndarray, shape (...)
        The distance at which the moving average of the root mean square error over runs first is
        above the limit; infinite if it never is.

    Raises
    ------
    ValueError
        If there are fewer than two scans.
    """
    squares, there = (part.mean(axis=-2) for part in _squares(error))
    return _first_above(squares, there, time, distance)


def usable_interval(error, time, distance, *, rng):
    """Return `usable_range` and its interval when runs are drawn with replacement.

    Parameters
    ----------
    error, time, distance
        See `usable_range`.
    rng : numpy.random.Generator
        Source of the resampling.

    Returns
    -------
    ConfidenceInterval
        In m; infinite where the error stays below the limit to the end.
    """
    return bootstrap_interval(
        lambda *means: _first_above(*means, time, distance), _squares(error), rng=rng
    )


def usable_ratio(a, b, time, distance, *, rng):
    """Return the usable range of one tracker over that of another on the same runs.

    Parameters
    ----------
    a, b : array_like, shape (runs, K)
        Errors of both in m.
    time, distance
        See `usable_range`.
    rng : numpy.random.Generator
        Source of the resampling, in which both keep their runs together.

    Returns
    -------
    ConfidenceInterval
        A range beyond the record counts as the last distance.
    """

    def ratio(*means):
        over, under = (
            np.minimum(_first_above(*pair, time, distance), distance[-1])
            for pair in (means[:2], means[2:])
        )
        return over / under

    return bootstrap_interval(ratio, [*_squares(a), *_squares(b)], rng=rng)


def _near(error, time, at, half_width):
    return np.asarray(error)[:, np.abs(np.asarray(time) - at) <= half_width + 1e-9]


def _squares(error):
    """Return the squares of all errors, 0 where there is none, and where there is one."""
    there = np.isfinite(error)
    return np.where(there, error, 0.0) ** 2, there.astype(float)


def _first_above(squares, there, time, distance):
    """Return the distance at which root mean squares (..., K) are first above the limit."""
    time, distance = np.asarray(time), np.asarray(distance)
    if len(time) < 2:
        raise ValueError(f"time must have two scans or more, got {len(time)}")
    # A scan without any estimate counts as unusable.
    mean = np.divide(squares, there, out=np.full(np.shape(squares), np.inf), where=there > 0)
    curve = np.sqrt(mean)
    scans = max(1, round(WINDOW / (time[1] - time[0])))
    # The average is over those of the scans around that are there: at the ends there are fewer.
    before, behind = scans // 2, (scans - 1) // 2
    smooth = np.stack([curve[..., max(0, k - before) : k + behind + 1].mean(axis=-1)
                       for k in range(len(time))], axis=-1)  # fmt: skip
    above = (smooth > LIMIT) & (time >= AFTER)
    return np.where(above.any(axis=-1), distance[np.argmax(above, axis=-1)], np.inf)
