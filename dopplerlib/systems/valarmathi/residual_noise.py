"""The variance of the measurements from the residuals of the filter: Eq 14 and its sign."""

from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Positive, Reals, checked, shaped
from ..._typing import FloatArray
from .published import reported


@checked
@_checks.quiet
def residual_variance(
    residual: Annotated[FloatArray, shaped(None)], HPH: Reals, sign: Literal[-1, 1] = -1
) -> FloatArray:
    """Return the variance of the measurements as estimated from the residuals after the update.

    residual (..., K): Measurement minus H times the updated state.
    HPH: H P H' of the updated covariance.
    sign: -1 as the document has it, 1 as it should be: the variance of this residual is R - H P H',
        so R is its variance *plus* H P H'.
    Returns (...): Can be negative with the sign of the document.
    Raises ValueError if an argument is not of the kind described, or there is no residual.

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
    if not residual.size:
        raise ValueError(f"residual must hold a value, got shape {residual.shape}")
    _checks.check_broadcast("HPH", HPH.shape, "residual", residual.shape[:-1])
    middle = np.median(residual, axis=-1, keepdims=True)
    spread = np.median(np.abs(residual - middle), axis=-1) / reported().stated.mad_to_std
    return spread**2 + sign * HPH


@checked
@_checks.quiet
def updated_residual(
    innovation: Reals, S: Annotated[FloatArray, _checks.positive], R: Positive
) -> tuple[FloatArray, FloatArray]:
    """Return the residual after the update, and H P H' then, of a scalar measurement.

    innovation (...): Residual before the update.
    S: Its variance.
    R: Supposed variance of the measurement.
    Returns residual (...): R / S times the innovation.
        HPH (...): R - R^2 / S.
    Raises ValueError if an argument is not of the kind described, or a residual is beyond what a
        float can hold.

    Examples
    --------
    >>> [one.tolist() for one in updated_residual([3.0], 4.0, 1.0)]
    [[0.75], 0.75]
    """
    _checks.check_broadcast("S", S.shape, "innovation", innovation.shape)
    residual, HPH = innovation * R / S, R - R**2 / S
    _checks.estimates("innovation, S, R", residual, HPH)
    return residual, HPH
