"""Every claim of the report has its verdict on record, and the evidence gives the same."""

import pytest

from tests.claims import check_flips, check_references, check_verdicts, evidence_of

DOCUMENT = "sombatsatien"


@pytest.fixture(scope="module", params=[1, 2])
def evidence(request):
    return evidence_of(DOCUMENT, request.param)


def test_every_claim_names_a_cell_and_a_test_that_exist():
    check_references(DOCUMENT)


def test_the_verdicts_are_those_of_the_evidence_whatever_the_seed(evidence):
    check_verdicts(DOCUMENT, evidence)


def test_a_verdict_follows_from_the_number(evidence):
    check_flips(DOCUMENT, evidence)
