"""A verdict follows from the numbers by the rules that are told, and from nothing else."""

import re
from dataclasses import replace

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.replication.claims import Claim
from dopplerlib.replication.documents import documents, read_document
from dopplerlib.replication.readings import Draws, Readings
from dopplerlib.replication.verdicts import judge, judge_all

NUMBER = Claim(
    "a", "Sec 1", "a is", "deterministic", "reproduced", "p", "c", "t", published=0.25,
    rounding=0.005,
)  # fmt: skip
LIMIT = replace(NUMBER, id="b", kind="relation", relation="<", published=1.0)
RUN = replace(NUMBER, id="c", kind="random", published=50.0, rounding=0.0)
HUNDRED = np.arange(1.0, 10_001) / 100  # its quantiles are its values


@pytest.mark.parametrize(
    "ours, verdict",
    [
        (0.2549, "reproduced"),
        (0.245, "reproduced"),
        (0.2551, "contradicted"),
        (0.096, "contradicted"),
    ],
)
def test_a_number_is_reproduced_if_it_rounds_to_the_printed_one(ours, verdict):
    assert judge(NUMBER, ours).verdict == verdict


def test_all_of_several_numbers_must_be_reproduced():
    claim = replace(NUMBER, published=[1.0, 2.0])
    assert judge(claim, [1.001, 2.0]).verdict == "reproduced"
    assert judge(claim, [1.001, 2.1]).verdict == "contradicted"


@pytest.mark.parametrize(
    "relation, holds", [("<", True), ("<=", True), (">", False), (">=", False)]
)
def test_a_relation_must_hold_on_the_whole_interval(relation, holds):
    claim = replace(LIMIT, relation=relation)
    assert judge(claim, ConfidenceInterval(0.5, 0.4, 0.6)).verdict == (
        "reproduced" if holds else "contradicted"
    )
    assert judge(claim, ConfidenceInterval(0.95, 0.85, 1.05)).verdict == "underdetermined"


def test_a_relation_without_uncertainty_is_sharp():
    assert judge(LIMIT, 1.0).verdict == "contradicted"
    assert judge(replace(LIMIT, relation="<="), 1.0).verdict == "reproduced"
    assert judge(LIMIT, 0.999).decided


@pytest.mark.parametrize(
    "published, verdict",
    [(50, "typical"), (2.6, "typical"), (2.4, "atypical"), (97.4, "typical"), (97.6, "atypical")],
)
def test_a_draw_is_typical_in_the_central_95_percent_of_ours(published, verdict):
    assert judge(replace(RUN, published=float(published)), Draws(HUNDRED)).verdict == verdict


def test_a_draw_may_be_anything_that_rounds_to_what_is_printed():
    claim = replace(RUN, published=2.0)
    assert judge(claim, Draws(HUNDRED)).verdict == "atypical"
    assert judge(replace(claim, rounding=1.0), Draws(HUNDRED)).verdict == "typical"


def test_the_percentile_tells_where_the_draw_lies_and_how_well_that_is_known():
    found = judge(replace(RUN, published=30.005), Draws(HUNDRED)).percentile
    assert found.value == pytest.approx(30)
    # The standard error of a share of 0.3 among 10 000 is 0.46 %.
    assert found.low == pytest.approx(30 - 1.96 * 0.46, abs=0.05)
    assert found.high == pytest.approx(30 + 1.96 * 0.46, abs=0.05)


def test_too_few_runs_leave_a_verdict_undecided():
    near = replace(RUN, published=96.0)
    assert judge(near, Draws(HUNDRED)).decided
    assert not judge(near, Draws(HUNDRED[::100])).decided
    assert judge(LIMIT, ConfidenceInterval(0.5, 0.4, 0.6)).decided
    assert not judge(LIMIT, ConfidenceInterval(0.8, 0.65, 0.95)).decided


def test_readings_that_agree_give_their_verdict():
    found = judge(LIMIT, Readings({"one": 0.5, "other": 0.7}))
    assert (found.verdict, found.reading) == ("reproduced", "other")


def test_readings_that_differ_leave_the_claim_underdetermined_and_name_the_nearest():
    found = judge(NUMBER, Readings({"far": 7.0, "hit": 0.25, "near": 0.3}))
    assert (found.verdict, found.reading, found.ours) == ("underdetermined", "hit", 0.25)


def test_readings_are_decided_only_if_each_of_them_is():
    near = ConfidenceInterval(0.8, 0.65, 0.95)
    assert not judge(LIMIT, near).decided
    assert not judge(LIMIT, Readings({"far": 0.5, "near": near})).decided
    assert judge(LIMIT, Readings({"far": 0.5, "farther": 0.4})).decided


def test_the_evidence_may_bring_the_number_of_a_curve():
    claim = replace(RUN, published=None)
    assert judge(claim, Draws(HUNDRED, published=50.0)).verdict == "typical"


