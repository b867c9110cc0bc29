"""Covariances as squares: roots, products and solutions, unchecked.

With a square root P = L L', the covariance F P F' is the product of F L with its own transpose. So
it has no negative variance, and every entry is off by rounding of the two standard deviations that
it belongs to, however much larger the covariance before was: what comes out is a covariance by the
test of the functions that take one. BLAS may add up the two halves of a square in another order.
Their mean is taken, which makes it symmetric and is part of the definition of each function.
Nothing else is repaired. NumPy is kept quiet by the functions that call these, which would do so
several times in every scan.
"""

import numpy as np

from .._typing import FloatArray


def square_root(P: FloatArray) -> FloatArray:
    """Return square roots of covariances P (..., n, n): L with L L' = P to rounding.

    Cholesky factors; where one of the matrices is singular, those of the eigenvalues after scaling
    to a diagonal of ones. Directions with no other spread than rounding, of either sign, have none.
    NaN where `P` is not finite.
    """
    try:
        return np.linalg.cholesky(P)
    except np.linalg.LinAlgError:
        scale, value, vector, finite = _eigen(P)
        # Its row is exactly zero where a variance is: what is known exactly stays so.
        vector = np.where(np.diagonal(P, axis1=-2, axis2=-1)[..., None] > 0, vector, 0.0)
        root = scale[..., :, None] * vector * np.sqrt(np.maximum(value, 0.0))[..., None, :]
        return np.where(finite, root, np.nan)


def squared(A: FloatArray, noise: FloatArray | float = 0.0) -> FloatArray:
    """Return A A' + noise, symmetric, of A (..., n, k) and covariances that are added."""
    S = A @ A.mT + noise
    return (S + S.mT) / 2


def solve(P: FloatArray, B: FloatArray) -> FloatArray:
    """Return P^-1 B by the pseudo-inverse: directions of no variance contribute nothing.

    Where P (..., n, n) is singular to rounding, the pseudo-inverse is that after scaling to a
    diagonal of ones. NaN where `P` is not finite.
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


def cholesky(S: FloatArray) -> FloatArray:
    """Return Cholesky factors of innovation covariances H P H' + R; NaN where S is not finite.

    ValueError if one is singular to rounding.
    """
    try:
        return np.linalg.cholesky(S)
    except np.linalg.LinAlgError:
        finite = np.isfinite(S).all(axis=(-2, -1), keepdims=True)
        if finite.all():
            raise singular(S) from None
        return np.where(finite, cholesky(np.where(finite, S, np.eye(S.shape[-1]))), np.nan)


def singular(S: FloatArray) -> ValueError:
    """Return the error that blames R for a singular innovation covariance."""
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
