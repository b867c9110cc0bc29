"""How often `ml_initialize` finds the global optimum, how fast, and what SciPy needs for that.

``make bench NAME=ml_initialize`` writes what the chapter on benchmarks shows: two minutes.
``python benchmarks/ml_initialize.py 1000 60 100`` takes half an hour: so many scenarios, of which
SciPy solves so many, from so many starts.

The optimum is the least cost that anybody found: `ml_initialize`; 300 refinements from random
states by the compiled Levenberg-Marquardt of the library; and, for the first scenarios, SciPy:
`least_squares` from random states, `basinhopping` and `differential_evolution`, the two with its
settings but for the number of hops, on variables scaled to the box, and with a last
`least_squares`. SciPy gets the analytic Jacobian, and the mean of the samples where that is all
that counts. Times are processor time of one thread.
"""

import sys
import time

import numpy as np
from measuring import ROUNDS, progress, save
from numba import njit
from scipy.optimize import basinhopping, differential_evolution, least_squares
from scipy.special import comb

from dopplerlib import RadarArray, doppler_shift, ml_initialize
from dopplerlib.estimation import _ml_refine
from dopplerlib.kernels import doppler as kernel

T, SAMPLES = 1e-3, 10
LINE, RING = RadarArray.linear(5, 0.4), RadarArray.ring(6, 0.2)
SPACE = np.array([[0.1, -0.75, -0.75, -2, -2, -2], [1.5, 0.75, 0.75, 2, 2, 2]])
PLANE = SPACE * [1, 1, 0, 1, 1, 0]
CASES = {
    "line of five, static": (LINE, PLANE, "stationary"),
    "line of five, moving": (LINE, PLANE, "constant_velocity"),
    "ring of six, static": (RING, SPACE, "stationary"),
    "ring of six, moving": (RING, SPACE, "constant_velocity"),
}
LEVELS = np.logspace(-2, 0, 5)  # standard deviations in Hz; a fifth of the scenarios each
RANDOM_STARTS = 300
HOPS = 20
SAME = 1e-6  # two costs (chi-square) are the same optimum if they differ by less, plus this share
SCIPY_SAME = 1e-2  # for SciPy, which stops earlier; without any weight as a statistic


def main():
    scenarios, scipy_scenarios, starts = map(int, sys.argv[1:] or (200, 25, 30))
    cases = {
        name: studied(name, case, scenarios, scipy_scenarios, starts)
        for name, case in CASES.items()
    }
    found = {"hops": HOPS, "starts": starts, "cases": cases}
    save("ml_initialize", found, packages=("numpy", "numba", "scipy"))


def studied(name, case, scenarios, scipy_scenarios, starts):
    """Return which optima were found, and times in s, of one array and likelihood."""
    z, sigma_f = measurements(case, scenarios)
    progress(f"{name}: ml_initialize, and random starts")
    cost, seconds = ours(z, sigma_f, case)
    rng = np.random.default_rng(3)
    best = np.array(
        [min(c, random_starts(*one, case, rng)) for c, *one in zip(cost, z, sigma_f, strict=True)]
    )
    costs, times = {}, {}
    for i in range(scipy_scenarios):
        progress(f"{name}: scenario {i + 1} of {scipy_scenarios} for SciPy")
        for method, solve in solvers(z[i], sigma_f[i], case, starts, rng).items():
            began = time.process_time()
            costs.setdefault(method, []).append(np.atleast_1d(solve()))
            times.setdefault(method, []).append(time.process_time() - began)
        best[i] = min(best[i], *(rows[i].min() for rows in costs.values()))
    limit = best[:scipy_scenarios, None] * (1 + SAME) + SCIPY_SAME
    hits = {method: np.sum(rows <= limit, axis=1) for method, rows in costs.items()}
    fits = hits.pop("least_squares")
    own = {"found": np.sum(cost <= best * (1 + SAME) + SAME), "of": scenarios, "s": seconds}
    return {
        "ml_initialize, batch": own,  # time of a scenario in each round
        **{
            method: {"found": np.sum(of_one), "of": scipy_scenarios, "s": times[method]}
            for method, of_one in hits.items()
        },  # time of each scenario
        "least_squares": {
            "of": scipy_scenarios,
            "s": np.divide(times["least_squares"], starts),  # of a start, by scenario
            "share": [successes(fits, starts, n) for n in range(1, starts + 1)],
        },
    }


def successes(hits, starts, n):
    """Return the expected share of scenarios of which some of n starts finds the optimum.

    hits: For each scenario how many of `starts` found it; the n are drawn from these.
    """
    return np.mean(1 - comb(starts - hits, n) / comb(starts, n))


