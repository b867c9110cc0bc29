"""Layouts of 4 to 8 sensors with the smallest bound, and with few second valleys below a bound.

Ten minutes on one processor. In the disc of the paper's ring, and in the cylinder 5 cm behind it.
"""

from itertools import product

import numpy as np

from dopplerlib.workspace._layout_search import fewest_twins, smallest_bound
from dopplerlib.workspace.layouts import layout_quality
from dopplerlib.workspace.targets import INTERVAL, draw_targets
from studies._rows import by_kind, rows, texts

FILES = (".json",)
PARAMETERS = {
    "seed": 2016,
    "bound_targets": 100,  # of the search for the smallest bound
    "targets": 400,  # of the search for few second valleys
    "depths": [0.0, 0.05],
    # Fronts: sensors, depth in m, limit of the bound over the smallest one, and generations.
    "fronts": [
        [6, 0.0, 1.1, 60], [6, 0.0, 1.3, 60], [6, 0.0, 1.6, 60], [6, 0.0, 2.2, 60],
        [6, 0.05, 1.1, 60],
    ],
}  # fmt: skip


def parts():
    """Return the one part, of which each run is a search."""
    return [({}, len(items()), 1)]


def items():
    """Return kind, number of sensors, depth of the room, and static or limit and generations."""
    bounds = product(["bound"], range(4, 9), PARAMETERS["depths"], [True, False])
    return [*bounds, *(("front", *front) for front in PARAMETERS["fronts"])]


def targets(name):
    """Return states at time zero (R, 6) of one kind of search, drawn from a seed of its own."""
    rng = np.random.default_rng([PARAMETERS["seed"], name == "targets"])
    x = draw_targets(PARAMETERS[name], rng=rng, sigma_a=0.0, samples=1)[:, 0]
    return x - INTERVAL * np.pad(x[:, 3:], ((0, 0), (0, 3)))


def compute(settings, seed, runs):
    """Return what some searches have found."""
    work = items()
    return texts(row(*work[run]) for run in runs)


def row(kind, n, depth, how, *generations):
    """Return the layout that a search has found, in millimeters, and how well."""
    few, many = targets("bound_targets"), targets("targets")
    rng = np.random.default_rng([PARAMETERS["seed"], n, round(1e3 * depth)])
    one = {"kind": kind, "n": n, "depth": depth}
    if kind == "bound":
        samples = 10 if how else 100
        found = smallest_bound(n, few, samples, rng=rng, static=how, depth=depth)
        one |= {"static": how, "bound": round(found.bound, 6)}
        one |= {"global": found.global_rate, "local": found.local_rate}
    else:
        start = smallest_bound(n, few, rng=rng, depth=depth, searches=1, starts=2).array
        limit = how * float(np.exp(np.log(layout_quality(many, start).moving).mean()))
        found = fewest_twins(start, many, limit, rng=rng, depth=depth, generations=generations[0])
        one |= {"limit": how, "bound": round(found.bound, 6)}
        one |= {"probability": round(found.probability, 6)}
    return one | {"sensors": np.rint(1e3 * found.array.positions).astype(int).tolist()}


def contents(found):
    """Return all rows by their kind, a line for each."""
    return [by_kind(rows(*found))]
