"""Velocity errors of filters and smoothers of several motion models, each over its constants.

Half a minute on one processor. 60 records of each of four paths, the same ones for all competitors.
"""

import json

import numpy as np

from dopplerlib.systems.macaveiu2013 import model_errors

FILES = (".json",)
PARAMETERS = {"seed": 20, "runs": 60}


def parts():
    """Return the one part, in one chunk: all competitors see the same records."""
    return [({}, PARAMETERS["runs"], PARAMETERS["runs"])]


def compute(settings, seed, runs):
    """Return the errors of some runs by case and competitor, in m/s."""
    found = model_errors(runs.stop, rng=np.random.default_rng(seed))
    return {
        f"{case}: {name}": error[runs.start :]
        for case, row in found.items()
        for name, error in row.items()
    }


def contents(found):
    """Return the errors, a line for each competitor of each case."""
    table = {}
    for title, errors in found[0].items():
        case, _, name = title.partition(": ")
        table.setdefault(case, {})[name] = errors.round(5).tolist()
    cases = []
    for case, row in table.items():
        lines = (f'  "{name}": {json.dumps(errors)}' for name, errors in row.items())
        cases.append(f' "{case}": {{\n' + ",\n".join(lines) + "\n }")
    return ["{\n" + ",\n".join(cases) + "\n}\n"]
