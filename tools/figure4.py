"""Run the study of Fig 4 in full, and score every reading of it: data/mittermaier2016/ourfigure4*.

The study takes about half a minute on two processors, the readings some minutes. A file appears
when it is complete; an interrupted comparison of readings goes on where it stopped.
"""

import json
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np

from dopplerlib.systems.mittermaier2016 import (
    SCORED_LEVELS,
    SWEEP_READINGS,
    figure4,
    figure4_score,
    published_figure4,
)

DATA = Path(__file__).resolve().parent.parent / "data" / "mittermaier2016"
SEED = 4
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
    write(path, "".join(",".join(map(str, line)) + "\n" for line in lines))


def readings(path):
    """Write the score of every reading, with what is needed to make it again."""
    part = path.with_suffix(".part")
    rows = json.loads(part.read_text(encoding="utf-8")) if part.exists() else []
    published = published_figure4()
    for reading in SWEEP_READINGS[len(rows) :]:
        sys.stderr.write(f"\rreading {len(rows) + 1} of {len(SWEEP_READINGS)}")
        rng = np.random.default_rng(SEED)
        result = figure4(SCORED_LEVELS, DRAWS, rng=rng, reading=reading, bound=False)
        values = figure4_score(result, published, rng=np.random.default_rng(SEED))
        names = ("score", "low", "high")
        rows.append(asdict(reading) | {k: round(v, 1) for k, v in zip(names, values, strict=True)})
        write(part, json.dumps(rows))
    sys.stderr.write("\n")
    lines = ",\n".join("    " + json.dumps(row) for row in rows)
    head = f'{{\n  "seed": {SEED},\n  "draws": {DRAWS},\n  "levels": {list(SCORED_LEVELS)},\n'
    write(path, head + f'  "readings": [\n{lines}\n  ]\n}}\n')
    part.unlink()


def write(path, text):
    """Replace the file in one step: an interrupted run leaves the old one."""
    temporary = path.with_suffix(".tmp")
    temporary.write_text(text, encoding="utf-8", newline="\n")
    temporary.replace(path)


if __name__ == "__main__":
    study(DATA / "ourfigure4.csv")
    readings(DATA / "ourfigure4_readings.json")
