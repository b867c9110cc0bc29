"""Every claim of the thesis has evidence, and the verdicts on record are those of the evidence."""

import numpy as np
import pytest

from dopplerlib.replication.claims import read_claims
from dopplerlib.systems.asheim2015.claims import stand_in_evidence
from dopplerlib.systems.asheim2015.published import data_file
from tests.claims import check_flips, check_references, check_verdicts, evidence_of

DOCUMENT = "asheim2015"
STAND_IN = read_claims(data_file("stand_in_claims.toml"))


@pytest.fixture(scope="module")
def evidence():
    return evidence_of(DOCUMENT, seed=1)


def test_the_verdicts_on_record_are_those_of_the_evidence(evidence):
    """Each verdict is decided: another seed would hardly change it."""
    check_verdicts(DOCUMENT, evidence)


def test_a_verdict_would_change_with_the_number(evidence):
    check_flips(DOCUMENT, evidence)


def test_every_claim_names_a_cell_and_a_test_that_are_there():
    check_references(DOCUMENT)


def test_the_simulated_walks_are_judged_apart(monkeypatch):
    """Chapter 6 has no published data: its claims stand in a list of their own."""
    monkeypatch.setattr("tests.claims.claims_of", lambda document: STAND_IN)
    found = stand_in_evidence(rng=np.random.default_rng(2))
    check_verdicts(DOCUMENT, found)
    check_flips(DOCUMENT, found)
    check_references(DOCUMENT)
    assert not {one.id for one in STAND_IN} & {
        one.id for one in read_claims(data_file("claims.toml"))
    }
