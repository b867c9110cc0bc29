"""Every claim of the report has its verdict on record, and the evidence gives the same."""

import pytest

from tests.claims import check_flips, check_references, check_verdicts, evidence_of

DOCUMENT = "sombatsatien"


@pytest.fixture(scope="module")
def evidence():
    """One seed only, since it takes some seconds; the chapter has another one."""
    return evidence_of(DOCUMENT, 1)


def test_every_claim_names_a_cell_and_a_test_that_exist():
    check_references(DOCUMENT)


def test_the_verdicts_are_those_of_the_evidence_whatever_the_seed(evidence):
    check_verdicts(DOCUMENT, evidence)


def test_a_verdict_follows_from_the_number(evidence):
    check_flips(DOCUMENT, evidence)
