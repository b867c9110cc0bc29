"""Make data/mittermaier2016/iq_race.csv: every frequency estimator against the bound.

It takes some minutes on one processor. The file appears when it is complete; an interrupted race
goes on at the level where it stopped.
"""

import argparse
import json
from pathlib import Path

from dopplerlib._progress import progress_bar
from dopplerlib.systems.mittermaier2016 import race
from tools.files import write

PATH = Path(__file__).resolve().parent.parent / "data" / "mittermaier2016" / "iq_race.csv"
HEAD = ["snr_db", "estimator", "windows", "outliers", "ratio", "low", "high"]


def rows_of(snr_db, names=tuple(race.RACE)):
    """Return the rows of one level, as they stand in the file."""
    x, f = race.race_windows(snr_db)
    rows = []
    for name in names:
        ratio, outliers = race.race_cell(name, x, f, snr_db)
        numbers = (f"{v:.5g}" for v in (ratio.value, ratio.low, ratio.high))
        rows.append([str(snr_db), name, str(len(f)), str(outliers), *numbers])
    return rows


def main():
    """Write the file."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    part = PATH.with_suffix(".part")
    done = json.loads(part.read_text(encoding="utf8")) if part.exists() else []
    for snr_db in progress_bar(race.RACE_LEVELS[len(done) :], "levels"):
        done.append(rows_of(snr_db))
        write(part, json.dumps(done))
    lines = [HEAD, *(row for rows in done for row in rows)]
    # A name may hold a comma.
    write(PATH, "".join(",".join(f'"{v}"' if "," in v else v for v in r) + "\n" for r in lines))
    part.unlink()


if __name__ == "__main__":
    main()
