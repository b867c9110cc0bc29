"""Velocity errors of filters and smoothers of several motion models, each over its constants.

Half a minute on one processor. 60 records of each of four paths, the same ones for all competitors.
"""

import json

import numpy as np

from dopplerlib.systems.macaveiu2013 import model_errors

FILES = (".json",)
PARAMETERS = {"seed": 20, "runs": 60}


def items():
    """Return the one part: all competitors see the same records."""
    return [PARAMETERS["runs"]]


def rows(items):
    """Yield the errors of all runs by case and competitor, in m/s."""
    for runs in items:
        found = model_errors(runs, rng=np.random.default_rng(PARAMETERS["seed"]))
        yield {
            case: {name: error.round(5).tolist() for name, error in row.items()}
            for case, row in found.items()
        }


def contents(rows):
    """Return the errors, a line for each competitor of each case."""
    (found,) = rows
    cases = []
    for case, row in found.items():
        lines = (f'  "{name}": {json.dumps(errors)}' for name, errors in row.items())
        cases.append(f' "{case}": {{\n' + ",\n".join(lines) + "\n }")
    return ["{\n" + ",\n".join(cases) + "\n}\n"]
