"""A Gaussian sum filter for Doppler shifts at a plane array, from a broad prior."""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Count, Positive, Probability, checked, up_to
from .._records import record
from .._typing import ArrayLike
from ..kernels import ring_coordinates as kernel
from ..model.motion import constant_velocity, dwna_gain
from ..model.radar_array import RadarArray
from .extended_kalman import _measurements, _variance

# Windows of the start: distance in units of 1 / radius (of eta) and in logarithms (of rho), and
# deviation of each window as a share of that distance, so that their sum is even to a percent.
_ACROSS, _ALONG, _WIDTH = 0.05, 0.17, 0.71
_DRAWN = 2**14  # points of the prior that say where windows are needed
_COVERED = 0.999  # share of them that lie in windows
_LEAST = 0.15  # of the radius: nearer to the plane of the sensors a member is given up
_FLAT = 1e-9  # of the radius: so far a sensor may be off the plane


@record
class GaussianSumTrack:
    """Estimates of a Gaussian sum filter; leading axes are those of the measurements.

    Attributes
    ----------
    x : ndarray, shape (..., O, 6)
        Mean of the state in m and m/s; NaN if all members have been lost.
    P : ndarray, shape (..., O, 6, 6)
        Covariance of the state.
    members : ndarray of int, shape (..., O)
        Gaussians that the sum has left, 0 if all have been lost.
    weights : ndarray, shape (..., O, M)
        Weights of the M heaviest Gaussians, the heaviest first; 0 where there are fewer. They add
        up to one if none is left out.
    means : ndarray, shape (..., O, M, 6)
        Mean of the state in m and m/s under each of them, NaN where there are fewer.
    covariances : ndarray, shape (..., O, M, 6, 6)
        Covariance of the state under each of them, NaN where there are fewer.
    """

    x: np.ndarray
    P: np.ndarray
    members: np.ndarray
    weights: np.ndarray
    means: np.ndarray
    covariances: np.ndarray


@checked
@_checks.quiet
def gaussian_sum(
    z: ArrayLike,
    array: RadarArray,
    x0: ArrayLike,
    P0: ArrayLike,
    T: Positive,
    sigma_a: float,
    sigma_f: ArrayLike,
    noise: Literal["shared", "per_axis"] = "per_axis",
    *,
    every: Count = 1,
    mixture: Annotated[int, up_to(1000, least=0)] = 0,
    block: Count = 5,
    lightest: Probability = 1e-5,
    loss: Positive = 1e-3,
    workers: Count | None = None,
) -> GaussianSumTrack:
    """Filter records of Doppler shifts with a sum of Gaussians in ring coordinates.

    The filter needs no initial estimate, only a prior, which may be as broad as the workspace. It
    keeps the second state that a plane array confuses with the right one as long as it is likely.

    Parameters
    ----------
    z : array_like, shape (..., K, N)
        Doppler measurements in Hz; NaN says that this sensor is missing at this sample.
    array : RadarArray
        N sensors in a plane, not all on a line.
    x0 : array_like, shape (6,)
        Mean of the prior, one interval before the first sample, in m and m/s; not in the plane of
        the sensors. The target is on the same side.
    P0 : array_like, shape (6, 6)
        Covariance of the prior, positive definite.
    T : float
        Sampling interval in s.
    sigma_a : float
        Standard deviation of the acceleration in m/s^2, see `constant_velocity`.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz.
    noise : {"shared", "per_axis"}
        Process noise, see `constant_velocity`.
    every : int
        Estimates are returned at the samples every - 1, 2 every - 1, ...
    mixture : int
        Number M of the heaviest Gaussians whose weights, means and covariances are returned, too.
    block : int
        Samples that are averaged while there are more than two Gaussians. In a block the target
        should turn little about any sensor.
    lightest : float
        Weight below which a Gaussian is dropped.
    loss : float
        Kullback-Leibler cost, at most, of uniting two Gaussians.
    workers : int, optional
        Threads among which the runs are shared; one for each processor if None. The result does
        not depend on it.

    Returns
    -------
    GaussianSumTrack
        O = K // every.

    Raises
    ------
    ValueError
        If an argument has the wrong shape or value, or the sensors do not span a plane.

    Notes
    -----
    Alspach and Sorenson (1972); the coordinates are those of `to_ring_coordinates`, with the root
    of the sensors' mean squared distance from their center as the radius, in which no linearization
    invents knowledge of range. At the start, the prior and the first block are split by a grid of
    Gaussian windows over direction and range; in each the mode is found by Gauss and Newton, and
    Laplace's approximation gives weight and covariance. Every second block, the lightest
    Gaussians are united with their neighbors while the cost after Runnalls (2007) allows.

    Examples
    --------
    A second in front of the paper's ring, from a prior over the workspace:

    >>> from dopplerlib import doppler_shift
    >>> array = RadarArray.ring(6, 0.2)
    >>> path = np.tile([0.83, 0.11, 0.09, -0.75, -0.13, -0.02], (1000, 1))
    >>> path[:, :3] += 1e-3 * np.arange(1000)[:, None] * path[:, 3:]
    >>> z = doppler_shift(path, array) + 0.4 * np.random.default_rng(1).standard_normal((1000, 6))
    >>> prior = [0.8, 0, 0, -0.75, 0, 0], np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
    >>> found = gaussian_sum(z, array, *prior, T=1e-3, sigma_a=0.1, sigma_f=0.4, every=500)
    >>> bool(np.abs(found.x[-1, :3] - path[-1, :3]).max() < 0.005)
    True
    """
    z = _measurements(z, array)
    weights = 1 / _variance(sigma_f, z.shape[-2:])
    x0 = _checks.exact_shape("x0", _checks.moderate("x0", x0, (6,)), (6,))
    P0 = _checks.exact_shape("P0", _checks.covariance("P0", P0, 6), (6, 6))
    batch, (K, N) = z.shape[:-2], z.shape[-2:]
    block = min(block, K)

    # The frame of the array: origin in the middle, first axis towards the prior.
    center, axes, radius = _frame(array, x0)
    turn = np.kron(np.eye(2), axes)
    G, sigma_a = dwna_gain(np.array([T]), sigma_a, noise)
    columns = np.ascontiguousarray((turn @ (sigma_a * G[0])).T)
    ahead = (block + 1) / 2 * T  # from the prior to the middle of the first block
    F, Q = constant_velocity(ahead, sigma_a * np.sqrt(T / ahead), noise)
    mean = turn @ (F @ (x0 - np.concatenate([center, np.zeros(3)])))
    P = turn @ (F @ P0 @ F.T + Q) @ turn.T
    _checks.estimates("x0, P0, T, sigma_a", mean, P)
    P = _checks.covariance("P0", (P + P.T) / 2, 6)
    least = _LEAST * radius
    grid, widths = _windows(mean, P, radius, least)
    positions = np.ascontiguousarray((array.positions - center) @ axes.T)

    runs = int(np.prod(batch))
    z = np.ascontiguousarray(z).reshape(runs, K, N)
    outputs = K // every
    # As it is where all members have been lost.
    x, covariance = np.full((runs, outputs, 6), np.nan), np.full((runs, outputs, 6, 6), np.nan)
    members, shares = np.zeros((runs, outputs), np.int64), np.zeros((runs, outputs, mixture))
    means = np.full((runs, outputs, mixture, 6), np.nan)
    covariances = np.full((runs, outputs, mixture, 6, 6), np.nan)
    information = np.linalg.inv(P)
    for value in (z, weights):
        value.flags.writeable = False

    # Here, and not above, so that importing the library does not load numba.
    from ._gaussian_sum_loop import filter_records

    def part(run):
        rows = slice(run, run + 1)
        filter_records(
            z[rows], weights, positions, radius, array.doppler_per_speed, float(T), block, columns,
            mean, (information + information.T) / 2, grid, widths, least, float(lightest),
            float(loss), every, x[rows], covariance[rows], members[rows],
            shares[rows], means[rows], covariances[rows],
        )  # fmt: skip

    with ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
        list(pool.map(part, range(runs)))
    for at in (x, means):
        at[:] = at @ turn
        at[..., :3] += center
    results = (x, turn.T @ covariance @ turn, members, shares, means, turn.T @ covariances @ turn)
    return GaussianSumTrack(*(value.reshape(*batch, *value.shape[1:]) for value in results))


