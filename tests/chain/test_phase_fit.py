"""The phases of all samples hold far more than windows do, and a fit from the chain finds it.

Seeds were written down once and are not chosen.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from dopplerlib.chain.phase_fit import fit_phases
from dopplerlib.chain.simulation import simulate_baseband
from dopplerlib.systems import mittermaier2016 as paper

S = paper.reported().scenario
RUNS = 40


def truth(moment):
    return S.x0 + np.concatenate([moment * S.x0[3:], np.zeros(3)])


@pytest.fixture(scope="module")
def iq():
    settings = {"fs": 2000.0, "snr_db": 27.0, "factor": 1}
    return simulate_baseband(
        paper.reported().scenario, RUNS, rng=np.random.default_rng(95), **settings
    )


def test_from_the_state_of_the_chain_it_reaches_the_bound_of_the_samples(iq):
    """Three directions of 40 errors at 0.5 s; two-sided false alarm 1e-6, 20 % for the faults."""
    found = paper.track_iq(iq).at(0.5)[0]
    fitted = fit_phases(iq, found, 0.5)
    error = (fitted - truth(0.5))[:, :3]
    P = paper.position_bound_iq(0.5, 2000 * 10**2.7)
    score = np.sum(np.linalg.solve(np.linalg.cholesky(P), error.T) ** 2)
    assert chi2.ppf(5e-7, 3 * RUNS) < score < chi2.isf(5e-7, 3 * RUNS) * 1.2
    before = np.linalg.norm((found - truth(0.5))[:, :3], axis=-1)
    assert (np.linalg.norm(error, axis=-1).max()) < np.median(before) / 3


def test_without_noise_and_faults_it_finds_the_truth_and_stays_there():
    """The filter of the receiver leaves 1e-4 of a turn or so; a micrometer is 3e-4 of one."""
    settings = {"fs": 2000.0, "snr_db": None, "factor": 1, "faults": False}
    iq = simulate_baseband(paper.reported().scenario, 1, rng=np.random.default_rng(96), **settings)
    start = truth(1.0) + np.array([1e-3, -1e-3, 1e-3, 1e-3, 1e-3, -1e-3])
    once, often = (fit_phases(iq, start[None], 1.0, steps)[0] for steps in (5, 8))
    np.testing.assert_allclose(often, once, atol=1e-6)
    # A mean of half a percent that the echo has, and that is taken for a constant, remains.
    assert np.linalg.norm((once - truth(1.0))[:3]) < 5e-5


def test_what_makes_no_sense_is_refused_by_name(iq):
    with pytest.raises(ValueError, match="time must leave room for three samples"):
        fit_phases(iq, np.tile(truth(0.0), (RUNS, 1)), 0.0)
    with pytest.raises(ValueError, match="iq must be samples of modules with a Q"):
        fit_phases(replace(iq, without_q=True), np.tile(truth(0.5), (RUNS, 1)), 0.5)
    with pytest.raises(ValueError, match="x must have shape"):
        fit_phases(iq, truth(0.5), 0.5)
