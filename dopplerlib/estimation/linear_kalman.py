"""The linear Kalman filter."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from . import gaussian, models, recursion
from .track import Track


@checked
@_checks.quiet
def kf_predict(
    x: ArrayLike, P: ArrayLike, F: ArrayLike, Q: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Time update of the linear Kalman filter: F x and F P F' + Q.

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
    _checks.check_leading(x=(x, 1), P=(P, 2), F=(F, 2), Q=(Q, 2))
    x, P = gaussian.predict(x, P, F, Q)
    return _checks.estimates("x, P, F, Q", x, P)


@checked
@_checks.quiet
def kf_update(
    x: ArrayLike, P: ArrayLike, z: ArrayLike, H: ArrayLike, R: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Measurement update of the linear Kalman filter (Joseph form).

    Parameters
    ----------
    x : array_like, shape (..., n)
        Predicted states.
    P : array_like, shape (..., n, n)
        Predicted covariances.
    z : array_like, shape (..., m)
        Measurements; NaN says that a component is missing. The others update alone.
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
        NaN where `z` is.
    S : ndarray, shape (..., m, m)
        Of all components, also of those that are missing.

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
    z = _checks.measured("z", z, (None,))
    m = z.shape[-1]
    H = _checks.finite("H", H, (m, n))
    R = _checks.covariance("R", R, m)
    _checks.check_leading(x=(x, 1), P=(P, 2), z=(z, 1), H=(H, 2), R=(R, 2))
    innovation = gaussian.innovation(x, z, H)
    x, P, S = gaussian.update(x, P, innovation, H, R)
    _checks.estimates("x, P, z, H, R", x, P, S, np.where(np.isnan(z), 0.0, innovation))
    return x, P, innovation, S


@checked
@_checks.quiet
def kf(
    z: ArrayLike,
    F: ArrayLike,
    Q: ArrayLike,
    H: ArrayLike,
    R: ArrayLike,
    x0: ArrayLike,
    P0: ArrayLike,
) -> Track:
    """Linear Kalman filter over whole records, many runs at once.

    Every cycle predicts, then updates, like `ekf`.

    Parameters
    ----------
    z : array_like, shape (..., K, m)
        Measurements; NaN says that a component is missing at this sample.
    F, Q : array_like, shape (n, n) or (K, n, n)
        Transition matrix; covariance of the process noise. At uneven times one for each sample,
        that of the step which leads to it.
    H : array_like, shape (m, n) or (K, m, n)
        Measurement matrix, or one for each sample.
    R : array_like, shape (m, m) or (K, m, m)
        Covariance of the measurement noise, or one for each sample.
    x0 : array_like, shape (..., n)
        State one step before the first measurement; leading axes broadcast against those of `z`.
    P0 : array_like, shape (..., n, n)
        Its covariance; it may be singular: a component can be known exactly.

    Returns
    -------
    Track
        Leading axes are those of `z`. Missing values are treated as by `ekf`: the components that
        are there update alone, and NIS is theirs.

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
    H = _checks.finite("H", H, (None, n))
    m = H.shape[-2]
    R = _checks.covariance("R", R, m)
    P0 = _checks.covariance("P0", P0, n, definite=False)
    z = _checks.measured("z", z, (None, m))
    if not z.size:
        raise ValueError(f"z must hold at least one run and one sample, got shape {z.shape}")
    batch, samples = z.shape[:-2], z.shape[-2]
    F = _checks.each_sample("F", _checks.finite("F", F, (n, n)), samples, (n, n))
    Q = _checks.covariance("Q", Q, n, definite=False)
    Q = _checks.each_sample("Q", Q, samples, (n, n))
    H = _checks.each_sample("H", H, samples, (m, n))
    R = _checks.each_sample("R", R, samples, (m, m))

    # Covariances do not depend on the measurements, only on which are there: runs that begin with
    # one P0 and miss the same share them all.
    there = ~np.isnan(z)
    first = there.reshape(-1, samples, m)[0]
    shared = P0.ndim == 2 and bool((there == first).all())
    x = _checks.each_run("x0", x0, batch, (n,))
    alone = (1,) * len(batch)
    P = P0.reshape(*alone, n, n) if shared else _checks.each_run("P0", P0, batch, (n, n))
    seen = first.reshape(*alone, samples, m) if shared else there

    motion = models.linear_motion(F, Q)
    measurement = models.linear_measurement(z, H, R, seen)
    track = recursion.filter_records(x, P, motion, measurement, range(samples), len(batch))
    return recursion.finite("F, Q, H, R, x0, P0, z", track)
