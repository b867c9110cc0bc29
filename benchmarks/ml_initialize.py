"""How often `ml_initialize` finds the global optimum, how fast, and what SciPy needs for that.

``python benchmarks/ml_initialize.py [scenarios [SciPy scenarios]]`` prints Markdown to standard
output and progress to standard error. With 1000 and 60, the defaults, it takes half an hour.

The optimum is the least cost that anybody found: `ml_initialize`; 300 refinements from random
states by the compiled Levenberg-Marquardt of the library; and, for the first scenarios, SciPy's
`least_squares` with an analytic Jacobian from 100 random states. Times are processor time, of one
thread: those of `ml_initialize` of the whole batch and its median over rounds, those of SciPy of
all its fits. How many starts SciPy needs follows from the share f of its starts that reach the
optimum, in each scenario: n starts succeed with probability 1 - (1 - f)^n.
"""

import os
import platform
import sys
import time

import numpy as np
from numba import njit
from scipy.optimize import least_squares
from scipy.stats import beta

from dopplerlib import RadarArray, doppler_shift, ml_initialize
from dopplerlib.estimation import _ml_refine
from dopplerlib.kernels import doppler as kernel

T, SAMPLES = 1e-3, 10
LINE, RING = RadarArray.linear(5, 0.4), RadarArray.ring(6, 0.2)
SPACE = np.array([[0.1, -0.75, -0.75, -2, -2, -2], [1.5, 0.75, 0.75, 2, 2, 2]])
PLANE = SPACE * [1, 1, 0, 1, 1, 0]
CASES = {
    "line of five, 2-D, static": (LINE, PLANE, "stationary"),
    "line of five, 2-D, moving": (LINE, PLANE, "constant_velocity"),
    "ring of six, static": (RING, SPACE, "stationary"),
    "ring of six, moving": (RING, SPACE, "constant_velocity"),
}
LEVELS = np.logspace(-2, 0, 5)  # standard deviations in Hz; a fifth of the scenarios each
RANDOM_STARTS = 300
SCIPY_STARTS = 100
SAME = 1e-6  # two costs (chi-square) are the same optimum if they differ by less, plus this share
SCIPY_SAME = 1e-2  # for SciPy, which stops earlier; without any weight as a statistic
ROUNDS = 7


def main():
    scenarios = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    scipy_scenarios = int(sys.argv[2]) if len(sys.argv) > 2 else 60
    print(f"{platform.processor() or platform.machine()}, Python {platform.python_version()}, ")
    print(f"load {', '.join(f'{load:.1f}' for load in os.getloadavg())} at the start.\n")
    print(
        "| | optimum found | 95 % interval | ms a solve | SciPy: ms a fit | starts for the same "
        "rate | ms | ÷ ml_initialize | SciPy, 100 starts: better / as good / worse |\n"
        "|---|---|---|---|---|---|---|---|---|"
    )
    for name, case in CASES.items():
        print(row(name, case, scenarios, scipy_scenarios), flush=True)
    print(f"\nLoad at the end: {', '.join(f'{load:.1f}' for load in os.getloadavg())}.")


