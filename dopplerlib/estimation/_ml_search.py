"""The search behind `ml_initialize`, compiled.

One run goes through four steps:

1. `_ml_grid`: at every point of a grid of positions the best velocity is a small linear
   least-squares problem (variable projection), prepared once for all runs.
2. `_ml_refine`: Levenberg-Marquardt in the box from the lowest local minima of the grid.
3. `_ml_valley.walk`: a line of sight says little about range, so along one direction the cost may
   have several minima close together; follow that direction both ways and refine what is found.
4. `_ml_valley.settle`: where the likelihood has no unique maximum, take the one nearest to the
   center of the box, so that the answer does not depend on where a search stopped.

Costs are chi-square: sums of squared residuals over their standard deviations.
"""

import numpy as np

from .._compile import cached_njit, fingerprint, inner_njit
from ..kernels import doppler as kernel
from . import _ml_grid, _ml_refine, _ml_valley
from ._ml_grid import STARTS, lowest_minima, project, scan
from ._ml_refine import ITERATIONS, copy, grow, move, normal_equations, refine
from ._ml_valley import STEPS, differ, lowest, settle, walk, weakest


@inner_njit
def _summarize(times, z, w, window, mean_t, mean_z, mean_w, slope, spread):
    """Reduce every sensor to the mean and the slope of its first samples.

    Return how many values determine the state: all that are there, or one a sensor if there is
    one time only. If a sensor is missing in the first samples, all samples are taken.
    """
    samples, sensors = z.shape
    seen = 0
    for n in range(sensors):
        total, early = 0, 0
        for k in range(samples):
            total += w[k, n] > 0
            early += k < window and w[k, n] > 0
        seen += total if times.size > 1 else total > 0
        if total > 0 and early == 0:
            window = samples
    # For each sensor the weighted least-squares line z = mean + slope (t - mean time), whose slope
    # has the variance 1 / spread: spread = sum w^2 (t - mean time)^2.
    all_weights, all_times = 0.0, 0.0
    for n in range(sensors):
        weight, time, mean = 0.0, 0.0, 0.0
        for k in range(window):
            square = w[k, n] ** 2
            weight += square
            mean += square * z[k, n]
            if times.size > 1:
                time += square * times[k]
        all_weights += weight
        all_times += time
        mean_w[0, n] = np.sqrt(weight)
        mean_z[0, n] = slope[n] = spread[n] = 0.0
        if weight == 0.0:
            continue
        mean_z[0, n] = mean / weight
        if times.size > 1:
            for k in range(window):
                square = w[k, n] ** 2
                since = times[k] - time / weight
                spread[n] += square * since**2
                slope[n] += square * since * z[k, n]
            if spread[n] > 0:
                slope[n] /= spread[n]
    mean_t[0] = all_times / all_weights if all_weights > 0 else 0.0
    return seen


