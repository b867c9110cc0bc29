"""Errors of the Gaussian sum in the runs of `exact_posterior`, and the bounds along their paths.

Half a minute on one processor.
"""

import numpy as np

from dopplerlib.workspace.yardsticks import bank_errors
from studies import exact_posterior

FILES = (".csv",)
PARAMETERS = {name: exact_posterior.PARAMETERS[name] for name in ("seed", "cases", "runs", "chunk")}
COLUMNS = "case,run,sample,nees,position,velocity,position_bound,velocity_bound"

parts = exact_posterior.parts


def compute(settings, seed, runs):
    """Return NEES, and errors and bounds in mm and mm/s of some runs, at all times."""
    found = bank_errors(settings["case"], runs.start, len(runs), seed=seed)
    found[1:] *= 1e3
    return {"columns": np.moveaxis(found, 0, -1)}


def contents(found):
    """Return a line for each run and time."""
    return ["\n".join([COLUMNS, *exact_posterior.lines(found)]) + "\n"]
