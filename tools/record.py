"""Execute every chapter again, judge every claim again, and write the page on reproducibility.

Hashes, versions, seeds and the verdicts under other seeds go to book/reproducibility.md, which
is not edited by hand. Nothing is written unless every chapter comes out as it is stored, byte for
byte, and every verdict is the one on record; an interrupted run starts over. After a change to one
chapter or document the rest still holds: with --hashes nothing runs and only the hashes are
renewed, and with documents named only their claims are judged.
"""

import hashlib
import json
import os
import platform
import re
import sys
from importlib.metadata import version
from pathlib import Path

from dopplerlib._files import write_text
from dopplerlib.replication.claims import VERDICTS
from dopplerlib.replication.documents import documents
from tools import judge as judged
from tools.command import parser, start
from tools.notebooks import ROOT, chapters, differences, executed, writable

PAGE = ROOT / "book" / "reproducibility.md"
SEED = re.compile(r"default_rng\(([\d_]+)\)")
RAN, SEEDS = "Environment", "Verdicts under other seeds"
SEEDS_TRIED = (1, 2, 3, 4, 5)
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
    """Return every file with numbers: those of the documents, then those of our studies."""
    return [
        path
        for folder in ("data", "results")
        for path in sorted((ROOT / folder).rglob("*"))
        if path.is_file() and path.suffix not in (".md", ".part")
    ]


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


def where_it_ran():
    """Return the section on Python, the processor and the packages."""
    return f"""CPython {platform.python_version()} on {platform.system()} ({platform.machine()}),
{processor()}, {os.cpu_count()} cores. Every chapter ran alone and on one thread for linear algebra.

{table(("package", "version"), packages().items())}

These are the packages that the project needs; `environment.lock` also lists the packages that these
need, with the hash of every file."""


def chapters_repeat():
    """Execute the chapters; return whether each comes out as it is stored."""
    bad = 0
    for path, new in executed(chapters(), timeout=300):
        found = ["failed"] if new is None else differences(path.read_text(encoding="utf8"), new)
        print(*found, sep="\n", end="\n" * bool(found), file=sys.stderr)
        bad += bool(found)
    return not bad


def seeds_tried(names):
    """Judge the claims of documents with other seeds; return rows by document, None if one fails.

    A row has the seed, how many claims got each verdict, and the claims whose verdict is not the
    one on record. Another seed may leave undecided what runs decided, or decide what they left
    so; it must not turn a verdict into another one.
    """
    found = judged.verdicts_by_seed(names, SEEDS_TRIED)
    bad, rows = [], {name: [] for name in found}
    for name, by_seed in found.items():
        record = judged.on_record(name)
        for seed, by_claim in by_seed.items():
            other = {claim: (record.get(claim), by_claim.get(claim)) for claim in by_claim | record}
            other = {claim: both for claim, both in other.items() if both[0] != both[1]}
            bad += [
                f"{name}, seed {seed}: {claim} is {there}, on record {here}"
                for claim, (here, there) in other.items()
                if "undecided" not in (here, there)
            ]
            counts = [list(by_claim.values()).count(verdict) for verdict in VERDICTS]
            rows[name].append((seed, *counts, ", ".join(sorted(other)) or "none"))
    print(*bad, sep="\n", file=sys.stderr)
    return None if bad else rows


def seed_tables(tried):
    """Return the tables of the rows of `seeds_tried`: a column a seed, then what is undecided."""
    counts, undecided = [], []
    for name in sorted(tried):
        seeds, *by_verdict, others = zip(*tried[name], strict=True)
        every = zip(VERDICTS, by_verdict, strict=True)
        counts += [(name, verdict, *numbers) for verdict, numbers in every if any(numbers)]
        every = zip(seeds, others, strict=True)
        undecided += [(name, seed, other) for seed, other in every if other != "none"]
    return (
        table(("document", "verdict", *(f"seed {seed}" for seed in SEEDS_TRIED)), counts),
        table(("document", "seed", "undecided here or on record, but not in both"), undecided),
    )


