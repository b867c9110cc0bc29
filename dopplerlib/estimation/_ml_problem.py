"""The problem that a start solves: predictions, bounds, and a global search for one kind of array.

Here for a `RadarArray`, by the compiled search of `_ml_search`.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from ..kernels import doppler as kernel
from ..model.information import SINGULAR
from ._ml_polish import Data, Refined

# Points of the search grid on each axis, by the number of axes that are free. If nothing moves the
# grid is most of the work; if something does it is a small part, and a fine one misses less.
_POINTS = {
    "stationary": {0: 1, 1: 64, 2: 16, 3: 11},
    "constant_velocity": {0: 1, 1: 64, 2: 24, 3: 16},
}

# The grid and its slopes see the first samples only, in which a target at the largest speed moves
# this far, relative to the size of the array: so far a straight line explains its Doppler shifts.
_WINDOW = 0.25


class Found(NamedTuple):
    """Results of a search, one row a run; NaN, and not converged, where it found nothing."""

    x: np.ndarray
    information: np.ndarray
    cost: np.ndarray
    converged: np.ndarray
    second_x: np.ndarray
    second_cost: np.ndarray


class Problem(NamedTuple):
    """Unknowns and their box, a model that predicts, and a search.

    Attributes
    ----------
    lower, upper : ndarray, shape (6,)
        Box of the target's state at the first sample.
    times : ndarray, shape (K,)
        Times of the samples in s.
    predict : callable
        Takes states (rows, 6) and returns shifts (rows, K, N) without clocks, and their derivatives
        (rows, K, N, 6).
    design : ndarray, shape (K, N, C)
        Derivatives of the shifts by the clocks.
    epoch : bool
        Whether clocks are others at each sample.
    search : callable
        Takes runs (runs, K, N) and deviations (K, N), and returns what is `Found`.
    begin : callable
        Takes a run (K, N), deviations, subsets (subsets, K, N) and a generator, and returns states
        `Refined` on these subsets alone.
    """

    lower: np.ndarray
    upper: np.ndarray
    times: np.ndarray
    predict: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    design: np.ndarray
    epoch: bool
    search: Callable[..., Found]
    begin: Callable[..., Refined]

    @property
    def free(self):
        """Number of components of the target that the box does not fix."""
        return int(np.sum(self.lower < self.upper))

    def unknowns(self, there):
        """Return the number of unknowns, clocks included, of measurements `there` (..., K N)."""
        scans = there.reshape(*there.shape[:-1], *self.design.shape[:2])
        samples = scans.any(axis=-1).sum(axis=-1) if self.epoch else 1
        return self.free + samples * self.design.shape[-1]

    def data(self, z, deviations, roots=None):
        """Return the `Data` of one run (K, N)."""
        there = ~np.isnan(z)
        return Data(
            self.predict, np.where(there, z, 0.0), there / deviations, self.design, self.epoch,
            roots,
        )  # fmt: skip


def array_problem(array, lower, upper, times, moving, workers):
    """Return the problem of a target at constant velocity, or at rest in its state.

    `times` (K,) begin at zero. More than one are needed if it is `moving`.
    """
    samples, every = len(times), times
    even = samples > 1 and (times == times[1] * np.arange(samples)).all()
    free = lower < upper
    center = array.positions.mean(axis=0)
    radius = np.sqrt(np.sum((array.positions - center) ** 2, axis=1).mean())
    radius = radius if radius > 0 else array.wavelength
    speed = np.linalg.norm(np.maximum(np.abs(lower[3:]), np.abs(upper[3:])))
    reach = _WINDOW * radius
    points = _POINTS["constant_velocity" if moving else "stationary"][int(free[:3].sum())]
    grid, shape = _grid(lower, upper, center, radius, points)
    times = times if moving else np.zeros(1)
    unknowns = int(free.sum())

    def predict(x):
        p, v, t = x[:, None, None, :3], x[:, None, None, 3:], times[:, None]
        p = np.moveaxis(p + t[..., None] * v, -1, 0)
        h, *J = kernel.doppler_shift_and_gradient(
            *p, *np.moveaxis(v, -1, 0), *array.positions.T, array.doppler_per_speed
        )
        # The gradient of h(F x) is F' times that of h.
        J = np.stack([*J[:3], *(J[3 + i] + t * J[i] for i in range(3))], axis=-1)
        shape = len(x), samples, len(array)
        return np.broadcast_to(h, shape), np.broadcast_to(J, (*shape, 6))

    def search(z, deviations, rows=None):
        # Here, and not above, so that importing the library does not load numba.
        from ._ml_search import search

        t = times if rows is None or not moving else times[rows]
        first = z.shape[1]
        if moving and even and rows is None:
            if speed * t[1] * first > reach:
                first = min(max(2, int(reach / (speed * t[1]))), first)
        elif moving:
            first = min(max(2, int(np.sum(speed * (t - t[0]) < reach))), first)
        z, deviations = np.ascontiguousarray(z).view(), np.ascontiguousarray(deviations).view()
        # Whether an array may be written to is part of its type: numba would compile once for each.
        z.flags.writeable = deviations.flags.writeable = False
        runs = len(z)
        x, second_x = np.empty((runs, 6)), np.empty((runs, 6))
        information = np.empty((runs, 6, 6))
        cost, second_cost = np.empty(runs), np.empty(runs)
        converged = np.empty(runs, bool)

        def part(some):
            search(
                z[some], deviations, t, first, array.positions, array.doppler_per_speed,
                lower, upper, grid, shape, center, radius, SINGULAR, max(unknowns, 1), x[some],
                information[some], cost[some], converged[some], second_x[some], second_cost[some],
            )  # fmt: skip

        size = -(-runs // workers)
        parts = [slice(first, first + size) for first in range(0, runs, size)]
        if len(parts) == 1:
            part(parts[0])
        else:
            with ThreadPoolExecutor(workers) as pool:
                list(pool.map(part, parts))
        return Found(x, information, cost, converged, second_x, second_cost)

    def begin(z, deviations, subsets, rng):
        x = np.empty((len(subsets), 6))
        for i, subset in enumerate(subsets):
            rows = np.flatnonzero(subset.any(axis=1))
            few = np.where(subset, z, np.nan)[None, rows]
            x[i] = search(few, deviations[rows], rows).x[0]
        x = x[np.isfinite(x).all(axis=1)]
        return Refined(x, np.zeros((len(x), 1, 0)), np.zeros(len(x)), np.ones(len(x), bool))

    design = np.zeros((samples, len(array), 0))
    return Problem(lower, upper, every, predict, design, False, search, begin)


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
