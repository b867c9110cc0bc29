"""Make data/mittermaier2016/ourfigure4*: the study of Fig 4 in full, or the score of every reading.

On two processors the study takes some twenty seconds, the comparison of readings a few minutes. A
file appears when it is complete; an interrupted comparison goes on where it stopped.
"""

import json
from dataclasses import asdict

import numpy as np

from dopplerlib._files import write_text
from dopplerlib._progress import progress_bar
from dopplerlib.systems.mittermaier2016 import (
    figure4,
    figure4_score,
    published_figure4,
    scored_levels,
    sweep_readings,
)
from dopplerlib.systems.mittermaier2016.published import data_file
from tools.command import parser, start
from tools.study import started

SEED = 4
AGAIN = 11  # of the repetition of the best reading with either likelihood
DRAWS = 24


def study(path):
    """Write the mean and median errors of Fig 4 under the reading that is the default."""
    result = figure4(rng=np.random.default_rng(SEED), progress=True)
    names = [name for name in vars(result) if name != "variance"]
    lines = [["variance_hz2", "series", *names]]
    for level, variance in enumerate(result.variance):
        for series in range(result.position.shape[1]):
            values = (getattr(result, name)[level, series] for name in names)
            lines.append([f"{variance:.6g}", series + 1, *(f"{value:.6g}" for value in values)])
    write_text(path, "".join(",".join(map(str, line)) + "\n" for line in lines))


def readings(path):
    """Write the score of every reading, with what is needed to make it again."""
    settings = {"seed": SEED, "draws": DRAWS, "levels": scored_levels()}
    with started(path, sweep_readings(), **settings) as study:
        for reading in progress_bar(study.left, "readings"):
            study.keep(score(reading, SEED))
        write_text(path, text_of(study.rows))


def text_of(rows):
    """Return the text of the file of scores; the best reading of either likelihood is repeated."""
    best = [
        max(range(len(rows)), key=lambda i: (rows[i]["likelihood"] == name, rows[i]["score"]))
        for name in ("moving", "static")
    ]
    again = [score(sweep_readings()[i], AGAIN) for i in best]
    head = {"seed": SEED, "draws": DRAWS, "levels": list(scored_levels()), "seed_again": AGAIN}
    parts = [f'  "{name}": {json.dumps(value)}' for name, value in head.items()]
    for name, table in {"again": again, "readings": rows}.items():
        lines = ",\n".join("    " + json.dumps(row) for row in table)
        parts.append(f'  "{name}": [\n{lines}\n  ]')
    return "{\n" + ",\n".join(parts) + "\n}\n"


def score(reading, seed):
    """Return the fields of a reading, its score, and the interval of the score."""
    result = figure4(
        scored_levels(), DRAWS, rng=np.random.default_rng(seed), reading=reading, bound=False
    )
    values = figure4_score(result, published_figure4(), rng=np.random.default_rng(seed))
    rounded = (round(value, 1) for value in values)
    return asdict(reading) | dict(zip(("score", "low", "high"), rounded, strict=True))


def main(argv=None):
    """Do what the command line asks for."""
    options = parser(__doc__)
    options.add_argument("what", choices=["study", "readings"])
    if options.parse_args(argv).what == "study":
        study(data_file("ourfigure4.csv"))
    else:
        readings(data_file("ourfigure4_readings.json"))


if __name__ == "__main__":
    start(main)
