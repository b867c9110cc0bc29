"""The filter beside its peers: one run and a thousand, after all of them were shown to agree.

``make bench NAME=ekf`` writes ``measured/ekf.json``, which the book shows: three minutes. All run
in this process, on one thread, with the same measurements, start, F, Q and R.
"""

import os
import subprocess
import sys
import tempfile
import time
from functools import partial

import numpy as np
import peers
import peers_c
import peers_jax
from measuring import (
    AGREEMENT,
    ROUNDS,
    SCENARIO,
    interleaved,
    processor_time,
    progress,
    save,
)

from dopplerlib import Scenario, constant_velocity, ekf, simulate
from dopplerlib.model.motion import dwna_gain

RUNS = 63 * peers_c.LANES
FEW = 2  # runs of those that filter one after the other; their time is multiplied
EVERYTHING = "P", "innovation", "S"
INEXACT = "Stone Soup, numerical"
PACKAGES = "numpy numba sympy filterpy stonesoup dynamax cuthbert jax jaxlib".split()

FIRST_CALLS = """
import sys, time
import numpy as np
from dopplerlib import Scenario, ekf, simulate
s = Scenario.from_toml(sys.argv[1])
z = simulate(s, 16, rng=np.random.default_rng(1))[1]
for records in (z[0], z):
    start = time.process_time()
    ekf(records, s.array, s.x0, s.P0, s.T, s.sigma_a, s.sigma_f)
    print(time.process_time() - start)
"""


def main():
    """Measure, and write what was measured."""
    scenario = Scenario.from_toml(SCENARIO)
    rng = np.random.default_rng(2016)
    # A start as the maximum likelihood gives it: P0 itself would put some targets behind the ring.
    x0 = scenario.x0 + rng.multivariate_normal(np.zeros(6), scenario.P0 / 100)
    z = np.ascontiguousarray(simulate(scenario, RUNS, rng=rng)[1])
    track = ours(scenario, x0, ("P",))(z)
    expected = {"x": track.x, "P": track.P, "NIS": track.nis}
    first = {name: values[0] for name, values in expected.items()}
    found = {
        "samples": z.shape[1],
        "runs": RUNS,
        "agreement": AGREEMENT,
        "first calls": first_calls(),
        "one run": measured("one run", one_run(scenario, x0), z[0], first, ROUNDS),
        "many runs": measured("many runs", many_runs(scenario, x0), z, expected, min(ROUNDS, 5)),
    }
    for runs in found["first calls"]["cached"]:
        for name, row in found[runs].items():
            if name.startswith("dopplerlib"):  # here compiled, or loaded, before
                row["start"] = found["first calls"]["nothing cached"][runs]
    found["gcc"] = peers_c.gcc_version()
    save("ekf", found, PACKAGES)


def ours(s, x0, kept):
    """Return dopplerlib's filter."""
    setting = s.array, x0, s.P0, s.T, s.sigma_a, s.sigma_f
    return lambda z: ekf(z, *setting, keep=kept, workers=1)


def one_run(scenario, x0):
    """Return {name: (maker of a filter of one record, its repetitions in a round)}."""
    c = peers_c.Filters(scenario, x0, 1)
    return {
        "dopplerlib, x and NIS": (partial(ours, scenario, x0, ()), 20),
        "dopplerlib, x and P": (partial(ours, scenario, x0, ("P",)), 20),
        "dopplerlib, everything": (partial(ours, scenario, x0, EVERYTHING), 20),
        **{name: (lambda name=name: first_record(c.in_c(name)), 20) for name in peers_c.OPTIONS},
        **{name: (maker, 3) for name, maker in on_jax(scenario, x0).items()},
        **{name: (maker, 1) for name, maker in in_python(scenario, x0).items()},
    }


def many_runs(scenario, x0):
    """Return the same for many records."""
    c = peers_c.Filters(scenario, x0, peers_c.LANES)
    return {
        "dopplerlib, x and NIS": (partial(ours, scenario, x0, ()), 1),
        "dopplerlib, x and P": (partial(ours, scenario, x0, ("P",)), 1),
        "dopplerlib, everything": (partial(ours, scenario, x0, EVERYTHING), 1),
        **{name: (partial(c.in_c, name), 1) for name in peers_c.OPTIONS},
        **{name: (maker, 1) for name, maker in on_jax(scenario, x0).items()},
        "NumPy, all at once": (lambda: peers.stacked(*arguments(scenario, x0)), 1),
        **{
            name: (partial(one_by_one, maker), 1) for name, maker in in_python(scenario, x0).items()
        },
    }


