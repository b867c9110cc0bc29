"""The Kalman filter in steady state: gain, covariance and lag."""

import warnings

import numpy as np

from .. import _checks
from .._typing import ArrayLike, FloatArray
from . import gaussian


@_checks.quiet
def steady_state_gain(
    F: ArrayLike, Q: ArrayLike, H: ArrayLike, R: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Return the steady-state gain and covariance of a Kalman filter.

    Parameters
    ----------
    F, Q : array_like, shape (n, n)
        Transition matrix; covariance of the process noise.
    H : array_like, shape (m, n)
        Measurement matrix.
    R : array_like, shape (m, m)
        Covariance of the measurement noise.

    Returns
    -------
    K : ndarray, shape (n, m)
        Gain.
    P : ndarray, shape (n, n)
        Covariance after the update.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, `R` is not positive definite, `Q` is not a
        covariance, or the filter does not settle: a mode that does not decay is not measured, or
        is not driven by noise.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 5.2.5: the predicted covariance solves the discrete
    algebraic Riccati equation.

    Examples
    --------
    A scalar random walk, everything equal to one, settles at the golden ratio:

    >>> K, P = steady_state_gain([[1]], [[1]], [[1]], [[1]])
    >>> round(float(K[0, 0]), 6)
    0.618034
    """
    # Here: it takes longer to load than all the rest.
    from scipy.linalg import LinAlgWarning, solve_discrete_are

    H = _checks.matrix("H", H, (None, None))
    m, n = H.shape
    F = _checks.matrix("F", F, (n, n))
    Q = _checks.matrix("Q", _checks.covariance("Q", Q, n, definite=False), (n, n))
    R = _checks.matrix("R", _checks.covariance("R", R, m), (m, m))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", LinAlgWarning)
            # SciPy takes no rounding across the diagonal.
            predicted = solve_discrete_are(F.T, H.T, (Q + Q.T) / 2, (R + R.T) / 2)
    except (np.linalg.LinAlgError, LinAlgWarning, ValueError):
        raise ValueError(
            "F, H, Q must be detectable and stabilizable, got no solution of the Riccati equation"
        ) from None
    K, P, _ = gaussian.gain(predicted, H, R)
    A = np.eye(n) - K @ H
    _checks.estimates("F, Q, H, R", K, P, A @ F)
    # A double eigenvalue of 1 comes out with an error of half the digits.
    if np.abs(np.linalg.eigvals(A @ F)).max() > 1 - 1e-7:
        raise ValueError(
            "F, H, Q must be detectable and stabilizable, got a filter that is not stable"
        )
    return K, P


@_checks.quiet
def steady_state_lag(F: ArrayLike, H: ArrayLike, K: ArrayLike, push: ArrayLike) -> FloatArray:
    """Return the steady-state lag of a filter whose model lacks a constant push.

    Parameters
    ----------
    F : array_like, shape (n, n)
        Transition matrix of the filter.
    H : array_like, shape (m, n)
        Measurement matrix.
    K : array_like, shape (n, m)
        Gain.
    push : array_like, shape (..., n)
        Push of the truth in addition to `F` in every step: for a constant acceleration a and a
        filter of constant velocity, [a T^2 / 2, a T] on each axis.

    Returns
    -------
    ndarray, shape (..., n)
        Mean of truth minus estimate, after the update.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, or errors do not die out with this gain.

    Notes
    -----
    The error e obeys e' = (I - K H)(F e + push), so that it settles at the fixed point of this
    equation. Bar-Shalom, Li, Kirubarajan (2001), Sec 6.5, for the alpha-beta filter.

    Examples
    --------
    An alpha-beta filter, T = 1, gains 0.5 and 0.25, and an acceleration of 1:

    >>> steady_state_lag([[1, 1], [0, 1]], [[1, 0]], [[0.5], [0.25]], [0.5, 1.0]).tolist()
    [2.0, 1.5]
    """
    H = _checks.matrix("H", H, (None, None))
    m, n = H.shape
    F = _checks.matrix("F", F, (n, n))
    K = _checks.matrix("K", K, (n, m))
    push = _checks.finite("push", push, (n,))
    A = np.eye(n) - K @ H
    _checks.estimates("F, H, K", A @ F)
    if np.abs(np.linalg.eigvals(A @ F)).max() >= 1:
        raise ValueError(
            "K must give a stable filter, got (I - K H) F with eigenvalues outside the unit circle"
        )
    lag = np.linalg.solve(np.eye(n) - A @ F, A @ push[..., None])[..., 0]
    return _checks.estimates("F, H, K, push", lag)
