"""Memory that a filter takes beside its results, for one run and for a thousand.

``make bench NAME=memory`` writes what the chapter on benchmarks shows, in half a minute. Each case
has a process of its own, which filters a few samples first, so that code is compiled and loaded.
Then two calls: the first by what Linux calls resident, at the most above that before; the second
by what Python and NumPy allocate, which is exact for a small one.
"""

import json
import subprocess
import sys
import tracemalloc
from functools import partial
from pathlib import Path

import numpy as np
import peers
from measuring import SCENARIO, progress, save

from dopplerlib import Scenario, constant_velocity, ekf, simulate

EVERYTHING = ("P", "innovation", "S")
RUNS = {"one run": 1, "a thousand runs": 1000}
KEPT = {"dopplerlib, x and NIS": (), "dopplerlib, everything": EVERYTHING}


def main():
    if sys.argv[1:]:
        print(json.dumps(measured(*sys.argv[1:])))
        return
    found = {}
    for size in RUNS:
        for filters in KEPT if size != "one run" else (*KEPT, "FilterPy", "Stone Soup"):
            progress(f"{size}, {filters}")
            command = [sys.executable, __file__, size, filters]
            found.setdefault(size, {})[filters] = json.loads(
                subprocess.run(command, check=True, capture_output=True).stdout
            )
    save("memory", found, packages=("numpy", "numba", "filterpy", "stonesoup"))


def measured(size, filters):
    """Return the steps of all runs, and bytes: of measurements, results, and a call at its most."""
    runs = RUNS[size]
    scenario = Scenario.from_toml(SCENARIO)
    run, prepared = filter_of(filters, scenario)
    z = simulate(scenario, runs, rng=np.random.default_rng(1))[1]
    few = z[:8, :20].copy()
    for records in (few, few[0]):
        run(prepared(records if filters in KEPT else few[0]))
    data = prepared(z if runs > 1 else z[0])
    before = resident("VmRSS", reset=True)
    results = run(data)
    resident_most = resident("VmHWM") - before
    sizes = [array.nbytes for array in results if array is not None]
    del results
    tracemalloc.start()
    run(data)
    return {
        "steps": runs * scenario.samples,
        "measurements": z.nbytes,
        "results": sum(sizes),
        "resident": resident_most,
        "allocated": tracemalloc.get_traced_memory()[1],
    }


def filter_of(name, scenario):
    """Return a function that filters, and one that makes of measurements what it wants."""
    s = scenario
    if name in KEPT:
        call = partial(ekf, array=s.array, x0=s.x0, P0=s.P0, T=s.T, sigma_a=s.sigma_a,
                       sigma_f=s.sigma_f, keep=KEPT[name], workers=1)  # fmt: skip
        return lambda z: vars(call(z)).values(), lambda z: z
    F, Q = constant_velocity(s.T, s.sigma_a)
    arguments = s.array, s.x0, s.P0, F, Q, s.sigma_f**2 * np.eye(len(s.array))
    if name == "FilterPy":
        return peers.filterpy(*arguments), lambda z: z
    run = peers.stonesoup(*arguments, s.T)
    return run, run.prepare


def resident(which, reset=False):
    """Return resident memory of this process in bytes: VmRSS now, VmHWM the most since `reset`."""
    if reset:
        Path("/proc/self/clear_refs").write_text("5")
    status = Path("/proc/self/status").read_text()
    return 1024 * int(status.partition(f"{which}:")[2].split()[0])


if __name__ == "__main__":
    main()
