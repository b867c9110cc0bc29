"""Clocks of all benchmarks, and the files that hold what they measured.

A benchmark that the book shows ends with ``save(NAME, found, packages)``, which writes
``measured/NAME.json``: what was found, and with what machine, load and versions. The chapter reads
these files and nothing else. ROUNDS=3 in the environment makes fewer rounds.
"""

import json
import os
import platform
import resource
import sys
import time
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np

from dopplerlib._files import write_text

FOLDER = Path(__file__).parent / "measured"
# What the filters are timed with: six sensors, 1001 samples.
SCENARIO = Path(__file__).parents[1] / "data" / "mittermaier2016" / "scenario.toml"
AGREEMENT = 1e-8  # of states and covariances, in SI units, before anything is timed
ROUNDS = int(os.environ.get("ROUNDS", "7"))
BEGUN = time.perf_counter(), os.getloadavg()[0]


def interleaved(title, clocks, clock=time.perf_counter, rounds=ROUNDS):
    """Return {name: seconds of a call in each round}, after one round that does not count.

    Every round times each call once, one after the other, so that a machine which is slower for a
    while slows all of them, and a ratio is taken inside its round.

    title: What the messages on standard error say.
    clocks: {name: (call, repetitions)}.
    clock: Wall time; `time.process_time` for what runs in one thread of this process.
    """
    times = {name: np.empty(rounds) for name in clocks}
    for k in range(-1, rounds):
        progress(f"{title}: " + ("warming up" if k < 0 else f"round {k + 1} of {rounds}"))
        for name, (run, repetitions) in clocks.items():
            start = clock()
            for _ in range(repetitions):
                run()
            if k >= 0:
                times[name][k] = (clock() - start) / repetitions
    return times


def processor_time():
    """Return the processor time in s of this process, and of the others that it has waited for."""
    kinds = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
    used = [resource.getrusage(kind) for kind in kinds]
    return sum(one.ru_utime + one.ru_stime for one in used)


def save(name, found, packages=("numpy", "numba")):
    """Write what the benchmark `name` found, whole or not at all.

    found: dict of numbers, texts, arrays and dicts; floats are written with six digits. Times are
        in s, a list of all rounds: the page makes medians and ratios of them.
    packages: Names of the packages whose versions matter.
    """
    content = {
        "made by": f"python benchmarks/{name}.py",
        "date": datetime.now(UTC).date().isoformat(),
        "seconds": time.perf_counter() - BEGUN[0],
        "processor": processor(),
        "processors": len(os.sched_getaffinity(0)),
        "load": [BEGUN[1], os.getloadavg()[0]],  # of a minute, at the start and at the end
        "versions": {"Python": platform.python_version()}
        | {package: version(package) for package in packages},
        "found": found,
    }
    FOLDER.mkdir(exist_ok=True)
    path = FOLDER / f"{name}.json"
    write_text(path, json.dumps(plain(content), indent=1, ensure_ascii=False) + "\n")
    progress(f"written: {path}")


def plain(value):
    """Return `value` as JSON has it, floats with six digits."""
    if isinstance(value, dict):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(one) for one in value]
    if isinstance(value, (float, np.floating)):
        return float(f"{value:.6g}")
    return value.item() if isinstance(value, np.generic) else value


def processor():
    """Return the name of the processor, as Linux has it, or its kind."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def load():
    """Return the load of the last 1, 5 and 15 minutes as text."""
    return ", ".join(f"{value:.1f}" for value in os.getloadavg())


def spread(values):
    """Return the median with least and most, to three digits, as text."""
    numbers = (np.median(values), np.min(values), np.max(values))
    middle, least, most = (np.format_float_positional(v, 3, fractional=False, trim="-")
                           for v in numbers)  # fmt: skip
    return f"{middle} ({least} to {most})"


def progress(what):
    """Tell on standard error where a benchmark is."""
    print(what, file=sys.stderr, flush=True)
