"""Fisher information of Doppler measurements about a state, and its inverse."""

from typing import Literal

import numpy as np

from .. import _checks
from .._hints import Count, checked
from .._typing import ArrayLike, BoolArray, FloatArray
from .doppler import doppler_jacobian
from .links import DopplerLinks, sample_times, state_size
from .radar_array import RadarArray

# Smallest eigenvalue, of an information matrix scaled to a diagonal of ones, that is not rounding.
# Rounding leaves some 1e-15 of an exact zero; the weakest direction that a ring of 0.2 m sees
# from two samples in 0.1 ms has about 1e-12.
SINGULAR = 1e-13


@checked
def fisher_information(
    x: ArrayLike,
    array: RadarArray | DopplerLinks,
    sigma_f: ArrayLike,
    K: Count | None = None,
    T: ArrayLike = 0.001,
    likelihood: Literal["stationary", "constant_velocity"] = "stationary",
) -> FloatArray:
    """Return the Fisher information of K Doppler samples about the state at the first one.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] at the first sample, in m and m/s, not on a sensor. For
        links shape (..., n), with the offsets of their clocks.
    array : RadarArray or DopplerLinks
        The N sensors or links.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz; NaN where one is missing.
    K : int, optional
        Number of samples: if None that of the links' times, or one.
    T : array_like, scalar or shape (K,)
        Sampling interval in s, or the interval before each sample, see `DopplerLinks.sampled`.
        Without effect on links that have times, and if everything is constant.
    likelihood : {"stationary", "constant_velocity"}
        "stationary": the target is the same at all samples, as in Eq 10. "constant_velocity":
        it moves at constant velocity, so sample k sees the state F^k x. Sensors and clocks go on
        in both.

    Returns
    -------
    ndarray, shape (..., 6, 6)
        The information in units of 1/m^2, s/m^2 and s^2/m^2. It is singular if no measurement
        changes, to first order, along some direction. For links shape (..., n, n).

    Notes
    -----
    J = sum over k of F'^k H_k' R^-1 H_k F^k with the Jacobian H_k of Eq 7 at sample k; see
    Bar-Shalom, Li and Kirubarajan (2001), Section 2.7. A clock of "epoch" is another unknown at
    each sample. All but those of the first are eliminated: what is left of H_k is orthogonal to
    the columns of the clock.

    Examples
    --------
    Six sensors on a ring cannot tell all six components apart:

    >>> J = fisher_information([0.8, 0.1, 0.1, -0.7, 0, 0], RadarArray.ring(6, 0.2), 0.4)
    >>> int(np.linalg.matrix_rank(J, hermitian=True, rtol=1e-13))
    5
    """
    n = state_size(array)
    x = _checks.moderate("x", x, (n,))
    times = sample_times(array, K, T)
    sigma_f = _checks.measured("sigma_f", sigma_f, ())
    missing = np.isnan(sigma_f)
    weight = np.where(missing, 0.0, 1 / _checks.deviation("sigma_f", np.where(missing, 1, sigma_f)))
    weight = _checks.each_run("sigma_f", weight, (len(times), len(array)), ())
    with np.errstate(all="ignore"):
        if isinstance(array, RadarArray) and likelihood == "stationary":
            H = doppler_jacobian(x, array) * np.sqrt(np.sum(weight**2, axis=0))[:, None]
            information = H.swapaxes(-1, -2) @ H
        else:
            F = np.tile(np.eye(n), (len(times), 1, 1))
            clocks = np.zeros((len(array), 0))
            if isinstance(array, DopplerLinks):
                array = array.sampled(len(times), T)
                F[1:] = array.transition(times[1:] - times[0])
                if array.clock_model == "epoch":
                    clocks = array.clocks
            moving = likelihood == "constant_velocity"
            F[:, :3, 3:6] = moving * (times - times[0])[:, None, None] * np.eye(3)
            information = np.zeros((*x.shape, n))
            for k, H in enumerate(_jacobians(x, F, array)):
                H = H * weight[k, :, None]
                if k and clocks.size:
                    C = clocks * weight[k, :, None]
                    H = H - C @ (np.linalg.pinv(C) @ H)
                H = H @ F[k]
                information += H.swapaxes(-1, -2) @ H
    return _checks.estimates("x, array, sigma_f, T", information, what="information")


