"""Long work, row by row: what is done is kept, and the next run goes on with it.

Beside the file that a study writes, `NAME.part` holds a line of JSON for every row that is done.
Its first line tells what the rows were made with. A part that was made with anything else is not
gone on with: half of a table from before a repair would go unnoticed.
"""

import hashlib
import json
import platform
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TextIO

import dopplerlib
from tools.alone import alone

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Study:
    """Work under way: the rows that are done, and the items that are left."""

    rows: list
    left: list
    file: TextIO

    def keep(self, row):
        """Add the row of the next item; from now on no interruption loses it."""
        self.rows.append(row)
        self.file.write(json.dumps(row) + "\n")
        self.file.flush()


@contextmanager
def started(path, items, **settings):
    """Begin to make a row for each item, or go on where the last run stopped.

    Parameters
    ----------
    path : pathlib.Path
        How the names of the files begin that the study writes. The part is forgotten when the
        block ends without an error.
    items : sequence
        What there is a row for. Their `repr` tells them apart.
    **settings
        All else that the rows depend on and that stands neither in the code nor in `data/`.

    Yields
    ------
    Study
    """
    part, items = path.with_name(f"{path.name}.part"), list(items)
    head = json.dumps({**made_with(), "settings": repr(settings), "items": repr(items)})
    with alone(part, path.name), part.open("r+", encoding="utf-8") as file:
        # A line that a kill has cut short has no end.
        first, *done = file.read().rpartition("\n")[0].split("\n")
        if first == head:
            print(f"{path.name}: {len(done)} of {len(items)} are done", file=sys.stderr)
        else:
            if first:
                print(
                    f"{path.name}: starts over, {part.name} is of other settings or code",
                    file=sys.stderr,
                )
            done = []
        file.seek(0)
        file.write("".join(line + "\n" for line in [head, *done]))
        file.truncate()
        file.flush()
        yield Study([json.loads(line) for line in done], items[len(done) :], file)
        part.unlink()


def made_with():
    """Return what every study depends on: code, data, and the versions that compute."""
    files = [
        *Path(dopplerlib.__file__).parent.rglob("*.py"),
        *Path(__file__).parent.glob("*.py"),
        *(path for path in (ROOT / "data").rglob("[!.]*.*") if path.suffix != ".part"),
    ]
    content = hashlib.sha256()
    for path in sorted(files):
        content.update(path.read_bytes())
    packages = {name: version(name) for name in ("numpy", "scipy", "numba")}
    return {"code": content.hexdigest(), "python": platform.python_version(), **packages}
