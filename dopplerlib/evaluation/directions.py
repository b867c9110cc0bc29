"""Consistency along the principal axes of the covariance."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray


@checked
def principal_axis_errors(error: ArrayLike, P: ArrayLike) -> FloatArray:
    """Return the normalized errors along the principal axes of their covariance.

    Parameters
    ----------
    error : array_like, shape (..., n)
        Estimate minus truth, in units in which the components can be compared.
    P : array_like, shape (..., n, n)
        Covariances as the filter believes them; leading axes broadcast.

    Returns
    -------
    ndarray, shape (..., n)
        From the widest axis to the narrowest; standard normal if the filter is consistent. The sum
        of their squares is NEES. Along an axis without any spread it is 0 if the error is, and
        infinite otherwise.

    Notes
    -----
    The axes depend on the units: with positions in m and velocities in m/s, "widest" weighs a meter
    like a meter per second. The sum does not depend on them.

    Examples
    --------
    Wrong by four deviations in the direction that the filter believes to know best:

    >>> principal_axis_errors([0.5, 4.0], np.diag([100.0, 1.0])).round(2).tolist()
    [0.05, 4.0]
    """
    error = _checks.finite("error", error, (None,))
    P = _checks.covariance("P", P, error.shape[-1], definite=False)
    _checks.check_broadcast("error", error.shape[:-1], "P", P.shape[:-2])
    variance, axis = np.linalg.eigh(P)
    # The sign of an axis is arbitrary: its largest component is made positive.
    largest = np.abs(axis).argmax(axis=-2, keepdims=True)
    axis = axis * np.sign(np.take_along_axis(axis, largest, axis=-2))
    along = (np.swapaxes(axis, -1, -2) @ error[..., None])[..., 0]
    # An axis without spread: what rounding leaves of the largest variance, and of the error.
    none = variance <= error.shape[-1] ** 2 * np.finfo(float).eps * variance[..., -1:]
    right = np.abs(along) <= 1e-9 * np.abs(error).max(axis=-1, keepdims=True)
    sure = np.where(right, 0.0, np.copysign(np.inf, along))
    return np.where(none, sure, along / np.sqrt(np.where(none, 1.0, variance)))[..., ::-1]
