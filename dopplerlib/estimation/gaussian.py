"""Gaussian estimates and linear measurements: the algebra of all filters, unchecked.

States are x (..., n) with covariances P (..., n, n); they move by F with process noise Q, both
(..., n, n). Measurements z (..., m) are H x, with H (..., m, n), and noise of covariance R
(..., m, m). Those that are missing are NaN in z and in the innovation (..., m): the others update
alone (the marginal likelihood), and where all are missing the estimate stays as it was, bit by bit.
Covariances are computed as squares, see `covariances`. ValueError if an innovation covariance S is
singular to rounding.
"""

from functools import cache

import numpy as np

from .. import _checks
from .._typing import BoolArray, FloatArray
from .covariances import cholesky, singular, solve, square_root, squared


@_checks.quiet
def predict(
    x: FloatArray, P: FloatArray, F: FloatArray, Q: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return state and covariance after a linear motion: F x and F P F' + Q."""
    return _times(F, x), squared(F @ square_root(P), Q)


@_checks.quiet
def innovation(x: FloatArray, z: FloatArray, H: FloatArray) -> FloatArray:
    """Return the innovation z - H x of a linear measurement."""
    return z - _times(H, x)


@_checks.quiet
def gain(
    P: FloatArray,
    H: FloatArray,
    R: FloatArray,
    there: BoolArray | bool = True,
    R_root: FloatArray | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the Kalman gain, the updated covariance, and that of the innovation.

    `there` (..., m) says which components are measured. The gain K (..., n, m) is P H' S^-1, zero
    for components that are missing; the covariance is in Joseph form,
    (I - K H) P (I - K H)' + K R K', which holds for any gain; S (..., m, m) is H P H' + R of all
    components, also those that are missing. `R_root` is the `square_root` of R, if it is at hand.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 5.2.3; the Joseph form is due to Bucy and Joseph (1968).
    """
    L, complete = square_root(P), _all(there)
    K, S, R = _weighed(L, H @ L, R, there, complete)
    R_root = R_root if complete and R_root is not None else square_root(R)
    return K, _joseph(P, (_eye(P.shape[-1]) - K @ H) @ L, K, R_root, there, complete), S


@_checks.quiet
def gain_of_root(
    P: FloatArray, L: FloatArray, HL: FloatArray, R: FloatArray, there: BoolArray | bool = True
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the same as `gain` from L with L L' = P and from H L, as sigma points give it."""
    complete = _all(there)
    K, S, R = _weighed(L, HL, R, there, complete)
    return K, _joseph(P, L - K @ HL, K, square_root(R), there, complete), S


@_checks.quiet
def moved(x: FloatArray, K: FloatArray, innovation: FloatArray) -> FloatArray:
    """Return updated states x + K innovation; missing components add nothing."""
    return x + _times(K, np.where(np.isnan(innovation), 0.0, innovation))


@_checks.quiet
def update(
    x: FloatArray, P: FloatArray, innovation: FloatArray, H: FloatArray, R: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return state and covariance after a measurement, from its innovation, and S."""
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

    `F` and `Q` are those of the step from x, P to x_next, P_next.

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


def _all(there):
    return there is True or bool(there.all())


@cache
def _eye(n):
    eye = np.eye(n)
    eye.setflags(write=False)
    return eye


def _weighed(L, HL, R, there, complete):
    """Return gain, S, and R in which the noise of missing components has variance 1.

    Missing components measure nothing: their rows of H L are zero, and their columns of the gain.
    """
    S = used = squared(HL, R)
    if not complete:
        both = there[..., :, None] & there[..., None, :]
        eye = _eye(there.shape[-1])
        used, R = np.where(both, S, eye), np.where(both, R, eye)
        HL = np.where(there[..., None], HL, 0.0)
    cholesky(used)
    try:
        return np.linalg.solve(used, HL @ L.mT).mT, S, R
    except np.linalg.LinAlgError:  # one factorization may find what the other does not
        raise singular(used) from None


def _joseph(P, AL, K, R_root, there, complete):
    """Return the covariance after an update with (I - K H) L, or P where nothing is there."""
    B = K @ R_root
    after = squared(AL, B @ B.mT)
    if not complete:
        after = np.where(there.any(axis=-1)[..., None, None], after, P)
    return after


def _times(A, v):
    return (A @ v[..., None])[..., 0]
