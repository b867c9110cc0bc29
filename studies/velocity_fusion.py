"""Errors of the six algorithms of Valarmathi et al. on all paths at all signal-to-noise ratios.

Four minutes of processor time, shared by two threads. Beside the errors of every run stands how
many runs fail, in steps of 1 dB around the threshold.
"""

import sys

from dopplerlib.systems.valarmathi import ALGORITHMS, reported
from dopplerlib.systems.valarmathi import fusion_study as made
from dopplerlib.systems.valarmathi.velocity_paths import PATHS

FILES = (".errors.csv", ".threshold.csv")
PARAMETERS = {
    "seed": made.SEED,
    "runs": made.RUNS,
    "snrs_db": made.SNRS_DB.tolist(),
    "threshold_runs": made.CLIFF_RUNS,
    "threshold_snrs_db": made.CLIFF_SNRS_DB.tolist(),
}
HEADS = (
    ",".join(["path", "snr_db", "algorithm", *made.MEASURES]),
    "path,snr_db,algorithm,runs,failed",
)


def items():
    """Return the cells of both files: which file, path, and signal-to-noise ratio."""
    levels = PARAMETERS["snrs_db"], PARAMETERS["threshold_snrs_db"]
    return [(file, name, snr_db) for file in (0, 1) for name in PATHS for snr_db in levels[file]]


def rows(items):
    """Yield the lines of each cell, and the file that they belong to."""
    print("the table of windows ...", file=sys.stderr)
    table = made.study_table()
    runs, rows_of = (PARAMETERS["runs"], PARAMETERS["threshold_runs"]), (error_rows, failure_rows)
    for file, name, snr_db in items:
        measures = made.cell_measures(made.study_cell(name, snr_db, table, runs[file]))
        where = [PATHS.index(name) + 1, f"{snr_db:g}"]
        yield file, [",".join(map(str, [*where, *row])) for row in rows_of[file](measures)]


def error_rows(measures):
    """Return the rows of one cell, without path and ratio: one for each algorithm and run."""
    return [
        [algorithm, *(f"{value:.4g}" for value in run)]
        for algorithm in ALGORITHMS
        for run in zip(*(measures[algorithm, name] for name in made.MEASURES), strict=True)
    ]


def failure_rows(measures):
    """Return the rows of one cell, without path and ratio: how many runs failed."""
    failed = reported().chosen.failed_rmse
    return [
        [a, len(measures[a, "whole"]), int((measures[a, "whole"] > failed).sum())]
        for a in ALGORITHMS
    ]


def contents(rows):
    """Return both tables."""
    for number, head in enumerate(HEADS):
        body = [line for file, lines in rows if file == number for line in lines]
        yield "\n".join([head, *body]) + "\n"
