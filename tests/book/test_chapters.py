"""Cells show ideas: results are tables; and every chapter has the same sections."""

import ast
import re
from base64 import b64decode
from statistics import median

import pytest

from dopplerlib.derive.printers import WIDTH
from tools.notebooks import chapters, stored_cells

MOST_PRINTING = 60  # lines in all chapters together: what prints is code, and a word here or there
BOOK = {path.stem: stored_cells(path) for path in chapters()}
WITH_EXERCISES = [name for name in BOOK if any("## Exercises" in c.source for c in BOOK[name])]
# Sections that had a heading of their own in each chapter.
OTHER_WORDS = re.compile(
    r"^#+ .*(what we get|beside what|reports, |in words$|What .* (is|says|does)\b)", re.M
)


def printing_lines(source):
    """Return how many lines of code belong to statements that only print."""
    return sum(
        node.end_lineno - node.lineno + 1
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Call)
        and getattr(node.value.func, "id", "") == "print"
    )


def prose(name):
    return "\n\n".join(cell.source for cell in BOOK[name] if cell.cell_type == "markdown")


def test_lines_of_print_are_counted_wherever_they_stand():
    assert printing_lines("x = 1\nfor i in x:\n    print(\n        i\n    )\nprint(x)") == 4
    assert printing_lines("printed = print\nf(print(1))") == 0


def test_few_lines_of_the_book_only_print():
    """It were 785 before there were tables as objects."""
    counts = {
        name: sum(printing_lines(c.source) for c in cells if c.cell_type == "code")
        for name, cells in BOOK.items()
    }
    assert sum(counts.values()) <= MOST_PRINTING, {k: v for k, v in counts.items() if v}


def test_what_cells_print_fits_the_page():
    wide = {
        f"{name}#{cell.id}": line
        for name, cells in BOOK.items()
        for cell in cells
        for output in cell.get("outputs", [])
        if output.output_type == "stream"
        for line in output.text.splitlines()
        if len(line) > WIDTH
    }
    assert wide == {}


def bare(text):
    """Return whether a text is the repr of a thing that does not name its parts, like a record."""
    try:
        value = ast.parse(text, mode="eval").body
    except SyntaxError:
        return True
    return not (isinstance(value, ast.Call) and value.keywords and not value.args)


def test_a_number_or_a_list_has_no_name_and_a_record_has():
    bare_ones = ("88", "False", "[0, 0]", "{'a': 1}", "array([1.], dtype=float32)", "<object at 0>")
    assert all(map(bare, bare_ones))
    assert not bare("ConfidenceInterval(value=1.0, low=0.5, high=2.0)")


def test_what_a_cell_shows_has_a_name():
    """A formula, a figure or a table is shown as such; the rest is a print with a label."""
    nameless = {
        f"{name}#{cell.id}": output.data["text/plain"]
        for name, cells in BOOK.items()
        for cell in cells
        for output in cell.get("outputs", [])
        if set(output.get("data", ())) == {"text/plain"} and bare(output.data["text/plain"])
    }
    assert nameless == {}


def test_pictures_are_equally_wide_so_that_their_letters_are_equally_large():
    """The page shows all at one width; what sticks out, or leaves a side empty, changes it."""
    widths = {
        f"{name}#{cell.id}": int.from_bytes(b64decode(picture[:40])[16:20])
        for name, cells in BOOK.items()
        for cell in cells
        for output in cell.get("outputs", [])
        if (picture := output.get("data", {}).get("image/png"))
    }
    usual = median(widths.values())
    assert {k: w for k, w in widths.items() if not 0.97 * usual < w < 1.02 * usual} == {}


@pytest.mark.parametrize("name", WITH_EXERCISES)
def test_three_key_takeaways_stand_before_the_exercises(name):
    found = re.search(
        r"^## Key takeaways\n\n((?:\* .*\n(?:  .*\n)*)+)\n*## Exercises$", prose(name), re.M
    )
    assert found
    assert len(re.findall(r"^\* ", found[1], re.M)) == 3


@pytest.mark.parametrize("name", BOOK)
def test_the_same_section_has_the_same_heading(name):
    assert OTHER_WORDS.findall(prose(name)) == []
    assert "{admonition} In practice" not in prose(name)


def test_every_project_has_a_solution_that_a_cell_computes():
    """The marks of its beginning and end enclose a code cell with an output."""
    for name, cells in BOOK.items():
        projects = re.findall(r"^:label: (.+)\n:class: project$", prose(name), re.M)
        sources = [cell.source for cell in cells]
        for label in projects:
            (start,) = [i for i, s in enumerate(sources) if f"{{solution-start}} {label}\n" in s]
            end = next(i for i in range(start + 1, len(cells)) if "{solution-end}" in sources[i])
            assert any(cell.get("outputs") for cell in cells[start + 1 : end]), label
