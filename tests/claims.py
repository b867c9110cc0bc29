"""Checks that the claims of every document have to pass; see tests/systems/*/test_claims.py."""

import ast
import json
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.replication.claims import read_claims
from dopplerlib.replication.verdicts import Draws, Readings, judge, judge_all

ROOT = Path(__file__).resolve().parents[1]
FAR = 1e12  # no quantity of any document comes near, in any unit


def claims_of(document):
    return read_claims(ROOT / "data" / document / "claims.toml")


def evidence_of(document, seed):
    room = import_module(f"dopplerlib.systems.{document}")
    module = room.evidence if "evidence" in dir(room) else room.claims
    return module.evidence(rng=np.random.default_rng(seed))


def check_references(document):
    """The cell and the test that a claim names are there."""
    for claim in claims_of(document):
        notebook = ROOT / "book" / f"{claim.page}.ipynb"
        cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
        assert claim.cell in [c["id"] for c in cells if c["cell_type"] == "code"], claim.id
        path, _, name = claim.test.partition("::")
        tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
        assert name in [node.name for node in tree.body if isinstance(node, ast.FunctionDef)], (
            claim.id
        )


def check_verdicts(document, evidence):
    """The verdicts on record are those of this evidence, and another seed would hardly differ."""
    judgments = judge_all(claims_of(document), evidence)
    found = {one.claim.id: one.verdict for one in judgments}
    assert found == {one.claim.id: one.claim.verdict for one in judgments}
    assert [one.claim.id for one in judgments if not one.decided] == []


def check_flips(document, evidence):
    """A verdict follows from the number: with ours it is good, and just beyond ours it is bad."""
    for claim in claims_of(document):
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
