"""Errors of the Gaussian sum in the runs of `exact_posterior`, and the bounds along their paths.

Half a minute on one processor.
"""

from dopplerlib.workspace.yardsticks import bank_errors
from studies import exact_posterior

FILES = (".csv",)
PARAMETERS = {name: exact_posterior.PARAMETERS[name] for name in ("seed", "cases", "runs", "chunk")}
COLUMNS = "case,run,sample,nees,position,velocity,position_bound,velocity_bound"

items = exact_posterior.items


def rows(items):
    """Yield the lines of each part."""
    for case, first in items:
        found = bank_errors(case, first, PARAMETERS["chunk"], seed=PARAMETERS["seed"])
        found[1:] *= 1e3
        yield exact_posterior.lines(case, first, found)


def contents(rows):
    """Return a line for each run and time; errors and bounds in mm and mm/s."""
    return ["\n".join([COLUMNS, *(line for part in rows for line in part)]) + "\n"]
