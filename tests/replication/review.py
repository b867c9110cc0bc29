"""Checks that the claims of every document have to pass: all of them in test_documents.py."""

import ast
import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.replication.readings import Draws, Readings
from dopplerlib.replication.verdicts import judge, judge_all

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


def check_verdicts(claims, evidence):
    """The verdicts on record are those of this evidence, and another seed would hardly differ."""
    judgments = judge_all(claims, evidence)
    found = {one.claim.id: one.verdict for one in judgments}
    assert found == {one.claim.id: one.claim.verdict for one in judgments}
    assert [one.claim.id for one in judgments if not one.decided] == []


def check_flips(claims, evidence):
    """A verdict follows from the number: with ours it is good, and just beyond ours it is bad."""
    for claim in claims:
        for one in _readings(evidence[claim.id]):
            for right in _right(claim, one):
                assert _verdict(claim, one, right) in ("reproduced", "typical"), claim.id
            for wrong in _wrong(claim, one):
                assert _verdict(claim, one, wrong) in ("contradicted", "atypical"), claim.id
            if isinstance(one, ConfidenceInterval) and one.low < one.value < one.high:
                assert _verdict(claim, one, one.value) == "underdetermined", claim.id


def _verdict(claim, evidence, published):
    evidence = Draws(evidence.values) if isinstance(evidence, Draws) else evidence
    return judge(replace(claim, published=published), evidence).verdict


def _readings(evidence):
    return evidence.by_name.values() if isinstance(evidence, Readings) else [evidence]


def _right(claim, evidence):
    """Return what a document that agrees with us would have printed."""
    if claim.kind == "relation":
        low, high = _ends(evidence)
        return [high + _step(claim, high) if "<" in claim.relation else low - _step(claim, low)]
    if claim.kind == "random":
        return [float(np.median(evidence.values))]
    return [np.asarray(evidence, float).tolist()]


def _wrong(claim, evidence):
    """Return numbers that are off by little more than they may be, each entry by itself."""
    if claim.kind == "relation":
        low, high = _ends(evidence)
        return (
            [low - _step(claim, low), -FAR]
            if "<" in claim.relation
            else [high + _step(claim, high), FAR]
        )
    if claim.kind == "random":
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
    if isinstance(evidence, ConfidenceInterval):
        return evidence.low, evidence.high
    return float(evidence), float(evidence)
