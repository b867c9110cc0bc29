"""The Rauch-Tung-Striebel smoother: what the later measurements add to the earlier states."""

import numpy as np

from .. import _checks


def rts_smooth(x, P, F, Q):
    """Return the states given the whole record, from those that a Kalman filter returned.

    Parameters
    ----------
    x : array_like, shape (..., K, n)
        Filtered states, after the updates.
    P : array_like, shape (..., K, n, n)
        Their covariances; leading axes broadcast against those of `x`.
    F, Q : array_like, shape (n, n)
        Transition matrix and process noise between two samples.

    Returns
    -------
    x : ndarray, shape (..., K, n)
    P : ndarray, shape (..., K, n, n)
        Leading axes as they came in.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, a matrix is not a covariance, or `F` and `Q`
        predict a covariance that has no inverse.

    Notes
    -----
    Rauch, Tung, Striebel (1965). It runs backwards and needs no measurements, and it waits for the
    end of the record: nothing for a brake, everything for a reference path.

    Examples
    --------
    A constant, measured as 0 and as 2: the filter learns of the 2 late, the smoother does not.

    >>> from dopplerlib import kf
    >>> track = kf([[0.0], [2.0]], [[1]], [[0]], [[1]], [[1]], [0], [[1e12]])
    >>> x, P = rts_smooth(track.x, track.P, [[1]], [[0]])
    >>> x.round(6).tolist(), P.round(6).tolist()
    ([[1.0], [1.0]], [[[0.5]], [[0.5]]])
    """
    x = _checks.finite("x", x, (None, None))
    K, n = x.shape[-2:]
    P = _checks.covariance("P", P, n)
    _checks.check_shape("P", P, (K, n, n))
    _checks.check_broadcast("x", x.shape[:-2], "P", P.shape[:-3])
    F = _checks.matrix("F", F, (n, n))
    Q = _checks.matrix("Q", _checks.covariance("Q", Q, n, definite=False), (n, n))
    x, P = x.copy(), P.copy()
    for k in range(K - 2, -1, -1):
        predicted = F @ P[..., k, :, :] @ F.T + Q
        try:
            gain = np.swapaxes(np.linalg.solve(predicted, F @ P[..., k, :, :]), -1, -2)
        except np.linalg.LinAlgError:
            raise ValueError(
                f"F and Q must give F P F' + Q an inverse, got a singular matrix at sample {k}"
            ) from None
        ahead = x[..., k + 1, :] - x[..., k, :] @ F.T
        x[..., k, :] += (gain @ ahead[..., None])[..., 0]
        surprise = P[..., k + 1, :, :] - predicted
        smoothed = P[..., k, :, :] + gain @ surprise @ np.swapaxes(gain, -1, -2)
        P[..., k, :, :] = (smoothed + np.swapaxes(smoothed, -1, -2)) / 2
    return x, P
