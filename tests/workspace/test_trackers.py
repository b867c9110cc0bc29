"""Trackers of the workspace: what all have in common, and one limit in which all are the same."""

import numpy as np
import pytest
from scipy.stats import chi2

from dopplerlib import constant_velocity, doppler_jacobian, doppler_shift
from dopplerlib.workspace._filters import FIRST
from dopplerlib.workspace.targets import (
    ARRAY,
    INTERVAL,
    SIGMA_A,
    SIGMA_F,
    draw_records,
    draw_targets,
)
from dopplerlib.workspace.trackers import TRACKERS, track_targets

DOUBTING = {
    "gated_start", "gated_start_ukf", "gate_paper", "gate_upper", "gate_soft", "gate_each",
    "huber", "student_t", "adaptive",
}  # fmt: skip
STARTED = {"paper", "own_covariance", "ekf_bayes", "iekf_bayes", "ring_iekf_bayes"} | DOUBTING
FROM_PRIOR = sorted(set(TRACKERS) - STARTED - {"batch", "moving_bank", "learning_bank"})
X0 = np.array([0.6, 0.1, 0.1, -0.7, 0.05, 0.0])
NARROW = np.diag([2e-3, 2e-3, 2e-3, 5e-3, 5e-3, 5e-3]) ** 2


@pytest.fixture(scope="module")
def records():
    """Return paths (2, 60, 6) and their records; the second record has an end."""
    truths, noise = np.random.default_rng(1).spawn(2)
    paths = draw_targets(2, rng=truths, prior=(X0, NARROW), samples=60)
    paths[1, 50:] = np.nan
    return paths, draw_records(paths, rng=noise)


@pytest.mark.parametrize("name", TRACKERS)
def test_estimates_begin_after_the_start_and_end_with_the_record(name, records):
    _, z = records
    every = 20 if name == "batch" else 5
    x, P = track_targets(z, name, every=every, rng=np.random.default_rng(2))
    assert x.shape == (2, 60 // every, 6)
    assert P.shape == (2, 60 // every, 6, 6)
    sample = np.arange(every, 61, every)
    there = np.tile(sample >= (FIRST if name in STARTED else 1), (2, 1))
    there[1] &= sample <= 50
    np.testing.assert_array_equal(np.isfinite(x).all(axis=-1), there)
    np.testing.assert_array_equal(np.isfinite(P).all(axis=(-2, -1)), there)
    np.testing.assert_array_equal(np.isnan(x).all(axis=-1), ~there)
    one, _ = track_targets(z[:1], name, every=every, rng=np.random.default_rng(2))
    # Alone or among others: rounding of matrix products may differ.
    np.testing.assert_allclose(one, x[:1], rtol=1e-6, atol=1e-9)


def kalman(z, x, P):
    """Return the estimate of the last sample by a filter that works with information matrices."""
    F, Q = constant_velocity(INTERVAL, SIGMA_A, "per_axis")
    for shifts in z:
        x, P = F @ x, F @ P @ F.T + Q
        H = doppler_jacobian(x, ARRAY)
        J = np.linalg.inv(P) + H.T @ H / SIGMA_F**2
        x = x + np.linalg.solve(J, H.T @ (shifts - doppler_shift(x, ARRAY))) / SIGMA_F**2
        P = np.linalg.inv(J)
    return x, P


@pytest.mark.parametrize("name", FROM_PRIOR)
def test_from_a_narrow_prior_all_are_one_kalman_filter(name, records):
    _, z = records
    x, P = track_targets(z[:1], name, every=60, prior=(X0, NARROW), rng=np.random.default_rng(2))
    expected, covariance = kalman(z[0], X0, NARROW)
    deviation = np.sqrt(np.diagonal(covariance))
    # Curvature over two millimeters; for particles their number, after a dozen times anew.
    sampled = name == "particles"
    assert np.abs((x[0, 0] - expected) / deviation).max() < (1 if sampled else 0.06)
    found = np.sqrt(np.diagonal(P[0, 0]))
    np.testing.assert_allclose(found, deviation, rtol=0.4 if sampled else 0.03)


def test_a_batch_near_the_ring_has_the_errors_that_it_claims():
    truths, noise = np.random.default_rng(3).spawn(2)
    paths = draw_targets(20, rng=truths, sigma_a=0, x0=[0.3, 0.05, 0.1, -0.5, 0.1, 0], samples=120)
    z = draw_records(paths, rng=noise)
    x, P = track_targets(z, "batch", every=120, sigma_a=0)
    error = x[:, 0] - paths[:, -1]
    nees = np.einsum("ri,ri->", error, np.linalg.solve(P[:, 0], error[..., None])[..., 0])
    # False alarm 1e-6 on both sides, if errors are small against the curvature.
    assert chi2.ppf(1e-6, 120) < nees < chi2.isf(1e-6, 120)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"tracker": "kalman"}, "tracker must be one of"),
        ({"tracker": "particles"}, "rng must be a numpy.random.Generator for tracker"),
        ({"tracker": "paper", "z": np.zeros((1, 10, 6))}, "z must have more than 10 samples"),
        ({"tracker": "ekf", "z": np.zeros((20, 6))}, "z must have"),
        ({"tracker": "ekf", "prior": (X0, np.zeros((6, 6)))}, "prior must"),
        ({"tracker": "ekf", "sigma_a": -1}, "sigma_a must be from 0"),
    ],
)
def test_what_cannot_be_tracked_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        track_targets(**({"z": np.zeros((1, 20, 6))} | arguments))


def test_a_start_may_be_given_and_one_that_is_lost_costs_the_others_nothing(records):
    _, z = records
    x, P = track_targets(z, "gated_bank", every=FIRST)
    start = x[:, 0], P[:, 0]
    own, given = track_targets(z, "huber"), track_targets(z, "huber", start=start)
    np.testing.assert_array_equal(given[0], own[0])
    np.testing.assert_array_equal(given[1], own[1])
    lost = np.where([[True], [False]], np.nan, start[0]), start[1]
    found, _ = track_targets(z, "huber", start=lost)
    assert np.isnan(found[0]).all()
    np.testing.assert_allclose(found[1], own[0][1], rtol=1e-6, atol=1e-9)