def in_python(scenario, x0):
    """Return {name: maker of a filter of one record} of those that Python steps through."""
    given = arguments(scenario, x0)
    return {
        "NumPy": lambda: peers.textbook(*given),
        "NumPy, lambdify": lambda: peers.lambdified(*given),
        "FilterPy": lambda: peers.filterpy(*given),
        "Stone Soup": lambda: peers.stonesoup(*given, scenario.T),
        INEXACT: lambda: peers.stonesoup_numerical(*given, scenario.T),
    }


def on_jax(scenario, x0):
    """Return {name: maker of a filter of one record or many} of the libraries on JAX."""
    array, x0, P0, F, Q, R = arguments(scenario, x0)
    G, sigma = dwna_gain(np.array([scenario.T]), scenario.sigma_a, "shared")
    return {
        "dynamax": lambda: peers_jax.dynamax(array, x0, P0, F, Q, R),
        "cuthbert": lambda: peers_jax.cuthbert(array, x0, P0, F, sigma * G[0], R),
    }


def arguments(scenario, x0):
    """Return array, start, F, Q and R: what a filter of the others is made of."""
    F, Q = constant_velocity(scenario.T, scenario.sigma_a)
    R = scenario.sigma_f**2 * np.eye(len(scenario.array))
    return scenario.array, x0, scenario.P0, F, Q, R


def first_record(many):
    """Return the filter of one record, of one that takes many."""
    return lambda z: [values[0] for values in many(z[None])]


def one_by_one(maker):
    """Return the filter of a few records, one after the other, of one that takes one."""
    one = maker()

    def run(records):
        return [np.stack(values) for values in zip(*map(one, records), strict=True)]

    run.prepare = lambda z: [prepared(one, record) for record in z[:FEW]]
    return run


def prepared(run, z):
    """Return `z` in the form that the filter `run` wants."""
    return run.prepare(z) if hasattr(run, "prepare") else z


def measured(title, makers, z, expected, rounds):
    """Return {name: start, difference, compared, beyond, seconds} of the filters.

    The start is what the first call costs beside a later one, making and compiling with it, in s;
    the others are s a step and run, one for each round. All is processor time.

    Stop before anything is timed if one does not agree with what is expected in most runs.
    """
    clocks, rows, steps = {}, {}, {}
    for name, (maker, repetitions) in makers.items():
        progress(f"{title}: agreement of {name}")
        begun = processor_time()
        run = maker()
        data = prepared(run, z)
        found = run(data)
        first = processor_time() - begun
        if hasattr(found, "nis"):
            found = found.x, (found.nis if found.P is None else found.P)
        rows[name] = {"start": first} | compared(name, found, expected)
        steps[name] = found[0].size // 6
        clocks[name] = (lambda run=run, data=data: run(data)), repetitions
    # One thread each: processor time is wall time without the waiting for other programs.
    times = interleaved(title, clocks, time.process_time, rounds)
    for name, seconds in times.items():
        rows[name]["start"] = max(rows[name]["start"] - np.median(seconds), 0.0)
        rows[name]["seconds"] = seconds / steps[name]
    return rows


def compared(name, found, expected):
    """Return the largest differences of a filter, and in how many runs they are large.

    Rounding grows in a few runs, with some updates. These are counted, and the median run has to
    agree.
    """
    found = dict(zip(("x", "P" if found[1].ndim > found[0].ndim else "NIS"), found, strict=True))
    runs = found["x"].size // expected["x"].shape[-2] // 6
    difference = {
        kept: np.abs(values - expected[kept][tuple(map(slice, values.shape))])
        .reshape(runs, -1)
        .max(-1)
        for kept, values in found.items()
    }
    largest = np.maximum(difference["x"], difference.get("P", 0.0))
    if name != INEXACT and not np.median(largest) < AGREEMENT:
        sys.exit(f"{name} differs by {np.median(largest):.1e}, more than {AGREEMENT:.0e}")
    return {
        "difference": {kept: values.max() for kept, values in difference.items()},
        "compared": runs,
        "beyond": np.count_nonzero(largest >= AGREEMENT),
    }


def first_calls():
    """Return the times in s of the first calls in a fresh process: of one record, and of many."""
    with tempfile.TemporaryDirectory() as cache:
        environment = os.environ | {"NUMBA_CACHE_DIR": cache}
        command = [sys.executable, "-c", FIRST_CALLS, str(SCENARIO)]
        found = {}
        for state in ("nothing cached", "cached"):
            progress(f"first calls in a fresh process, {state}")
            output = subprocess.run(
                command, env=environment, check=True, capture_output=True, text=True
            ).stdout
            found[state] = dict(
                zip(("one run", "many runs"), map(float, output.split()), strict=True)
            )
    return found


if __name__ == "__main__":
    main()
