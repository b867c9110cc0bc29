"""Every claim of the document has its verdict on record, and the evidence gives the same."""

import numpy as np
import pytest

from dopplerlib.systems import valarmathi as system
from tests.claims import check_flips, check_references, check_verdicts, claims_of, evidence_of

DOCUMENT = "valarmathi"


@pytest.fixture(scope="module")
def evidence():
    """One seed only, since it takes long; the chapter has another one."""
    return evidence_of(DOCUMENT, 3)


def test_every_claim_names_a_cell_and_a_test_that_exist():
    check_references(DOCUMENT)


def test_every_statement_of_abstract_results_and_conclusion_is_there():
    names = {claim.id for claim in claims_of(DOCUMENT)}
    abstract = {"low-snr", "adaptive-maneuver", "fusion-maneuver", "kalman-fails"}
    results = {
        "fusion-delay",
        "fusion-every-snr",
        "constant",
        "limit-fused",
        "limit-single",
        "paths",
    }
    conclusion = {"fusion-fast", "smoothing", "trade-off", "adaptive-delay", "same", "fighter"}
    windows = {"window-acceleration", "window-snr", "window-short", "window-long"}
    windows |= {"window-plane", "window-linear"}
    assert abstract | results | conclusion | windows <= names


def test_the_verdicts_are_those_of_the_evidence_whatever_the_seed(evidence):
    check_verdicts(DOCUMENT, evidence)


def test_the_verdicts_are_those_of_all_cells_of_the_study():
    cells = system.saved_study().cells()
    found = system.evidence(rng=np.random.default_rng(4), runs=20, cells=cells)
    check_verdicts(DOCUMENT, found)


def test_a_verdict_follows_from_the_number(evidence):
    check_flips(DOCUMENT, evidence)
