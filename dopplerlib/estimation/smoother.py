"""The Rauch-Tung-Striebel smoother."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from . import gaussian, recursion


@checked
@_checks.quiet
def rts_smooth(
    x: ArrayLike, P: ArrayLike, F: ArrayLike, Q: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Smooth the estimates of a Kalman filter over the whole record.

    Parameters
    ----------
    x : array_like, shape (..., K, n)
        Filtered states, after the updates or, in a gap, the predictions.
    P : array_like, shape (..., K, n, n)
        Their covariances, which may be singular; leading axes broadcast against those of `x`.
    F, Q : array_like, shape (n, n) or (K, n, n)
        Transition matrix and process noise between two samples. At uneven times as in `kf`: those
        of the step which leads to each sample, of which the first is not used.

    Returns
    -------
    x : ndarray, shape (..., K, n)
    P : ndarray, shape (..., K, n, n)
        Leading axes as they came in.

    Notes
    -----
    Rauch, Tung, Striebel (1965). It runs backwards and needs no measurements, and it waits for the
    end of the record: nothing for a brake, everything for a reference path. Where a prediction is
    singular, such as in a plane, the later samples teach nothing about what was certain before.

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
    P = _checks.covariance("P", P, n, definite=False)
    _checks.check_shape("P", P, (K, n, n))
    _checks.check_broadcast("x", x.shape[:-2], "P", P.shape[:-3])
    F = _checks.each_sample("F", _checks.finite("F", F, (n, n)), K, (n, n))
    Q = _checks.covariance("Q", Q, n, definite=False)
    Q = _checks.each_sample("Q", Q, K, (n, n))
    batch = np.broadcast_shapes(x.shape[:-2], P.shape[:-3])
    x, shape = np.broadcast_to(x, (*batch, K, n)), P.shape
    P = P.reshape((1,) * (len(batch) + 3 - P.ndim) + shape)  # runs may share it

    def step(k, later):
        earlier = gaussian.smooth(
            x[..., k, :], P[..., k, :, :], F[k + 1], Q[k + 1], later[0], later[1]
        )
        return earlier, earlier

    last = x[..., -1, :], P[..., -1, :, :]
    x, P = recursion.scan(step, last, range(K - 2, -1, -1), len(batch), first=last)
    _checks.estimates("x, P, F, Q", x, P)
    return np.flip(x, -2), np.flip(P, -3).reshape(shape)