def test_every_claim_needs_evidence_and_evidence_a_claim():
    assert [one.verdict for one in judge_all([NUMBER, LIMIT], {"b": 0.0, "a": 0.25})] == [
        "reproduced",
        "reproduced",
    ]
    with pytest.raises(ValueError, match="evidence must hold every claim, got none for 'b'"):
        judge_all([NUMBER, LIMIT], {"a": 0.25})
    with pytest.raises(ValueError, match="must belong to a claim, got 'd', which is none"):
        judge_all([NUMBER], {"a": 0.25, "d": 1.0})


@pytest.mark.parametrize(
    "claim, evidence, message",
    [
        (NUMBER, Draws(HUNDRED), "for 'a', a deterministic claim, must be a number"),
        (NUMBER, [0.25, 0.25], r"must be numbers of shape \(\)"),
        (NUMBER, np.nan, "the evidence for 'a' must be finite, got nan"),
        (LIMIT, Draws(HUNDRED), "for 'b', a relation claim, must be a ConfidenceInterval"),
        (RUN, 50.0, "for 'c', a random claim, must be Draws"),
        (RUN, Draws(HUNDRED, published=50.0), "must be given by the claim .*, got it twice"),
        (replace(RUN, published=None), Draws(HUNDRED), "got it not at all"),
        (NUMBER, Readings({"only": 0.25}), "for 'a', a .* claim, must be two Readings or more"),
    ],
)
def test_evidence_of_the_wrong_kind_is_refused(claim, evidence, message):
    with pytest.raises(ValueError, match=message):
        judge(claim, evidence)


CLAIMS = [claim for name in documents() for claim in read_document(name).claims]
NOTHING = [
    np.nan,
    -np.inf,
    None,
    "1.0",
    True,
    1j,
    [],
    [np.nan, np.nan],
    ConfidenceInterval(np.nan, np.nan, np.nan),
    ConfidenceInterval(np.nan, -1e300, 1e300),
    ConfidenceInterval(0.0, np.nan, 1.0),
    ConfidenceInterval(0.0, -1.0, np.nan),
    ConfidenceInterval(0.0, 1.0, -1.0),
    ConfidenceInterval(2.0, 0.0, 1.0),
    Draws([np.nan] * 50),
    Draws([*range(49), np.nan]),
    Draws(np.arange(50.0), np.nan),
    Draws([]),
    Draws("text"),
    Draws(None),
    Readings({"a": np.nan, "b": np.nan}),
    Readings({"a": Draws([np.nan] * 50), "b": Draws([np.nan] * 50)}),
    Readings({"a": Draws([np.nan] * 50, 1.0), "b": Draws([1.0] * 50, np.nan)}),
    Readings(
        {"a": ConfidenceInterval(0.0, np.nan, np.nan), "b": ConfidenceInterval(np.nan, 0.0, 0.0)}
    ),
    Readings({}),
    Readings([1.0, 2.0]),
]


def test_the_documents_are_all_there():
    assert len(documents()) >= 5
    assert len(CLAIMS) >= 229


@pytest.mark.parametrize("evidence", NOTHING, ids=lambda value: str(value)[:40])
def test_no_claim_of_any_document_gets_a_verdict_from_what_is_no_evidence(evidence):
    """NaN above all: a broken computation must not look like a contradiction, or like a success."""
    for claim in CLAIMS:
        one = evidence
        if isinstance(evidence, Draws) and evidence.published is None and claim.published is None:
            one = replace(evidence, published=1.0)
        with pytest.raises(ValueError, match=re.escape(repr(claim.id))):
            judge(claim, one)


@pytest.mark.parametrize(
    "changed",
    [
        {"kind": "randm"}, {"verdict": "fine"}, {"rounding": np.nan}, {"rounding": -1.0},
        {"rounding": np.inf}, {"published": np.nan}, {"published": "1"}, {"published": True},
        {"relation": "="}, {"id": 1}, {"note": None},
    ],
    ids=str,
)  # fmt: skip
def test_no_verdict_on_a_claim_that_no_file_may_hold(changed):
    for claim in CLAIMS[::20]:
        with pytest.raises(ValueError, match=f"{next(iter(changed))} .*must"):
            judge(replace(claim, **changed), 1.0)


@pytest.mark.parametrize("claim", [None, "a", {"id": "a"}])
def test_what_is_no_claim_is_refused(claim):
    with pytest.raises(ValueError, match="claim must be a Claim"):
        judge(claim, 1.0)
    with pytest.raises(ValueError, match="claims must be a Claim"):
        judge_all([claim], {})
    with pytest.raises(ValueError, match="claims must be an iterable, got 3"):
        judge_all(3, {})
    with pytest.raises(ValueError, match="evidence must be a dict, got 3"):
        judge_all([], 3)


def test_claims_may_come_from_an_iterator():
    claim = next(c for c in CLAIMS if c.kind == "deterministic" and np.ndim(c.published) == 0)
    evidence = {claim.id: claim.published}
    assert judge_all(iter([claim]), evidence) == judge_all([claim], evidence)
