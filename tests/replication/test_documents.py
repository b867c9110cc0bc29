"""What every document has to have, and what its claims and deviations have to pass.

A new document is tested as soon as its folder in ``data/`` holds claims.
"""

import json

import numpy as np
import pytest

from dopplerlib.replication import evidence as pieces
from dopplerlib.replication.documents import data_file, documents, read_document
from tests.replication.review import (
    ROOT,
    check_cells,
    check_flips,
    check_numbers,
    check_record,
    check_tests,
)
from tools.judge import SEED, evidence_of

EVERY = 64


@pytest.fixture(scope="module", params=documents())
def document(request):
    return read_document(request.param)


@pytest.fixture(scope="module")
def evidence(document):
    """Return the evidence of the seed on record, at one point in 64 of each sweep.

    Each point has noise of its own, so that it repeats alone; `make judge` takes all of them.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pieces, "_tried", _sample)
        return evidence_of(document.name, SEED)


def _sample(choices, count):
    """Return the places to try; a choice has the same value in all sweeps, which share runs then.

    It is not the first value, with which most else is tested.
    """
    sizes = [len(one.values) for one in choices]
    first = np.ravel_multi_index([2 * size // 3 for size in sizes], sizes)
    return range(first % EVERY, count, EVERY)


def test_every_folder_of_the_library_is_a_document_and_every_document_has_one():
    folders = (ROOT / "dopplerlib" / "systems").glob("*/__init__.py")
    assert sorted(path.parent.name for path in folders) == list(documents())


def test_a_document_has_a_page_for_its_verdicts(document):
    page = f"scorecard_{document.name}"
    assert (ROOT / "book" / f"{page}.ipynb").is_file()
    assert f"- file: {page}\n" in (ROOT / "book" / "_toc.yml").read_text(encoding="utf-8")


def test_claims_name_cells_and_tests_that_are_there(document):
    check_cells(document.claims)
    check_tests(document.claims)


def test_deviations_name_cells_and_claims_that_are_there(document):
    check_cells(document.deviations.entries)
    ids = {claim.id for claim in document.claims}
    for one in document.deviations.entries:
        assert set(one.claims) <= ids, one.id


def test_every_underdetermined_claim_is_a_gap_that_is_listed(document):
    listed = {id for one in document.deviations.entries for id in one.claims}
    open_ones = {one.id for one in document.claims if one.verdict == "underdetermined"}
    assert open_ones <= listed


def test_every_choice_was_tried_and_the_verdict_is_that_of_all(document):
    """If this fails: `make judge NAME=...`, and the reason in the commit."""
    check_record(document)


def test_the_judged_numbers_come_out_again(document, evidence):
    """If this fails: `make judge NAME=...`, and the reason in the commit."""
    check_numbers(document, evidence)


def test_a_verdict_flips_when_the_number_is_wrong(document, evidence):
    check_flips(document, evidence)


def test_what_is_no_document_or_no_file_is_refused():
    with pytest.raises(ValueError, match=r"document must be one of .*'asheim2015', .*got 'asheim'"):
        data_file("asheim", "claims.toml")
    with pytest.raises(ValueError, match=r"name must be one of 'README.md', .*, got '../claims.t"):
        data_file("valarmathi", "../claims.toml")


def code_of(page):
    """Return the sources of the cells of a chapter that hold code, by their ids."""
    book = json.loads((ROOT / "book" / f"{page}.ipynb").read_text(encoding="utf-8"))
    return {c["id"]: "".join(c["source"]) for c in book["cells"] if c["cell_type"] == "code"}


def test_scorecards_have_the_same_cells_but_for_the_name():
    pages = []
    for name in documents():
        cells = code_of(f"scorecard_{name}")
        # A page whose document has a table of all its sentences shows it last.
        assert cells.pop("sentences", "document.sentences") == "document.sentences"
        pages.append({id: text.replace(name, "NAME") for id, text in cells.items()})
    assert pages == pages[:1] * len(pages)
    assert list(pages[0]) == ["judge", "scorecard", "deviations"]
