"""What every chapter of the book keeps to."""

import re
from pathlib import Path

import pytest
import yaml

from tools.notebooks import chapters, stored_cells

ROOT = Path(__file__).resolve().parents[2]
BOOK = ROOT / "book"
CHAPTERS = chapters(BOOK)
NO_PAGES = ("_build", "text")  # what is built, and the chapters as text
PAGES = CHAPTERS + sorted(
    p for p in BOOK.rglob("*.md") if p.relative_to(BOOK).parts[0] not in NO_PAGES
)
LONGEST_CELL = 15  # lines: what does not fit belongs in the library
LINK = re.compile(r"\]\(([^)\s#]+)(?:#[^)\s]*)?\)")
HUE = re.compile(r"\b(?:blue|orange|green|red|pink|purple|gr[ae]y|yellow|brown|black)\b", re.I)
PICTURE = re.compile(r"^(`{3,}|:{3,})\{(?:glue:)?(?:figure|image)\}(.*?)^\1", re.M | re.S)


def name(path):
    return path.relative_to(BOOK).as_posix()


def code_cells(path):
    """Return (label, cell) for every cell that has code."""
    cells = stored_cells(path)
    return [
        (f"cell {number} ({cell.id})", cell)
        for number, cell in enumerate(cells)
        if cell.cell_type == "code" and cell.source.strip()
    ]


def prose(path):
    if path.suffix == ".md":
        return path.read_text(encoding="utf8")
    cells = stored_cells(path)
    return "\n\n".join(cell.source for cell in cells if cell.cell_type == "markdown")


def listed(entry):
    """Yield every page of the table of contents."""
    if isinstance(entry, list):
        for item in entry:
            yield from listed(item)
    elif isinstance(entry, dict):
        yield from (entry[key] for key in ("root", "file") if key in entry)
        for value in entry.values():
            if isinstance(value, list):
                yield from listed(value)


def test_every_page_is_in_the_table_of_contents():
    toc = yaml.safe_load((BOOK / "_toc.yml").read_text(encoding="utf8"))
    assert sorted(listed(toc)) == sorted(name(p.with_suffix("")) for p in PAGES)


@pytest.mark.parametrize("path", CHAPTERS, ids=name)
def test_every_cell_was_executed_without_complaint(path):
    for label, cell in code_cells(path):
        assert cell.execution_count is not None, f"{label} was not executed"
        kinds = {out.get("name", out.output_type) for out in cell.outputs}
        assert "stderr" not in kinds, f"{label} wrote to stderr"
        if "raises-exception" not in cell.metadata.get("tags", []):
            assert "error" not in kinds, f"{label} failed"


@pytest.mark.parametrize("path", CHAPTERS, ids=name)
def test_no_cell_is_too_long_to_be_read_at_once(path):
    long = [label for label, c in code_cells(path) if len(c.source.splitlines()) > LONGEST_CELL]
    assert long == []


@pytest.mark.parametrize("path", CHAPTERS, ids=name)
def test_every_figure_has_a_name_a_caption_and_a_text_for_those_who_do_not_see_it(path):
    for label, cell in code_cells(path):
        pictures = [
            out
            for out in cell.outputs
            if out.output_type in {"display_data", "execute_result"}
            and any(mime.startswith("image/") for mime in out.data)
        ]
        if pictures:
            render = cell.metadata.get("mystnb", {})
            assert len(pictures) == 1, f"{label}: one caption cannot describe several figures"
            assert render.get("image", {}).get("alt", "").strip(), f"{label} has no image.alt"
            for key in ("caption", "name"):
                assert render.get("figure", {}).get(key, "").strip(), f"{label}: no figure.{key}"


@pytest.mark.parametrize("path", PAGES, ids=name)
def test_every_picture_in_the_prose_has_a_text_too(path):
    text = prose(path)
    assert "![](" not in text
    assert [m[0] for m in PICTURE.finditer(text) if ":alt:" not in m[2]] == []


@pytest.mark.parametrize("path", PAGES, ids=name)
def test_no_sentence_needs_an_eye_for_colors(path):
    """A line is told by its dashes, a mark by its form: one reader in twenty sees few hues."""
    captions = [
        cell.metadata.get("mystnb", {}).get("figure", {}).get("caption", "")
        for _, cell in (code_cells(path) if path in CHAPTERS else ())
    ]
    seen = [
        text
        for line in prose(path).splitlines()
        if not line.startswith(":alt:")
        for text in HUE.findall(line)
    ]
    assert seen + HUE.findall(" ".join(captions)) == []


@pytest.mark.parametrize("path", CHAPTERS, ids=name)
def test_no_cell_hides_its_value_with_a_semicolon(path):
    """The kernel that compares the outputs shows what the one of `make chapter` hid."""
    assert [label for label, c in code_cells(path) if c.source.rstrip().endswith(";")] == []


@pytest.mark.parametrize("path", [*PAGES, *sorted(ROOT.glob("*.md"))], ids=lambda p: p.name)
def test_every_link_to_a_file_resolves(path):
    targets = [t for t in LINK.findall(prose(path)) if not re.match(r"\w+:", t)]
    missing = [t for t in targets if not (path.parent / t).exists()]
    assert missing == []
