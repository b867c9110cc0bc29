"""Bootstrap confidence intervals."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from .. import _checks
from .._typing import ArrayLike
from .intervals import ConfidenceInterval

_MOST = 2**27  # entries of the table of draws


@_checks.quiet
def bootstrap_interval(
    statistic: Callable[..., Any],
    arrays: Iterable[ArrayLike],
    *,
    rng: np.random.Generator,
    resamples: int = 400,
    confidence: float = 0.95,
) -> ConfidenceInterval:
    """Return a bootstrap interval for a function of means over independent runs.

    Parameters
    ----------
    statistic : callable
        Takes the means of the arrays over the runs, each of shape (draws, ...), and returns the
        statistic of each draw, shape (draws,). It may be infinite, as a range is at which an error
        never grows too large.
    arrays : iterable of array_like, shape (runs, ...)
        Each with the runs first; they are drawn together.
    rng : numpy.random.Generator
        Source of the draws.
    resamples : int
        Number of draws.
    confidence : float
        Fraction of the draws inside the interval.

    Returns
    -------
    ConfidenceInterval
        The statistic of all runs, and the percentiles of that of the draws.

    Raises
    ------
    ValueError
        If there is no array or no run, arrays have different numbers of runs or values that are not
        finite, `statistic` does not return one number a draw, or another argument is not of the
        kind described.

    Notes
    -----
    The percentile bootstrap of Efron and Tibshirani (1993), Section 13.3. Root mean squares, ratios
    of them, and the place where a mean curve passes a limit all are functions of means: of n runs,
    the mean of a draw is the product of how often it holds each run with the runs, over n.

    Examples
    --------
    The root mean square of 50 errors of standard deviation 1:

    >>> errors = np.random.default_rng(1).standard_normal(50)
    >>> print(bootstrap_interval(np.sqrt, [errors**2], rng=np.random.default_rng(2)))
    0.882 (0.648 to 1.1)
    """
    _checks.generator("rng", rng)
    tail = 50 * (1 - _checks.probability("confidence", confidence))
    values = [
        _checks.finite(f"arrays[{i}]", array)
        for i, array in enumerate(_checks.iterable("arrays", arrays))
    ]
    sizes = {array.shape[:1] for array in values}
    if len(sizes) != 1 or sizes & {(), (0,)}:
        raise ValueError(
            f"arrays must have one number of runs as first axes, got shapes "
            f"{[array.shape for array in values]}"
        )
    runs = len(values[0])
    resamples = _checks.count("resamples", resamples, _MOST // runs)
    draws = rng.integers(runs, size=(resamples, runs))
    counts = [np.ones(runs), *(np.bincount(draw, minlength=runs) for draw in draws)]
    shares = np.stack(counts) / runs
    means = [(shares @ array.reshape(runs, -1)).reshape(-1, *array.shape[1:]) for array in values]
    found = _checks.real("statistic(...)", _checks.called("statistic", statistic, *means))
    if found.shape != (resamples + 1,):
        raise ValueError(
            f"statistic(...) must have shape {(resamples + 1,)}, one value a draw, "
            f"got {found.shape}"
        )
    # "lower": an infinite value next to a finite one must not make their mean NaN.
    low, high = np.percentile(found[1:], [tail, 100 - tail], method="lower")
    return ConfidenceInterval(float(found[0]), float(low), float(high))
