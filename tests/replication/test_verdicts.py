"""A verdict follows from the numbers by the rules that are told, and from nothing else."""

import re
from dataclasses import replace
from datetime import date

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.replication.choices import Choice
from dopplerlib.replication.claims import Claim
from dopplerlib.replication.documents import documents, read_document
from dopplerlib.replication.evidence import Draws, Sweep, combinations, sweep
from dopplerlib.replication.verdicts import judge, judge_all

NUMBER = Claim(
    "a", "Sec 1", "a is", "number", "reproduced", "p", "c", "t", ("k",), published=0.25,
    rounding=0.005,
)  # fmt: skip
LIMIT = replace(NUMBER, id="b", form="relation", relation="<", published=1.0)
RUN = replace(NUMBER, id="c", form="draw", published=50.0, rounding=0.0)
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
    assert judge(claim, ConfidenceInterval(0.95, 0.85, 1.05)).verdict == "undecided"


def test_a_relation_without_uncertainty_is_sharp():
    assert judge(LIMIT, 1.0).verdict == "contradicted"
    assert judge(replace(LIMIT, relation="<="), 1.0).verdict == "reproduced"
    assert judge(LIMIT, 0.999).verdict == "reproduced"


@pytest.mark.parametrize(
    "published, verdict",
    [
        (50, "typical"),
        (3.1, "typical"),
        (1.9, "atypical"),
        (96.9, "typical"),
        (98.1, "atypical"),
        (2.6, "undecided"),
        (2.4, "undecided"),
        (97.4, "undecided"),
        (97.6, "undecided"),
    ],
)
def test_a_draw_is_typical_in_the_central_95_percent_of_ours(published, verdict):
    assert judge(replace(RUN, published=float(published)), Draws(HUNDRED)).verdict == verdict


def test_a_draw_may_be_anything_that_rounds_to_what_is_printed():
    claim = replace(RUN, published=1.9)
    assert judge(claim, Draws(HUNDRED)).verdict == "atypical"
    assert judge(replace(claim, rounding=2.0), Draws(HUNDRED)).verdict == "typical"


def test_the_percentile_tells_where_the_draw_lies_and_how_well_that_is_known():
    found = judge(replace(RUN, published=30.005), Draws(HUNDRED)).nearest.percentile
    assert found.value == pytest.approx(30)
    # The standard error of a share of 0.3 among 10 000 is 0.46 %.
    assert found.low == pytest.approx(30 - 1.96 * 0.46, abs=0.05)
    assert found.high == pytest.approx(30 + 1.96 * 0.46, abs=0.05)


def test_too_few_runs_leave_a_verdict_undecided():
    near = replace(RUN, published=96.0)
    assert judge(near, Draws(HUNDRED)).verdict == "typical"
    assert judge(near, Draws(HUNDRED[::100])).verdict == "undecided"
    # Four standard errors away another seed agrees; three are too few.
    assert judge(LIMIT, ConfidenceInterval(0.5, 0.26, 0.74)).verdict == "reproduced"
    assert judge(LIMIT, ConfidenceInterval(0.5, 0.24, 0.76)).verdict == "undecided"
    assert judge(LIMIT, ConfidenceInterval(1.5, 1.24, 1.74)).verdict == "undecided"


SIZE = replace(NUMBER, form="size", published=8.0, limit="about")
ABOUT = Choice("about", "reading", "about", (2.0,), "a word", date(2026, 11, 29), (4.0,))


@pytest.mark.parametrize(
    "ours, verdict",
    [
        (4.0, "reproduced"),
        (16.0, "reproduced"),
        (3.9, "contradicted"),
        (16.1, "contradicted"),
        (ConfidenceInterval(8.0, 6.1, 11.0), "reproduced"),
        (ConfidenceInterval(8.0, 5.9, 11.0), "undecided"),
        (ConfidenceInterval(20.0, 18.1, 21.0), "contradicted"),
        (ConfidenceInterval(8.0, 1.0, 31.0), "undecided"),
    ],
)
def test_a_size_holds_within_its_factor_both_ways(ours, verdict):
    assert judge(SIZE, ours, [ABOUT]).verdict == verdict


