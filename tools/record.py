"""Execute every chapter again and write down what it took: the page on reproducibility.

Hashes, versions, seeds and run times go to book/reproducibility.md, which nobody edits by hand.
Nothing is written unless every chapter comes out as it is stored. Without executing anything,
--hashes brings the hashes up to date, for whoever has just changed one chapter.
"""

import argparse
import hashlib
import json
import os
import platform
import re
import sys
import time
from importlib.metadata import version
from pathlib import Path

from tools.notebooks import ROOT, chapters, differences, execute

PAGE = ROOT / "book" / "reproducibility.md"
SEED = re.compile(r"default_rng\(([\d_]+)\)")
SHOWN = 16  # hexadecimal digits of a hash: 64 bits, plenty to tell files apart


def digest(content):
    """Return the first digits of the SHA-256 of some bytes."""
    return hashlib.sha256(content).hexdigest()[:SHOWN]


def results(path):
    """Return the outputs of a notebook, all cells together, as bytes."""
    cells = json.loads(path.read_text(encoding="utf8"))["cells"]
    return json.dumps([cell.get("outputs", []) for cell in cells], sort_keys=True).encode()


def seeds(path):
    """Return the seeds that the cells of a notebook name, in rising order."""
    cells = json.loads(path.read_text(encoding="utf8"))["cells"]
    source = "".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    return sorted({int(seed) for seed in SEED.findall(source)})


def data_files():
    """Return every file with numbers of a source document."""
    return sorted(
        path
        for path in (ROOT / "data").rglob("*")
        if path.is_file() and path.name != "README.md" and path.parent != ROOT / "data"
    )


def packages():
    """Return the packages that the project asks for, by name, with their versions."""
    lines = (ROOT / "requirements.in").read_text(encoding="utf8").splitlines()
    names = [re.split(r"[=<>\[; ]", line)[0] for line in lines if line and line[0] != "#"]
    return {name: version(name) for name in sorted(names)}


def processor():
    """Return the name of the processor, as far as the system tells it."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf8")
    except OSError:
        text = ""
    found = re.search(r"^model name\s*:\s*(.+)$", text, flags=re.MULTILINE)
    return found[1] if found else platform.processor() or platform.machine()


def table(head, rows):
    """Return a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


def hash_tables():
    """Return the tables of the page that must never be out of date: results and data."""
    chapter_rows = [
        (f"`{path.name}`", ", ".join(map(str, seeds(path))) or "none", f"`{digest(results(path))}`")
        for path in chapters()
    ]
    data_rows = [
        (f"`{path.relative_to(ROOT).as_posix()}`", f"`{digest(path.read_bytes())}`")
        for path in data_files()
    ]
    return (
        table(("chapter", "seeds", "hash of its results"), chapter_rows),
        table(("file", "hash"), data_rows),
    )


def page(seconds):
    """Return the page as text; `seconds` is the run time of each chapter by its name."""
    chapter_table, data_table = hash_tables()
    time_table = table(
        ("chapter", "run time in s"), [(f"`{n}`", f"{s:.0f}") for n, s in sorted(seconds.items())]
    )
    versions = table(("package", "version"), packages().items())
    return f"""(sec-reproducibility)=
# Can you repeat it?

<!-- Written by `make record`; do not edit. -->

Yes, with one command: `make test` executes every chapter and compares all text that comes out with
what is stored, and `make notebooks-check` compares every byte, the figures included. Both install
the exact versions of `environment.lock` first. This page tells what the stored results are, and
where they were last made.

## Where it ran

CPython {platform.python_version()} on {platform.system()} ({platform.machine()}),
{processor()}, {os.cpu_count()} cores. Every chapter ran alone and on one thread for linear algebra.

{versions}

These are the packages that the project asks for; `environment.lock` holds all that they ask for in
turn, with the hash of every file.

## Results

A hash is made of the first {SHOWN} digits of SHA-256, over all outputs of a chapter, text and
figures. Seeds are those that its cells hand to `numpy.random.default_rng`.

{chapter_table}

## Run times

Of the whole chapter, with the kernels compiled before. They say what to expect, no more: on other
machines, and on a busy one, they differ.

{time_table}

## Data

{data_table}

## How to cite

`CITATION.cff` in the root of the project names the book and the paper that it replicates; reference
managers read it. `codecheck.yml` lists for every figure and table of the paper the file that
reproduces it, for whoever wants to check the replication formally.
"""


def recorded_seconds():
    """Return the run times that the page tells, by chapter."""
    text = PAGE.read_text(encoding="utf8").split("## Run times")[1].split("## ")[0]
    return {name: int(time) for name, time in re.findall(r"^\| `(.+?)` \| (\d+) \|$", text, re.M)}


def measured_seconds():
    """Execute the chapters; return their run times, and how many came out differently."""
    seconds, bad = {}, 0
    for path in chapters():
        print(f"{path.name} ...", end=" ", file=sys.stderr, flush=True)
        start = time.perf_counter()
        found = differences(path.read_text(encoding="utf8"), execute(path, timeout=300))
        seconds[path.name] = time.perf_counter() - start
        print(f"{seconds[path.name]:.1f} s", *found, sep="\n  ", file=sys.stderr)
        bad += bool(found)
    return seconds, bad


def main(argv=None):
    """Write the page; return the number of chapters that kept it from being written."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hashes", action="store_true", help="execute nothing, keep the run times")
    seconds, bad = (recorded_seconds(), 0) if parser.parse_args(argv).hashes else measured_seconds()
    if not bad:
        temporary = PAGE.with_suffix(".tmp")
        temporary.write_text(page(seconds), encoding="utf8", newline="\n")
        temporary.replace(PAGE)
    return bad


if __name__ == "__main__":
    sys.exit(bool(main()))
