"""Tests of innovations: zero mean and whiteness."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._records import record
from .._typing import ArrayLike, FloatArray
from ._innovations import ljung_box, measured, whiten, winsorized


@record
class Whiteness:
    """Autocorrelation of innovations, and the test that it is zero.

    Attributes
    ----------
    autocorrelation : ndarray, shape (..., lags, m)
        At lags 1, 2, ...; of each component after division by its standard deviation. NaN where no
        two values are that far apart.
    statistic : ndarray, shape (...)
        Ljung-Box statistic, summed over the components.
    dof : int, or ndarray of int, shape (...)
        Its degrees of freedom if the innovations are white: lags times m, less those without a
        pair of values.
    p_value : ndarray, shape (...)
        Probability of a larger statistic if the innovations are white; NaN if no pair is there.
    """

    autocorrelation: np.ndarray
    statistic: np.ndarray
    dof: int | np.ndarray
    p_value: np.ndarray


@checked
def innovation_mean(innovation: ArrayLike, S: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the time average of each innovation, and its standard error for a consistent filter.

    Parameters
    ----------
    innovation : array_like, shape (..., K, m)
        Innovations of a record; NaN where a measurement is missing.
    S : array_like, shape (..., K, m, m)
        Their covariances.

    Returns
    -------
    mean : ndarray, shape (..., m)
        Average over the samples that are there; NaN for a component of which none is.
    standard_error : ndarray, shape (..., m)
        Standard deviation of `mean` for independent innovations of covariance `S`.

    Notes
    -----
    Mittermaier et al. (2016), Section 4: "mean-value of the innovation".

    Examples
    --------
    A hundred values of variance 1 that are all 0.2: twice the standard error.

    >>> mean, standard_error = innovation_mean(np.full((100, 1), 0.2), np.ones((100, 1, 1)))
    >>> round(float(mean[0]), 3), round(float(standard_error[0]), 3)
    (0.2, 0.1)
    """
    innovation, S, there = measured(innovation, S, record=True)
    variance = np.where(there, np.diagonal(S, axis1=-2, axis2=-1), 0.0)
    samples = there.sum(axis=-2)
    known = samples > 0
    samples = np.maximum(samples, 1)
    with np.errstate(over="ignore", invalid="ignore"):
        mean = innovation.sum(axis=-2) / samples
        error = np.sqrt(variance.sum(axis=-2)) / samples
    _checks.estimates("innovation, S", mean, error, what="averages")
    return np.where(known, mean, np.nan), np.where(known, error, np.nan)


def innovation_whiteness(
    innovation: ArrayLike, S: ArrayLike, lags: int = 20, *, limit: float | None = None
) -> Whiteness:
    """Test innovations for whiteness (Ljung-Box).

    Parameters
    ----------
    innovation : array_like, shape (..., K, m)
        Innovations of a record; NaN where a measurement is missing.
    S : array_like, shape (..., K, m, m)
        Their covariances, which take out the correlation between components.
    lags : int
        Number of lags, less than K.
    limit : float, optional
        Values farther than that from their median, in standard deviations by the median absolute
        deviation, count as that far. All count as they are if None. Choose 4 where there may be
        outliers: they stay in the innovations, also those that a gate refused or weakened, and hide
        the correlation of the others. Of Gaussian values it changes one in 16 000.

    Returns
    -------
    Whiteness

    Raises
    ------
    ValueError
        If the shapes do not fit, an innovation is infinite, `S` is not a covariance, there are too
        few samples, an innovation never changes, or `limit` is not positive.

    Notes
    -----
    Ljung and Box (1978). The components are decorrelated by the Cholesky factor of `S`, and those
    that are there by that of their own part of it. With r_l the sum of the products of values l
    samples apart over the sum of squares, the statistic is the sum of n (n + 2) r_l^2 / n_l: for n
    independent Gaussian values of which n_l pairs are there, r_l^2 has the mean n_l / (n (n + 2)),
    whatever is missing (Stoffer and Toloi 1992). Without gaps n_l is n - l. A component with no
    more values than lags is left out.

    Examples
    --------
    An innovation that changes its sign at every sample remembers the one before:

    >>> innovation = np.resize([1.0, -1.0], (100, 1))
    >>> result = innovation_whiteness(innovation, np.ones((100, 1, 1)), lags=1)
    >>> result.autocorrelation.round(2).tolist(), bool(result.p_value < 1e-6)
    ([[-0.99]], True)
    """
    innovation, S, there = measured(innovation, S, record=True)
    samples = innovation.shape[-2]
    lags = _checks.whole_number("lags", lags)
    if lags >= samples:
        raise ValueError(f"lags must be less than the number of samples {samples}, got {lags}")
    white = whiten(innovation, S)
    if limit is not None:
        limit = _checks.one_number("limit", limit, _checks.deviation)
        white = winsorized(white, there, limit)
    return Whiteness(*ljung_box(white, there, lags))
