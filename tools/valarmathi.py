"""Make data/valarmathi/{study,cliff}.csv: all algorithms, paths and signal-to-noise ratios.

It takes about four minutes of processor time, shared by two threads. A file appears when it is
complete; an interrupted study goes on with the cell at which it stopped. Progress goes to standard
error.
"""

import argparse

from dopplerlib._progress import progress_bar
from dopplerlib.systems.valarmathi import ALGORITHMS, chosen
from dopplerlib.systems.valarmathi.published import PATHS, data_file
from dopplerlib.systems.valarmathi.study import (
    CLIFF_RUNS,
    CLIFF_SNRS_DB,
    MEASURES,
    RUNS,
    SNRS_DB,
    cell_measures,
    study_cell,
    study_table,
)
from tools.files import write

HEADS = {
    "study.csv": ",".join(["path", "snr_db", "algorithm", *MEASURES]),
    "cliff.csv": "path,snr_db,algorithm,runs,failed",
}


def study_rows(measures):
    """Return the rows of one cell, without path and ratio: one for each algorithm and run."""
    return [
        [algorithm, *(f"{value:.4g}" for value in run)]
        for algorithm in ALGORITHMS
        for run in zip(*(measures[algorithm, name] for name in MEASURES), strict=True)
    ]


def cliff_rows(measures):
    """Return the rows of one cell, without path and ratio: how many runs failed."""
    failed = chosen().failed_rmse
    return [
        [a, len(measures[a, "whole"]), int((measures[a, "whole"] > failed).sum())]
        for a in ALGORITHMS
    ]


def make(path, snrs_db, runs, rows_of):
    """Write one file, cell by cell."""
    cells = [(name, float(snr_db)) for name in PATHS for snr_db in snrs_db]
    part = path.with_suffix(".part")
    text = part.read_text(encoding="utf-8") if part.exists() else ""
    done = text.count("\n\n")  # an empty line ends each cell
    table = study_table()
    for name, snr_db in progress_bar(cells[done:], path.stem):
        measures = cell_measures(study_cell(name, snr_db, table, runs))
        for row in rows_of(measures):
            text += ",".join(map(str, [PATHS.index(name) + 1, f"{snr_db:g}", *row])) + "\n"
        text += "\n"
        write(part, text)
    write(path, HEADS[path.name] + "\n" + text.replace("\n\n", "\n"))
    part.unlink()


def main():
    """Make both files."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    make(data_file("study.csv"), SNRS_DB, RUNS, study_rows)
    make(data_file("cliff.csv"), CLIFF_SNRS_DB, CLIFF_RUNS, cliff_rows)


if __name__ == "__main__":
    main()
