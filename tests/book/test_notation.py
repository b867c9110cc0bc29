"""The page on notation names things that exist, each symbol once."""

import dataclasses
import inspect
import re
from pathlib import Path

import pytest

import dopplerlib

PAGE = Path(__file__).resolve().parents[2] / "book" / "notation.md"
HEADER = ["symbol", "meaning", "name in the code", "unit", "in the paper", "chapter"]
NAME = re.compile(r"`([\w.]+)`(?: in `([\w.]+)`)?")
# 17 equations, 2 tables and 6 sections, some of which have parts
PAPER = re.compile(
    r"—|((Eqs? (1[0-7]|[1-9])(, (1[0-7]|[1-9]))*|Tables? [12](, [12])*|Sec [1-6](\.[1-5])?)(, |$))+"
)


def rows():
    """Return the rows of all tables, each as {column: text}."""
    table = [line for line in PAGE.read_text(encoding="utf8").splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in table]
    assert all(len(row) == len(HEADER) for row in cells), "a bar inside a cell?"
    return [
        dict(zip(HEADER, row, strict=True))
        for row in cells
        if row != HEADER and not row[0].startswith("---")
    ]


ROWS = rows()
CLAIMS = [
    (row["meaning"], *claim) for row in ROWS for claim in NAME.findall(row["name in the code"])
]


def public(path):
    """Return the public object of this name, or the field or property of a public class."""
    first, *rest = path.split(".")
    assert first in dopplerlib.__all__, f"{first} is no public name"
    found = getattr(dopplerlib, first)
    for part in rest:
        fields = {field.name for field in dataclasses.fields(found)}
        assert part in fields or hasattr(found, part), f"{first} has no {part}"
        found = getattr(found, part, None)
    return found


@pytest.mark.parametrize(("meaning", "name", "function"), CLAIMS)
def test_every_name_in_the_code_exists(meaning, name, function):
    if function:
        assert name in inspect.signature(public(function)).parameters
    else:
        public(name)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["symbol"])
def test_every_row_says_what_the_columns_promise(row):
    assert row["meaning"]
    # nothing but names, so that all of them were checked above
    assert NAME.sub("", row["name in the code"]).strip(", ") in ("", "—")
    assert row["name in the code"]
    assert PAPER.fullmatch(row["in the paper"])
    assert re.fullmatch(r"\{numref\}`%s <sec-[\w-]+>`", row["chapter"])


def test_there_are_rows_and_no_symbol_has_two_meanings():
    symbols = [row["symbol"] for row in ROWS if row["symbol"]]
    assert len(symbols) > 20
    assert len(set(symbols)) == len(symbols)
