"""Make data/valarmathi/{study,cliff}.csv: all algorithms, paths and signal-to-noise ratios.

It takes about four minutes of processor time, shared by two threads. A file appears when it is
complete; an interrupted study goes on with the cell at which it stopped.
"""

import sys
from contextlib import contextmanager

from dopplerlib._files import write_text
from dopplerlib._progress import progress_bar
from dopplerlib.systems.valarmathi import ALGORITHMS, chosen
from dopplerlib.systems.valarmathi.published import PATHS, data_file
from dopplerlib.systems.valarmathi.study import (
    CLIFF_RUNS,
    CLIFF_SNRS_DB,
    MEASURES,
    RUNS,
    SEED,
    SNRS_DB,
    cell_measures,
    study_cell,
    study_table,
)
from tools.command import parser, start
from tools.study import started

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


@contextmanager
def text_of(path, snrs_db, runs, rows_of):
    """Give the text of one file, made cell by cell; the cells are kept until the block ends."""
    cells = [(name, float(snr_db)) for name in PATHS for snr_db in snrs_db]
    with started(path, cells, seed=SEED, runs=runs, rows=rows_of.__name__) as study:
        if study.left:
            print(f"{path.stem}: the table of windows ...", file=sys.stderr)
            table = study_table()
        for name, snr_db in progress_bar(study.left, path.stem):
            measures = cell_measures(study_cell(name, snr_db, table, runs))
            where = [PATHS.index(name) + 1, f"{snr_db:g}"]
            study.keep([",".join(map(str, [*where, *row])) for row in rows_of(measures)])
        rows = [row for cell in study.rows for row in cell]
        yield "\n".join([HEADS[path.name], *rows]) + "\n"


def make(path, snrs_db, runs, rows_of):
    """Write one file."""
    with text_of(path, snrs_db, runs, rows_of) as text:
        write_text(path, text)


def main(argv=None):
    """Make both files; what either is made of is kept until both are there."""
    parser(__doc__).parse_args(argv)
    study, cliff = data_file("study.csv"), data_file("cliff.csv")
    with (
        text_of(study, SNRS_DB, RUNS, study_rows) as runs,
        text_of(cliff, CLIFF_SNRS_DB, CLIFF_RUNS, cliff_rows) as counts,
    ):
        write_text(study, runs)
        write_text(cliff, counts)


if __name__ == "__main__":
    start(main)
