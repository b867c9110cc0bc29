"""Time of one EKF step, as ratios against other libraries, after they were shown to agree.

``make bench`` prints Markdown to standard output and progress to standard error. Rounds are
interleaved: every round times every filter once, and a ratio is taken inside its round, so that
a machine which is slower for a while slows both sides of it.
"""

import os
import platform
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np
import peers
from measuring import ROUNDS, interleaved, load, progress, spread

from dopplerlib import Scenario, constant_velocity, ekf, simulate

SCENARIO = Path(__file__).parents[1] / "data" / "mittermaier2016" / "scenario.toml"
RUNS = 1_000
MANY_RUNS = 10_000
AGREEMENT = 1e-8
EVERYTHING = ("P", "innovation", "S")

FIRST_CALLS = """
import sys, time
start = time.perf_counter()
from dopplerlib import Scenario, ekf, simulate
import numpy as np
s = Scenario.from_toml(sys.argv[1])
z = simulate(s, 16, rng=np.random.default_rng(1))[1]
ekf(z[0], s.array, s.x0, s.P0, s.T, s.sigma_a, s.sigma_f)
ekf(z, s.array, s.x0, s.P0, s.T, s.sigma_a, s.sigma_f)
print(time.perf_counter() - start)
"""


def main():
    print(f"{machine()}\n")
    progress("first calls in a fresh process")
    print(first_calls(), "\n")

    scenario = Scenario.from_toml(SCENARIO)
    rng = np.random.default_rng(2016)
    # A start as the maximum likelihood gives it: P0 itself would put some targets behind the ring.
    x0 = scenario.x0 + rng.multivariate_normal(np.zeros(6), scenario.P0 / 100)
    ours, others = filters(scenario, x0)
    _, z = simulate(scenario, RUNS, rng=rng)
    compare(z[0], ours(z[0]), others)
    one_run(z[0], ours, others)
    many_runs(z, ours, others)
    progress(f"{MANY_RUNS} runs")
    ten_thousand(scenario, ours, rng)

    # The same second, sampled ten times as often: what a call costs once no longer counts.
    longer = replace(scenario, T=scenario.T / 10, samples=10 * scenario.samples)
    ours, others = filters(longer, x0)
    del others["Stone Soup, its numerical Jacobian"]
    z = simulate(longer, 1, rng=rng)[1][0]
    compare(z, ours(z), others)
    one_run(z, ours, others)
    print(f"Load of the machine (1, 5, 15 minutes) at the end: {load()}.")


def filters(scenario, x0):
    """Return dopplerlib's filter and {name: filter} of the others, all with the same settings."""

    def ours(z, **options):
        return ekf(
            z, scenario.array, x0, scenario.P0, scenario.T, scenario.sigma_a, scenario.sigma_f,
            **options,
        )  # fmt: skip

    F, Q = constant_velocity(scenario.T, scenario.sigma_a)
    R = scenario.sigma_f**2 * np.eye(len(scenario.array))
    arguments = scenario.array, x0, scenario.P0, F, Q, R
    return ours, {
        "NumPy, as in a textbook": peers.textbook(*arguments),
        "FilterPy": peers.filterpy(*arguments),
        "Stone Soup": peers.stonesoup(*arguments, scenario.T),
        "Stone Soup, its numerical Jacobian": peers.stonesoup_numerical(*arguments, scenario.T),
    }


def compare(z, track, others):
    """Print the largest differences from `track`; stop if an exact filter does not agree."""
    print(f"Largest difference from dopplerlib over {len(z)} samples:\n")
    print("| | state (m, m/s) | covariance |\n|---|---|---|")
    for name, run in others.items():
        progress(f"agreement of {name}")
        x, P = run(prepared(run, z))
        difference = np.abs(x - track.x).max(), np.abs(P - track.P).max()
        print("| {} | {:.0e} | {:.0e} |".format(name, *difference))
        if "numerical" not in name and not max(difference) < AGREEMENT:
            sys.exit(f"{name} differs by {max(difference):.1e}, more than {AGREEMENT:.0e}")
    print()


