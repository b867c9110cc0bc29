"""What is on record comes back as it was judged, and a page shows its own claims."""

from dataclasses import replace
from datetime import date

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.replication import judgments as records
from dopplerlib.replication.choices import Choice
from dopplerlib.replication.claims import Claim
from dopplerlib.replication.documents import Document, documents, read_document
from dopplerlib.replication.evidence import Draws, sweep
from dopplerlib.replication.judgments import (
    PageVerdicts,
    judgments_text,
    read_judgments,
    verdicts_on_page,
)
from dopplerlib.replication.verdicts import judge

NUMBERS = Claim("pair", "Sec 1", "Two are. So", "number", "reproduced", "p", "c", "t", ("k",),
                published=(1.0, 2.0), rounding=0.1)  # fmt: skip
LIMIT = replace(NUMBERS, id="limit", form="relation", relation="<", published=1.0, page="q")
RUN = replace(NUMBERS, id="run", form="draw", published=None, verdict="typical")
OPEN = replace(LIMIT, id="open", choices=("count",), unit="m")
COUNT = Choice("count", "ours", "count", (3, 5), "usual", date(2026, 11, 29), (9,))
JUDGED = (
    judge(NUMBERS, [1.0000000049, 2.0]),
    judge(LIMIT, ConfidenceInterval(1e-20, -1.0, 2.0)),
    judge(RUN, Draws(np.arange(100.0), 50.0)),
    judge(OPEN, sweep([COUNT], lambda count: count / 4), [COUNT]),
)


@pytest.fixture
def on_record(monkeypatch, tmp_path):
    """Let the records be those of JUDGED."""
    (tmp_path / "valarmathi.verdicts.json").write_text(judgments_text(JUDGED, 7))
    claims = [one.claim for one in JUDGED]
    deviations = read_document("valarmathi").deviations
    monkeypatch.setattr(records, "results", tmp_path.joinpath)
    monkeypatch.setattr(
        records, "read_document", lambda name: Document(name, claims, deviations, [COUNT])
    )


def test_judgments_come_back_as_they_were_written_to_eight_digits(on_record):
    found = read_judgments("valarmathi")
    assert (found[1], found[3]) == (JUDGED[1], JUDGED[3])
    percentile = found[2].nearest.percentile
    assert percentile.low == pytest.approx(JUDGED[2].nearest.percentile.low, rel=1e-7)
    assert found[0].points[0].ours.tolist() == [1.0, 2.0]  # 1.0000000049 in eight digits


def test_a_page_shows_its_own_claims_with_number_verdict_and_flips(on_record):
    page = verdicts_on_page("valarmathi", "q")
    assert [one.claim.id for one in page.judgments] == ["limit", "open"]
    lines = repr(page).splitlines()
    assert lines[0] == "limit: undecided"
    assert lines[2] == "open: underdetermined"
    assert lines[3] == "  published < 1 m, ours 0.75 m"
    assert lines[4] == "  count: reproduced (3); contradicted (5)"
    row = page._repr_markdown_().splitlines()[-1]
    assert row.startswith("| Two are.<br>")
    assert 'href="scorecard_valarmathi.html#claim-open"' in row
    with pytest.raises(ValueError, match="page must be one of 'p', 'q', got 'r'"):
        verdicts_on_page("valarmathi", "r")


@pytest.mark.parametrize("name", documents())
def test_every_claim_of_a_document_is_on_record(name):
    assert [one.claim for one in read_judgments(name)] == list(read_document(name).claims)


def test_what_is_no_judgment_is_refused():
    with pytest.raises(ValueError, match="judgments must be a Judgment"):
        judgments_text([1.0], 7)
    with pytest.raises(ValueError, match="seed must be a whole number"):
        judgments_text(JUDGED, 0.5)
    with pytest.raises(ValueError, match="document must be one of"):
        PageVerdicts("other", JUDGED)
