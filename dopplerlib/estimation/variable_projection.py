"""The velocity given the position is a linear problem: projected out, or integrated out."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from ..model.doppler import doppler_jacobian
from ..model.radar_array import RadarArray
from . import densities


@checked
@_checks.quiet
def velocity_given_position(
    z: ArrayLike, array: RadarArray, sigma_f: ArrayLike, p: ArrayLike, in_plane: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return the weighted least-squares velocity from Doppler shifts at a known position.

    Parameters
    ----------
    z : array_like, shape (N,)
        Doppler shifts in Hz, one sample or the mean of several.
    array : RadarArray
        The N sensors.
    sigma_f : array_like, broadcast to (N,)
        Standard deviation of the shifts in Hz.
    p : array_like, shape (..., 3)
        Positions in m.
    in_plane : bool
        Whether v_z is known to be zero.

    Returns
    -------
    v : ndarray, shape (..., 3)
        Velocities in m/s; the shortest one where several are equally good.
    cost : ndarray, shape (...)
        Remaining misfit: the sum of the squared residuals over their variances.

    Notes
    -----
    The Doppler shift is linear in the velocity, h = A(p) v, where the rows of A are the unit
    vectors towards the sensors times 2 / wavelength. So v is a linear least-squares estimate, and
    the cost a function of position only: variable projection, Golub and Pereyra (1973).

    Examples
    --------
    >>> from dopplerlib import doppler_shift
    >>> array = RadarArray.ring(6, 0.2)
    >>> z = doppler_shift([0.8, 0.1, 0.1, -0.7, 0, 0.2], array)
    >>> v, cost = velocity_given_position(z, array, 0.4, [0.8, 0.1, 0.1])
    >>> (v.round(6) + 0.0).tolist(), bool(cost < 1e-9)
    ([-0.7, 0.0, 0.2], True)
    """
    z = _checks.finite("z", z, (len(array),))
    if z.ndim != 1:
        raise ValueError(f"z must be one sample, got an array of shape {z.shape}")
    sigma_f = _checks.each_run("sigma_f", _checks.deviation("sigma_f", sigma_f), (len(array),), ())
    p = _checks.moderate("p", p, (3,))
    A = doppler_jacobian(np.concatenate([p, 0 * p], axis=-1), array)[..., 3:] / sigma_f[:, None]
    A[..., 2] *= not _checks.one_boolean("in_plane", in_plane)
    y = z / sigma_f
    # A direction that no sensor sees leaves a singular value of 1e-16.
    v = np.linalg.pinv(A, rcond=1e-12) @ y
    cost = np.sum((y - np.einsum("...ni,...i->...n", A, v)) ** 2, axis=-1)
    return _checks.estimates("z, sigma_f, p", v, cost)


@checked
@_checks.quiet
def log_position_density(
    z: ArrayLike, array: RadarArray, sigma_f: ArrayLike, p: ArrayLike, x0: ArrayLike, P0: ArrayLike
) -> FloatArray:
    """Return the log posterior density of positions, the velocity integrated out.

    It is exact: on a grid fine enough, it is what a filter of a snapshot is to be compared with.

    Parameters
    ----------
    z : array_like, shape (K, N)
        Doppler shifts of one state in Hz; NaN says that this sensor is missing at this sample.
    array : RadarArray
        The N sensors.
    sigma_f : array_like, broadcast to (N,)
        Standard deviation of a shift in Hz.
    p : array_like, shape (..., 3)
        Positions in m.
    x0 : array_like, shape (6,)
        Mean of the prior of the state in m and m/s.
    P0 : array_like, shape (6, 6)
        Covariance of the prior.

    Returns
    -------
    ndarray, shape (...)
        Up to a constant that does not depend on the position.

    Notes
    -----
    With h = A(p) v, see `velocity_given_position`, and v of mean m and covariance V given p, the
    means of the shifts are Gaussian, with mean A m and covariance A V A' + R / K.

    Examples
    --------
    Ten samples of a target at 0.6 m: a ring does not see how far away it is, and if the prior is
    broad, twice as far is twice as likely.

    >>> from dopplerlib import doppler_shift
    >>> array, prior = RadarArray.ring(6, 0.2), ([0.8, 0, 0, -0.7, 0, 0], 0.1 * np.eye(6))
    >>> z = np.tile(doppler_shift([0.6, 0, 0, -0.7, 0, 0], array), (10, 1))
    >>> near, far = log_position_density(z, array, 0.4, [[0.6, 0, 0], [1.2, 0, 0]], *prior)
    >>> round(float(np.exp(far - near)), 1)
    1.9
    """
    z = _checks.measured("z", z, (None, len(array)))
    z = _checks.exact_shape("z", z, z.shape[-2:])
    sigma_f = _checks.each_run("sigma_f", _checks.deviation("sigma_f", sigma_f), (len(array),), ())
    p = _checks.moderate("p", p, (3,))
    x0 = _checks.exact_shape("x0", _checks.moderate("x0", x0, (6,)), (6,))
    P0 = _checks.exact_shape("P0", _checks.covariance("P0", P0, 6), (6, 6))
    slope = np.linalg.solve(P0[:3, :3], P0[:3, 3:]).T
    A = doppler_jacobian(np.concatenate([p, 0 * p], axis=-1), array)[..., 3:]
    off = p - x0[:3]
    mean = (A @ (x0[3:] + off @ slope.T)[..., None])[..., 0]
    V = P0[3:, 3:] - slope @ P0[:3, 3:]
    there = ~np.isnan(z)
    count = there.sum(axis=0)
    total = np.where(there, z, 0.0).sum(axis=0)
    measured = np.where(count > 0, total / count, np.nan)
    S = A @ V @ A.mT + np.diag(sigma_f**2 / np.maximum(count, 1))
    log_density = densities.log_density(measured - mean, S)
    return _checks.estimates(
        "z, sigma_f, p, x0, P0", log_density + densities.log_density(off, P0[:3, :3])
    )
