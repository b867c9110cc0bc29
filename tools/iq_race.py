"""Make data/mittermaier2016/iq_race.json: every frequency estimator against the bound.

It takes some minutes on one processor. The file appears when it is complete; an interrupted race
goes on at the level where it stopped.
"""

import json
from pathlib import Path

from dopplerlib._files import write_text
from dopplerlib._progress import progress_bar
from dopplerlib.systems.mittermaier2016 import race
from tools.command import parser, start
from tools.study import started

PATH = Path(__file__).resolve().parent.parent / "data" / "mittermaier2016" / "iq_race.json"
COLUMNS = ("outliers", "ratio", "low", "high")


def level(snr_db, names=tuple(race.RACE)):
    """Return what the file holds of one level: by name the outliers, the ratio and its interval."""
    x, f = race.race_windows(snr_db)
    result = {}
    for name in names:
        ratio, outliers = race.race_cell(name, x, f, snr_db)
        ends = (float(f"{v:.5g}") for v in (ratio.value, ratio.low, ratio.high))
        result[name] = [outliers, *ends]
    return result


def text_of(levels):
    """Return the text of the file."""
    head = {"seed": race.RACE_SEED, "windows": race.RACE_WINDOWS, "snr_db": race.RACE_LEVELS}
    parts = [f'  "{name}": {json.dumps(value)}' for name, value in head.items()]
    for k, column in enumerate(COLUMNS):
        rows = (
            f'    "{name}": {json.dumps([found[name][k] for found in levels])}'
            for name in race.RACE
        )
        parts.append(f'  "{column}": {{\n' + ",\n".join(rows) + "\n  }")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def main(argv=None):
    """Write the file."""
    parser(__doc__).parse_args(argv)
    with started(PATH, race.RACE_LEVELS) as study:
        for snr_db in progress_bar(study.left, "levels"):
            study.keep(level(snr_db))
        write_text(PATH, text_of(study.rows))


if __name__ == "__main__":
    start(main)
