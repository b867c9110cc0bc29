"""Maximum-likelihood initialization from the first measurements."""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Literal

import numpy as np

from .. import _checks
from .._records import record
from .._typing import ArrayLike, BoolArray
from ..model.information import SINGULAR, inverse_information
from ..model.radar_array import RadarArray
from .extended_kalman import _measurements

# Points of the search grid on each axis, by the number of axes that are free. If nothing moves the
# grid is most of the work; if something does it is a small part, and a fine one misses less.
_POINTS = {
    "stationary": {0: 1, 1: 64, 2: 16, 3: 11},
    "constant_velocity": {0: 1, 1: 64, 2: 24, 3: 16},
}

# Chi-square of a start over its degrees of freedom: 1 if all is right, 100 if the deviations are a
# tenth of what they should be. What is beyond has another reason.
IMPLAUSIBLE = 100.0

# The grid and its slopes see the first samples only, in which a target at the largest speed moves
# this far, relative to the size of the array: so far a straight line explains its Doppler shifts.
_WINDOW = 0.25


class ImplausibleStart(UserWarning):
    """Warning of an initial estimate that does not explain its measurements."""


@record
class InitialEstimate:
    """Maximum-likelihood initial estimates; leading axes are those of the measurements.

    Attributes
    ----------
    x : ndarray, shape (..., 6)
        Estimated states in m and m/s; NaN if there are fewer measurements than unknowns.
    P : ndarray, shape (..., 6, 6)
        Their covariance by the Fisher information at the estimate, as if there were no box. A
        component that the box fixes has variance zero; one that the measurements do not determine
        has an infinite variance and NaN covariances.
    cost : ndarray, shape (...)
        Chi-square of the estimate: the sum of the squared residuals over their variances.
    at_bound : ndarray of bool, shape (..., 6)
        Components on the box at the first sample, other than those that it fixes.
    identifiable : ndarray of bool, shape (...)
        Whether the information at the estimate is regular. If not, other states in the box
        explain the measurements just as well (to first order), and `x` is the one of them nearest
        to the center of the box.
    converged : ndarray of bool, shape (...)
        Whether the search ended in an optimum to rounding.
    second_x : ndarray, shape (..., 6)
        The best optimum found elsewhere; NaN if none was found.
    second_cost : ndarray, shape (...)
        Its chi-square. A difference of a few from `cost` says that the choice is uncertain.
    degrees : ndarray of int, shape (...)
        Degrees of freedom of the chi-square: measurements that are there less unknowns.
    """

    x: np.ndarray
    P: np.ndarray
    cost: np.ndarray
    at_bound: np.ndarray
    identifiable: np.ndarray
    converged: np.ndarray
    second_x: np.ndarray
    second_cost: np.ndarray
    degrees: np.ndarray

    @property
    def plausible(self) -> BoolArray:
        """Whether chi-square is at most a hundred times its degrees of freedom, shape (...).

        If not, no straight flight in the box explains the measurements. Usual reasons: I and Q are
        exchanged, so that all Doppler shifts have the wrong sign; sensors are in another order
        than their positions; or the true state is not in the box. With the likelihood "stationary",
        a target that moves is a reason, too.
        """
        cost, degrees = _checks.real("cost", self.cost), _checks.real("degrees", self.degrees)
        _checks.check_leading(cost=(cost, 0), degrees=(degrees, 0))
        return cost <= IMPLAUSIBLE * np.maximum(degrees, 1)


