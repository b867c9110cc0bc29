"""Gaussian estimates and linear measurements: the algebra of all filters, unchecked.

Covariances are computed as squares: with a square root P = L L', the covariance F P F' is the
product of F L with its own transpose. So it has no negative variance, and every entry is off by
rounding of the two standard deviations that it belongs to, however much larger the covariance
before was: what comes out is a covariance by the test of the functions that take one. BLAS may add
up the two halves of a square in another order. Their mean is taken, which makes it symmetric and is
part of the definition of each function. Nothing else is repaired.

Measurements that are missing are NaN in the innovation: the others update alone (the marginal
likelihood), and where all are missing the estimate stays as it was, bit by bit.
"""

import numpy as np

from .. import _checks
from .._typing import BoolArray, FloatArray


@_checks.quiet
def square_root(P: FloatArray) -> FloatArray:
    """Return square roots of covariances: L with L L' = P to rounding.

    Parameters
    ----------
    P : ndarray, shape (..., n, n)
        Positive semidefinite to rounding: directions with no other spread than rounding, of either
        sign, have none.

    Returns
    -------
    ndarray, shape (..., n, n)
        Cholesky factors; where one of the matrices is singular, those of the eigenvalues after
        scaling to a diagonal of ones. NaN where `P` is not finite.
    """
    try:
        return np.linalg.cholesky(P)
    except np.linalg.LinAlgError:
        scale, value, vector, finite = _eigen(P)
        # Its row is exactly zero where a variance is: what is known exactly stays so.
        vector = np.where(np.diagonal(P, axis1=-2, axis2=-1)[..., None] > 0, vector, 0.0)
        root = scale[..., :, None] * vector * np.sqrt(np.maximum(value, 0.0))[..., None, :]
        return np.where(finite, root, np.nan)


@_checks.quiet
def squared(A: FloatArray, noise: FloatArray | float = 0.0) -> FloatArray:
    """Return A A' + noise, symmetric.

    Parameters
    ----------
    A : ndarray, shape (..., n, k)
    noise : ndarray, shape (..., n, n), optional
        Covariances that are added.

    Returns
    -------
    ndarray, shape (..., n, n)
    """
    return _symmetric(_squared(A) + noise)


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
def quadratic_forms(v: FloatArray, S: FloatArray) -> FloatArray:
    """Return v' S^-1 v of many vectors with one covariance, such as the NIS of all detections.

    Parameters
    ----------
    v : ndarray, shape (..., D, m)
        Vectors; the form is that of the components which are not NaN.
    S : ndarray, shape (..., m, m)
        Covariances.

    Returns
    -------
    ndarray, shape (..., D)
        Not negative; NaN where all components are.

    Raises
    ------
    ValueError
        If a covariance is singular to rounding.
    """
    there = ~np.isnan(v)
    if there.all():
        white = np.linalg.solve(_cholesky(S), v.mT)
        return np.sum(white * white, axis=-2)
    return quadratic_form(v, S[..., None, :, :])


@_checks.quiet
def quadratic_form(v: FloatArray, S: FloatArray) -> FloatArray:
    """Return v' S^-1 v of each vector with a covariance of its own, such as NIS.

    Parameters
    ----------
    v : ndarray, shape (..., m)
        Vectors; the form is that of the components which are not NaN.
    S : ndarray, shape (..., m, m)
        Covariances.

    Returns
    -------
    ndarray, shape (...)
        Not negative; NaN where all components are.

    Raises
    ------
    ValueError
        If a covariance is singular to rounding.
    """
    return _form(v, S)[0]


@_checks.quiet
def log_density(v: FloatArray, S: FloatArray) -> FloatArray:
    """Return the log density of zero-mean Gaussians.

    Parameters
    ----------
    v : ndarray, shape (..., m)
        Vectors; the density is that of the components which are not NaN.
    S : ndarray, shape (..., m, m)
        Covariances.

    Returns
    -------
    ndarray, shape (...)
        Zero where all components are NaN: what is not measured speaks for no model.

    Raises
    ------
    ValueError
        If a covariance is singular to rounding.
    """
    form, L, there = _form(v, S)
    size = np.sum(there, axis=-1)
    diagonal = np.diagonal(L, axis1=-2, axis2=-1)
    logarithm = size * np.log(2 * np.pi) / 2 + np.sum(np.log(diagonal), axis=-1)
    return np.where(size > 0, -form / 2 - logarithm, 0.0)