def _frame(array, x0):
    """Return center, axes (3, 3) as rows and radius of a plane array; x0 lies on its first axis."""
    center = array.positions.mean(axis=0)
    around = array.positions - center
    radius = float(np.sqrt(np.mean(np.sum(around**2, axis=-1))))
    _, spread, rows = np.linalg.svd(around, full_matrices=True)
    if len(array) < 3 or spread[1] < 1e-6 * spread[0] or spread[2] > _FLAT * spread[0]:
        raise ValueError(
            "array must have its sensors in one plane and not on a line, got extents "
            f"{np.round(spread, 6).tolist()} m along its axes"
        )
    normal = rows[2]
    height = (x0[:3] - center) @ normal
    if not abs(height) > _LEAST * radius:
        raise ValueError(
            f"x0 must lie in front of the plane of the sensors, got {abs(height):g} m beside it"
        )
    normal = normal * np.sign(height)
    return center, np.array([normal, rows[0], np.cross(normal, rows[0])]), radius


def _windows(mean, P, radius, least):
    """Return centers (W, 3) of eta and ln rho where the prior is, and widths of the windows."""
    draws = np.random.default_rng(0).standard_normal((_DRAWN, 6))
    states = mean + draws @ np.linalg.cholesky(P).T
    states = states[states[:, 0] > least]
    if not len(states):
        raise ValueError("P0 must leave states in front of the sensors, got none")
    eta_y, eta_z, *_, rho = kernel.to_coordinates(*states.T, radius)
    across = _ACROSS / radius
    # A hexagonal lattice: rows sqrt(3) / 2 apart, each other one moved by half.
    row = np.round(eta_z / (across * np.sqrt(3) / 2))
    cells = np.stack(
        [np.round(eta_y / across - 0.5 * (row % 2)), row, np.round(np.log(rho) / _ALONG)]
    )
    cells, drawn = np.unique(cells.T.astype(int), axis=0, return_counts=True)
    order = np.argsort(-drawn, kind="stable")
    cells = cells[order][np.cumsum(drawn[order]) - drawn[order] < _COVERED * drawn.sum()]
    i, j, k = cells.T
    grid = np.stack(
        [(i + 0.5 * (j % 2)) * across, j * across * np.sqrt(3) / 2, k * _ALONG], axis=-1
    )
    return grid, _WIDTH * np.array([across, across, _ALONG])
