"""The verdicts on record follow from the numbers, and the cells and tests that they name exist."""

import pytest

from tests import claims

DOCUMENT = "macaveiu2013"


@pytest.fixture(scope="module")
def evidence():
    return claims.evidence_of(DOCUMENT, seed=71)


def test_every_claim_names_a_cell_and_a_test():
    claims.check_references(DOCUMENT)


def test_the_verdicts_on_record_are_those_of_our_numbers(evidence):
    claims.check_verdicts(DOCUMENT, evidence)


def test_the_verdicts_follow_from_the_numbers(evidence):
    claims.check_flips(DOCUMENT, evidence)