def measurements(case, scenarios):
    """Return z (scenarios, K, N) and the standard deviation of each scenario."""
    array, box, likelihood = case
    rng = np.random.default_rng(1)
    x = rng.uniform(*box, (scenarios, 6))
    v = rng.normal(size=(scenarios, 3)) * (box[0, 3:] < box[1, 3:])
    v *= rng.uniform(0.1, 2, (scenarios, 1)) / np.linalg.norm(v, axis=1, keepdims=True)
    approaching = np.sum(v * x[:, :3], axis=1, keepdims=True) < 0
    x[:, 3:] = np.where(approaching, v, -v)
    sigma_f = LEVELS[np.arange(scenarios) % len(LEVELS)]
    path = np.repeat(x[:, None], SAMPLES, axis=1)
    if likelihood == "constant_velocity":
        path[..., :3] += (T * np.arange(SAMPLES))[:, None] * x[:, None, 3:]
    shifts = doppler_shift(path, array)
    return shifts + sigma_f[:, None, None] * rng.standard_normal(shifts.shape), sigma_f


def ours(z, sigma_f, case):
    """Return the costs of `ml_initialize`, and the time for a scenario in s, of all rounds."""
    array, box, likelihood = case
    cost = np.empty(len(z))
    times = []
    for _ in range(ROUNDS + 1):
        began = time.process_time()
        for sigma in LEVELS:
            rows = sigma_f == sigma
            cost[rows] = ml_initialize(z[rows], array, sigma, T, box, likelihood, workers=1).cost
        times.append(time.process_time() - began)
    return cost, np.array(times[1:]) / len(z)


@njit
def refine(x, t, z, w, positions, c, lower, upper, size):
    return _ml_refine.refine(x, t, z, w, positions, c, lower, upper, size, _ml_refine.ITERATIONS)[0]


def random_starts(z, sigma_f, case, rng):
    """Return the least cost of refinements from random states."""
    array, box, likelihood = case
    t, w, scatter = T * np.arange(len(z)), np.full(z.shape, 1 / sigma_f), 0.0
    if likelihood == "stationary":
        mean = z.mean(axis=0)[None]
        scatter = np.sum((z - mean) ** 2) / sigma_f**2
        z, w, t = mean, w[:1] * np.sqrt(len(z)), t[:1]
    size = np.sqrt(np.sum((w * z) ** 2))
    return scatter + min(
        refine(x, t, z, w, array.positions, array.doppler_per_speed, *box, size)
        for x in rng.uniform(*box, (RANDOM_STARTS, 6))
    )


def solvers(z, sigma_f, case, starts, rng):
    """Return {method: function} that return the cost of the scenario, that of starts for each."""
    array, box, likelihood = case
    whole, level = z, sigma_f
    free, size = box[0] < box[1], box[1] - box[0]
    F = np.eye(6) + np.zeros((len(z), 6, 6))
    scatter = 0.0
    if likelihood == "constant_velocity":
        F[:, :3, 3:] = (T * np.arange(len(z)))[:, None, None] * np.eye(3)
    else:
        mean = z.mean(axis=0)[None]
        scatter = np.sum((z - mean) ** 2) / sigma_f**2
        z, sigma_f, F = mean, sigma_f / np.sqrt(len(z)), F[:1]
    x, sensors = box[0].copy(), (*array.positions.T, array.doppler_per_speed)
    columns = [np.broadcast_to(one, len(array))[:, None] for one in sensors]
    bounds = [(0, 1)] * free.sum()

    # The printed kernels themselves: no time for checks of arguments.
    def residuals(u):
        x[free] = box[0, free] + size[free] * u
        return ((kernel.doppler_shift(*(F @ x).T[..., None], *sensors) - z) / sigma_f).ravel()

    def jacobian(u):
        x[free] = box[0, free] + size[free] * u
        _, *gradient = kernel.doppler_shift_and_gradient(*(F @ x).T[..., None], *sensors)
        return (np.stack(gradient, axis=-1) @ F * (size / sigma_f)).reshape(-1, 6)[:, free]

    def value_and_gradient(u):
        r = residuals(u)
        return r @ r, 2 * r @ jacobian(u)

    def values(u):
        """Return the costs of a population, a state a column."""
        many = np.repeat(box[0][:, None], u.shape[1], axis=1)
        many[free] += size[free, None] * u
        shifts = kernel.doppler_shift(*(F @ many).swapaxes(0, 1)[:, :, None], *columns)
        return np.sum(((shifts - z[..., None]) / sigma_f) ** 2, axis=(0, 1))

    def fitted(u):
        u = np.clip(u, 1e-9, 1 - 1e-9)
        found = least_squares(residuals, u, jacobian, (0, 1), x_scale="jac", max_nfev=1000)
        return scatter + 2 * found.cost

    def hopped():
        local = {"method": "L-BFGS-B", "jac": True, "bounds": bounds}
        u = rng.random(free.sum())
        return basinhopping(value_and_gradient, u, HOPS, minimizer_kwargs=local, rng=rng).x

    def evolved():
        vectorized = {"vectorized": True, "updating": "deferred"}
        return differential_evolution(values, bounds, polish=False, rng=rng, **vectorized).x

    return {
        "ml_initialize, single": lambda: (
            ml_initialize(whole, array, level, T, box, likelihood, workers=1).cost
        ),
        "least_squares": lambda: [fitted(rng.random(free.sum())) for _ in range(starts)],
        "basinhopping": lambda: fitted(hopped()),
        "differential_evolution": lambda: fitted(evolved()),
    }


if __name__ == "__main__":
    main()
