"""The problem of a start with `DopplerLinks`: sensors that move, clocks.

Everything is linear in velocity and clocks at a given position, but for the target's motion during
the record. So a grid of positions is scored by one or two steps of the others (variable
projection), and its lowest local minima are refined with all unknowns.
"""

import numpy as np

from ..kernels import links as kernel
from ._ml_polish import Data, refine
from ._ml_problem import Found, Problem, _grid

_POINTS = {0: 1, 1: 128, 2: 40, 3: 12}  # of the grid on each axis, by the number of axes

_VALUES = 128  # measurements that score the grid: so many are taken, evenly over the samples

_CHUNK = 1024  # points of the grid that are scored at a time

_STARTS = 8  # local minima that are refined

_DISTINCT = 1e-3  # two states differ if a component does by this share of the box


def links_problem(links, lower, upper, times, moving):
    """Return the problem of a target at constant velocity, or at rest in its state.

    `links` have states at all samples, whose `times` (K,) begin at zero.
    """
    legs, bias = links.legs, links.bias
    clocks = np.broadcast_to(links.clocks, (len(times), *links.clocks.shape))
    if links.clock_model == "drift":
        clocks = np.concatenate([clocks, times[:, None, None] * clocks], axis=-1)
    epoch = links.clock_model == "epoch" and clocks.shape[-1] > 0
    ends = np.concatenate([end[..., :3].reshape(-1, 3) for end, _ in legs])
    center = ends.mean(axis=0)
    radius = np.sqrt(np.sum((ends - center) ** 2, axis=1).mean())
    radius = radius if radius > 0 else links.wavelength[0]
    points = _POINTS[int((lower < upper)[:3].sum())]
    grid, shape = _grid(lower, upper, center, radius, points)

    def model(rows):
        t = times[rows] if moving else np.zeros(len(times[rows]))
        known = bias[rows] if bias.ndim == 2 else bias

        def predict(x):
            p = x[:, None, None, :3] + t[:, None, None] * x[:, None, None, 3:]
            state = np.moveaxis(p, -1, 0), x[:, 3:].T[..., None, None]
            total, J = known, 0.0
            for end, per_speed in legs:
                h, *slopes = kernel.leg_shift_and_gradient(
                    *state[0], *state[1], *np.moveaxis(end[rows], -1, 0), per_speed
                )
                total = total + h
                J = J + np.stack(np.broadcast_arrays(*slopes), axis=-1)
            J[..., 3:] += t[:, None, None] * J[..., :3]
            return total, J

        return predict

    everything = slice(None)
    predict = model(everything)
    few = np.unique(
        np.linspace(0, len(times) - 1, max(2, _VALUES // len(links)), dtype=int)
        if len(times) > 1
        else [0]
    )

    def starts(z, deviations):
        """Return the lowest local minima of a grid, (starts, 6)."""
        from scipy.ndimage import minimum_filter

        data = problem.data(z, deviations)
        # Samples that hold most measurements, evenly over the record.
        thin = Data(model(few), data.z[few], data.weight[few], data.design[few], epoch)
        x, cost = np.empty((len(grid), 6)), np.empty(len(grid))
        x[:, :3], x[:, 3:] = grid, np.clip(0.0, lower[3:], upper[3:])
        for first in range(0, len(grid), _CHUNK):
            part = slice(first, first + _CHUNK)
            box = [np.tile(bound, (len(x[part]), 1)) for bound in (lower, upper)]
            for bound in box:
                bound[:, :3] = grid[part]
            found = refine(thin, x[part], box, iterations=2)
            x[part], cost[part] = found.x, np.where(np.isfinite(found.cost), found.cost, np.inf)
        low = minimum_filter(cost.reshape(shape), size=3, mode="nearest").ravel()
        minima = np.flatnonzero((cost <= low) & np.isfinite(cost))
        return x[minima[np.argsort(cost[minima], kind="stable")[:_STARTS]]]

    def search(z, deviations):
        runs = len(z)
        nothing = np.full(runs, np.nan)
        found = Found(
            np.full((runs, 6), np.nan), np.full((runs, 6, 6), np.nan), nothing.copy(),
            np.zeros(runs, bool), np.full((runs, 6), np.nan), nothing.copy(),
        )  # fmt: skip
        for i, run in enumerate(z):
            there = ~np.isnan(run)
            if np.sum(there) < problem.unknowns(there.ravel()):
                continue
            begun = starts(run, deviations)
            if not len(begun):
                continue
            ends = refine(problem.data(run, deviations), begun, (lower, upper))
            ends = ends.of(np.argsort(ends.cost, kind="stable"))
            found.x[i], found.cost[i], found.converged[i] = ends.x[0], ends.cost[0], ends.arrived[0]
            apart = (np.abs(ends.x - ends.x[0]) > _DISTINCT * (upper - lower)).any(axis=1)
            for other in np.flatnonzero(apart)[:1]:
                found.second_x[i], found.second_cost[i] = ends.x[other], ends.cost[other]
        return found

    def begin(z, deviations, subsets, rng):
        # From the minima of all measurements, wrong ones among them, and from anywhere.
        minima = starts(z, deviations)
        anywhere = np.tile(np.clip(0.0, lower, upper), (len(subsets), 1))
        anywhere[:, :3] = grid[rng.integers(len(grid), size=len(subsets))]
        if len(minima):
            anywhere[::2] = minima[np.arange(len(anywhere[::2])) % len(minima)]
        found = refine(
            problem.data(z, deviations), anywhere, (lower, upper),
            m=subsets.reshape(len(subsets), -1) + 0.0, iterations=50,
        )  # fmt: skip
        return found.of(np.isfinite(found.cost))

    problem = Problem(lower, upper, times, predict, clocks, epoch, search, begin)
    return problem
