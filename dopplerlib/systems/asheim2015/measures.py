"""Definitions behind the numbers: departure, usable range, error at a time."""

import numpy as np

from ... import _checks
from ...evaluation.intervals import Estimate


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
    near = np.abs(np.asarray(time) - at) <= half_width + 1e-9
    return float(np.sqrt(np.nanmean(np.square(np.asarray(error)[:, near]))))


def usable_range(error, time, distance, limit=1.0, after=5.0, window=1.0):
    """Return the distance from the origin at which the error of all runs exceeds a limit.

    Parameters
    ----------
    error : array_like, shape (runs, K)
        Position errors in m; NaN where there is no estimate.
    time : array_like, shape (K,)
        Time of each scan in s.
    distance : array_like, shape (K,)
        True distance from the origin in m.
    limit : float
        In m.
    after : float
        The search begins at this time in s.
    window : float
        Length of the moving average in s.

    Returns
    -------
    float
        The distance at which the moving average of the root mean square error over runs first is
        above the limit; infinite if it never is.
    """
    time, distance = np.asarray(time), np.asarray(distance)
    there = np.isfinite(error)
    total = np.sum(np.where(there, error, 0.0) ** 2, axis=0)
    # A scan without any estimate counts as unusable.
    curve = np.sqrt(np.where(there.any(axis=0), total / np.maximum(there.sum(axis=0), 1), np.inf))
    scans = max(1, round(window / (time[1] - time[0])))
    smooth = np.convolve(curve, np.ones(scans), mode="same")
    # At the ends the window is not full.
    inside = np.convolve(np.ones(len(curve)), np.ones(scans), mode="same")
    above = (smooth / inside > limit) & (time >= after)
    return float(distance[np.argmax(above)]) if above.any() else np.inf


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
    Estimate
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
    tail = 50 * (1 - _checks.probability("confidence", confidence))
    # "lower": an infinite value next to a finite one must not make their mean NaN.
    low, high = np.percentile(values, [tail, 100 - tail], method="lower")
    return Estimate(float(statistic(*arrays)), float(low), float(high))
