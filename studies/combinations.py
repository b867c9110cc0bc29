"""NEES and NIS of the paper's filter for every combination of four causes of its overconfidence.

Ten seconds on one processor. A thousand records of each combination, the same noise for all.
"""

import json
from itertools import product

import numpy as np

from dopplerlib.evaluation.intervals import quantile_interval
from dopplerlib.systems.mittermaier2016.readings.combinations import (
    MOMENTS,
    SWITCHES,
    combination_runs,
)

FILES = (".json",)
PARAMETERS = {"seed": 6, "runs": 1000, "first": 2, "moments": list(MOMENTS)}


def parts():
    """Return the combinations, each in one chunk: its records come from one generator."""
    keys = product(*SWITCHES.values())
    runs = PARAMETERS["runs"]
    return [(dict(zip(SWITCHES, key, strict=True)), runs, runs) for key in keys]


def compute(settings, seed, runs):
    """Return NEES and NIS of some runs at the moments."""
    switches = {name: settings[name] for name in SWITCHES}
    found = combination_runs(runs.stop, **switches, rng=np.random.default_rng(seed))
    return {"nees": found.nees[runs.start :], "nis": found.nis[runs.start :]}


def contents(found):
    """Return medians with their intervals, and NEES of the first runs, a line for each."""
    rows = [
        json.dumps(
            settings
            | {name: [_interval(column) for column in part[name].T] for name in ("nees", "nis")}
            | {"first": _short(part["nees"][: PARAMETERS["first"]])}
        )
        for (settings, *_), part in zip(parts(), found, strict=True)
    ]
    head = f'{{\n  "moments": {json.dumps(PARAMETERS["moments"])},\n  "rows": [\n    '
    return [head + ",\n    ".join(rows) + "\n  ]\n}\n"]


def _interval(values):
    middle = quantile_interval(values)
    return _short([middle.value, middle.low, middle.high])


def _short(values):
    return np.vectorize(lambda value: float(f"{value:.4g}"))(values).tolist()
