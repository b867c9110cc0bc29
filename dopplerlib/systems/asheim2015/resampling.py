"""Numbers of many runs with their intervals: runs are drawn with replacement."""

import numpy as np

from ... import _checks
from ...evaluation.intervals import ConfidenceInterval
from .measures import _first_above, _near, _squares


def over_runs(statistic, *arrays, rng, resamples=400, confidence=0.95):
    """Return a statistic of all runs, and its interval when runs are drawn with replacement.

    Parameters
    ----------
    statistic : callable
        Takes the arrays, returns a float.
    *arrays : array_like, shape (runs, ...)
        Each with the runs first; they are drawn together.
    rng : numpy.random.Generator
        Source of the resampling.
    resamples : int
        Number of resamples.
    confidence : float
        Share of resamples inside the interval.

    Returns
    -------
    ConfidenceInterval
        Its interval is that between percentiles of the resampled statistic.

    Notes
    -----
    The percentile bootstrap of Efron and Tibshirani (1993), Section 13.3.
    """
    _checks.generator("rng", rng)
    arrays = [np.asarray(array) for array in arrays]
    runs = len(arrays[0])
    draws = rng.integers(runs, size=(resamples, runs))
    values = [statistic(*(array[draw] for array in arrays)) for draw in draws]
    return _percentiles(statistic(*arrays), values, confidence)


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
    return over_runs(lambda s, n: np.sqrt(s.sum() / n.sum()), *sums, rng=rng)


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
    return over_runs(
        lambda sa, na, sb, nb: np.sqrt(sa.sum() / na.sum() / (sb.sum() / nb.sum())), *sums, rng=rng
    )


def usable_interval(error, time, distance, *, rng, resamples=400, confidence=0.95):
    """Return `usable_range` and its interval when runs are drawn with replacement.

    Parameters
    ----------
    error, time, distance
        See `usable_range`.
    rng : numpy.random.Generator
        Source of the resampling.
    resamples : int
        Number of resamples.
    confidence : float
        Share of resamples inside the interval.

    Returns
    -------
    ConfidenceInterval
        In m; infinite where the error stays below the limit to the end.
    """
    (value,), (values,) = _resampled_ranges([error], time, distance, rng, resamples)
    return _percentiles(value, values, confidence)


def usable_ratio(a, b, time, distance, *, rng, resamples=400, confidence=0.95):
    """Return the usable range of one tracker over that of another on the same runs.

    Parameters
    ----------
    a, b : array_like, shape (runs, K)
        Errors of both in m.
    time, distance
        See `usable_range`.
    rng : numpy.random.Generator
        Source of the resampling, in which both keep their runs together.
    resamples : int
        Number of resamples.
    confidence : float
        Share of resamples inside the interval.

    Returns
    -------
    ConfidenceInterval
        A range beyond the record counts as the last distance.
    """
    found = _resampled_ranges([a, b], time, distance, rng, resamples)
    (va, vb), (ra, rb) = (np.minimum(part, np.asarray(distance)[-1]) for part in found)
    return _percentiles(va / vb, ra / rb, confidence)


def _resampled_ranges(errors, time, distance, rng, resamples):
    """Return the usable range of each tracker, and those of its resamples (trackers, resamples).

    How often each resample has drawn each run makes sums over runs a product of matrices.
    """
    _checks.generator("rng", rng)
    runs = len(errors[0])
    draws = rng.integers(runs, size=(resamples, runs))
    times = np.stack([np.bincount(draw, minlength=runs) for draw in draws]).astype(float)
    times = np.vstack([np.ones(runs), times])
    found = np.stack(
        [
            _first_above(*(times @ part for part in _squares(error)), time, distance)
            for error in errors
        ]
    )
    return found[:, 0], found[:, 1:]


def _percentiles(value, values, confidence):
    tail = 50 * (1 - _checks.probability("confidence", confidence))
    # "lower": an infinite value next to a finite one must not make their mean NaN.
    low, high = np.percentile(values, [tail, 100 - tail], method="lower")
    return ConfidenceInterval(float(value), float(low), float(high))
