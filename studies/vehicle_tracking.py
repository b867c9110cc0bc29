"""Tracks and detections of the scheme of Macaveiu et al. in 200 records of each path.

Twenty minutes on one processor. Every record is processed in every variant, so that variants are
compared on the same noise.
"""

import math
from dataclasses import astuple, fields

from dopplerlib.systems import macaveiu2013 as paper
from dopplerlib.systems.macaveiu2013.processing_study import RUNS, SEED, VARIANTS
from studies._rows import rows, texts

FILES = (".tracks.csv", ".detections.csv")
PARAMETERS = {"seed": SEED, "runs": RUNS, "together": 5}


def parts():
    """Return the paths, of which a run is a record."""
    runs, together = PARAMETERS["runs"], PARAMETERS["together"]
    return [({"figure": figure}, runs, together) for figure in paper.vehicle_paths()]


def compute(settings, seed, runs):
    """Return the lines of both files for some records of a path."""
    return texts(lines(settings["figure"], run) for run in runs)


def lines(figure, run):
    """Return the lines of both files for a record: one for each variant, and one."""
    truth, found = paper.vehicle_paths()[figure].truth, []
    for number, variant in enumerate(VARIANTS, start=1):
        if variant not in paper.study_variants(figure):
            continue
        scans = paper.study_record(figure, run, variant)
        values = (text(v) for v in astuple(paper.study_outcome(scans, truth, variant)))
        found.append(",".join([str(figure), str(number), str(run), *values]))
    values = map(str, astuple(paper.count_detections(paper.study_record(figure, run))))
    return found, [",".join([str(figure), str(run), *values])]


def text(value):
    """Return a number as it is written: counts whole, errors to 0.1 mm."""
    if isinstance(value, int):
        return str(value)
    return "NaN" if math.isnan(value) else f"{value:.4f}"


def contents(found):
    """Return both tables, sorted by path and record."""
    heads = (
        ["figure", "variant", "run", *(field.name for field in fields(paper.SchemeOutcome))],
        ["figure", "run", *(field.name for field in fields(paper.DetectionCounts))],
    )
    for column, head in enumerate(heads):
        body = [line for part in found for record in rows(part) for line in record[column]]
        yield "\n".join([",".join(head), *body]) + "\n"
