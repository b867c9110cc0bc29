"""The linear Kalman filter: for linear models, and as a yardstick for the others."""

import numpy as np

from .. import _checks
from .track import Track


def kf_predict(x, P, F, Q):
    """Return the predicted state and covariance: F x and F P F' + Q.

    Parameters
    ----------
    x : array_like, shape (..., n)
        State estimates.
    P : array_like, shape (..., n, n)
        Their covariances.
    F, Q : array_like, shape (..., n, n)
        Transition matrix and covariance of the process noise. Leading axes of all arguments
        broadcast against one another.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, or `P` or `Q` is not a covariance (it may be
        singular).

    Notes
    -----
    Mittermaier et al. (2016), Table 1.

    Examples
    --------
    A position that moves at 2 m/s for one second, known to 0.5 m/s:

    >>> F, Q = [[1, 1], [0, 1]], np.zeros((2, 2))
    >>> x, P = kf_predict([0.0, 2.0], np.diag([0.0, 0.25]), F, Q)
    >>> x.tolist(), P.tolist()
    ([2.0, 2.0], [[0.25, 0.25], [0.25, 0.25]])
    """
    x = _checks.finite("x", x, (None,))
    n = x.shape[-1]
    P = _checks.covariance("P", P, n, definite=False)
    F = _checks.finite("F", F, (n, n))
    Q = _checks.covariance("Q", Q, n, definite=False)
    _check_leading({"x": (x, 1), "P": (P, 2), "F": (F, 2), "Q": (Q, 2)})
    return _predict(x, P, F, Q)


def kf_update(x, P, z, H, R):
    """Return the state and covariance after a measurement, in the form of Joseph.

    Parameters
    ----------
    x : array_like, shape (..., n)
        Predicted states.
    P : array_like, shape (..., n, n)
        Predicted covariances.
    z : array_like, shape (..., m)
        Measurements.
    H : array_like, shape (..., m, n)
        Measurement matrix.
    R : array_like, shape (..., m, m)
        Covariance of the measurement noise. Leading axes of all arguments broadcast against one
        another.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)
    innovation : ndarray, shape (..., m)
    S : ndarray, shape (..., m, m)

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, `P` is not a covariance (it may be
        singular), or `R` is not positive definite.

    Notes
    -----
    Mittermaier et al. (2016), Table 1; the covariance is (I - K H) P (I - K H)' + K R K' of Bucy
    and Joseph (1968), which holds for any gain and keeps its symmetry.

    Examples
    --------
    A measurement as good as the prediction meets it half way:

    >>> x, P, innovation, S = kf_update([0.0], [[1.0]], [4.0], [[1]], [[1]])
    >>> x.tolist(), P.tolist(), innovation.tolist(), S.tolist()
    ([2.0], [[0.5]], [4.0], [[2.0]])
    """
    x = _checks.finite("x", x, (None,))
    n = x.shape[-1]
    P = _checks.covariance("P", P, n, definite=False)
    z = _checks.finite("z", z, (None,))
    m = z.shape[-1]
    H = _checks.finite("H", H, (m, n))
    R = _checks.covariance("R", R, m)
    _check_leading({"x": (x, 1), "P": (P, 2), "z": (z, 1), "H": (H, 2), "R": (R, 2)})
    return _update(x, P, z, H, R)


def _check_leading(arguments):
    """Raise unless the axes before the last one or two of all arguments broadcast."""
    leading = {name: value.shape[: value.ndim - own] for name, (value, own) in arguments.items()}
    try:
        np.broadcast_shapes(*leading.values())
    except ValueError:
        got = ", ".join(f"{lead} of {name}" for name, lead in leading.items())
        raise ValueError(
            f"{', '.join(leading)} must have leading axes that broadcast, got {got}"
        ) from None


def _predict(x, P, F, Q):
    return (F @ x[..., None])[..., 0], F @ P @ np.swapaxes(F, -1, -2) + Q


def _update(x, P, z, H, R):
    Ht = np.swapaxes(H, -1, -2)
    innovation = z - (H @ x[..., None])[..., 0]
    S = H @ P @ Ht + R
    K = np.swapaxes(np.linalg.solve(S, H @ P), -1, -2)
    A = np.eye(x.shape[-1]) - K @ H
    x = x + (K @ innovation[..., None])[..., 0]
    P = A @ P @ np.swapaxes(A, -1, -2) + K @ R @ np.swapaxes(K, -1, -2)
    return x, P, innovation, S


def kf(z, F, Q, H, R, x0, P0):
    """Filter whole records with a linear Kalman filter, many runs at once.

    Every cycle predicts, then updates, like `ekf`.

    Parameters
    ----------
    z : array_like, shape (..., K, m)
        Measurements.
    F, Q : array_like, shape (n, n)
        Transition matrix; covariance of the process noise.
    H : array_like, shape (m, n)
        Measurement matrix.
    R : array_like, shape (m, m)
        Covariance of the measurement noise.
    x0 : array_like, shape (..., n)
        State one step before the first measurement; leading axes broadcast against those of `z`.
    P0 : array_like, shape (..., n, n)
        Its covariance.

    Returns
    -------
    Track
        Leading axes are those of `z`.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, `R` or `P0` is not positive definite, or `Q`
        is not a covariance (it may be singular).

    Notes
    -----
    Mittermaier et al. (2016), Table 1, with a linear measurement; Kalman (1960).

    Examples
    --------
    The mean of three equally good measurements of a constant, with hardly any prior:

    >>> track = kf([[1.0], [2.0], [3.0]], [[1]], [[0]], [[1]], [[1]], [0], [[1e12]])
    >>> round(float(track.x[-1, 0]), 6), round(float(track.P[-1, 0, 0]), 6)
    (2.0, 0.333333)
    """
    x0 = _checks.finite("x0", x0, (None,))
    n = x0.shape[-1]
    H = _checks.matrix("H", H, (None, n))
    m = H.shape[0]
    F = _checks.matrix("F", F, (n, n))
    Q = _checks.matrix("Q", _checks.covariance("Q", Q, n, definite=False), (n, n))
    R = _checks.matrix("R", _checks.covariance("R", R, m), (m, m))
    P0 = _checks.covariance("P0", P0, n)
    z = _checks.finite("z", z, (None, m))
    if not z.size:
        raise ValueError(f"z must hold at least one run and one sample, got shape {z.shape}")

    batch, samples = z.shape[:-2], z.shape[-2]
    # Covariances do not depend on the measurements: runs that begin with one P0 share them all.
    shared = P0.ndim == 2
    x = _checks.each_run("x0", x0, batch, (n,))
    P = P0 if shared else _checks.each_run("P0", P0, batch, (n, n))
    steps = []
    for k in range(samples):
        x, P = _predict(x, P, F, Q)
        x, P, innovation, S = _update(x, P, z[..., k, :], H, R)
        steps.append((x, P, innovation, S))
    x, P, innovation, S = zip(*steps, strict=True)
    x, innovation = (np.stack(values, axis=len(batch)) for values in (x, innovation))
    P, S = (
        np.broadcast_to(
            np.stack(values, axis=0 if shared else len(batch)), (*batch, samples, size, size)
        )
        for values, size in ((P, n), (S, m))
    )
    weighted = np.linalg.solve(S, innovation[..., None])[..., 0]
    nis = np.sum(innovation * weighted, axis=-1)
    return Track(x, P, innovation, S, nis, np.ones(nis.shape, bool))