START = Choice("start", "reading", "start", ("one", "other"), "not told", date(2026, 11, 29))
COUNT = Choice("count", "ours", "count", (3, 5), "both are usual", date(2026, 11, 29), (2, 9))
OPEN = replace(LIMIT, choices=("start", "count"))


def swept(values):
    """Return evidence by start and count."""
    return sweep([START, COUNT], lambda start, count: values.get((start, count), 0.5))


def test_everything_that_is_left_open_is_tried_and_what_lies_beyond_one_at_a_time():
    found = combinations([START, COUNT])
    within = [(start, count) for start in ("one", "other") for count in (3, 5)]
    assert found[:4] == tuple(within)
    assert set(found[4:]) == {(start, count) for start in ("one", "other") for count in (2, 9)}
    both = replace(START, beyond=("third",))
    assert ("third", 2) not in combinations([both, COUNT])
    assert ("third", 3) in combinations([both, COUNT])


def test_a_verdict_is_one_over_all_that_is_left_open():
    assert judge(OPEN, swept({}), [START, COUNT]).verdict == "reproduced"
    found = judge(OPEN, swept({("one", 5): 1.5}), [START, COUNT])
    assert found.verdict == "underdetermined"
    assert found.flips == {
        "start": {"contradicted or reproduced": ("one",), "reproduced": ("other",)},
        "count": {"reproduced": (3,), "contradicted or reproduced": (5,)},
    }
    assert found.nearest.verdict == "reproduced"


def test_a_verdict_that_hangs_on_one_choice_names_its_values():
    found = judge(OPEN, swept({("one", 5): 1.5, ("other", 5): 1.5}), [START, COUNT])
    assert found.flips == {"count": {"reproduced": (3,), "contradicted": (5,)}}


def test_runs_that_do_not_tell_leave_the_whole_undecided_unless_the_text_does_already():
    near = ConfidenceInterval(0.9, 0.8, 1.1)
    assert judge(OPEN, swept({("one", 5): near}), [START, COUNT]).verdict == "undecided"
    both = {("one", 5): near, ("other", 3): 2.0}
    assert judge(OPEN, swept(both), [START, COUNT]).verdict == "underdetermined"


def test_what_lies_beyond_the_range_is_told_and_does_not_count():
    found = judge(OPEN, swept({("other", 9): 1.5}), [START, COUNT])
    assert found.verdict == "reproduced"
    assert [one.at for one in found.turned] == [{"start": "other", "count": 9}]


def test_a_value_beyond_does_not_turn_a_verdict_that_the_range_leaves_open():
    near = ConfidenceInterval(0.9, 0.8, 1.1)
    found = judge(OPEN, swept({("one", 5): 1.5, ("one", 9): near}), [START, COUNT])
    assert (found.verdict, found.turned) == ("underdetermined", ())
    found = judge(OPEN, swept({("one", 5): near, ("one", 9): 1.5}), [START, COUNT])
    assert found.verdict == "undecided"
    assert [one.verdict for one in found.turned] == ["contradicted"]


def test_the_limit_may_be_a_choice():
    claim = replace(LIMIT, published=None, limit="count", relation=">")
    assert judge(claim, 6.0, [COUNT]).verdict == "reproduced"
    assert [one.at["count"] for one in judge(claim, 6.0, [COUNT]).turned] == [9]
    found = judge(claim, 4.0, [COUNT])
    assert found.verdict == "underdetermined"
    assert found.flips == {"count": {"reproduced": (3,), "contradicted": (5,)}}
    # Not both beyond at once: a limit beyond is tried with the other choices in their range.
    open_too = replace(claim, choices=("start",))
    values = [START.values, (*COUNT.values, *COUNT.beyond)]
    points = judge(open_too, sweep([START], lambda start: 6.0), [START, COUNT]).points
    assert len(points) == len(values[0]) * len(values[1])


def test_statements_that_are_no_results_hold_or_fail():
    demand = replace(LIMIT, kind="demand", verdict="holds")
    assert judge(demand, 0.5).verdict == "holds"
    assert judge(demand, 1.5).verdict == "fails"
    assert judge(replace(RUN, kind="inference", verdict="holds"), Draws(HUNDRED)).verdict == "holds"
    with pytest.raises(ValueError, match=r"verdict of claim 'b' must be one of .*'holds'"):
        judge(replace(LIMIT, kind="demand"), 0.5)


