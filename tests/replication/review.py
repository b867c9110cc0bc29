"""Checks that the claims of every document have to pass: all of them in test_documents.py."""

import ast
import json
from dataclasses import replace
from datetime import date
from functools import cache
from pathlib import Path

import numpy as np

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.replication.choices import Choice
from dopplerlib.replication.evidence import Draws, Sweep, combinations
from dopplerlib.replication.judgments import read_judgments
from dopplerlib.replication.verdicts import _together, judge

ROOT = Path(__file__).resolve().parents[2]
FAR = 1e12  # no quantity of any document comes near, in any unit


@cache
def cells(page):
    """Return the ids of the cells of a chapter that hold code."""
    text = (ROOT / "book" / f"{page}.ipynb").read_text(encoding="utf-8")
    return {cell["id"] for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"}


@cache
def functions(path):
    """Return the names of the functions of a file."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


def check_cells(entries):
    """The cells that claims or deviations name are there."""
    assert [one.id for one in entries if one.cell not in cells(one.page)] == []


def check_tests(claims):
    """The tests that claims name are there."""
    named = {one.id: one.test.partition("::") for one in claims}
    assert [id for id, (path, _, name) in named.items() if name not in functions(path)] == []


def check_record(document):
    """The judgments that the book shows are complete, and their verdicts those of the claims."""
    shown = read_judgments(document.name)
    assert {one.claim.id: one.verdict for one in shown} == {
        claim.id: claim.verdict for claim in document.claims
    }
    for one in shown:
        assert one.verdict == _together([p.verdict for p in one.points if not p.beyond])
        axes = document.choice(*one.claim.choices)
        wanted = list(combinations(axes)) if axes else [()]
        places = [tuple(point.at[name] for name in one.claim.choices) for point in one.points]
        assert list(dict.fromkeys(places)) == wanted, one.claim.id


def check_numbers(document, evidence):
    """The judgments that the book shows are those of this evidence, as far as it goes."""
    for there in read_judgments(document.name):
        claim, stored = there.claim, {tuple(point.at.items()): point for point in there.points}
        for at, piece in _at(evidence[claim.id]):
            place = dict(zip(claim.choices, at, strict=True))
            for ours in judge(replace(claim, choices=()), piece, document.choices).points:
                theirs = stored.get(tuple((place | ours.at).items()))
                if theirs is None:  # beyond the range of the limit and of another choice at once
                    assert ours.beyond
                    continue
                assert ours.verdict == theirs.verdict, (claim.id, place)
                for name in ("ours", "published", "percentile"):
                    values = [_values(getattr(point, name)) for point in (ours, theirs)]
                    np.testing.assert_allclose(*values, rtol=1e-6, atol=1e-12, err_msg=claim.id)


def check_flips(document, evidence):
    """A verdict follows from the number: with ours it is good, and just beyond ours it is bad."""
    for claim in document.claims:
        for one in _pieces(evidence[claim.id]):
            for right in _right(claim, one):
                assert _verdict(document, claim, one, right) in ("reproduced", "typical"), claim.id
            for wrong in _wrong(claim, one):
                assert _verdict(document, claim, one, wrong) in _BAD, claim.id
            if isinstance(one, ConfidenceInterval) and one.low < one.value < one.high:
                at_the_limit = one.value * (FACTOR if claim.form == "size" else 1)
                assert _verdict(document, claim, one, at_the_limit) == "undecided", claim.id


_BAD = ("contradicted", "atypical", "undecided")
FACTOR = 2.0


def _verdict(document, claim, evidence, published):
    """Judge one piece of evidence against one number, without what the claim leaves open."""
    evidence = Draws(evidence.values) if isinstance(evidence, Draws) else evidence
    bare = replace(
        claim, published=published, choices=(), limit=None, kind="result", verdict="reproduced"
    )
    if claim.form == "size":
        bare = replace(bare, limit="factor")
    factor = Choice("factor", "ours", "factor", (FACTOR,), "of this test", date(2026, 11, 29))
    return judge(bare, evidence, [factor]).verdict


def _at(evidence):
    """Return the pieces of evidence, each after the values of the choices that it is for."""
    return evidence.points.items() if isinstance(evidence, Sweep) else [((), evidence)]


def _pieces(evidence):
    return evidence.points.values() if isinstance(evidence, Sweep) else [evidence]


def _values(value):
    if value is None:
        return []
    if isinstance(value, ConfidenceInterval):
        return [value.value, value.low, value.high]
    return np.asarray(value, float)


def _right(claim, evidence):
    """Return what a document that agrees with us would have printed."""
    if claim.form == "size":
        return [_ends(evidence)[2]]
    if claim.form == "relation":
        low, high, _ = _ends(evidence)
        return [high + _step(claim, high) if "<" in claim.relation else low - _step(claim, low)]
    if claim.form == "draw":
        return [float(np.median(evidence.values))]
    return [np.asarray(evidence, float).tolist()]


def _wrong(claim, evidence):
    """Return numbers that are off by little more than they may be, each entry by itself."""
    if claim.form == "size":
        most = _ends(evidence)[1]
        return [1.01 * FACTOR * most, FAR] if most else [FAR]  # no factor leads away from zero
    if claim.form == "relation":
        low, high, _ = _ends(evidence)
        return (
            [low - _step(claim, low), -FAR]
            if "<" in claim.relation
            else [high + _step(claim, high), FAR]
        )
    if claim.form == "draw":
        low, high = np.min(evidence.values), np.max(evidence.values)
        return [low - _step(claim, low), high + _step(claim, high), -FAR, FAR]
    ours = np.asarray(evidence, float)
    wrong = []
    for place in np.ndindex(ours.shape):
        for step in (_step(claim, ours[place]), FAR):
            for sign in (-1, 1):
                moved = ours.copy()
                moved[place] += sign * step
                wrong.append(moved.tolist())
    return wrong


def _step(claim, value):
    return 1.01 * claim.rounding + 1e-6 * (1 + abs(float(value)))


def _ends(evidence):
    """Return the ends of an interval that other seeds would hardly leave, and its middle."""
    if not isinstance(evidence, ConfidenceInterval):
        return (float(evidence),) * 3
    middle = evidence.value
    return 2 * evidence.low - middle, 2 * evidence.high - middle, middle