def one_run(z, ours, others):
    """Print the time of a step for one run, and the ratios."""
    kept = {"x and NIS": (), "everything": EVERYTHING}
    clocks = {
        f"dopplerlib, {what}": (lambda keep=keep: ours(z, keep=keep, workers=1), 50)
        for what, keep in kept.items()
    }
    for name, run in others.items():
        data = prepared(run, z)
        clocks[name] = (lambda run=run, data=data: run(data), 1)
    # One thread each: processor time is wall time without the waiting for other programs.
    times = interleaved("one run", clocks, time.process_time)
    print(
        f"One run of {len(z)} steps; median (least to most) of {ROUNDS} rounds, processor time:\n"
    )
    print("| | µs a step | ÷ dopplerlib, x and NIS | ÷ dopplerlib, everything |")
    print("|---|---|---|---|")
    for name, seconds in times.items():
        ratios = [spread(seconds / times[f"dopplerlib, {what}"]) for what in kept]
        print(f"| {name} | {spread(seconds / len(z) * 1e6)} | {' | '.join(ratios)} |")
    print()


def many_runs(z, ours, others):
    """Print the time of many runs together, and the ratios to the others' one by one."""
    settings = {
        f"{what}, {workers} worker{'s' * (workers > 1)}": {"keep": keep, "workers": workers}
        for what, keep in {"x and NIS": (), "everything": EVERYTHING}.items()
        for workers in (1, 2)
    }
    clocks = {
        name: (lambda options=options: ours(z, **options), 1) for name, options in settings.items()
    }
    counts = dict.fromkeys(others, 2) | {"Stone Soup, its numerical Jacobian": 1}
    for name, run in others.items():
        data = [prepared(run, record) for record in z[: counts[name]]]
        clocks[name] = (lambda run=run, data=data: [run(record) for record in data], 1)
    times = interleaved(f"{len(z)} runs", clocks)
    for name, count in counts.items():
        times[name] *= len(z) / count
    print(f"{len(z)} runs of {z.shape[1]} steps; dopplerlib filters them together, the others are")
    print("timed on one or two runs, one after the other, and the time is multiplied:\n")
    print("| | s | ns a step and run |\n|---|---|---|")
    for name in settings:
        per_step = times[name] / len(z) / z.shape[1] * 1e9
        print(f"| dopplerlib, {name} | {spread(times[name])} | {spread(per_step)} |")
    print(f"\n| | s | {' | '.join(f'÷ {name}' for name in settings)} |")
    print("|---|---|" + "---|" * len(settings))
    for name in others:
        ratios = " | ".join(spread(times[name] / times[setting]) for setting in settings)
        print(f"| {name} | {spread(times[name])} | {ratios} |")
    print()


def ten_thousand(scenario, ours, rng):
    """Print the wall time of ten thousand runs, once for each number of workers."""
    _, z = simulate(scenario, MANY_RUNS, rng=rng)
    for workers in (1, 2):
        start = time.perf_counter()
        ours(z, keep=(), workers=workers)
        seconds = time.perf_counter() - start
        print(f"{MANY_RUNS} runs, x and NIS, workers={workers}: {seconds:.2f} s.", end=" ")
    print("\n")


def first_calls():
    """Return a line on what a fresh process pays before its first result."""
    with tempfile.TemporaryDirectory() as cache:
        environment = os.environ | {"NUMBA_CACHE_DIR": cache}
        command = [sys.executable, "-c", FIRST_CALLS, str(SCENARIO)]
        cold, cached = (
            float(subprocess.run(command, env=environment, check=True, capture_output=True).stdout)
            for _ in range(2)
        )
    return (
        "Import and first calls in a fresh process (one run and 16 runs, two compilations; not in "
        f"the times below): {cold:.1f} s with nothing cached, {cached:.1f} s with numba's cache."
    )


def machine():
    """Return a line on what the times were taken with."""
    packages = ("numpy", "numba", "filterpy", "stonesoup")
    versions = ", ".join(f"{name} {version(name)}" for name in packages)
    return (
        f"Python {platform.python_version()}, {versions}; {platform.machine()}, "
        f"{os.cpu_count()} processors, OMP_NUM_THREADS={os.environ.get('OMP_NUM_THREADS')}, "
        f"load at the start {load()}."
    )


def prepared(run, z):
    """Return `z` in the form that the filter `run` wants."""
    return run.prepare(z) if hasattr(run, "prepare") else z


if __name__ == "__main__":
    main()
