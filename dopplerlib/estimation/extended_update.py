"""Measurement update of the extended Kalman filter, for any measurement function."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from .. import _checks
from .._typing import ArrayLike, FloatArray
from . import gaussian


@_checks.quiet
def ekf_update(
    x: ArrayLike,
    P: ArrayLike,
    z: ArrayLike,
    h: Callable[..., Any],
    H: Callable[..., Any],
    R: ArrayLike,
    wrap: Iterable[int] = (),
    accept: ArrayLike | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Measurement update of the extended Kalman filter (Joseph form).

    Parameters
    ----------
    x : array_like, shape (..., n)
        Predicted states.
    P : array_like, shape (..., n, n)
        Predicted covariances.
    z : array_like, shape (..., m)
        Measurements; NaN says that a component is missing. The others update alone.
    h : callable
        Measurement function: takes states (..., n), returns (..., m).
    H : callable
        Its Jacobian: takes states (..., n), returns (..., m, n).
    R : array_like, shape (..., m, m)
        Covariance of the measurement noise. Leading axes of all arguments broadcast against one
        another.
    wrap : iterable of int
        Components of the measurement that are angles in rad: their innovations are brought into
        [-pi, pi).
    accept : array_like of bool, shape (...), optional
        False where the state is to stay predicted; all True if None.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)
    innovation : ndarray, shape (..., m)
        NaN where `z` is NaN.
    S : ndarray, shape (..., m, m)
        Of all components, also of those that are missing.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite (but for a NaN in `z`), also of what comes out,
        `h` or `H` is no function, `P` is not a covariance (it may be singular), `R` is not positive
        definite, or so small that S is singular to rounding, or `wrap` names a component that the
        measurement does not have.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 10.3; the covariance is in Joseph form, as in
    `kf_update`.

    Examples
    --------
    The side of a square of which the area is measured; the second measurement is missing:

    >>> x, P, innovation, S = ekf_update(
    ...     [2.0], [[1.0]], [[5.0], [np.nan]], lambda x: x**2, lambda x: 2 * x[..., None], [[4.0]]
    ... )
    >>> x.round(3).tolist(), P.round(3).tolist()
    ([[2.2], [2.0]], [[[0.2]], [[1.0]]])
    """
    x = _checks.finite("x", x, (None,))
    P = _checks.covariance("P", P, x.shape[-1], definite=False)
    z = _checks.measured("z", z, (None,))
    R = _checks.covariance("R", R, z.shape[-1])
    accept = _checks.booleans("accept", True if accept is None else accept)
    _checks.check_leading(x=(x, 1), P=(P, 2), z=(z, 1), R=(R, 2), accept=(accept, 0))
    innovation, J = linearized(x, z, h, H, wrap)
    # What is refused is treated as if it were missing.
    x, P, S = gaussian.update(x, P, np.where(accept[..., None], innovation, np.nan), J, R)
    _checks.estimates("x, P, z, h, H, R", x, P, S)
    return x, P, innovation, S


def linearized(
    x: FloatArray,
    z: FloatArray,
    h: Callable[..., Any],
    H: Callable[..., Any],
    wrap: Iterable[int] = (),
) -> tuple[FloatArray, FloatArray]:
    """Return the innovation (..., m) of a nonlinear measurement, and the Jacobian (..., m, n).

    Predicted states x (..., n) and measurements z (..., m), NaN where one is missing, are
    unchecked; what the functions return is not. ValueError if `h` or `H` is no function, returns
    another shape or a value that is not finite, or `wrap` names a component that the measurement
    does not have.
    """
    m = z.shape[-1]
    wrap = _checks.components("wrap", wrap, m)
    predicted, J = predicted_measurement(x, m, h, H)
    _checks.check_leading(**{"x": (x, 1), "z": (z, 1), "h(x)": (predicted, 1), "H(x)": (J, 2)})
    return wrapped(z - predicted, wrap), J


def predicted_measurement(
    x: FloatArray, m: int, h: Callable[..., Any], H: Callable[..., Any]
) -> tuple[FloatArray, FloatArray]:
    """Return h(x) (..., m) and H(x) (..., m, n) of states x (..., n), which are unchecked.

    ValueError as by `linearized`.
    """
    predicted = _checks.finite("h(x)", _checks.called("h", h, x), (m,))
    return predicted, _checks.finite("H(x)", _checks.called("H", H, x), (m, x.shape[-1]))


def wrapped(difference: FloatArray, wrap: Iterable[int]) -> FloatArray:
    """Return differences with the angles among them wrapped to [-pi, pi); unchecked."""
    difference = difference.copy()
    for i in wrap:
        difference[..., i] = (difference[..., i] + np.pi) % (2 * np.pi) - np.pi
    return difference