def row(name, case, scenarios, scipy_scenarios):
    """Return one line of the table."""
    z, sigma_f = measurements(case, scenarios)
    cost, milliseconds = ours(z, sigma_f, case)
    best = cost.copy()
    rng = np.random.default_rng(3)
    for i in range(scenarios):
        best[i] = min(best[i], random_starts(z[i], sigma_f[i], case, rng))
        progress(f"{name}: random starts", i, scenarios)
    fits, fit_time = [], 0.0
    for i in range(scipy_scenarios):
        began = time.process_time()
        fits.append(scipy_fits(z[i], sigma_f[i], case, rng))
        fit_time += time.process_time() - began
        best[i] = min(best[i], *fits[-1])
        progress(f"{name}: SciPy", i, scipy_scenarios)
    fits = np.array(fits)
    found = cost <= best * (1 + SAME) + SAME
    count = int(found.sum())
    low = beta.ppf(0.025, count, scenarios - count + 1)
    high = beta.ppf(0.975, count + 1, scenarios - count) if count < scenarios else 1.0

    first, own = cost[:scipy_scenarios], found[:scipy_scenarios]
    share = np.mean(fits <= (best[:scipy_scenarios] * (1 + SAME) + SCIPY_SAME)[:, None], axis=1)
    per_fit = 1e3 * fit_time / fits.size
    rate = min(own.mean(), count / scenarios)
    number = starts_needed(share, rate)
    least = fits.min(axis=1)
    tie = np.abs(least - first) <= 1e-9 * first + 1e-9
    verdict = [
        int(np.sum(~tie & (least < first))),
        int(tie.sum()),
        int(np.sum(~tie & (least > first))),
    ]
    if number is None:  # not reached by any number: some optimum was never hit
        number, sign = SCIPY_STARTS, "> "
    else:
        sign = ""
    return (
        f"| {name} | {count} of {scenarios} | {100 * low:.1f} to {100 * high:.1f} % "
        f"| {milliseconds:.3f} | {per_fit:.1f} | {sign}{number} | {sign}{number * per_fit:.0f} "
        f"| {sign}{number * per_fit / milliseconds:.0f} | {' / '.join(map(str, verdict))} |"
    )


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
    """Return the costs of `ml_initialize` and its time for one solve in ms."""
    array, box, likelihood = case
    cost = np.empty(len(z))
    times = []
    for _ in range(ROUNDS + 1):
        began = time.process_time()
        for sigma in LEVELS:
            rows = sigma_f == sigma
            cost[rows] = ml_initialize(z[rows], array, sigma, T, box, likelihood, workers=1).cost
        times.append(time.process_time() - began)
    return cost, 1e3 * np.median(times[1:]) / len(z)


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


def scipy_fits(z, sigma_f, case, rng):
    """Return the costs of SciPy's fits from random states."""
    array, box, likelihood = case
    free = box[0] < box[1]
    F = np.eye(6) + np.zeros((len(z), 6, 6))
    scatter = 0.0
    if likelihood == "constant_velocity":
        F[:, :3, 3:] = (T * np.arange(len(z)))[:, None, None] * np.eye(3)
    else:
        mean = z.mean(axis=0)[None]
        scatter = np.sum((z - mean) ** 2) / sigma_f**2
        z, sigma_f, F = mean, sigma_f / np.sqrt(len(z)), F[:1]
    x = box[0].copy()
    sensors = *array.positions.T, array.doppler_per_speed

    # The printed kernels themselves: no time for checks of arguments.
    def residuals(u):
        x[free] = u
        return ((kernel.doppler_shift(*(F @ x).T[..., None], *sensors) - z) / sigma_f).ravel()

    def jacobian(u):
        x[free] = u
        _, *gradient = kernel.doppler_shift_and_gradient(*(F @ x).T[..., None], *sensors)
        return (np.stack(gradient, axis=-1) @ F / sigma_f).reshape(-1, 6)[:, free]

    bounds = box[:, free]
    return [
        scatter
        + 2 * least_squares(residuals, start, jacobian, bounds, x_scale="jac", max_nfev=1000).cost
        for start in rng.uniform(*bounds, (SCIPY_STARTS, free.sum()))
    ]


def starts_needed(share, rate):
    """Return the least number of starts that succeed as often as `rate`, or None."""
    for n in range(1, 100 * SCIPY_STARTS):
        if np.mean(1 - (1 - share) ** n) >= rate - 1e-3:
            return n
    return None


def progress(text, i, total):
    if i % 10 == 9 or i == total - 1:
        print(f"\r{text}: {i + 1} of {total}   ", end="", file=sys.stderr, flush=True)
        if i == total - 1:
            print(file=sys.stderr)


if __name__ == "__main__":
    main()
