"""Bounds of filters with a prior: along each path, and the posterior Cramér-Rao bound."""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Literal

import numpy as np

from .. import _checks
from .._hints import Count, checked
from .._typing import ArrayLike, FloatArray
from ..estimation.recursion import scan
from ..model.doppler import doppler_jacobian
from ..model.motion import dwna_gain
from ..model.radar_array import RadarArray

_PATHS = 64  # that a thread takes at a time


@checked
@_checks.quiet
def path_crlb(
    x: ArrayLike,
    array: RadarArray,
    sigma_f: ArrayLike,
    P0: ArrayLike,
    T: ArrayLike = 0.001,
    sigma_a: float = 0.0,
    noise: Literal["shared", "per_axis"] = "per_axis",
    *,
    every: Count = 1,
    workers: Count | None = None,
) -> FloatArray:
    """Return the Cramér-Rao bound with a prior along true paths, after each sample.

    Parameters
    ----------
    x : array_like, shape (..., K, 6)
        True states [x, y, z, v_x, v_y, v_z] at the samples, in m and m/s; NaN from the end of a
        path on.
    array : RadarArray
        The N sensors.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz; NaN where one is missing.
    P0 : array_like, shape (6, 6)
        Covariance of the prior, one interval before the first sample, positive definite.
    T : array_like, scalar or shape (K,)
        Sampling interval in s, or the interval before each sample.
    sigma_a : float
        Standard deviation of the acceleration in m/s^2, see `constant_velocity`; zero if the
        velocity is constant, and known to be.
    noise : {"shared", "per_axis"}
        Process noise, see `constant_velocity`.
    every : int
        Bounds are returned at the samples every - 1, 2 every - 1, ...
    workers : int, optional
        Threads among which the paths are shared; one for each processor if None. The result does
        not depend on it.

    Returns
    -------
    ndarray, shape (..., K // every, 6, 6)
        Covariances; NaN where the path has ended. Their mean over many paths is the expected
        Cramér-Rao bound (ECRB).

    Raises
    ------
    ValueError
        If an argument has the wrong shape or value, or a path leads through a sensor.

    Notes
    -----
    The recursion of the information, J = (F inv(J) F' + Q)^-1 + H' R^-1 H with the Jacobian H at
    the *true* state (Taylor 1979), from J = inv(P0), in factors. It is the covariance of an EKF
    that linearizes at the truth, and not a bound of the mean squared error in a strict sense:
    averaged over truths it is what an efficient estimator reaches whose posterior is nearly
    Gaussian. `pcrlb` is strict, and lower.

    Examples
    --------
    A fifth of a second before a ring, of a target near and one far; deviations of x in mm:

    >>> x = np.zeros((2, 200, 6))
    >>> x[..., 0] = [[0.5], [1.2]] - 0.0007 * np.arange(1, 201)
    >>> x[..., 3] = -0.7
    >>> prior = np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
    >>> P = path_crlb(x, RadarArray.ring(6, 0.2), 0.4, prior, every=200)
    >>> (1e3 * P[:, 0, 0, 0] ** 0.5).round(1).tolist()
    [1.0, 35.8]
    """
    x, weights, P0, T = _arguments(x, array, sigma_f, P0, T)
    columns = _columns(T, sigma_a, noise)
    batch, K = x.shape[:-2], x.shape[-2]
    x = np.ascontiguousarray(x).reshape(-1, K, 6)
    variance, factors = 1 / weights, _factors(P0)
    for value in (x, variance, T, columns, factors):
        value.flags.writeable = False  # part of the type for which numba compiles
    out = np.full((len(x), K // every, 6, 6), np.nan)

    # Here, and not above, so that importing the library does not load numba.
    from ._path_bound_loop import bound_paths

    def part(first):
        rows = slice(first, first + _PATHS)
        bound_paths(
            x[rows], array.positions, array.doppler_per_speed, variance, T, columns, factors,
            every, out[rows],
        )  # fmt: skip

    with ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
        list(pool.map(part, range(0, len(x), _PATHS)))
    there = ~np.isnan(x[:, every - 1 :: every, 0][:, : K // every])
    _checks.estimates("x, sigma_f, P0", out[there], what="bounds")
    return out.reshape(*batch, K // every, 6, 6)


@checked
@_checks.quiet
def pcrlb(
    x: ArrayLike,
    array: RadarArray,
    sigma_f: ArrayLike,
    P0: ArrayLike,
    T: ArrayLike = 0.001,
    sigma_a: float = 0.0,
    noise: Literal["shared", "per_axis"] = "per_axis",
    *,
    every: Count = 1,
) -> FloatArray:
    """Return the posterior Cramér-Rao bound, by the mean over paths drawn from the model.

    Parameters
    ----------
    x : array_like, shape (..., K, 6)
        Paths drawn from prior and motion, over which the information is averaged; NaN from the end
        of a path on.
    array, sigma_f, P0, T, sigma_a, noise, every
        See `path_crlb`. The prior is Gaussian.

    Returns
    -------
    ndarray, shape (K // every, 6, 6)
        Covariances; NaN where all paths have ended.

    Notes
    -----
    Tichavský, Muravchik and Nehorai (1998): the recursion of `path_crlb`, with the mean over paths
    of H' R^-1 H. No estimator whatever has a smaller mean squared error over the paths.
    But what one path leaves unseen another shows, and the mean of their information leaves nothing
    unseen: the inverse of a mean is less than the mean of inverses (Jensen), and the bound may lie
    out of reach.

    Examples
    --------
    For the two targets of `path_crlb` together the bound is less than for either of them:

    >>> x = np.zeros((2, 200, 6))
    >>> x[..., 0] = [[0.5], [1.2]] - 0.0007 * np.arange(1, 201)
    >>> x[..., 3] = -0.7
    >>> prior = np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
    >>> P = pcrlb(x, RadarArray.ring(6, 0.2), 0.4, prior, every=200)
    >>> float((1e3 * P[0, 0, 0] ** 0.5).round(1))
    0.5
    """
    x, weights, P0, T = _arguments(x, array, sigma_f, P0, T)
    columns = _columns(T, sigma_a, noise)
    F, Q = np.eye(6) + T[:, None, None] * np.eye(6, k=3), columns.mT @ columns
    K = x.shape[-2]
    x = x.reshape(-1, K, 6)

    def step(k, P):
        states = x[~np.isnan(x[:, k, 0]), k]
        if not len(states):
            return P, (np.full((6, 6), np.nan),)
        H = doppler_jacobian(states, array)
        J = np.einsum("rni,n,rnj->ij", H, weights[k], H, optimize=True) / len(states)
        M = F[k] @ P @ F[k].T + Q[k]
        P = np.linalg.solve(np.eye(6) + M @ J, M)  # the inverse of inv(M) + J
        P = _checks.estimates("x, sigma_f, P0", (P + P.T) / 2, what="bounds")
        return P, (P,)

    (bound,) = scan(step, P0, range(K))
    return bound[every - 1 :: every][: K // every]


def _columns(T, sigma_a, noise):
    """Return the columns of the process noise of each interval as rows, none if there is none."""
    if _checks.one_number("sigma_a", sigma_a) == 0:
        return np.empty((len(T), 0, 6))
    G, sigma_a = dwna_gain(T, sigma_a, noise)
    return np.ascontiguousarray(sigma_a * G.mT)


def _factors(P):
    """Return U and D of P = U D U' as the kernels keep them, D in place of the diagonal of U."""
    root = np.linalg.cholesky(P[::-1, ::-1])[::-1, ::-1]
    U = root / np.diag(root)
    np.fill_diagonal(U, np.diag(root) ** 2)
    return U[np.triu_indices(6)]


def _arguments(x, array, sigma_f, P0, T):
    """Return paths, weights 1 / sigma_f^2 (K, N), P0 and intervals, checked."""
    x = _checks.real("x", x)
    _checks.check_shape("x", x, (None, 6))
    if not x.size:
        raise ValueError(f"x must hold at least one path and one sample, got shape {x.shape}")
    ended = np.isnan(x).any(axis=-1)
    if (np.isnan(x).all(axis=-1) != ended).any() or (ended[..., :-1] > ended[..., 1:]).any():
        raise ValueError("x must be NaN from the end of a path on, got a gap or half a state")
    _checks.moderate("x", x[~ended])
    K = x.shape[-2]
    sigma_f = _checks.measured("sigma_f", sigma_f, ())
    missing = np.isnan(sigma_f)
    weight = np.where(missing, 0.0, 1 / _checks.deviation("sigma_f", np.where(missing, 1, sigma_f)))
    weight = _checks.each_run("sigma_f", weight, (K, len(array)), ())
    P0 = _checks.covariance("P0", _checks.moderate("P0", P0), 6)
    P0 = _checks.exact_shape("P0", P0, (6, 6))
    T = _checks.each_run("T", _checks.deviation("T", T), (K,), ())
    return x, np.ascontiguousarray(weight**2), P0, np.array(T)
