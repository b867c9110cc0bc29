"""Fusion of two estimates of one state."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from ..estimation import covariances, gaussian


@checked
@_checks.quiet
def fuse_state_vectors(
    x1: ArrayLike, P1: ArrayLike, x2: ArrayLike, P2: ArrayLike, P12: ArrayLike | None = None
) -> tuple[FloatArray, FloatArray]:
    """Fuse two estimates with known cross-covariance (zero by default).

    Parameters
    ----------
    x1, x2 : array_like, shape (..., n)
        Estimates of the same state.
    P1, P2 : array_like, shape (..., n, n)
        Their covariances, which may be singular. Leading axes of all arguments broadcast against
        one another.
    P12 : array_like, shape (..., n, n), optional
        Covariance of the error of the first with that of the second; none if None. The difference
        of the two then has the covariance P1 + P2 - P12 - P12'.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)

    Notes
    -----
    With A = P1 - P12, the estimate is x1 + A (P1 + P2 - P12 - P12')^-1 (x2 - x1): Bar-Shalom and
    Campo (1986). Without P12 it is Eqs 15 to 17 of Valarmathi et al., right only if the errors are
    independent. Those of two filters that follow one target never are: both miss its maneuvers.
    A component that both know exactly, such as in a plane, is that of the first.

    Examples
    --------
    Two equal estimates, taken for independent, and known to have half of their variance in common:

    >>> x, P = fuse_state_vectors([0.0], [[1.0]], [2.0], [[1.0]])
    >>> x.tolist(), P.tolist()
    ([1.0], [[0.5]])
    >>> fuse_state_vectors([0.0], [[1.0]], [2.0], [[1.0]], [[0.5]])[1].tolist()
    [[0.75]]
    """
    x1, P1, x2, P2 = _estimates(False, x1=x1, P1=P1, x2=x2, P2=P2)
    if P12 is None:
        return _independent(x1, P1, x2, P2)
    n = x1.shape[-1]
    P12 = _checks.finite("P12", P12, (n, n))
    _checks.check_leading(x1=(x1, 1), P1=(P1, 2), x2=(x2, 1), P2=(P2, 2), P12=(P12, 2))
    S = P1 + P2 - P12 - P12.mT
    try:
        np.linalg.cholesky(S)
    except np.linalg.LinAlgError:
        raise ValueError(
            "P12 must leave P1 + P2 - P12 - P12' positive definite, got a smallest eigenvalue of "
            f"{np.linalg.eigvalsh(S)[..., 0].min():.3g}"
        ) from None
    P1, P12, P2 = np.broadcast_arrays(P1, P12, P2)
    joint = np.block([[P1, P12], [P12.mT, P2]])
    _checks.covariance("P12 with P1 and P2, [[P1, P12], [P12', P2]],", joint, 2 * n, definite=False)
    W = np.linalg.solve(S, (P1 - P12).mT).mT
    root = covariances.square_root(joint)
    x = gaussian.moved(x1, W, x2 - x1)
    P = covariances.squared(np.concatenate([np.eye(n) - W, W], axis=-1) @ root)
    return _checks.estimates("x1, P1, x2, P2, P12", x, P)


def _independent(x1, P1, x2, P2):
    """Return the fusion of independent estimates; components that both know exactly stay."""
    W = covariances.solve(P1 + P2, P1).mT
    A = np.eye(x1.shape[-1]) - W
    parts = np.broadcast_arrays(A @ covariances.square_root(P1), W @ covariances.square_root(P2))
    x, P = gaussian.moved(x1, W, x2 - x1), covariances.squared(np.concatenate(parts, axis=-1))
    return _checks.estimates("the two estimates", x, P)


@checked
@_checks.quiet
def cross_covariance_step(
    P12: ArrayLike,
    F: ArrayLike,
    Q: ArrayLike,
    K1: ArrayLike,
    H1: ArrayLike,
    K2: ArrayLike,
    H2: ArrayLike,
) -> FloatArray:
    """Return the cross-covariance of the errors of two filters after one more cycle.

    Parameters
    ----------
    P12 : array_like, shape (..., n, n)
        Covariance between the errors after the last cycle.
    F, Q : array_like, shape (..., n, n)
        Transition matrix, and covariance of the process noise that both have in common.
    K1, K2 : array_like, shape (..., n, m)
        Gains of the two filters.
    H1, H2 : array_like, shape (..., m, n)
        Their measurement matrices.

    Returns
    -------
    ndarray, shape (..., n, n)
        (I - K1 H1) (F P12 F' + Q) (I - K2 H2)'.

    Notes
    -----
    Bar-Shalom (1981). The noise of the measurements is independent; common is the target.

    Examples
    --------
    >>> cross_covariance_step([[0.0]], [[1]], [[2.0]], [[0.5]], [[1]], [[0.5]], [[1]]).tolist()
    [[0.5]]
    """
    P12 = _checks.finite("P12", P12, (None, None))
    n = P12.shape[-1]
    _checks.check_shape("P12", P12, (n, n))
    F, Q = _checks.finite("F", F, (n, n)), _checks.covariance("Q", Q, n, definite=False)
    leading, keep = {"P12": (P12, 2), "F": (F, 2), "Q": (Q, 2)}, []
    for K_name, K, H_name, H in (("K1", K1, "H1", H1), ("K2", K2, "H2", H2)):
        K = _checks.finite(K_name, K, (n, None))
        H = _checks.finite(H_name, H, (K.shape[-1], n))
        leading |= {K_name: (K, 2), H_name: (H, 2)}
        keep.append((K, H))
    _checks.check_leading(**leading)
    keep = [np.eye(n) - K @ H for K, H in keep]
    P12 = keep[0] @ (F @ P12 @ F.mT + Q) @ keep[1].mT
    return _checks.estimates("P12, F, Q, K1, H1, K2, H2", P12)


@checked
@_checks.quiet
def covariance_intersection(
    x1: ArrayLike, P1: ArrayLike, x2: ArrayLike, P2: ArrayLike, w: ArrayLike | None = None
) -> tuple[FloatArray, FloatArray]:
    """Fuse two estimates with unknown cross-correlation.

    Parameters
    ----------
    x1, x2 : array_like, shape (..., n)
        Estimates of the same state.
    P1, P2 : array_like, shape (..., n, n)
        Their covariances. Leading axes of all arguments broadcast against one another.
    w : array_like, shape (...), optional
        Weight of the first, from 0 to 1; where the determinant of the result is least if None,
        one half if it is the same everywhere.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)
        Not smaller than the true covariance, whatever the errors have in common, provided that
        neither `P1` nor `P2` is.

    Notes
    -----
    P^-1 = w P1^-1 + (1 - w) P2^-1: Julier and Uhlmann (1997). The logarithm of the determinant
    of P^-1 is concave in w, so bisection of its slope finds the best one.

    Examples
    --------
    Each knows one of two coordinates:

    >>> x, P = covariance_intersection([1, 0], np.diag([1, 9.0]), [0, 1], np.diag([9.0, 1]), 0.5)
    >>> x.round(2).tolist(), P.round(2).tolist()
    ([0.9, 0.9], [[1.8, 0.0], [0.0, 1.8]])
    """
    x1, P1, x2, P2 = _estimates(False, x1=x1, P1=P1, x2=x2, P2=P2)
    if w is None:
        w = _best_weight(P1, P2)
    else:
        w = _checks.finite("w", w)
        if ((w < 0) | (w > 1)).any():
            raise ValueError(f"w must be from 0 to 1, got {w}")
        _checks.check_leading(x1=(x1, 1), P1=(P1, 2), x2=(x2, 1), P2=(P2, 2), w=(w, 0))
    w = w[..., None, None]
    # P is P1 M P2 with the inverse M of this sum, which also holds for the weights 0 and 1. Written
    # as w B P1 B' + (1 - w) A P2 A' with A = P1 M and B = P2 M, it is a sum of squares.
    both = (1 - w) * P1 + w * P2
    A = np.where(w > 0, covariances.solve(both, P1).mT, np.eye(P1.shape[-1]))
    B = np.where(w < 1, covariances.solve(both, P2).mT, np.eye(P1.shape[-1]))
    L1, L2 = covariances.square_root(P1), covariances.square_root(P2)
    parts = np.broadcast_arrays(np.sqrt(w) * (B @ L1), np.sqrt(1 - w) * (A @ L2))
    x, P = (
        gaussian.moved(x1, (1 - w) * A, x2 - x1),
        covariances.squared(np.concatenate(parts, axis=-1)),
    )
    return _checks.estimates("x1, P1, x2, P2", x, P)


@checked
@_checks.quiet
def fuse_measurements(
    z1: ArrayLike, R1: ArrayLike, z2: ArrayLike, R2: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Fuse two independent measurements of the same quantity.

    Parameters
    ----------
    z1, z2 : array_like, shape (..., m)
        Measurements.
    R1, R2 : array_like, shape (..., m, m)
        Covariances of their noise. Leading axes of all arguments broadcast against one another.

    Returns
    -------
    z : ndarray, shape (..., m)
    R : ndarray, shape (..., m, m)
        For one Kalman filter behind both sensors: it does as well as one that takes both
        measurements.

    Notes
    -----
    Bar-Shalom, Li and Kirubarajan (2001). Measurement errors of two sensors are independent, even
    where the errors of their filters are correlated.

    Examples
    --------
    >>> z, R = fuse_measurements([1.0], [[1.0]], [4.0], [[2.0]])
    >>> z.round(3).tolist(), R.round(3).tolist()
    ([2.0], [[0.667]])
    """
    return _independent(*_estimates(True, z1=z1, R1=R1, z2=z2, R2=R2))


def _estimates(definite, **named):
    """Return the checked estimate, covariance, estimate, covariance that come in this order."""
    a, A, b, B = named
    named[a] = _checks.finite(a, named[a], (None,))
    n = named[a].shape[-1]
    named[b] = _checks.finite(b, named[b], (n,))
    for name in (A, B):
        named[name] = _checks.covariance(name, named[name], n, definite)
    _checks.check_leading(
        **{a: (named[a], 1), A: (named[A], 2), b: (named[b], 1), B: (named[B], 2)}
    )
    return named.values()


def _best_weight(P1, P2):
    """Return the weights (...) with the least determinant of the intersection."""
    # Where P1 + P2 is the identity, P1 and P2 are diagonal, with a and b = 1 - a there. The slope
    # of sum log(w / a + (1 - w) / b) falls from w = 0 to w = 1. Singular values, whose squares a
    # and b are, never come out negative.
    P1, P2 = np.broadcast_arrays(P1, P2)
    root = covariances.square_root(P1 + P2)
    white = covariances.solve(P1 + P2, root).mT
    # For what both know exactly no weight is better: one half each.
    rest = np.sqrt(0.5) * (np.eye(P1.shape[-1]) - white @ root)
    a, b = (
        np.linalg.svd(np.concatenate([white @ half, rest], axis=-1), compute_uv=False) ** 2
        for half in (covariances.square_root(P1), covariances.square_root(P2))
    )
    b = b[..., ::-1]
    low, high = np.zeros(a.shape[:-1]), np.ones(a.shape[:-1])
    for _ in range(52):
        w = (low + high) / 2
        rising = np.sum((b - a) / (w[..., None] * b + (1 - w[..., None]) * a), axis=-1) > 0
        low, high = np.where(rising, w, low), np.where(rising, high, w)
    # Of two equal covariances no weight is better: the middle then, not what rounding prefers.
    return np.where(np.abs(b - a).max(axis=-1) < 1e-9, 0.5, (low + high) / 2)
