"""Confidence intervals of Monte Carlo results: means, RMS, proportions, quantiles."""

import numpy as np

from .. import _checks
from .._hints import Number, Probability, checked
from .._records import record
from .._typing import ArrayLike


@checked
@record
class ConfidenceInterval:
    """A number estimated from independent runs, with its confidence interval.

    Attributes
    ----------
    value : float
        The estimate. It may be NaN, of which `judge` makes no verdict.
    low : float
        Lower end of its confidence interval.
    high : float
        Upper end.

    Examples
    --------
    >>> ConfidenceInterval(2.0, 1.5, 2.5).half_width
    0.5
    """

    value: Number
    low: Number
    high: Number

    @property
    def half_width(self) -> float:
        """Half the length of the interval, the number after ± where it is nearly symmetric.

        It is infinite if an end is.
        """
        return (self.high - self.low) / 2

    def __str__(self):
        return f"{self.value:.3g} ({self.low:.3g} to {self.high:.3g})"


@checked
def mean_interval(values: ArrayLike, confidence: Probability = 0.95) -> ConfidenceInterval:
    """Estimate a mean from independent runs, with its confidence interval.

    Parameters
    ----------
    values : array_like, shape (runs,)
        One number from each run; at least two.
    confidence : float
        Probability with which the interval holds the mean.

    Returns
    -------
    ConfidenceInterval

    Notes
    -----
    Student's t interval: exact for normal values, and by the central limit theorem good for any
    others that have a variance, if the runs are many. For heavy tails use `quantile_interval`.

    Examples
    --------
    >>> print(mean_interval([1.0, 2.0, 3.0, 4.0]))
    2.5 (0.446 to 4.55)
    """
    from scipy.special import stdtrit

    values = _runs("values", values, 2)
    values, size = _scaled(values)
    mean = values.mean()
    half = stdtrit(len(values) - 1, (1 + confidence) / 2) * values.std(ddof=1) / len(values) ** 0.5
    return ConfidenceInterval(*(float(end) * size for end in (mean, mean - half, mean + half)))


@checked
def rms_interval(errors: ArrayLike, confidence: Probability = 0.95) -> ConfidenceInterval:
    """Estimate an RMS error from independent runs, with its confidence interval.

    Parameters
    ----------
    errors : array_like, shape (runs,)
        One error from each run; at least two.
    confidence : float
        Probability with which the interval holds it.

    Returns
    -------
    ConfidenceInterval

    Notes
    -----
    The root of the `mean_interval` of the squares. Its lower end is 0 where that one's is negative:
    then a few runs make up nearly all of the sum.

    Examples
    --------
    >>> print(rms_interval([3.0, -4.0, 4.0, -3.0, 4.0, 3.0]))
    3.54 (2.91 to 4.06)
    """
    errors, size = _scaled(_runs("errors", errors, 2))
    square = mean_interval(errors**2, confidence)
    ends = square.value, square.low, square.high
    return ConfidenceInterval(*(max(end, 0.0) ** 0.5 * size for end in ends))


@checked
def proportion_interval(hits: ArrayLike, confidence: Probability = 0.95) -> ConfidenceInterval:
    """Estimate a probability from the proportion of runs, with its confidence interval.

    Parameters
    ----------
    hits : array_like of bool, shape (runs,)
        Whether the event happened in a run.
    confidence : float
        Probability, at least, with which the interval holds the probability of the event.

    Returns
    -------
    ConfidenceInterval

    Notes
    -----
    The exact interval of Clopper and Pearson (1934).

    Examples
    --------
    >>> print(proportion_interval([True] * 9 + [False]))
    0.9 (0.555 to 0.997)
    """
    from scipy.special import betaincinv

    hits = _checks.booleans("hits", hits)
    if hits.ndim != 1 or not len(hits):
        raise ValueError(f"hits must be booleans of shape (runs,), got shape {hits.shape}")
    tail = (1 - confidence) / 2
    k, n = int(hits.sum()), len(hits)
    low = betaincinv(k, n - k + 1, tail) if k else 0.0
    high = betaincinv(k + 1, n - k, 1 - tail) if k < n else 1.0
    return ConfidenceInterval(k / n, float(low), float(high))


@checked
def quantile_interval(
    values: ArrayLike, q: Probability = 0.5, confidence: Probability = 0.95
) -> ConfidenceInterval:
    """Estimate a quantile (the median by default) from independent runs, with its interval.

    Parameters
    ----------
    values : array_like, shape (runs,)
        One number from each run; infinite ones are allowed.
    q : float
        Probability that the quantile leaves below it.
    confidence : float
        Probability, at least, with which the interval holds the quantile.

    Returns
    -------
    ConfidenceInterval
        Ends that the runs are too few for are infinite.

    Notes
    -----
    Free of assumptions on the distribution: the number of runs below the quantile is binomial, so
    the ends are order statistics (Conover 1999, Sec 3.2).

    Examples
    --------
    >>> print(quantile_interval(range(101)))
    50 (40 to 60)
    """
    from scipy.special import bdtr, bdtrc

    values = np.sort(_runs("values", values, 1, infinite=True))
    tail = (1 - confidence) / 2
    n = len(values)
    # Order statistics, counted from 1: the quantile is below the first with at most `tail`.
    first = int(np.sum(bdtr(np.arange(n), n, q) < tail))
    last = int(np.sum(bdtrc(np.arange(n), n, q) > tail)) + 1
    low = values[first - 1] if first >= 1 else -np.inf
    high = values[last - 1] if last <= n else np.inf
    return ConfidenceInterval(_quantile(values, q), float(low), float(high))


def _quantile(values, q):
    """Return a quantile of sorted values as NumPy defines it, also of infinite ones."""
    place = (len(values) - 1) * q
    first = int(place)
    part, pair = place - first, values[first : first + 2]
    infinite = np.isinf(pair)
    if part == 0 or pair[0] == pair[-1]:
        return float(pair[0])
    if infinite.any():  # every number between a finite and an infinite one is infinite
        return float(pair[int(part >= 0.5) if infinite.all() else int(infinite[1])])
    pair, size = _scaled(pair)
    return float(np.quantile(pair, part)) * size


def _scaled(values):
    """Return values below 2 and the power of two to multiply by: so no sum or square overflows."""
    exponent = int(np.frexp(np.abs(values).max())[1]) - 1
    return np.ldexp(values, -exponent), 2.0**exponent


def _runs(name, values, least, infinite=False):
    array = _checks.real(name, values)
    if array.ndim != 1 or len(array) < least:
        raise ValueError(f"{name} must hold at least {least} runs, got shape {array.shape}")
    if np.isnan(array).any() or not (infinite or np.isfinite(array).all()):
        raise ValueError(f"{name} must be finite, got {array[~np.isfinite(array)][0]}")
    return array