def _jacobians(x, F, array):
    """Yield the Jacobian (..., N, n) at each sample, of which `F` is the transition."""
    if isinstance(array, RadarArray):  # the same for all: one sample after the other fits memory
        yield from (doppler_jacobian(x @ F_k.T, array) for F_k in F)
    else:
        path = np.einsum("kij,...j->...ki", F, x)
        yield from np.moveaxis(doppler_jacobian(path, array), -3, 0)


def free_components(free: ArrayLike | None, n: int) -> BoolArray:
    """Return which of `n` components, a number that is unchecked, are unknown: all if None."""
    if free is None:
        return np.ones(n, bool)
    free = _checks.booleans("free", free)
    if free.shape != (n,):
        raise ValueError(f"free must be {n} booleans, got an array of shape {free.shape}")
    return free


@checked
def inverse_information(
    information: ArrayLike, free: ArrayLike | None = None
) -> tuple[FloatArray, BoolArray]:
    """Return the inverse of an information matrix, infinite along unobservable components.

    Parameters
    ----------
    information : array_like, shape (..., n, n)
        Symmetric positive semidefinite matrices.
    free : array_like of bool, shape (n,), optional
        Components that are unknown; the others are known and have variance zero. All if None.

    Returns
    -------
    covariance : ndarray, shape (..., n, n)
        The inverse. If it does not exist, the variance of every component that takes part in an
        unobservable direction is infinite and its covariances are NaN; the other components keep
        the finite values that they have whatever the unobservable directions do.
    regular : ndarray of bool, shape (...)
        Whether the inverse exists, and floating-point numbers can hold it.

    Examples
    --------
    >>> covariance, regular = inverse_information(np.diag([4.0, 0.0]))
    >>> np.diagonal(covariance).tolist(), bool(regular)
    ([0.25, inf], False)
    """
    information = _checks.finite("information", information, (None, None))
    n = information.shape[-1]
    _checks.check_shape("information", information, (n, n))
    free = free_components(free, n)
    covariance = np.zeros(information.shape)
    if not free.any():
        return covariance, np.ones(information.shape[:-2], bool)
    block = np.ix_(free, free)
    J = information[..., *block]
    diagonal = np.diagonal(J, axis1=-2, axis2=-1)
    if (diagonal < 0).any():
        raise ValueError(
            f"information must have no negative entry on its diagonal, got {diagonal.min()}"
        )
    scale = np.sqrt(diagonal)
    scale = np.where(scale > 0, scale, 1.0)
    scale = scale[..., :, None] * scale[..., None, :]
    eigenvalue, V = np.linalg.eigh(J / scale)
    null = eigenvalue < SINGULAR
    inverse = np.where(null, 0.0, 1 / np.where(null, 1.0, eigenvalue))
    with np.errstate(all="ignore"):
        P = (V * inverse[..., None, :]) @ V.swapaxes(-1, -2) / scale
    # An eigenvector is exact to rounding over the gap to the next eigenvalue; 1e-6 is above that.
    lost = (np.abs(V) * null[..., None, :]).max(axis=-1) > 1e-6
    lost |= ~np.isfinite(P).all(axis=-1)  # a variance beyond the range of floats
    P = np.where(lost[..., :, None] | lost[..., None, :], np.nan, P)
    P = np.where(lost[..., :, None] & np.eye(lost.shape[-1], dtype=bool), np.inf, P)
    covariance[..., *block] = P
    return covariance, np.asarray(~lost.any(axis=-1))
