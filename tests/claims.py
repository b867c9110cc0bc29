"""Checks that the claims of every document have to pass; see tests/systems/*/test_claims.py."""

import ast
import json
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np

from dopplerlib.evaluation.claims import read_claims
from dopplerlib.evaluation.intervals import Estimate
from dopplerlib.evaluation.verdicts import Draws, Readings, judge, judge_all

ROOT = Path(__file__).resolve().parents[1]
FAR = 1e12  # no quantity of any document comes near, in any unit


def claims_of(document):
    return read_claims(ROOT / "data" / document / "claims.toml")


def evidence_of(document, seed):
    module = import_module(f"dopplerlib.systems.{document}.claims")
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
    """A verdict follows from the number: with a wrong one, or with ours, it is another."""
    for claim in claims_of(document):
        ours = evidence[claim.id]
        if claim.verdict in ("reproduced", "typical"):
            # Far away on the side where the statement fails; both are wrong for a number.
            sides = {"<": [-FAR], "<=": [-FAR], ">": [FAR], ">=": [FAR]}
            for wrong in sides.get(claim.relation, [-FAR, FAR]):
                verdict = _verdict(claim, ours, wrong)
                assert verdict in ("contradicted", "atypical"), claim.id
        else:
            verdicts = {_verdict(claim, ours, right) for right in (-FAR, FAR, *_values(ours))}
            assert verdicts - {claim.verdict}, claim.id
            if claim.verdict != "underdetermined":
                assert verdicts & {"reproduced", "typical"}, claim.id


def _verdict(claim, evidence, published):
    if isinstance(claim.published, list) and np.isscalar(published):
        published = [published] * len(claim.published)
    return judge(replace(claim, published=published), _without_published(evidence)).verdict


def _without_published(evidence):
    if isinstance(evidence, Readings):
        return Readings({name: _without_published(e) for name, e in evidence.by_name.items()})
    return Draws(evidence.values) if isinstance(evidence, Draws) else evidence


def _values(evidence):
    """Return our numbers: what a document that agreed with us would have printed."""
    if isinstance(evidence, Readings):
        return [value for one in evidence.by_name.values() for value in _values(one)]
    if isinstance(evidence, Draws):
        return [float(np.median(evidence.values))]
    return [evidence.value if isinstance(evidence, Estimate) else evidence]
