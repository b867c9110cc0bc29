"""Starts, choices and runs of the filter for the evidence on the tracking example."""

from functools import cache
from itertools import product

import numpy as np

from ....estimation.extended_kalman import ekf
from ....model.motion import constant_velocity
from ....replication.documents import read_document
from .._assumed import assumed_deviation
from ..example import run_example
from ..published import reported

GATES = {"none": None, "upper": "upper", "two-sided": "two-sided"}


def starts():
    """Return the two initial estimates that the paper has, by the values of the choice `start`."""
    return {"Table 2": reported().table2.x_ml, "as drawn": reported().figure6.start}


def choices(*names):
    """Return choices of the paper by their names, as `sweep` takes them."""
    return read_document("mittermaier2016").choice(*names)


def tracked(z, array, start, P0, sigma_a=None, noise="shared", keep=()):
    """Return the track from a start at the first sample, without a gate."""
    s = reported().scenario
    F, _ = constant_velocity(s.T, s.sigma_a)
    before = np.linalg.solve(F, start[..., None])[..., 0]
    return ekf(z, array, before, P0, s.T, sigma_a or s.sigma_a, s.sigma_f, noise, keep=keep)


def example_runs(rng, names, runs, describe, keep, chunk=400):
    """Return a function that describes runs of the example for a value of each choice named.

    `names` begins with gate and start, and may go on with the raised noise. Every combination has
    a generator of its own and is run once, however often it is asked for; `describe` makes a dict
    of arrays, runs first, of a few runs at a time, so that memory does not grow with their number.
    `runs` is that number, or a dict with one for each gate.
    """
    values = list(product(*(one.values for one in choices(*names))))
    children = dict(zip(values, rng.spawn(len(values)), strict=True))

    @cache
    def described(gate, start, raised="not raised"):
        child = children[(gate, start, raised)[: len(names)]]
        number = runs if isinstance(runs, int) else runs[gate]
        parts = [
            describe(
                run_example(
                    min(chunk, number - first),
                    rng=child,
                    gate=GATES[gate],
                    start=starts()[start],
                    sigma_f=assumed_deviation(raised),
                    keep=keep,
                )
            )
            for first in range(0, number, chunk)
        ]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    return described