@inner_njit
def _search(z, deviations, times, window, positions, c, lower, upper, grid, shape, center, radius,
           singular, needed, x, information, cost, converged, second_x, second_cost):  # fmt: skip
    """Fill the outputs, one row a run.

    With one entry in `times` the state is constant, and one weighted mean of every sensor stands
    for all samples. The first `window` samples are those of the grid and of the walk.
    A run in which fewer than `needed` values (after the mean) are there is left NaN.
    """
    runs, samples, sensors = z.shape
    moving = times.size > 1
    points = len(grid)
    Q, R, bound = np.empty((3, sensors, points)), np.empty((9, points)), np.empty((3, 2, points))
    order, rate = np.empty((3, points), np.int64), np.empty((sensors, points))
    v, score = np.empty((3, points)), np.empty(points)
    low, spare = np.empty(points), np.empty(points)
    prepared = np.full(sensors, np.nan)
    slope, spread = np.empty(sensors), np.empty(sensors)
    data, w = np.empty((samples, sensors)), np.empty((samples, sensors))
    mean_t, mean_z, mean_w = np.zeros(1), np.empty((1, sensors)), np.empty((1, sensors))
    chosen = np.empty(STARTS, np.int64)
    path, path_cost = np.empty((2 * STEPS + 1, 6)), np.empty(2 * STEPS + 1)
    states, costs = np.empty((2 * STARTS + 2 * STEPS + 1, 6)), np.empty(2 * STARTS + 2 * STEPS + 1)
    arrived, taken = np.empty(costs.size, np.bool_), np.empty(costs.size, np.bool_)
    H, g, L = np.empty((6, 6)), np.empty(6), np.empty((6, 6))
    held, e, ones = np.empty(6, np.bool_), np.empty(6), np.ones(6)
    for run in range(runs):
        x[run] = second_x[run] = np.nan
        information[run] = np.nan
        cost[run] = second_cost[run] = np.nan
        converged[run] = False
        # A missing measurement is one of weight zero.
        size = 0.0
        for k in range(samples):
            for n in range(sensors):
                here = not np.isnan(z[run, k, n])
                data[k, n] = z[run, k, n] if here else 0.0
                w[k, n] = 1 / deviations[k, n] if here else 0.0
                size += (w[k, n] * data[k, n]) ** 2
        size = np.sqrt(size)
        seen = _summarize(times, data, w, window if moving else samples, mean_t, mean_z, mean_w,
                          slope, spread)  # fmt: skip
        # Without motion the samples of a sensor are replaced by their mean; what they scatter about
        # it costs the same at every state, and is added to the costs in the end.
        scatter = 0.0
        if moving:
            t_fit, z_fit, w_fit = times, data, w
        else:
            t_fit, z_fit, w_fit = mean_t, mean_z, mean_w
            for k in range(samples):
                for n in range(sensors):
                    scatter += (w[k, n] * (data[k, n] - mean_z[0, n])) ** 2
        if seen < needed:
            continue

        # Step 1. Runs mostly share their weights, and then the factors of the grid.
        for n in range(sensors):
            if mean_w[0, n] != prepared[n]:
                copy(mean_w[0], prepared)
                project(grid, prepared, positions, c, lower, upper, Q, R, bound, order, rate)
                break
        scan(mean_z[0], prepared, slope, spread, c, Q, R, bound, rate, v, score)
        count = lowest_minima(score, shape, low, spare, chosen)
        for m in range(count):
            p = chosen[m]
            for a in range(3):
                states[m, 3 + order[a, p]] = v[a, p]
            # The grid is for the mean time: back to time zero, and into the box again.
            for i in range(3):
                e[i] = grid[p, i] - mean_t[0] * states[m, 3 + i]
            e[3:] = 0.0
            states[m, :3] = 0.0
            move(states[m], e, lower, upper, states[m])
        # Step 2, from each minimum as it is, and from what growing windows make of it.
        if window < t_fit.size:
            for m in range(count):
                copy(states[m], states[count + m])
                grow(
                    states[count + m], t_fit, z_fit, w_fit, window, positions, c, lower, upper,
                    size,
                )  # fmt: skip
            count *= 2
        for m in range(count):
            costs[m], arrived[m] = refine(
                states[m], t_fit, z_fit, w_fit, positions, c, lower, upper, size, ITERATIONS
            )
        taken[:] = False
        best = lowest(states[:count], costs[:count], taken, lower, upper)
        if best < 0:
            continue
        if moving:
            # Step 3. Every local minimum of the cost along the walk is refined.
            first, last = walk(
                states[best], times, data, w, mean_t, mean_z, mean_w, positions, c, lower, upper,
                center, radius, path, path_cost,
            )  # fmt: skip
            for m in range(first, last + 1):
                if (
                    m != STEPS
                    and (m == first or path_cost[m] < path_cost[m - 1])
                    and (m == last or path_cost[m] <= path_cost[m + 1])
                ):
                    copy(path[m], states[count])
                    costs[count], arrived[count] = refine(
                        states[count], times, data, w, positions, c, lower, upper, size, ITERATIONS
                    )
                    count += 1
            best = lowest(states[:count], costs[:count], taken, lower, upper)

        # Step 4.
        normal_equations(states[best], t_fit, z_fit, w_fit, positions, c, H, g)
        flat = weakest(H, lower, upper, ones, held, L, e) < singular
        if flat:
            settle(states[best], t_fit, z_fit, w_fit, positions, c, lower, upper)
        copy(states[best], x[run])
        converged[run] = arrived[best]
        cost[run] = scatter + normal_equations(
            x[run], t_fit, z_fit, w_fit, positions, c, information[run], g
        )
        # The second-best state: the lowest one that is another state, not the same found twice.
        taken[best] = True
        while True:
            m = lowest(states[:count], costs[:count], taken, lower, upper)
            if m < 0:
                break
            taken[m] = True
            if flat:
                settle(states[m], t_fit, z_fit, w_fit, positions, c, lower, upper)
            if differ(states[m], x[run], lower, upper) >= 0:
                copy(states[m], second_x[run])
                second_cost[run] = scatter + costs[m]
                break


def _cached(compiled_in):
    """Return `_search`, compiled once for all processes."""

    @cached_njit
    def search(*arguments):
        compiled_in  # noqa: B018  (see fingerprint)
        _search(*arguments)

    return search


search = _cached(fingerprint(kernel, _ml_grid, _ml_refine, _ml_valley))