def page(ran, tried):
    """Return the page as text, given the section on where it ran and the rows of `seeds_tried`."""
    chapter_table, data_table = hash_tables()
    count_table, undecided_table = seed_tables(tried)
    return f"""(sec-reproducibility)=
# Reproducibility

<!-- Written by `make record`; do not edit. -->

This page is for a check that the results of the book repeat: it lists the environment in which they
were last made, the hashes of results and data, and the verdicts under other seeds. `make test`
executes every chapter and compares all text output with the stored output; `make record` compares
every byte, figures included. Both first install the exact versions of `environment.lock`.

## {RAN}

{ran}

## Results

A hash is the first {SHOWN} digits of SHA-256 over all outputs of a chapter, text and figures.
Seeds are the arguments of `numpy.random.default_rng` in its cells.

{chapter_table}

## {SEEDS}

A verdict stands only if it stands for every reasonable value of our choices, and for every reading
of the text. `data/<document>/choices.toml` declares these values, each with a date and a reason
that does not depend on the result. If they change the verdict of a row, the row names the value.

Random results change with the seed, but verdicts should not. No limit is moved to achieve this: if
there are too few runs, the verdict on the page is *undecided*. A verdict is decided only if it also
holds on an interval of twice the width of the 95 % interval. `make record` draws the noise for
every claim again with five other seeds, and fails if a verdict changes into another one. The first
table counts the claims of each document with each verdict; a verdict without a row has no claim.

{count_table}

A claim can be undecided with one seed and decided with another. The second table names the claims
for which that holds between a seed and the record; with all other seeds there are none.

{undecided_table}

## Data

{data_table}

## How to cite

`CITATION.cff` at the root of the project describes the book and the paper that it replicates, in a
form that reference managers read. For a formal check of the replication, `codecheck.yml` lists the
file that reproduces each figure and table of the paper.
"""


def recorded(text):
    """Return what of a page takes a run: the section on where it ran, and the rows by document."""
    ran, tried = (
        text.split(f"\n## {title}\n")[1].split("\n## ")[0].strip() for title in (RAN, SEEDS)
    )
    counts = {}
    for name, verdict, numbers in re.findall(r"(?m)^\| (\w+) \| (\w+) \| (\d[\d |]*) \|$", tried):
        counts.setdefault(name, {})[verdict] = [int(number) for number in numbers.split(" | ")]
    named = re.findall(r"(?m)^\| (\w+) \| (\d+) \| (.*) \|$", tried)
    others = {(name, int(seed)): other for name, seed, other in named}
    none = [0] * len(SEEDS_TRIED)
    return ran, {
        name: [
            (seed, *numbers, others.get((name, seed), "none"))
            for seed, *numbers in zip(
                SEEDS_TRIED, *(counts[name].get(verdict, none) for verdict in VERDICTS), strict=True
            )
        ]
        for name in counts
        if name in documents()
    }


def main(argv=None):
    """Write the page; return 1, and write nothing, if a result differs."""
    options = parser(__doc__)
    options.add_argument(
        "--hashes", action="store_true", help="run nothing, keep what was measured"
    )
    options.add_argument("documents", nargs="*", help="judge these only, and execute no chapter")
    chosen = options.parse_args(argv)
    writable(PAGE)
    if chosen.hashes or chosen.documents:
        ran, known = recorded(PAGE.read_text(encoding="utf8"))
        tried = seeds_tried(chosen.documents) if chosen.documents else {}
    else:
        print("all chapters, then all claims; interrupted, it starts over", file=sys.stderr)
        repeated, ran, known = chapters_repeat(), where_it_ran(), {}
        tried = seeds_tried(documents()) if repeated else None
    if tried is None:
        return 1
    write_text(PAGE, page(ran, known | tried))
    return 0


if __name__ == "__main__":
    start(main)
