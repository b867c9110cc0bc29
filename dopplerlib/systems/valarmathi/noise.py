"""The variance of the measurements from what the filter leaves of them: Eq 14 and its sign."""

import numpy as np

from ... import _checks
from .published import stated


def residual_variance(residual, HPH, sign=-1):
    """Return the variance of the measurements as estimated from the residuals after the update.

    Parameters
    ----------
    residual : array_like, shape (..., K)
        Measurement minus H times the updated state.
    HPH : array_like, broadcast to (...)
        H P H' of the updated covariance.
    sign : {-1, 1}
        -1 as the document has it, 1 as it should be: the variance of this residual is R - H P H',
        so R is its variance *plus* H P H'.

    Returns
    -------
    ndarray, shape (...)
        Can be negative with the sign of the document.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, or `sign` is neither of the two.

    Notes
    -----
    Eq 14 of the document: the spread is the median of the distances from the median, over 0.6745,
    which is the standard deviation of normal residuals.

    Examples
    --------
    >>> residual = np.random.default_rng(1).standard_normal(100_000)
    >>> [round(float(residual_variance(residual, 0.2, sign)), 1) for sign in (-1, 1)]
    [0.8, 1.2]
    """
    residual = _checks.finite("residual", residual, (None,))
    HPH = _checks.finite("HPH", HPH)
    sign = _checks.one_of("sign", sign, (-1, 1))
    middle = np.median(residual, axis=-1, keepdims=True)
    spread = np.median(np.abs(residual - middle), axis=-1) / stated().mad_to_std
    return spread**2 + sign * HPH


def updated_residual(innovation, S, R):
    """Return the residual after the update, and H P H' then, of a scalar measurement.

    Parameters
    ----------
    innovation : array_like, shape (...)
        Residual before the update.
    S : array_like, broadcast to (...)
        Its variance.
    R : float
        Supposed variance of the measurement.

    Returns
    -------
    residual : ndarray, shape (...)
        R / S times the innovation.
    HPH : ndarray, shape (...)
        R - R^2 / S.

    Raises
    ------
    ValueError
        If a variance is not positive or a value is not finite.
    """
    S, R = _checks.positive("S", S), _checks.positive_number("R", R)
    return _checks.finite("innovation", innovation) * R / S, R - R**2 / S