@_checks.quiet
def mixture(x: FloatArray, P: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of mixtures.

    Parameters
    ----------
    x : ndarray, shape (..., M, n)
        Means of the M parts.
    P : ndarray, shape (..., M, n, n)
        Their covariances.
    weight : ndarray, shape (..., M)
        Their probabilities.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)
    """
    mean = np.sum(weight[..., None] * x, axis=-2)
    off = x - mean[..., None, :]
    spread = P + off[..., :, None] * off[..., None, :]
    return mean, np.sum(weight[..., None, None] * spread, axis=-3)


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
    return x, _symmetric(_squared(A @ L) + _squared(G @ square_root(Q + P_next)))


@_checks.quiet
def solve(P: FloatArray, B: FloatArray) -> FloatArray:
    """Return P^-1 B by the pseudo-inverse: directions of no variance contribute nothing.

    Parameters
    ----------
    P : ndarray, shape (..., n, n)
        Covariances.
    B : ndarray, shape (..., n, k)

    Returns
    -------
    ndarray, shape (..., n, k)
        By the pseudo-inverse after scaling to a diagonal of ones, where `P` is singular to
        rounding. NaN where `P` is not finite.
    """
    n = P.shape[-1]
    # The entries of a square of n columns, scaled to a diagonal of ones, are off by n roundings, so
    # its eigenvalues by n^2 of them, and a pivot of Cholesky's is not above the least eigenvalue.
    rounding = n**2 * np.finfo(float).eps
    try:
        pivot = np.diagonal(np.linalg.cholesky(P), axis1=-2, axis2=-1) ** 2
        if (pivot > rounding * np.diagonal(P, axis1=-2, axis2=-1)).all():
            return np.linalg.solve(P, B)
    except np.linalg.LinAlgError:
        pass
    scale, value, vector, finite = _eigen(P)
    regular = value > rounding
    weight = np.where(regular, 1 / np.where(regular, value, 1.0), 0.0)
    half = vector / scale[..., :, None]
    return np.where(finite, (half * weight[..., None, :]) @ (half.mT @ B), np.nan)


def _form(v, S):
    """Return the quadratic forms, the factors of S for the components there, and which are."""
    there = ~np.isnan(v)
    if there.all():
        L = _cholesky(S)
        white = np.linalg.solve(L, v[..., None])[..., 0]
        return np.sum(white * white, axis=-1), L, there
    both = there[..., :, None] & there[..., None, :]
    L = _cholesky(np.where(both, S, np.eye(v.shape[-1])))
    white = np.linalg.solve(L, np.where(there, v, 0.0)[..., None])[..., 0]
    form = np.where(there.any(axis=-1), np.sum(white * white, axis=-1), np.nan)
    return form, L, there


def _weighed(L, HL, R, there):
    """Return gain, S, and R in which the noise of missing components has variance 1.

    What is missing measures nothing: its rows of H L are zero, and so are its columns of the gain.
    """
    S = used = squared(HL, R)
    if not np.all(there):
        both = there[..., :, None] & there[..., None, :]
        eye = np.eye(there.shape[-1])
        used, R = np.where(both, S, eye), np.where(both, R, eye)
        HL = np.where(there[..., None], HL, 0.0)
    _cholesky(used)
    try:
        return np.linalg.solve(used, HL @ L.mT).mT, S, R
    except np.linalg.LinAlgError:  # one factorization may find what the other does not
        raise _singular(used) from None


def _joseph(P, AL, K, R, there):
    """Return the covariance after an update with (I - K H) L, or P where nothing is there."""
    after = _symmetric(_squared(AL) + _squared(K @ square_root(R)))
    if not np.all(there):
        after = np.where(there.any(axis=-1)[..., None, None], after, P)
    return after


def _cholesky(S):
    """Return Cholesky factors; NaN where S is not finite; raise if one is singular to rounding."""
    try:
        return np.linalg.cholesky(S)
    except np.linalg.LinAlgError:
        finite = np.isfinite(S).all(axis=(-2, -1), keepdims=True)
        if finite.all():
            raise _singular(S) from None
        return np.where(finite, _cholesky(np.where(finite, S, np.eye(S.shape[-1]))), np.nan)


def _singular(S):
    return ValueError(
        "R must make H P H' + R positive definite, got a smallest eigenvalue of "
        f"{np.linalg.eigvalsh(S)[..., 0].min():.3g}, zero to rounding"
    )


def _eigen(P):
    """Return scale, eigenvalues and eigenvectors of P / (scale scale'), and where P is finite."""
    deviation = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    scale = np.where(deviation > 0, deviation, 1.0)
    finite = np.isfinite(P).all(axis=(-2, -1), keepdims=True)
    scaled = np.where(finite, P / scale[..., :, None] / scale[..., None, :], 0.0)
    return scale, *np.linalg.eigh(scaled), finite


def _times(A, v):
    return (A @ v[..., None])[..., 0]


def _squared(A):
    return A @ A.mT


def _symmetric(A):
    return (A + A.mT) / 2
