"""How near the filter is to what the arithmetic of this processor allows.

``make bench NAME=limit`` writes ``measured/limit.json``, which the book shows: half a minute.
Bounds of a step are measured in the same rounds as the filters:

* latency: results wait for each other. The printed formulas run on numbers that know when they are
  ready, with the measured latency of each operation, as if there were any number of units;
* throughput: the operations of a step at the rate of independent ones, alone or in vectors;
* memory: what a step reads and writes, at the rate of a copy into new memory.

A square root counts as a division, which is no slower. Nothing is fused, or the bits would differ.
"""

import ctypes
import time
from functools import partial
from typing import ClassVar

import numpy as np
import peers_c
from measuring import SCENARIO, interleaved, save

from dopplerlib import Scenario, ekf, simulate
from dopplerlib.derive import ekf as derive
from dopplerlib.derive.operations import KINDS, count_operations
from dopplerlib.derive.printers import python_function

RUNS = 63 * peers_c.LANES
CHAINS, TIMES, STEPS = 12, 2_000_000, 40
FACTOR = 1.0 + 1e-9
WRITTEN = 8 * (6 + 1) + 1  # bytes of a step and run: x, NIS, whether there was an update
EXPRESSIONS = {
    "addition": "c[i] + b",
    "multiplication": "c[i] * b",
    "division": "b / c[i]",
    "multiplication and addition": "c[i] * b + b",
}
# One chain waits for its last result; many keep all units busy. Vectors are those of the processor.
TEXT = """
#if {alone}
typedef double number;
#elif defined __AVX512F__
typedef double number __attribute__((vector_size(64)));
#elif defined __AVX__
typedef double number __attribute__((vector_size(32)));
#else
typedef double number __attribute__((vector_size(16)));
#endif
int lanes(void) {{ return sizeof(number) / sizeof(double); }}
void run(long times, double factor, double *out)
{{
    number c[{chains}], b = (number){{0}} + factor;
    for (int i = 0; i < {chains}; i++) c[i] = b + i;
    for (long k = 0; k < times; k++)
        for (int i = 0; i < {chains}; i++) c[i] = {expression};
    for (int i = 0; i < {chains}; i++) ((number *)out)[i] = c[i];
}}
"""


class Ready:
    """A number of which only the time is known at which it is ready."""

    latency: ClassVar = {}  # in s, by kind

    def __init__(self, at=0.0):
        self.at = at

    def after(self, kind, *others):
        times = [other.at if isinstance(other, Ready) else 0.0 for other in others]
        return Ready(max(self.at, *times) + self.latency[kind])

    def __neg__(self):
        return self

    def __add__(self, other):
        return self.after("addition", other)

    def __mul__(self, other):
        return self.after("multiplication", other)

    def __truediv__(self, other):
        return self.after("division", other)

    __radd__ = __sub__ = __rsub__ = __add__
    __rmul__, __rtruediv__ = __mul__, __truediv__


def main():
    """Measure, and write what was measured."""
    scenario = Scenario.from_toml(SCENARIO)
    sensors = len(scenario.array)
    tasks = filters(scenario)
    for kind in EXPRESSIONS:
        tasks["latency", kind] = chains(kind, 1, alone=True)
        tasks["one at a time", kind] = chains(kind, CHAINS, alone=True)
        tasks["in vectors", kind] = chains(kind, CHAINS, alone=False)
    clocks = {key: (run, repetitions) for key, (run, repetitions, _) in tasks.items()}
    times = interleaved("filters and operations", clocks, time.process_time)
    found = {"sensors": sensors, "operations": operations_of_a_step(sensors)}
    for (group, name), seconds in times.items():
        found.setdefault(group, {})[name] = seconds / tasks[group, name][2]
    bounds = {
        "one run": {"bound by latency": waiting(found["latency"], sensors)}
        | throughput(found["operations"], found["one at a time"]),
        "many runs": throughput(found["operations"], found["in vectors"]),
    }
    found |= {runs: bound | found[runs] for runs, bound in bounds.items()}
    save("limit", found, ("numpy", "numba", "sympy"))


