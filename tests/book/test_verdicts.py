"""One voice: what a chapter says of a claim is printed from the claims, with the judged number."""

import importlib.util
import re
from functools import cache

import pytest

from dopplerlib.replication._cells import ours
from dopplerlib.replication.documents import documents, read_document
from dopplerlib.replication.judgments import read_judgments
from tools.notebooks import ROOT, chapters, stored_cells

BOOK = {path.stem: stored_cells(path) for path in chapters()}
PAGES = sorted({(name, one.page) for name in documents() for one in read_document(name).claims})
# A page that says by which rules a verdict is made has to name the verdicts.
RULES = {"scorecard_mittermaier2016": "sec-verdict-rules"}
TYPED = re.compile(r"\b(reproduced|contradicted|atypical|typical|underdetermined|undecided)\b")
ROLE = re.compile(r"\{verdict\}`([^`]*)`")

judgments = cache(read_judgments)  # those of a document stand on many pages


def extension():
    """Return the Sphinx extension, which is no part of the library."""
    spec = importlib.util.spec_from_file_location("verdicts", ROOT / "book/_ext/verdicts.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def judged(page):
    """Return the text that the cell with the judgments of a page shows."""
    (cell,) = [cell for cell in BOOK[page] if cell.get("id") == "judged"]
    return "".join(one["data"]["text/plain"] for one in cell.outputs if "data" in one)


@pytest.mark.parametrize(("document", "page"), PAGES)
def test_a_page_shows_the_judged_numbers_of_its_claims(document, page):
    shown = judged(page)
    for one in judgments(document):
        if one.claim.page == page:
            assert f"{one.claim.id}: {one.verdict}\n" in shown
            assert f"ours {ours(one)}" in shown, one.claim.id


@pytest.mark.parametrize("page", BOOK)
def test_no_verdict_is_typed(page):
    for cell in BOOK[page]:
        source = "".join(cell.source)
        if cell.cell_type == "markdown" and f"({RULES.get(page)})=" not in source:
            prose = re.sub(r"`[^`]*`|\{[^}]*\}`[^`]*`", "", source)
            assert TYPED.findall(prose) == [], (page, cell.id)


@pytest.mark.parametrize("page", BOOK)
def test_every_verdict_in_the_prose_is_one_of_a_claim(page):
    word = extension().word
    for cell in BOOK[page]:
        if cell.cell_type == "markdown":
            for text in ROLE.findall("".join(cell.source)):
                word(text)  # raises if there is none


@pytest.mark.parametrize("path", sorted((ROOT / "book").glob("*.md")), ids=lambda path: path.stem)
def test_a_page_of_text_prints_its_verdicts_too(path):
    text, word = path.read_text(encoding="utf-8"), extension().word
    for one in ROLE.findall(text):
        word(one)
    if ROLE.search(text):
        assert TYPED.findall(re.sub(r"`[^`]*`", "", text)) == []


def test_the_role_gives_the_verdict_on_record():
    name = documents()[0]
    claim = read_document(name).claims[0]
    assert extension().word(f"{name}:{claim.id}") == (name, claim.id, claim.verdict)
    for text in ("nothing", "nobody:claim", f"{name}:no-such-claim"):
        with pytest.raises(ValueError, match="must"):
            extension().word(text)