@pytest.mark.parametrize(
    "evidence, message",
    [
        (0.5, "must be a Sweep over start, count, got 0.5"),
        (sweep([COUNT, START], lambda *_: 0.5), "must be a Sweep over start, count, got"),
        (Sweep(("start", "count"), {("one", 3): 0.5}), "must be a Sweep at .*got {"),
    ],
)
def test_a_sweep_that_leaves_something_out_is_refused(evidence, message):
    with pytest.raises(ValueError, match=message):
        judge(OPEN, evidence, [START, COUNT])


def test_a_choice_that_is_not_declared_is_refused():
    with pytest.raises(ValueError, match="choices must hold those of 'b', got none called 'count'"):
        judge(OPEN, swept({}), [START])
    with pytest.raises(ValueError, match="values and beyond of choice 'start' must differ"):
        judge(OPEN, swept({}), [replace(START, values=("one", "one")), COUNT])


def test_each_point_of_a_sweep_draws_noise_of_its_own_for_all_claims_at_once():
    def both(child, start, count):
        draw = child.normal()
        return {"a": draw, "b": draw + count}

    found = sweep([START, COUNT], both, np.random.default_rng(1))
    assert len(set(found["a"].points.values())) == len(combinations([START, COUNT]))
    assert found["b"].points["one", 5] == found["a"].points["one", 5] + 5
    with pytest.raises(ValueError, match="function must return evidence on the same claims"):
        sweep([COUNT], lambda count: {str(count): 1.0})


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
        (NUMBER, Draws(HUNDRED), "for 'a', a number, must be a number"),
        (NUMBER, [0.25, 0.25], r"must be numbers of shape \(\)"),
        (NUMBER, np.nan, "the evidence for 'a' must be finite, got nan"),
        (LIMIT, Draws(HUNDRED), "for 'b', a relation, must be a ConfidenceInterval"),
        (RUN, 50.0, "for 'c', a draw, must be Draws"),
        (RUN, Draws(HUNDRED, published=50.0), "must be given by the claim .*, got it twice"),
        (replace(RUN, published=None), Draws(HUNDRED), "got it not at all"),
        (NUMBER, Sweep((), {}), "for 'a', a number, must be a number"),
    ],
)
def test_evidence_of_the_wrong_kind_is_refused(claim, evidence, message):
    with pytest.raises(ValueError, match=message):
        judge(claim, evidence)


CHOICES = {claim: one.choices for one in map(read_document, documents()) for claim in one.claims}
CLAIMS = list(CHOICES)
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
    Sweep((), {}),
    Sweep(("a",), {("b",): np.nan}),
]


def axes(claim):
    """Return the choices that a claim names."""
    return [next(one for one in CHOICES[claim] if one.id == name) for name in claim.choices]


def test_the_documents_are_all_there():
    assert len(documents()) >= 5
    assert len(CLAIMS) >= 229


@pytest.mark.parametrize("evidence", NOTHING, ids=lambda value: str(value)[:40])
def test_no_claim_of_any_document_gets_a_verdict_from_what_is_no_evidence(evidence):
    """NaN above all: a broken computation must not look like a contradiction, or like a success."""
    for claim in CLAIMS:
        one, known = evidence, CHOICES[claim]
        if isinstance(evidence, Draws) and evidence.published is None and claim.published is None:
            one = replace(evidence, published=1.0)
        if claim.choices:
            one = Sweep(claim.choices, dict.fromkeys(combinations(axes(claim)), one))
        with pytest.raises(ValueError, match=re.escape(repr(claim.id))):
            judge(claim, one, known)


@pytest.mark.parametrize(
    "changed",
    [
        {"kind": "randm"}, {"form": "randm"}, {"verdict": "fine"}, {"rounding": np.nan},
        {"rounding": -1.0},
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
    alone = (c for c in CLAIMS if c.form == "number" and not c.choices)
    claim = next(c for c in alone if np.ndim(c.published) == 0)
    evidence = {claim.id: claim.published}
    assert judge_all(iter([claim]), evidence) == judge_all([claim], evidence)
