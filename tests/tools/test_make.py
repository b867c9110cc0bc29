"""What a text names is there: targets of make, their NAME, modules to run, names of the library."""

import os
import re
import subprocess
from importlib.util import find_spec
from pathlib import Path

import pytest

import dopplerlib
from dopplerlib.replication.documents import documents
from studies.__main__ import names
from tools.notebooks import ROOT, chapters

MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
TARGETS = set(re.findall(r"^\.PHONY: (\S+)$", MAKEFILE, flags=re.MULTILINE)) - {"FORCE"}
NAMED = {
    "chapter": {path.stem for path in chapters()},
    "record": set(documents()),
    "study": set(names()),
    "bench": {path.stem for path in (ROOT / "benchmarks").glob("*.py")},
}
SUFFIXES = {"", ".in", ".md", ".py", ".toml", ".yaml", ".yml"}  # chapters are texts, too
FOLDERS = (
    ".ci .github benchmarks book data decisions dopplerlib firmware results studies tests "
    "tools".split()
)
# A command stands in code, `make` or ``make``, or is a line of a script.
COMMAND = re.compile(
    r"(?:`|run: |exec |^(?=make [\w-]+(?: NAME=\w+)?(?: *#.*)?$))"
    r"make ([a-z][a-z-]*)(?: NAME=([\w.]+))?",
    flags=re.MULTILINE,
)
MODULE = re.compile(r"python -m ((?:dopplerlib|studies|tests|tools)[\w.]*\w)")


# What make hands down, from which a second make would take more to say.
HANDED_DOWN = {"MAKEFLAGS", "MAKELEVEL", "MFLAGS"}
NAME = re.compile(r"`(dopplerlib(?:\.\w+)+)`")
FILE = re.compile(rf"`((?:{'|'.join(FOLDERS[2:])})/[\w./-]*\w)`")


def texts():
    """Yield every text of the project, with its path."""
    outside = (path for path in ROOT.iterdir() if path.is_file())
    inside = (path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.is_file())
    for path in (*outside, *inside):
        if path.suffix in SUFFIXES and "_build" not in path.parts and path != Path(__file__):
            yield path, path.read_text(encoding="utf-8", errors="replace")


def unknown(text):
    """Return the commands in a text that are not there."""
    found = []
    for target, name in COMMAND.findall(text):
        if target not in TARGETS or (name.strip(".") and name not in NAMED.get(target, ())):
            found.append(f"make {target} {name}".strip())
    return found + [module for module in MODULE.findall(text) if find_spec(module) is None]


def is_there(name):
    """Return whether a dotted name leads from the library to something."""
    value = dopplerlib
    for part in name.split(".")[1:]:
        value = getattr(value, part, None)
    return value is not None


def test_every_name_of_the_library_and_every_file_that_a_text_names_is_there():
    found = set()
    for path, text in texts():
        names = [name for name in NAME.findall(text) if not is_there(name)]
        names += [name for name in FILE.findall(text) if not (ROOT / name).exists()]
        found |= {(path.relative_to(ROOT).as_posix(), name) for name in names}
    assert {one for one in found if not re.search("NAME|DOCUMENT", one[1])} == set()


def test_every_command_that_a_text_names_is_there():
    found = {path.relative_to(ROOT).as_posix(): unknown(text) for path, text in texts()}
    assert {path: names for path, names in found.items() if names} == {}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("run `make book`", []),
        ("run `make books`", ["make books"]),
        ("      - run: make tests-matrix\n", ["make tests-matrix"]),
        ("sh\nmake bench NAME=iq   # a minute\nmake bench-iq # a minute\n", ["make bench-iq"]),
        ("what others\nmake of it", []),
        ("`make study NAME=...` or `make study NAME=noise_sweep`", []),
        ("`make study NAME=guess`", ["make study guess"]),
        ("`make lint NAME=ekf`", ["make lint ekf"]),
        ("python -m tools.notebooks --text", []),
        ("python -m tools.guess", ["tools.guess"]),
    ],
)
def test_an_unknown_command_is_found(text, found):
    assert unknown(text) == found


def test_the_help_lists_every_target_but_the_two_steps_of_test():
    alone = {name: value for name, value in os.environ.items() if name not in HANDED_DOWN}
    shown = subprocess.run(
        ["make", "help"], cwd=ROOT, env=alone, capture_output=True, text=True, check=True
    )
    listed = [line.split()[0] for line in shown.stdout.splitlines()]
    assert set(listed) == TARGETS - {"tests", "compile"}
    assert len(listed) == len(set(listed)) <= 16


def test_a_name_becomes_the_file_of_the_chapter():
    made = subprocess.run(
        ["make", "-n", "chapter", "NAME=ekf iq"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert "tools.notebooks book/ekf.ipynb book/iq.ipynb\n" in made.stdout


def test_the_readme_of_the_benchmarks_names_all_that_run():
    folder = ROOT / "benchmarks"
    told = set(
        re.findall(r"^make bench NAME=(\w+) +#", (folder / "README.md").read_text("utf-8"), re.M)
    )
    runs = {path.stem for path in folder.glob("*.py") if "__main__" in path.read_text("utf-8")}
    assert told >= runs
