"""The table shows every claim, with its numbers, its verdict, and the way to the evidence."""

from dataclasses import replace
from datetime import date

import numpy as np

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.replication.choices import Choice
from dopplerlib.replication.claims import Claim
from dopplerlib.replication.evidence import Draws, sweep
from dopplerlib.replication.scorecard import Scorecard
from dopplerlib.replication.verdicts import judge

CLAIMS = {
    "nis": Claim("nis", "Fig 6", "NIS", "draw", "typical", "figure6", "nis-cell",
                 "tests/x.py::test_nis", ("k",), published=50.0),
    "limit": Claim("limit", "Sec 3", "$|x|$ small", "relation", "reproduced", "start", "x-cell",
                   "tests/x.py::test_limit", ("k",), published=0.3, unit="m", relation="<"),
    "open": Claim("open", "Sec 4", "open", "number", "underdetermined", "ekf", "o-cell",
                  "tests/x.py::test_open", ("k",), published=2.0, note="The start is not told.",
                  choices=("start",)),
}  # fmt: skip
STARTS = {"this": 2.0, "that": 3.0, "other": 2.0}
START = Choice("start", "reading", "start", tuple(STARTS), "none is told", date(2026, 11, 29))
MUCH = Choice("much", "ours", "much", (2.0, 10.0), "a word", date(2026, 11, 29), (1.5, 15.0))
CARD = Scorecard(
    (
        judge(CLAIMS["nis"], Draws(np.arange(101.0))),
        judge(CLAIMS["limit"], ConfidenceInterval(0.2, 0.19, 0.21)),
        judge(CLAIMS["open"], sweep([START], STARTS.get), [START]),
    )
)


def test_the_card_counts_the_verdicts():
    assert repr(CARD) == "3 claims: 1 reproduced, 1 typical, 1 underdetermined"
    assert CARD.counts == {"reproduced": 1, "typical": 1, "underdetermined": 1}


def test_a_row_shows_numbers_verdict_cell_and_test():
    nis, limit, open_ = CARD._repr_markdown_().splitlines()[2:]
    assert "50 (2.5 to 97.5)" in nis
    assert "percentile 49.5 (39.4 to 59.6)" in nis
    assert '<a href="figure6.html#cell-nis-cell">' in nis
    assert '<a href="figure6.html#cell-judged">' in nis
    assert '<span id="claim-nis"></span>' in nis
    assert "test nis" in nis
    assert "| < 0.3 m | 0.2 (0.19 to 0.21) m |" in limit
    assert "The start is not told." in open_
    assert "nearest at start this" in open_
    assert "start: reproduced (this, other); contradicted (that)" in open_
    assert 'verdict-underdetermined">underdetermined<' in open_


def test_the_first_sentence_is_what_is_claimed():
    claim = replace(CLAIMS["nis"], statement="It is large. We ask for one. Or two.")
    row = Scorecard((judge(claim, Draws(np.arange(101.0))),))._repr_markdown_()
    assert "**It is large.** We ask for one. Or two.<br>" in row


def test_a_bar_in_a_formula_does_not_end_the_column():
    row = CARD._repr_markdown_().splitlines()[3]
    assert r"$\|x\|$" in row


def test_verdicts_on_a_surrogate_stand_in_a_table_of_their_own_and_do_not_count():
    claim = replace(CLAIMS["limit"], id="walk", surrogate="a simulated walk")
    card = Scorecard((judge(claim, 0.5), *CARD.judgments))
    assert card.counts == CARD.counts
    assert repr(card).splitlines() == [repr(CARD), "1 claims (a simulated walk): 1 contradicted"]
    above, text, below = card._repr_markdown_().split("\n\n")
    assert above == CARD._repr_markdown_()
    assert text == "On a simulated walk; these verdicts do not count above:"
    assert 'verdict-contradicted">contradicted<' in below


def test_a_limit_of_ours_tells_its_range_and_where_the_verdict_turns():
    claim = replace(CLAIMS["limit"], relation=">", published=None, limit="much", unit="")
    card = Scorecard((judge(claim, 11.0, [MUCH]),))
    row, _, turned = card._repr_markdown_().splitlines()[-3:]
    assert "| > 2 to 10 | 11<br>" in row
    assert turned.endswith("1 verdicts were tried; these would change: limit")
    assert repr(card).splitlines()[-1] == turned
    assert "turns at a limit of 11" in row
    assert "beyond its range, much 15: contradicted" in row
    claim = replace(CLAIMS["limit"], form="size", relation=None, published=3.0, limit="much")
    row, _, turned = Scorecard((judge(claim, 12.0, [MUCH]),))._repr_markdown_().splitlines()[-3:]
    assert turned.endswith("these would change: none")
    assert "| 3 within a factor of 2 to 10 m | 12 m<br>" in row
    assert "much: contradicted (2); reproduced (10)" in row


def test_what_is_no_finding_is_counted_apart():
    apart = {
        "arithmetic": {"weight": "arithmetic"},
        "misprint": {"weight": "misprint"},
        "follows": {"kind": "demand", "verdict": "holds"},
    }
    extra = tuple(
        judge(replace(CLAIMS["limit"], id=name, **fields), 0.2) for name, fields in apart.items()
    )
    card = Scorecard((*extra, *CARD.judgments))
    assert card.counts == CARD.counts
    assert repr(card).splitlines() == [
        repr(CARD),
        "1 claims (arithmetic): 1 reproduced",
        "1 claims (misprint): 1 reproduced",
        "1 claims (follows): 1 holds",
    ]
    assert "Sec 3 (demand)" in card._repr_markdown_()
