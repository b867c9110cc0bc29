"""Every statement of the document has its claim, and the whole study gives the same verdicts."""

import numpy as np

from dopplerlib.replication.documents import read_document
from dopplerlib.systems.valarmathi import saved_study
from dopplerlib.systems.valarmathi.evidence import evidence
from tests.replication.review import check_verdicts

CLAIMS = read_document("valarmathi").claims


def test_every_statement_of_abstract_results_and_conclusion_is_there():
    names = {claim.id for claim in CLAIMS}
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


def test_the_verdicts_are_those_of_all_cells_of_the_study():
    cells = saved_study().cells()
    found = evidence(rng=np.random.default_rng(4), runs=20, cells=cells)
    check_verdicts(CLAIMS, found)
