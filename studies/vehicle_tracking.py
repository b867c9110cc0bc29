"""Tracks and detections of the scheme of Macaveiu et al. in 200 records of each path.

Ten minutes on two processors. Every record is processed in every variant, so that variants are
compared on the same noise. The files do not depend on the number of processors.
"""

import math
import multiprocessing
from dataclasses import astuple, fields

from dopplerlib.systems import macaveiu2013 as paper
from dopplerlib.systems.macaveiu2013.processing_study import RUNS, SEED, VARIANTS
from tools.command import quiet_worker

FILES = (".tracks.csv", ".detections.csv")
PARAMETERS = {"seed": SEED, "runs": RUNS, "together": 5}


def items():
    """Return the jobs: a path, and the first of the runs that are saved together."""
    firsts = range(0, PARAMETERS["runs"], PARAMETERS["together"])
    return [(figure, first) for first in firsts for figure in paper.vehicle_paths()]


def rows(items):
    """Yield the lines of both files for each job."""
    with multiprocessing.Pool(initializer=quiet_worker) as pool:
        yield from pool.imap(lines, items)


def lines(job):
    """Return the figure, and the lines of both files for some runs of its path."""
    figure, first = job
    truth = paper.vehicle_paths()[figure].truth
    found, counted = [], []
    for run in range(first, first + PARAMETERS["together"]):
        for number, variant in enumerate(VARIANTS, start=1):
            if variant not in paper.study_variants(figure):
                continue
            scans = paper.study_record(figure, run, variant)
            values = (text(v) for v in astuple(paper.study_outcome(scans, truth, variant)))
            found.append(",".join([str(figure), str(number), str(run), *values]))
        values = map(str, astuple(paper.count_detections(paper.study_record(figure, run))))
        counted.append(",".join([str(figure), str(run), *values]))
    return figure, found, counted


def text(value):
    """Return a number as it is written: counts whole, errors to 0.1 mm."""
    if isinstance(value, int):
        return str(value)
    return "NaN" if math.isnan(value) else f"{value:.4f}"


def contents(rows):
    """Return both tables, sorted by path and record."""
    heads = (
        ["figure", "variant", "run", *(field.name for field in fields(paper.SchemeOutcome))],
        ["figure", "run", *(field.name for field in fields(paper.DetectionCounts))],
    )
    by_path = sorted(rows, key=lambda row: row[0])  # the sort is stable: runs stay in order
    for column, head in enumerate(heads, start=1):
        body = [line for row in by_path for line in row[column]]
        yield "\n".join([",".join(head), *body]) + "\n"
