"""How the time of a filter grows with runs, steps and sensors, and that of the start with runs.

``make bench NAME=growth`` writes what the chapter on benchmarks shows, in a minute. Processor time
of one thread. A call has a constant cost, the time of the smallest: one run of one step, or one
run. The exponent is fitted by least squares to the logarithms of sizes and of median times less the
constant cost, where the times are at least ten times as large; its interval is Student's, from the
scatter about the line.
"""

import time
from dataclasses import replace

import numpy as np
from measuring import SCENARIO, interleaved, save
from scipy.stats import linregress, t

from dopplerlib import RadarArray, Scenario, ekf, ml_initialize, simulate

RUNS = 1, 16, 48, 160, 480, 1600, 4800, 10_000  # sixteen go side by side: others make stairs
STEPS = 1, 10, 30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000
SENSORS = 3, 4, 6, 8, 12, 16, 24, 32, 48
STARTS = 1, 3, 10, 30, 100, 300, 1000, 3000
BOX = np.array([[0.1, -0.75, -0.75, -2, -2, -2], [1.5, 0.75, 0.75, 2, 2, 2]])
COUNTS = 10  # times the constant cost
SHORTEST = 2e-3  # s that a clock runs at least


def main():
    calls = {
        "runs of 100 steps": {n: filtered(n, 100, 6) for n in RUNS},
        "steps of one run": {n: filtered(1, n, 6) for n in STEPS},
        "sensors in 10 000 steps": {n: filtered(1, 10_000, n) for n in SENSORS},
        "runs of ml_initialize": {n: started(n) for n in STARTS},
    }
    one_step = clocked("one step", {1: filtered(1, 1, 6)})[0]
    found = {}
    for name, by_size in calls.items():
        seconds = clocked(name, by_size)
        constant = np.median(seconds[0] if "ml_initialize" in name else one_step)
        found[name] = {"sizes": list(by_size), "s": seconds} | exponent(
            list(by_size), np.median(seconds, axis=1), constant
        )
    save("growth", found, packages=("numpy", "numba"))


def clocked(title, calls):
    """Return the times (sizes, rounds) of calls by their size."""
    clocks = {}
    for size, call in calls.items():
        call()
        began = time.process_time()
        call()
        once = max(time.process_time() - began, 1e-6)
        clocks[size] = call, int(np.ceil(SHORTEST / once))
    return np.array(list(interleaved(title, clocks, time.process_time).values()))


def exponent(sizes, seconds, constant):
    """Return the exponent of the growth with its 95 % interval, and what it was fitted to."""
    used = seconds >= COUNTS * constant
    x, y = np.log(np.asarray(sizes)[used]), np.log(seconds[used] - constant)
    line = linregress(x, y)
    half = t.ppf(0.975, len(x) - 2) * line.stderr
    return {
        "constant": constant,
        "used": used,
        "exponent": [line.slope, line.slope - half, line.slope + half],
        "seconds at size one": np.exp(line.intercept),
    }


def records(runs, steps, sensors):
    """Return the scenario of a second with so many steps and sensors, and its measurements."""
    array = RadarArray.ring(sensors, 0.2)
    scenario = replace(Scenario.from_toml(SCENARIO), array=array, T=1 / steps, samples=steps)
    return scenario, simulate(scenario, runs, rng=np.random.default_rng(1))[1]


def filtered(runs, steps, sensors):
    s, z = records(runs, steps, sensors)
    z = z if runs > 1 else z[0]
    return lambda: ekf(z, s.array, s.x0, s.P0 / 100, s.T, s.sigma_a, s.sigma_f, keep=(), workers=1)


def started(runs):
    s, z = records(runs, 1000, 6)
    z = z[:, :10]
    return lambda: ml_initialize(z, s.array, s.sigma_f, s.T, BOX, "constant_velocity", workers=1)


if __name__ == "__main__":
    main()
