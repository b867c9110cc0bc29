"""One update of an extended Kalman filter with any measurement function."""

import numpy as np

from .. import _checks
from .linear_kalman import _check_leading


def ekf_innovation(x, P, z, h, H, R, wrap=()):
    """Return the innovation and its covariance: what a gate looks at before the update.

    Parameters
    ----------
    x, P, z, h, H, R, wrap
        See `ekf_update`.

    Returns
    -------
    innovation : ndarray, shape (..., m)
    S : ndarray, shape (..., m, m)

    Raises
    ------
    ValueError
        See `ekf_update`.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 10.3.

    Examples
    --------
    >>> innovation, S = ekf_innovation(
    ...     [2.0], [[1.0]], [5.0], lambda x: x**2, lambda x: 2 * x[..., None], [[4.0]]
    ... )
    >>> innovation.tolist(), S.tolist()
    ([1.0], [[20.0]])
    """
    x, P, z, R = _checked(x, P, z, R)
    innovation, S, _ = _innovation(x, P, z, h, H, R, wrap)
    return innovation, S


def ekf_update(x, P, z, h, H, R, wrap=(), accept=None):
    """Return the state and covariance after a measurement of a nonlinear function of the state.

    Parameters
    ----------
    x : array_like, shape (..., n)
        Predicted states.
    P : array_like, shape (..., n, n)
        Predicted covariances.
    z : array_like, shape (..., m)
        Measurements. One with a NaN in it is missing as a whole.
    h : callable
        Measurement function: takes states (..., n), returns (..., m).
    H : callable
        Its Jacobian: takes states (..., n), returns (..., m, n).
    R : array_like, shape (..., m, m)
        Covariance of the measurement noise. Leading axes of all arguments broadcast against one
        another.
    wrap : sequence of int
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

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite (but for a NaN in `z`), `P` is not a covariance
        (it may be singular), `R` is not positive definite, or `wrap` names a component that the
        measurement does not have.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 10.3; the covariance is in the form of Joseph, as in
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
    x, P, z, R = _checked(x, P, z, R)
    accept = np.asarray(True if accept is None else accept)
    if accept.dtype != bool:
        raise ValueError(f"accept must be made of booleans, got {accept.dtype}")
    _check_leading({"x": (x, 1), "P": (P, 2), "z": (z, 1), "R": (R, 2), "accept": (accept, 0)})
    return _update(x, P, z, h, H, R, wrap, accept)


def _update(x, P, z, h, H, R, wrap, accept=True):
    innovation, S, J = _innovation(x, P, z, h, H, R, wrap)
    there = np.isfinite(innovation).all(axis=-1) & accept
    updated = _corrected(x, P, np.where(there[..., None], innovation, 0), S, J, R)
    return updated[0], np.where(there[..., None, None], updated[1], P), innovation, S


def _checked(x, P, z, R):
    x = _checks.finite("x", x, (None,))
    P = _checks.covariance("P", P, x.shape[-1], definite=False)
    z = _checks.real("z", z)
    _checks.check_shape("z", z, (None,))
    if np.isinf(z).any():
        raise ValueError("z must be finite, or NaN where it is missing, got an infinite value")
    R = _checks.covariance("R", R, z.shape[-1])
    _check_leading({"x": (x, 1), "P": (P, 2), "z": (z, 1), "R": (R, 2)})
    return x, P, z, R


def _innovation(x, P, z, h, H, R, wrap):
    m = z.shape[-1]
    predicted = _checks.finite("h(x)", h(x), (m,))
    J = _checks.finite("H(x)", H(x), (m, x.shape[-1]))
    innovation = z - predicted
    if not set(wrap) <= set(range(m)):
        raise ValueError(f"wrap must hold components from 0 to {m - 1}, got {wrap}")
    for i in wrap:
        innovation[..., i] = (innovation[..., i] + np.pi) % (2 * np.pi) - np.pi
    return innovation, J @ P @ np.swapaxes(J, -1, -2) + R, J


def _corrected(x, P, innovation, S, J, R):
    K = np.swapaxes(np.linalg.solve(S, J @ P), -1, -2)
    A = np.eye(x.shape[-1]) - K @ J
    P = A @ P @ np.swapaxes(A, -1, -2) + K @ R @ np.swapaxes(K, -1, -2)
    return x + (K @ innovation[..., None])[..., 0], P
