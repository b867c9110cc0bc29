"""Make data/macaveiu2013/ourchain.csv and ourdetections.csv: the scheme of Fig 6 on many records.

Every record is processed in every way, so that ways are compared on the same noise. The study
takes several minutes; interrupted, it goes on where it stopped. The files do not depend on the
number of processors.
"""

import math
import multiprocessing
from dataclasses import astuple, fields

from dopplerlib._files import replacing
from dopplerlib._progress import progress_bar
from dopplerlib.systems.macaveiu2013 import chain_study, paths
from dopplerlib.systems.macaveiu2013.published import data_file
from tools.command import parser, quiet_worker, start
from tools.study import started

TOGETHER = 5  # runs between two saves


def lines(job):
    """Return the lines of both files for some runs of one path."""
    figure, first = job
    truth = paths()[figure].truth
    found, counted = [], []
    for run in range(first, first + TOGETHER):
        for number, variant in enumerate(chain_study.VARIANTS, start=1):
            if variant not in chain_study.variants(figure):
                continue
            scans = chain_study.record(figure, run, variant)
            values = (text(v) for v in astuple(chain_study.outcome(scans, truth, variant)))
            found.append(",".join([str(figure), str(number), str(run), *values]))
        values = map(str, astuple(chain_study.counts(chain_study.record(figure, run))))
        counted.append(",".join([str(figure), str(run), *values]))
    return found, counted


def study(folder, figures, runs):
    """Write both files to a folder."""
    jobs = [(figure, first) for first in range(0, runs, TOGETHER) for figure in figures]
    files = folder / "ourchain.csv", folder / "ourdetections.csv"
    with started(files[0], jobs, together=TOGETHER) as study:
        with multiprocessing.Pool(initializer=quiet_worker) as pool:
            results = pool.imap(lines, study.left)
            for _ in progress_bar(study.left, "records"):
                study.keep(next(results))
        with replacing(*files) as unfinished:
            for path, text in zip(unfinished, texts(jobs, study.rows), strict=True):
                path.write_text(text, encoding="utf-8", newline="\n")


def texts(jobs, done):
    """Return the texts of both files, sorted by path and record."""
    done = [lines_of_job for _, lines_of_job in sorted(zip(jobs, done, strict=True))]
    heads = (
        ["figure", "variant", "run", *(field.name for field in fields(chain_study.Outcome))],
        ["figure", "run", *(field.name for field in fields(chain_study.Counts))],
    )
    for head, parts in zip(heads, zip(*done, strict=True), strict=True):
        rows = [line for part in parts for line in part]
        yield "\n".join([",".join(head), *rows]) + "\n"


def text(value):
    """Return a number as it is written: counts whole, errors to 0.1 mm."""
    if isinstance(value, int):
        return str(value)
    return "NaN" if math.isnan(value) else f"{value:.4f}"


def main(argv=None):
    """Write both files where they belong."""
    parser(__doc__).parse_args(argv)
    study(data_file(), tuple(paths()), chain_study.RUNS)


if __name__ == "__main__":
    start(main)
