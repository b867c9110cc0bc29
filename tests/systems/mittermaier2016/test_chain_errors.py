"""What is known at a moment, and how far that is from the truth: tracks that are written down."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dopplerlib.chain.track import IqTrack
from dopplerlib.systems import mittermaier2016 as paper

S = paper.reported().scenario
TIME = np.array([0.1, 0.2, 0.3, 0.4])
LATER = 0.03  # a shift is known so long after the moment it belongs to


def truth(time):
    return S.x0 + np.concatenate([time * S.x0[3:], np.zeros(3)])


@pytest.fixture
def found():
    """Two hypotheses in one run: the second is the truth, and the third sample decides for it."""
    rng = np.random.default_rng(5)
    root = rng.standard_normal((6, 6))
    P = np.tile(root @ root.T, (1, 2, 4, 1, 1))
    x = np.array([[truth(t) for t in TIME]] * 2)[None]
    x[0, 0] += 1.0
    score = np.array([[[1.0, 1.0, 9.0, 1.0], [2.0, 2.0, 2.0, 2.0]]])
    nis, memory = np.array([[[1.0, 2, 3], [4, 5, 6]]]), np.array([0.1])
    z = np.zeros((1, 4, 6))
    nu, S = np.zeros((1, 2, 3, 6)), np.zeros((1, 2, 3, 6, 6))
    last = nis, memory, score, np.array([18]), 0.5
    return IqTrack(TIME, TIME + LATER, z, z + 1, 1, x, P, nu, S, *last)


def test_the_likeliest_so_far_counts_whatever_comes_later(found):
    moments = TIME + LATER
    assert [int(found.at(m)[2][0]) for m in moments] == [0, 0, 1, 0]
    assert [int(found.at(m, carry=False)[2][0]) for m in moments] == [0, 0, 0, 0]


def test_nothing_is_known_before_its_window_ends(found):
    assert [found.samples_at(m) for m in (0.131, 0.2299, 0.23, 0.3)] == [0, 0, 1, 1]
    with pytest.raises(ValueError, match="time must not be before"):
        found.samples_at(0.12)


def test_between_samples_the_state_is_predicted_and_less_well_known(found):
    """The likeliest is now the second hypothesis, of sample 3."""
    moment = 0.35
    x, P, _ = found.at(moment)
    assert_allclose(x[0], truth(moment), atol=1e-12)
    assert_allclose(
        P[0], _predicted(found.P[0, 1, 2], moment - 0.3, found.velocity_random_walk), rtol=1e-12
    )


def _predicted(P, ahead, sigma):
    """Return F P F' + Q with the rank-one Q of Eq 17, sigma that of a second."""
    F = np.eye(6)
    F[:3, 3:] = ahead * np.eye(3)
    G = np.array([ahead**2 / 2] * 3 + [ahead] * 3)
    return F @ P @ F.T + np.outer(G, G) * sigma**2 / ahead


def test_nees_is_the_squared_error_in_units_of_the_covariance(found):
    """The first hypothesis is off by one in all six, and predicted for LATER."""
    r = paper.track_errors(found, (0.23,))
    off = -np.r_[np.full(3, 1 + LATER), np.ones(3)]
    expected = off @ np.linalg.inv(_predicted(found.P[0, 0, 1], LATER, 0.5)) @ off
    assert_allclose(r.error, [[np.sqrt(3) * (1 + LATER)]])
    assert_allclose(r.nees, [[expected]], rtol=1e-9)


def test_nis_is_that_of_the_hypothesis_that_counts_at_the_last_moment(found):
    for moments, mean in (((0.23,), 2.0), ((0.23, 0.33), 5.0)):
        assert_array_equal(paper.track_errors(found, moments).nis, [mean])
    assert_array_equal(found.final_nis, [[1.0, 2, 3]])
