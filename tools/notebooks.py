"""Execute the chapters of the book in place, or check that doing so would change nothing.

A chapter is stored with its outputs, so the same sources must give the same file: the kernel runs
with fixed settings and alone on one thread, and whatever else a run leaves behind (times, versions,
the name of the machine's kernel) is removed.
"""

import asyncio
import base64
import json
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

from dopplerlib._files import file_to_write, replacing, write_text
from tools.command import parser, start
from tools.isolation import ONE_THREAD, own_profile
from tools.prose import as_text, text_path

ROOT = Path(__file__).resolve().parent.parent
FIXED = {
    "PYTHONHASHSEED": "0",
    "SOURCE_DATE_EPOCH": "0",
    "PYDEVD_DISABLE_FILE_VALIDATION": "1",  # else a warning on stderr, from Python 3.12 on
}
METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python", "pygments_lexer": "ipython3"},
}
# The picture of the first page, and where README and messages that link to the book find it.
HERO = ROOT / "book" / "index.ipynb", ROOT / "book" / "_static" / "hero.png"
TRANSIENT = ("execution", "collapsed", "ExecuteTime")


class ChapterError(Exception):
    """A chapter failed, or printed what no reader should see."""


def chapters(book=ROOT / "book"):
    """Return the notebooks of the book, without copies made by a build or an editor."""
    return sorted(
        path
        for path in book.rglob("*.ipynb")
        if not any(part.startswith(("_", ".")) for part in path.relative_to(book).parts)
    )


@cache
def stored_cells(path):
    """Return the cells of a chapter as they are stored, read once: nobody changes them."""
    return nbformat.read(path, as_version=4).cells


def read(path):
    """Read a notebook; a cell without an id gets one that depends on its place only."""
    content = json.loads(path.read_text(encoding="utf8"))
    content["nbformat_minor"] = max(5, content["nbformat_minor"])
    used = {cell["id"] for cell in content["cells"] if "id" in cell}
    for place, cell in enumerate(content["cells"]):
        if "id" not in cell:
            cell["id"] = next(i for i in _names(f"cell-{place:02d}") if i not in used)
            used.add(cell["id"])
    return nbformat.reads(json.dumps(content), as_version=4)


def _names(stem):
    yield stem
    number = 1
    while True:
        yield f"{stem}-{number}"
        number += 1


def execute(path, timeout):
    """Return the text of the notebook file as a fresh execution would leave it."""
    nb = read(path)
    for cell in nb.cells:
        if cell.cell_type == "code":  # an empty cell is never run: it must not keep an old count
            cell.execution_count, cell.outputs = None, []
    with own_profile():
        env = {k: v for k, v in os.environ.items() if k != "MPLBACKEND"} | FIXED | ONE_THREAD
        client = NotebookClient(
            nb,
            timeout=timeout,
            kernel_name="python3",
            record_timing=False,
            coalesce_streams=True,
            extra_arguments=["--log-level=ERROR"],
            resources={"metadata": {"path": str(path.parent)}},
        )
        # In a thread of its own: in the main one the client would take over the signals.
        thread = ThreadPoolExecutor(1)
        thread.submit(asyncio.run, client.async_execute(env=env)).result()
        thread.shutdown()
    nb.metadata = nbformat.from_dict(METADATA)
    for number, cell in enumerate(nb.cells):
        for key in TRANSIENT:
            cell.metadata.pop(key, None)
        for output in cell.get("outputs", []):
            if output.output_type == "stream" and output.name == "stderr":
                raise ChapterError(f"cell {number} ({cell.id}) wrote to stderr:\n{output.text}")
    nbformat.validate(nb)
    return nbformat.writes(nb, indent=1).rstrip("\n") + "\n"


def differences(old, new):
    """Describe cell by cell what differs between two texts of the same notebook."""
    if old == new:
        return []
    old_nb, new_nb = json.loads(old), json.loads(new)
    found = []
    for number, (was, now) in enumerate(zip(old_nb["cells"], new_nb["cells"], strict=True)):
        where = f"cell {number} ({now['id']})"
        if was.get("execution_count") != now.get("execution_count"):
            count = was.get("execution_count")
            found.append(f"{where}: {'was not executed' if count is None else 'other count'}")
        elif _without_images(was.get("outputs")) != _without_images(now.get("outputs")):
            found.append(f"{where}: text of the output differs")
        elif was.get("outputs") != now.get("outputs"):
            found.append(f"{where}: image only")
        elif was != now:
            found.append(f"{where}: metadata or id differs")
    return found or ["only the layout or the metadata of the file differs"]


def _without_images(outputs):
    return [
        {
            key: {mime: data for mime, data in value.items() if not mime.startswith("image/")}
            if key == "data"
            else value
            for key, value in output.items()
        }
        for output in outputs or []
    ]


def writable(*paths):
    """End the command at once if what it makes could not be written in the end."""
    try:
        for path in paths:
            file_to_write(path)
    except ValueError as error:
        sys.exit(f"error: {error}")


def executed(paths, timeout):
    """Yield every path with the text that executing it gives, or None if it fails."""
    for number, path in enumerate(paths, start=1):
        print(f"{number} of {len(paths)}: {path.name} ...", end=" ", file=sys.stderr, flush=True)
        start, new = time.perf_counter(), None
        try:
            new = execute(path, timeout)
        except (CellExecutionError, ChapterError, TimeoutError) as error:
            print(f"failed\n{error}", file=sys.stderr)
        if new is not None:
            print(f"{time.perf_counter() - start:.1f} s", file=sys.stderr)
        yield path, new


def main(argv=None):
    """Return whether notebooks failed or, with --check, differ."""
    options = parser(__doc__)
    options.add_argument("--check", action="store_true", help="compare only, write nothing")
    options.add_argument("--text", action="store_true", help="only write book/text again")
    options.add_argument("--timeout", type=int, default=300, help="seconds a cell may take")
    options.add_argument("notebooks", nargs="*", type=Path, help="default: all of the book")
    chosen = options.parse_args(argv)
    paths = chosen.notebooks or chapters()
    if not chosen.check:
        writable(*paths)
    if chosen.text:
        for path in paths:
            write_beside(path, path.read_text(encoding="utf8"))
        return 0
    bad = False
    for path, new in executed(paths, chosen.timeout):
        if new is None:
            bad = True
        elif chosen.check:
            found = differences(path.read_text(encoding="utf8"), new)
            bad = bad or bool(found)
            for line in found:
                print(f"{path}: {line}")
        else:
            write_text(path, new)
            write_beside(path, new)
    return int(bad)


def first_picture(notebook):
    """Return the bytes of the first PNG that a notebook holds."""
    outputs = (output for cell in notebook["cells"] for output in cell.get("outputs", []))
    found = next(o["data"]["image/png"] for o in outputs if "image/png" in o.get("data", {}))
    return base64.b64decode("".join(found))


def write_beside(path, notebook):
    """Write the text that stands beside a chapter for review; of the first, its picture too."""
    notebook = json.loads(notebook)
    text = text_path(path)
    text.parent.mkdir(exist_ok=True)
    write_text(text, as_text(notebook))
    if path == HERO[0]:
        with replacing(HERO[1]) as (new,):
            new.write_bytes(first_picture(notebook))


if __name__ == "__main__":
    start(main)
