"""Errors of the algorithms of Valarmathi et al. on all paths at all signal-to-noise ratios.

Six minutes of processor time, shared by two threads. Beside the errors of every run stands how
many runs fail, in steps of 1 dB around the threshold, and a sweep over what the document leaves
open.
"""

from functools import cache
from itertools import product

import numpy as np

from dopplerlib.systems.valarmathi import ALGORITHMS, reported
from dopplerlib.systems.valarmathi import fusion_study as made
from dopplerlib.systems.valarmathi import fusion_sweep as swept
from dopplerlib.systems.valarmathi.error_measures import MEASURES
from dopplerlib.systems.valarmathi.velocity_paths import PATHS
from studies._rows import rows, texts

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


def parts():
    """Return the files, of which a run is a cell."""
    return [({"file": file}, len(cells(file)), 1) for file in range(len(FILES))]


def cells(file):
    """Return path and signal-to-noise ratio of each cell of a file."""
    if file == 2:
        return list(product(swept.PATHS, swept.SNRS_DB))
    return list(product(PATHS, PARAMETERS["threshold_snrs_db" if file else "snrs_db"]))


def compute(settings, seed, runs):
    """Return the lines of some cells of a file."""
    file = settings["file"]
    return texts(lines(file, *cells(file)[run]) for run in runs)


@cache
def table():
    """Return the table of windows, which takes some seconds."""
    return made.study_table()


def lines(file, name, snr_db):
    """Return the lines of a cell."""
    if file == 2:
        cell = swept.sweep_cell(name, snr_db, table(), PARAMETERS["sweep_runs"])
        return sweep_rows(name, snr_db, cell)
    runs, rows_of = (PARAMETERS["runs"], PARAMETERS["threshold_runs"]), (error_rows, failure_rows)
    measures = made.cell_measures(made.study_cell(name, snr_db, table(), runs[file]))
    where = [PATHS.index(name) + 1, f"{snr_db:g}"]
    return [",".join(map(str, [*where, *row])) for row in rows_of[file](measures)]


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


def contents(found):
    """Return the tables."""
    for head, part in zip(HEADS, found, strict=True):
        body = [line for cell in rows(part) for line in cell]
        yield "\n".join([head, *body]) + "\n"