def filters(s):
    """Return {(kind, name): (call, its repetitions in a round, steps that it filters)}."""
    z = np.ascontiguousarray(simulate(s, RUNS, rng=np.random.default_rng(2016))[1])
    sensors, tasks = z.shape[-1], {}
    setting = s.array, s.x0, s.P0, s.T, s.sigma_a, s.sigma_f
    for kind, records, lanes, repetitions in (
        ("one run", z[:1], 1, 20),
        ("many runs", z, peers_c.LANES, 1),
    ):
        peer = peers_c.Filters(s, s.x0, lanes)
        steps = records.size // sensors
        # A copy reads z and writes it; a step reads z and writes its results.
        copied = steps * 2 / (1 + WRITTEN / (8 * sensors))
        own = records[0] if kind == "one run" else records
        for name, run, argument, done in (
            ("bound by memory", np.copy, records, copied),
            ("C", peer.in_c("C"), records, steps),
            ("dopplerlib, its loop alone", peer.loop, records, steps),
            ("dopplerlib", lambda z: ekf(z, *setting, keep=(), workers=1), own, steps),
        ):
            tasks[kind, name] = partial(run, argument), repetitions, done
    return tasks


def chains(kind, count, *, alone):
    """Return a function that does operations in `count` chains, 1, and how many in a call."""
    text = TEXT.format(alone=int(alone), chains=count, expression=EXPRESSIONS[kind])
    options = ["-O3", "-ffp-contract=off", "-march=native", *["-fno-tree-vectorize"] * alone]
    library = peers_c.built(text, options)
    lanes = library.lanes()
    room = np.zeros(count * lanes + 8)
    place = room[-room.ctypes.data % 64 // 8 :]  # aligned as the widest vectors have to be

    def run():
        library.run(
            ctypes.c_long(TIMES), ctypes.c_double(FACTOR), ctypes.c_void_p(place.ctypes.data)
        )

    return run, 1, TIMES * count * lanes


def operations_of_a_step(sensors):
    """Return the number of operations by kind."""
    total = dict.fromkeys(KINDS, 0)
    for name in peers_c.USED:
        times = sensors if name in ("linearize", "update") else 1
        for kind, number in count_operations(peers_c.BLOCKS[name]).items():
            total[kind] += times * number
    total["additions"] += len(derive.CORRECTION)  # to the predicted state
    return total


def throughput(count, seconds):
    """Return the least times of a step in each round, if nothing waits for another's result."""
    both = (count["additions"] + count["multiplications"]) / 2
    slow = count["divisions"] + count["square roots"]
    return {
        "bound by sums and products": both * seconds["multiplication and addition"],
        "bound by divisions": slow * seconds["division"],
    }


def waiting(latency, sensors):
    """Return the time from one step to the next in each round, if only results are waited for."""
    programs = {}
    for name in peers_c.USED:
        exec(python_function(peers_c.BLOCKS[name]), {"sqrt": lambda x: x / x}, programs)
    found = np.empty(len(latency["addition"]))
    for k in range(len(found)):
        Ready.latency = {kind: seconds[k] for kind, seconds in latency.items()}
        known = {symbol.name: Ready() for name in peers_c.USED
                 for symbol in peers_c.BLOCKS[name].inputs}  # fmt: skip
        at = []
        for _ in range(STEPS):
            step(programs, known, sensors)
            at.append(max(value.at for value in known.values()))
        half = STEPS // 2
        found[k] = (at[-1] - at[-1 - half]) / half
    return found


def step(programs, known, sensors):
    """Let the programs of one step tell when their results are ready."""
    known |= {symbol.name: Ready() for symbol in (*derive.CORRECTION, derive.NIS)}

    def call(name):
        block = peers_c.BLOCKS[name]
        results = programs[name](*(known[symbol.name] for symbol in block.inputs))
        names = (symbol.name.removesuffix("_new") for symbol in block.outputs)
        return dict(zip(names, results, strict=True))

    known |= call("predict")
    known |= call("add_noise")
    linearized = call("linearize")  # of each sensor at the same time
    for _ in range(sensors):
        known |= linearized
        known |= call("update")
    known |= {
        x.name: known[x.name] + known[c.name]
        for x, c in zip(derive.STATE, derive.CORRECTION, strict=True)
    }


if __name__ == "__main__":
    main()