@_checks.quiet
def ml_initialize(
    z: ArrayLike,
    array: RadarArray,
    sigma_f: ArrayLike,
    T: float,
    box: tuple[ArrayLike, ArrayLike],
    likelihood: Literal["constant_velocity", "stationary"] = "constant_velocity",
    *,
    at: Literal["first", "last"] = "first",
    workers: int | None = None,
) -> InitialEstimate:
    """Return initial estimates: the global maximum of the likelihood in a box.

    Parameters
    ----------
    z : array_like, shape (..., K, N)
        Doppler measurements in Hz; NaN says that this sensor is missing at this sample.
    array : RadarArray
        The N sensors.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz.
    T : float
        Sampling interval in s.
    box : pair of array_like, shape (6,)
        Lower and upper bounds of the state at the first sample. Equal bounds fix a component:
        z = v_z = 0 makes the problem one in a plane.
    likelihood : {"constant_velocity", "stationary"}
        "constant_velocity": the target moves at constant velocity. "stationary": its state is the
        same at all samples, Eq 10 as printed.
    at : {"first", "last"}
        Sample to which `x`, `P` and `second_x` belong. With "stationary" they are the
        same.
    workers : int, optional
        Threads among which the runs are shared; one for each processor if None. The result does
        not depend on it.

    Returns
    -------
    InitialEstimate
        Leading axes are those of `z`. A run that is too incomplete to be solved is NaN, with
        `converged` and `identifiable` False.

    Raises
    ------
    ValueError
        If an argument has the wrong shape, is not finite and positive where it has to be, the box
        is empty, or even complete measurements would be fewer than the unknowns.

    Notes
    -----
    Mittermaier et al. (2016), Eq 10. The Doppler shift is linear in the velocity once the
    position is given, so only positions need to be searched (variable projection, Golub and
    Pereyra 1973): on a grid that is finer near the array, then by Levenberg-Marquardt in the box.
    Where a direction is hardly determined, it is searched on its own.
    The search is not exhaustive; its success rates are in ``benchmarks/README.md``.

    Examples
    --------
    >>> from dopplerlib import doppler_shift
    >>> array = RadarArray.linear(5, 0.4)
    >>> z = doppler_shift([0.5, 0.2, 0, -1, 0.5, 0], array)[None]
    >>> box = [0.1, -1, 0, -2, -2, 0], [2, 1, 0, 2, 2, 0]
    >>> (ml_initialize(z, array, 0.1, 0.001, box).x.round(6) + 0.0).tolist()
    [0.5, 0.2, 0.0, -1.0, 0.5, 0.0]
    """
    _checks.instance("array", array, RadarArray)
    z = _measurements(z, array)
    T = _checks.positive_number("T", T)
    sigma_f = _checks.deviation("sigma_f", sigma_f)
    deviations = np.ascontiguousarray(_checks.each_run("sigma_f", sigma_f, z.shape[-2:], ())).view()
    lower, upper = _box(box)
    _checks.one_of("likelihood", likelihood, ("constant_velocity", "stationary"))
    _checks.one_of("at", at, ("first", "last"))
    workers = (os.cpu_count() or 1) if workers is None else _checks.whole_number("workers", workers)

    batch, (samples, sensors) = z.shape[:-2], z.shape[-2:]
    runs = int(np.prod(batch))
    free = lower < upper
    needed = int(free.sum())
    moving = likelihood == "constant_velocity" and samples > 1
    values = samples * sensors if moving else sensors
    if values < needed:
        raise ValueError(
            f"z must hold at least as many values as there are unknowns, got {values} "
            f"({likelihood} likelihood) for {needed}; equal bounds in box fix a component"
        )
    times = T * np.arange(samples) if moving else np.zeros(1)
    center = array.positions.mean(axis=0)
    radius = np.sqrt(np.sum((array.positions - center) ** 2, axis=1).mean())
    radius = radius if radius > 0 else array.wavelength
    speed = np.linalg.norm(np.maximum(np.abs(lower[3:]), np.abs(upper[3:])))
    window = samples
    if speed * T * samples > _WINDOW * radius:
        window = max(2, int(_WINDOW * radius / (speed * T)))
    window = min(window, samples)
    points = _POINTS["constant_velocity" if moving else "stationary"][int(free[:3].sum())]
    grid, shape = _grid(lower, upper, center, radius, points)
    z = np.ascontiguousarray(z).reshape(runs, samples, sensors)
    # Whether an array may be written to is part of its type: numba would compile once for each.
    z.flags.writeable = deviations.flags.writeable = False
    x, second_x = np.empty((runs, 6)), np.empty((runs, 6))
    information = np.empty((runs, 6, 6))
    cost, second_cost = np.empty(runs), np.empty(runs)
    converged = np.empty(runs, bool)

    # Here, and not above, so that importing the library does not load numba.
    from ._ml_search import search

    def part(rows):
        search(
            z[rows], deviations, times, window, array.positions, array.doppler_per_speed,
            lower, upper, grid, shape, center, radius, SINGULAR, max(needed, 1), x[rows],
            information[rows], cost[rows], converged[rows], second_x[rows], second_cost[rows],
        )  # fmt: skip

    size = -(-runs // workers)
    parts = [slice(first, first + size) for first in range(0, runs, size)]
    if len(parts) == 1:
        part(parts[0])
    else:
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(part, parts))

    at_bound = free & ((x <= lower) | (x >= upper))
    solved = ~np.isnan(cost)
    if at == "last" and moving:
        F = np.eye(6)
        F[:3, 3:] = (samples - 1) * T * np.eye(3)
        back = np.linalg.inv(F)
        x, second_x = x @ F.T, second_x @ F.T
        information = back.T @ information @ back
    P = np.full((runs, 6, 6), np.nan)
    identifiable = np.zeros(runs, bool)
    _checks.estimates("z, array, sigma_f, T, box", information[solved])
    P[solved], identifiable[solved] = inverse_information(information[solved], free)
    degrees = np.sum(~np.isnan(z), axis=(1, 2)) - needed
    fields = x, P, cost, at_bound, identifiable, converged, second_x, second_cost, degrees
    return InitialEstimate(*(field.reshape((*batch, *field.shape[1:])) for field in fields))


def _box(box):
    try:
        lower, upper = box
    except (TypeError, ValueError):
        raise ValueError(f"box must be a pair (lower, upper), got {box!r}") from None
    bounds = [
        _checks.finite(f"the {name} bound of box", bound, (6,))
        for name, bound in (("lower", lower), ("upper", upper))
    ]
    for bound in bounds:
        if bound.ndim != 1:
            raise ValueError(f"box must be a pair of arrays of shape (6,), got {bound.shape}")
    lower, upper = bounds
    if (lower > upper).any():
        i = int(np.argmax(lower > upper))
        raise ValueError(
            f"box must not be empty, got lower {lower[i]} above upper {upper[i]} at index {i}"
        )
    return lower.copy(), upper.copy()


def _grid(lower, upper, center, radius, points):
    """Return positions in the box, shape (G, 3), denser near the array, and their grid's shape.

    Steps are even in asinh(distance / radius): about even within the array's size, and a constant
    share of the distance beyond.
    """
    axes = []
    for low, high, middle in zip(lower[:3], upper[:3], center, strict=True):
        if low == high:
            axes.append(np.array([low]))
            continue
        first, last = np.arcsinh((np.array([low, high]) - middle) / radius)
        cells = first + (last - first) * (np.arange(points) + 0.5) / points
        axes.append(middle + radius * np.sinh(cells))
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    return np.ascontiguousarray(grid.reshape(-1, 3)), np.array(grid.shape[:3])
