"""Errors of the algorithms of Valarmathi et al. on all paths at all signal-to-noise ratios.

Six minutes of processor time, shared by two threads. Beside the errors of every run stands how
many runs fail, in steps of 1 dB around the threshold, and a sweep over what the document leaves
open.
"""

import sys

import numpy as np

from dopplerlib.systems.valarmathi import ALGORITHMS, reported
from dopplerlib.systems.valarmathi import fusion_study as made
from dopplerlib.systems.valarmathi import fusion_sweep as swept
from dopplerlib.systems.valarmathi.error_measures import MEASURES
from dopplerlib.systems.valarmathi.velocity_paths import PATHS

FILES = (".errors.csv", ".threshold.csv", ".sweep.csv")
PARAMETERS = {
    "seed": made.SEED,
    "runs": made.RUNS,
    "snrs_db": made.SNRS_DB.tolist(),
    "threshold_runs": made.CLIFF_RUNS,
    "threshold_snrs_db": made.CLIFF_SNRS_DB.tolist(),
    "sweep_runs": swept.RUNS,
}
HEADS = (
    ",".join(["path", "snr_db", "algorithm", *MEASURES]),
    "path,snr_db,algorithm,runs,failed",
    ",".join(["path", "snr_db", "q", "sensors", "algorithm", "setting", *MEASURES]),
)


def items():
    """Return the cells of all files: which file, path, and signal-to-noise ratio."""
    levels = PARAMETERS["snrs_db"], PARAMETERS["threshold_snrs_db"]
    cells = [(file, name, snr_db) for file in (0, 1) for name in PATHS for snr_db in levels[file]]
    return cells + [(2, path, snr_db) for path in swept.PATHS for snr_db in swept.SNRS_DB]


def rows(items):
    """Yield the lines of each cell, and the file that they belong to."""
    print("the table of windows ...", file=sys.stderr)
    table = made.study_table()
    runs, rows_of = (PARAMETERS["runs"], PARAMETERS["threshold_runs"]), (error_rows, failure_rows)
    for file, name, snr_db in items:
        if file == 2:
            cell = swept.sweep_cell(name, snr_db, table, PARAMETERS["sweep_runs"])
            yield file, sweep_rows(name, snr_db, cell)
            continue
        measures = made.cell_measures(made.study_cell(name, snr_db, table, runs[file]))
        where = [PATHS.index(name) + 1, f"{snr_db:g}"]
        yield file, [",".join(map(str, [*where, *row])) for row in rows_of[file](measures)]


def error_rows(measures):
    """Return the rows of one cell, without path and ratio: one for each algorithm and run."""
    return [
        [algorithm, *(f"{value:.4g}" for value in run)]
        for algorithm in ALGORITHMS
        for run in zip(*(measures[algorithm, name] for name in MEASURES), strict=True)
    ]


def failure_rows(measures):
    """Return the rows of one cell, without path and ratio: how many runs failed."""
    failed = reported().chosen.failed_rmse
    return [
        [a, len(measures[a, "whole"]), int((measures[a, "whole"] > failed).sum())]
        for a in ALGORITHMS
    ]


def sweep_rows(path, snr_db, cell):
    """Return the lines of the sweep for one cell: one a run, by numbers instead of names."""
    where, lines = (tuple(swept.PATHS).index(path) + 1, snr_db), []
    for key in dict.fromkeys(key[:-1] for key in cell):
        q, sensors, algorithm, setting = key
        number = swept.STATE if algorithm == "5 state" else algorithm
        least = swept.GRIDS[setting][0] if setting in swept.GRIDS else setting
        head = ",".join(map(str, [*where, q, swept.SENSORS.index(sensors) + 1, number, least]))
        runs = len(cell[*key, "whole"])
        columns = [cell.get((*key, measure), np.full(runs, np.nan)) for measure in MEASURES]
        for run in zip(*columns, strict=True):
            values = ["NaN" if np.isnan(value) else f"{value:.4g}" for value in run]
            lines.append(",".join([head, *values]))
    return lines


def contents(rows):
    """Return the tables."""
    for number, head in enumerate(HEADS):
        body = [line for file, lines in rows if file == number for line in lines]
        yield "\n".join([head, *body]) + "\n"
