"""Trackers of scans with many detections take the gate of their settings."""

from dataclasses import replace

import numpy as np
import pytest

from dopplerlib.systems import asheim2015 as thesis
from tests.gate_edges import beside_the_gate

F, START = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([3.0, 0.2])


def edges(probability):
    """Return settings, and scans with an innovation just inside and outside their gate."""
    own = replace(thesis.filter_settings("modern", 1.0), gate_probability=probability)
    S = F @ own.P0 @ F.T + own.Q + np.diag(own.R((F @ START)[0]))
    return own, [(nu, inside) for nu, inside in beside_the_gate(S, probability)]


@pytest.mark.parametrize("probability", [0.9, 0.999])
def test_a_managed_track_takes_what_is_inside(probability):
    """Two detections in a row confirm it; the third scan shows whose they were."""
    own, pairs = edges(probability)
    for nu, inside in pairs:
        scans = np.array([[START], [F @ START + nu]])
        assert len(thesis.managed_tracks(scans, own)) == inside


@pytest.mark.parametrize("probability", [0.9, 0.999])
def test_data_association_takes_what_is_inside(probability):
    own, pairs = edges(probability)
    for nu, inside in pairs:
        _, missed = thesis.pda_ranges(np.array([[START], [F @ START + nu]]), own, x0=START)
        assert (missed[1] < 1) == inside
