"""Innovations of an optimal filter have mean zero and no memory: the tests of both."""

import numpy as np

from .. import _checks
from .._records import record


@record
class Whiteness:
    """Autocorrelation of innovations and the test that it is zero.

    Attributes
    ----------
    autocorrelation : ndarray, shape (..., lags, m)
        At lags 1, 2, ...; of each component after division by its standard deviation.
    statistic : ndarray, shape (...)
        Ljung-Box statistic, summed over the components.
    dof : int
        Its degrees of freedom if the innovations are white: lags times m.
    p_value : ndarray, shape (...)
        Probability of a larger statistic if the innovations are white.
    """

    autocorrelation: np.ndarray
    statistic: np.ndarray
    dof: int
    p_value: np.ndarray


def innovation_mean(innovation, S):
    """Return the time average of each innovation and its standard error if the filter is right.

    Parameters
    ----------
    innovation : array_like, shape (..., K, m)
        Innovations of a record.
    S : array_like, shape (..., K, m, m)
        Their covariances.

    Returns
    -------
    mean : ndarray, shape (..., m)
        Time average.
    standard_error : ndarray, shape (..., m)
        Standard deviation of `mean` for independent innovations of covariance `S`.

    Raises
    ------
    ValueError
        If the shapes do not fit, a value is not finite, or `S` is not a covariance (symmetric and
        positive definite).

    Notes
    -----
    Mittermaier et al. (2016), Section 4: "mean-value of the innovation".

    Examples
    --------
    A hundred values of variance 1 that are all 0.2: twice what chance gives.

    >>> mean, standard_error = innovation_mean(np.full((100, 1), 0.2), np.ones((100, 1, 1)))
    >>> round(float(mean[0]), 3), round(float(standard_error[0]), 3)
    (0.2, 0.1)
    """
    innovation, S = _record(innovation, S)
    variance = np.diagonal(S, axis1=-2, axis2=-1)
    samples = innovation.shape[-2]
    return innovation.mean(axis=-2), np.sqrt(variance.sum(axis=-2)) / samples


def innovation_whiteness(innovation, S, lags=20):
    """Test whether innovations are uncorrelated in time.

    Parameters
    ----------
    innovation : array_like, shape (..., K, m)
        Innovations of a record.
    S : array_like, shape (..., K, m, m)
        Their covariances, which take out the correlation between components.
    lags : int
        Number of lags, less than K.

    Returns
    -------
    Whiteness

    Raises
    ------
    ValueError
        If the shapes do not fit, a value is not finite, `S` is not a covariance, there are too few
        samples, or an innovation never changes.

    Notes
    -----
    Ljung and Box (1978). The components are decorrelated by the Cholesky factor of `S`.

    Examples
    --------
    An innovation that changes its sign at every sample remembers the one before:

    >>> innovation = np.resize([1.0, -1.0], (100, 1))
    >>> result = innovation_whiteness(innovation, np.ones((100, 1, 1)), lags=1)
    >>> result.autocorrelation.round(2).tolist(), bool(result.p_value < 1e-6)
    ([[-0.99]], True)
    """
    from scipy.stats import chi2  # here: it takes longer to load than all the rest

    innovation, S = _record(innovation, S)
    samples, m = innovation.shape[-2:]
    lags = _checks.whole_number("lags", lags)
    if lags >= samples:
        raise ValueError(f"lags must be less than the number of samples {samples}, got {lags}")
    white = _whiten(innovation, np.linalg.cholesky(S))
    if (np.ptp(white, axis=-2) == 0).any():
        raise ValueError("innovation must vary in time, got a component that is constant")
    white = white - white.mean(axis=-2, keepdims=True)
    power = np.sum(white**2, axis=-2)
    autocorrelation = np.stack(
        [
            np.sum(white[..., lag:, :] * white[..., :-lag, :], axis=-2) / power
            for lag in range(1, lags + 1)
        ],
        axis=-2,
    )
    weight = samples * (samples + 2) / (samples - np.arange(1, lags + 1))
    statistic = np.sum(weight[:, None] * autocorrelation**2, axis=(-2, -1))
    dof = lags * m
    return Whiteness(autocorrelation, statistic, dof, chi2.sf(statistic, dof))


def _whiten(innovation, L):
    """Return L^-1 innovation; factors L that all runs share are used once for all of them."""
    if innovation.ndim > 2 and L.size == np.prod(L.shape[-3:]):
        runs = innovation.reshape(-1, *innovation.shape[-2:])
        columns = np.linalg.solve(L.reshape(L.shape[-3:]), np.moveaxis(runs, 0, -1))
        return np.moveaxis(columns, -1, 0).reshape(innovation.shape)
    return np.linalg.solve(L, innovation[..., None])[..., 0]


def _record(innovation, S):
    innovation = _checks.finite("innovation", innovation, (None, None))
    samples, m = innovation.shape[-2:]
    S = _checks.covariance("S", S, m)
    _checks.check_shape("S", S, (samples, m, m))
    _checks.check_broadcast("innovation", innovation.shape[:-2], "S", S.shape[:-3])
    return innovation, S
