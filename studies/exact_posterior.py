"""Errors of the exact posterior in front of the ring, by importance sampling.

Some twenty minutes on one processor. Targets of the four cases of `dopplerlib.workspace`: from a
prior over the workspace or at Table 2, with acceleration noise or at constant velocity.
"""

import numpy as np

from dopplerlib.workspace.yardsticks import SAMPLES, posterior_errors

FILES = (".csv",)
PARAMETERS = {
    "seed": 4211,
    "cases": ["A", "B", "C", "D"],
    "runs": [500, 1000, 250, 250],
    "chunk": 25,
    "draws": 1000,
}
COLUMNS = "case,run,sample,efficiency,nees,position,velocity"


def parts():
    """Return the cases."""
    runs = zip(PARAMETERS["cases"], PARAMETERS["runs"], strict=True)
    return [({"case": case}, number, PARAMETERS["chunk"]) for case, number in runs]


def compute(settings, seed, runs):
    """Return efficiency, NEES, and errors in mm and mm/s of some runs, at all times."""
    draws = settings["draws"]
    found = posterior_errors(settings["case"], runs.start, len(runs), seed=seed, draws=draws)
    found[2:] *= 1e3
    return {"columns": np.moveaxis(found, 0, -1)}


def lines(found):
    """Return a line for each run and time at which it has not ended, of all cases in turn."""
    size = PARAMETERS["chunk"]
    return [
        f"{case},{first + run},{SAMPLES[o]}," + ",".join(f"{v:.4g}" for v in columns[run, o])
        for first in range(0, max(PARAMETERS["runs"]), size)
        for case, columns in enumerate(one["columns"][first : first + size] for one in found)
        for run, o in np.argwhere(~np.isnan(columns[..., 0]))
    ]


def contents(found):
    """Return a line for each run and time."""
    return ["\n".join([COLUMNS, *lines(found)]) + "\n"]
