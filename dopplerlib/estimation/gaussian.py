"""Gaussian estimates and linear measurements: the algebra of all filters, unchecked.

Covariances are computed as squares, see `covariances`. Measurements that are missing are NaN in the
innovation: the others update alone (the marginal likelihood), and where all are missing the
estimate stays as it was, bit by bit.
"""

import numpy as np

from .. import _checks
from .._typing import BoolArray, FloatArray
from .covariances import cholesky, singular, solve, square_root, squared


@_checks.quiet
def predict(
    x: FloatArray, P: FloatArray, F: FloatArray, Q: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Predict state and covariance by a linear motion: F x and F P F' + Q.

    Parameters
    ----------
    x : ndarray, shape (..., n)
        States.
    P : ndarray, shape (..., n, n)
        Their covariances.
    F, Q : ndarray, shape (..., n, n)
        Transition matrices; covariances of the process noise.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)
    """
    return _times(F, x), squared(F @ square_root(P), Q)


@_checks.quiet
def innovation(x: FloatArray, z: FloatArray, H: FloatArray) -> FloatArray:
    """Return the innovation z - H x of a linear measurement.

    Parameters
    ----------
    x : ndarray, shape (..., n)
        Predicted states.
    z : ndarray, shape (..., m)
        Measurements; NaN where one is missing.
    H : ndarray, shape (..., m, n)
        Measurement matrices.

    Returns
    -------
    ndarray, shape (..., m)
    """
    return z - _times(H, x)


@_checks.quiet
def gain(
    P: FloatArray, H: FloatArray, R: FloatArray, there: BoolArray | bool = True
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the Kalman gain, the updated covariance, and that of the innovation.

    Parameters
    ----------
    P : ndarray, shape (..., n, n)
        Predicted covariances.
    H : ndarray, shape (..., m, n)
        Measurement matrices.
    R : ndarray, shape (..., m, m)
        Covariances of the measurement noise.
    there : ndarray of bool, shape (..., m)
        Which components are measured; all if True.

    Returns
    -------
    K : ndarray, shape (..., n, m)
        P H' S^-1; zero for components that are missing.
    P : ndarray, shape (..., n, n)
        In Joseph form: (I - K H) P (I - K H)' + K R K', which holds for any gain.
    S : ndarray, shape (..., m, m)
        H P H' + R of all components, also those that are missing.

    Raises
    ------
    ValueError
        If S is singular to rounding.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 5.2.3; the Joseph form is due to Bucy and Joseph (1968).
    """
    L = square_root(P)
    K, S, R = _weighed(L, H @ L, R, there)
    return K, _joseph(P, (np.eye(P.shape[-1]) - K @ H) @ L, K, R, there), S


@_checks.quiet
def gain_of_root(
    P: FloatArray, L: FloatArray, HL: FloatArray, R: FloatArray, there: BoolArray | bool = True
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the same as `gain` from H L in place of H, as sigma points give it.

    Parameters
    ----------
    P, R, there
        See `gain`.
    L : ndarray, shape (..., n, n)
        Square root of `P`, see `square_root`.
    HL : ndarray, shape (..., m, n)
        Measurement matrix times `L`.

    Returns
    -------
    K, P, S
        See `gain`.

    Raises
    ------
    ValueError
        If S is singular to rounding.
    """
    K, S, R = _weighed(L, HL, R, there)
    return K, _joseph(P, L - K @ HL, K, R, there), S


@_checks.quiet
def moved(x: FloatArray, K: FloatArray, innovation: FloatArray) -> FloatArray:
    """Return updated states x + K innovation; missing components add nothing.

    Parameters
    ----------
    x : ndarray, shape (..., n)
        Predicted states.
    K : ndarray, shape (..., n, m)
        Gains.
    innovation : ndarray, shape (..., m)
        Measured minus predicted measurement; NaN where it is missing.

    Returns
    -------
    ndarray, shape (..., n)
    """
    return x + _times(K, np.where(np.isnan(innovation), 0.0, innovation))


@_checks.quiet
def update(
    x: FloatArray, P: FloatArray, innovation: FloatArray, H: FloatArray, R: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Update state and covariance by a measurement; return the innovation covariance as well.

    Parameters
    ----------
    x : ndarray, shape (..., n)
        Predicted states.
    P, H, R
        See `gain`.
    innovation : ndarray, shape (..., m)
        Measured minus predicted measurement; NaN where it is missing.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)
    S : ndarray, shape (..., m, m)

    Raises
    ------
    ValueError
        If S is singular to rounding.
    """
    K, P, S = gain(P, H, R, ~np.isnan(innovation))
    return moved(x, K, innovation), P, S


@_checks.quiet
def smooth(
    x: FloatArray,
    P: FloatArray,
    F: FloatArray,
    Q: FloatArray,
    x_next: FloatArray,
    P_next: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return a smoothed estimate from the filtered one and the smoothed one after it.

    Parameters
    ----------
    x, P : ndarray, shape (..., n) and (..., n, n)
        Filtered states and covariances.
    F, Q : ndarray, shape (..., n, n)
        The step from them to the next ones.
    x_next, P_next : ndarray, shape (..., n) and (..., n, n)
        Smoothed states and covariances after the step.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)

    Notes
    -----
    Rauch, Tung, Striebel (1965) with the gain G = P F' (F P F' + Q)^-1 by `solve`: a direction in
    which the prediction is certain teaches nothing. The covariance P + G (P_next - F P F' - Q) G'
    is (I - G F) P (I - G F)' + G (Q + P_next) G', which only adds.
    """
    L = square_root(P)
    FL = F @ L
    predicted = squared(FL, Q)
    G = solve(predicted, FL @ L.mT).mT
    x = x + _times(G, x_next - _times(F, x))
    A = np.eye(P.shape[-1]) - G @ F
    B = G @ square_root(Q + P_next)
    return x, squared(A @ L, B @ B.mT)


def _weighed(L, HL, R, there):
    """Return gain, S, and R in which the noise of missing components has variance 1.

    Missing components measure nothing: their rows of H L are zero, and their columns of the gain.
    """
    S = used = squared(HL, R)
    if not np.all(there):
        both = there[..., :, None] & there[..., None, :]
        eye = np.eye(there.shape[-1])
        used, R = np.where(both, S, eye), np.where(both, R, eye)
        HL = np.where(there[..., None], HL, 0.0)
    cholesky(used)
    try:
        return np.linalg.solve(used, HL @ L.mT).mT, S, R
    except np.linalg.LinAlgError:  # one factorization may find what the other does not
        raise singular(used) from None


def _joseph(P, AL, K, R, there):
    """Return the covariance after an update with (I - K H) L, or P where nothing is there."""
    B = K @ square_root(R)
    after = squared(AL, B @ B.mT)
    if not np.all(there):
        after = np.where(there.any(axis=-1)[..., None, None], after, P)
    return after


def _times(A, v):
    return (A @ v[..., None])[..., 0]
