"""Errors of the exact posterior in front of the ring, by importance sampling.

Some five minutes on one processor. Targets of the four cases of `dopplerlib.workspace`: from a
prior over the workspace or at Table 2, with acceleration noise or at constant velocity.
"""

import numpy as np

from dopplerlib.workspace.yardsticks import SAMPLES, posterior_errors

FILES = (".csv",)
PARAMETERS = {
    "seed": 2031,
    "cases": ["A", "B", "C", "D"],
    "runs": [50, 350, 25, 25],
    "chunk": 25,
    "draws": 1000,
}
COLUMNS = "case,run,sample,efficiency,nees,position,velocity"


def items():
    """Return case and first run of each part; of all cases in turn."""
    runs = dict(zip(PARAMETERS["cases"], PARAMETERS["runs"], strict=True))
    return [
        (case, first)
        for first in range(0, max(runs.values()), PARAMETERS["chunk"])
        for case in runs
        if first < runs[case]
    ]


def rows(items):
    """Yield the lines of each part."""
    for case, first in items:
        chunk, draws = PARAMETERS["chunk"], PARAMETERS["draws"]
        found = posterior_errors(case, first, chunk, seed=PARAMETERS["seed"], draws=draws)
        found[2:] *= 1e3
        yield lines(case, first, found)


def lines(case, first, found):
    """Return a line for each run and time of columns (C, runs, O), unless it is NaN."""
    number = PARAMETERS["cases"].index(case)
    return [
        f"{number},{first + run},{SAMPLES[o]},"
        + ",".join(f"{value:.4g}" for value in found[:, run, o])
        for run, o in np.argwhere(~np.isnan(found[0]))
    ]


def contents(rows):
    """Return a line for each run and time; errors in mm and mm/s."""
    return ["\n".join([COLUMNS, *(line for part in rows for line in part)]) + "\n"]
