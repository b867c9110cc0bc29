"""The table shows every claim, with its numbers, its verdict, and the way to the evidence."""

from dataclasses import replace

import numpy as np

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.replication.claims import Claim
from dopplerlib.replication.readings import Draws, Readings
from dopplerlib.replication.scorecard import Scorecard
from dopplerlib.replication.verdicts import judge

CLAIMS = {
    "nis": Claim("nis", "Fig 6", "NIS", "random", "typical", "figure6", "nis-cell",
                 "tests/x.py::test_nis", published=50.0),
    "limit": Claim("limit", "Sec 3", "$|x|$ small", "relation", "reproduced", "start", "x-cell",
                   "tests/x.py::test_limit", published=0.3, unit="m", relation="<"),
    "open": Claim("open", "Sec 4", "open", "deterministic", "underdetermined", "ekf", "o-cell",
                  "tests/x.py::test_open", published=2.0, note="The start is not told."),
}  # fmt: skip
CARD = Scorecard(
    (
        judge(CLAIMS["nis"], Draws(np.arange(101.0))),
        judge(CLAIMS["limit"], ConfidenceInterval(0.2, 0.19, 0.21)),
        judge(CLAIMS["open"], Readings({"this": 2.0, "that": 3.0})),
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
    assert "test nis" in nis
    assert "| < 0.3 m | 0.2 (0.19 to 0.21) m |" in limit
    assert "The start is not told." in open_
    assert "nearest reading: this" in open_
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
    assert repr(card).splitlines() == [repr(CARD), "1 claims on a simulated walk: 1 contradicted"]
    above, text, below = card._repr_markdown_().split("\n\n")
    assert above == CARD._repr_markdown_()
    assert text == "On a simulated walk; these verdicts do not count above:"
    assert 'verdict-contradicted">contradicted<' in below
