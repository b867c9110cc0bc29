"""A colored error as part of the state: the optimal filter, with innovations that are white."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import binom

from dopplerlib import (
    chi2_interval,
    ekf_records,
    innovation_whiteness,
    kf,
    steady_state_gain,
    ukf,
)
from dopplerlib.estimation.colored_errors import augment_functions, augment_linear
from dopplerlib.estimation.thinning import remedy_errors
from dopplerlib.model.motion import cwna_process_noise, ncv_transition

RHO, T, Q0, WHITE, RUNS, K = 0.8, 0.1, 0.05, 0.3, 200, 400
TAU = -T / np.log(RHO)
F, Q, H = ncv_transition(T, dim=1), cwna_process_noise(T, Q0, dim=1), np.array([[1.0, 0.0]])
R, P0 = np.array([[WHITE**2]]), np.diag([1.0, 0.5])


@pytest.fixture(scope="module")
def world():
    """Return states that start as the filter believes, and measurements with colored errors."""
    rng = np.random.default_rng(1)
    steps = rng.multivariate_normal(np.zeros(2), Q, (RUNS, K))
    before = rng.multivariate_normal(np.zeros(2), P0, RUNS)
    truth = np.empty((RUNS, K, 2))
    for k in range(K):
        before = before @ F.T + steps[:, k]
        truth[:, k] = before
    new = rng.standard_normal((RUNS, K))
    new[:, 1:] *= np.sqrt(1 - RHO**2)
    colored = lfilter([1], [1, -RHO], new, axis=1)
    return truth, truth[..., :1] + (colored + WHITE * rng.standard_normal((RUNS, K)))[..., None]


@pytest.fixture(scope="module")
def track(world):
    model = augment_linear(F, Q, H, R, np.zeros(2), P0, sigma=1.0, tau=TAU, T=T)
    return kf(world[1], *model)


def test_innovations_are_white_with_the_colored_state_and_not_without(world, track):
    """The number of rejections at 5 % is outside binomial limits for one seed in 10 000."""
    low, high = binom.ppf([5e-5, 1 - 5e-5], RUNS, 0.05)
    rejected = (innovation_whiteness(track.innovation, track.S, 10).p_value < 0.05).sum()
    assert low <= rejected <= high
    plain = kf(world[1], F, Q, H, R + 1, np.zeros(2), P0)
    assert (innovation_whiteness(plain.innovation, plain.S, 10).p_value < 0.05).mean() > 0.99


def test_nees_and_nis_are_those_of_a_consistent_filter(world, track):
    """Two samples far apart; each interval misses for one seed in a thousand."""
    error = track.x[..., :2] - world[0]
    nees = np.sum(error * np.linalg.solve(track.P[..., :2, :2], error[..., None])[..., 0], axis=-1)
    for k in (K // 2, K - 1):
        low, high = chi2_interval(2, RUNS, 0.999)
        assert low < nees[:, k].mean() < high
    low, high = chi2_interval(1, RUNS * K, 0.999)
    assert low < track.nis.mean() < high


def test_without_a_white_part_the_settled_filter_is_that_of_the_differences():
    """z_k - rho z_(k-1) has white errors: another Riccati equation. R adds 1e-8 of a variance."""
    model = augment_linear(F, Q, H, [[1e-8]], np.zeros(2), P0, sigma=1.0, tau=TAU, T=T)
    P = kf(np.zeros((400, 1)), *model).P[-1, :2, :2]
    want = remedy_errors(F, Q, H, RHO)["colored"].actual
    np.testing.assert_allclose(P, want, rtol=1e-5)


def test_the_covariance_settles_where_the_riccati_equation_says(track):
    F_all, Q_all, H_all, *_ = augment_linear(F, Q, H, R, np.zeros(2), P0, sigma=1.0, tau=TAU, T=T)
    _, P = steady_state_gain(F_all, Q_all, H_all, R)
    np.testing.assert_allclose(track.P[0, -1], P, rtol=1e-6)


def batch(z, t, sigma, white, start):
    """Return the least-squares estimate of a constant from errors of a full covariance."""
    there = ~np.isnan(z)
    C = sigma**2 * np.exp(-np.abs(t[:, None] - t) / TAU) + white**2 * np.eye(len(t))
    weights = np.linalg.solve(C[np.ix_(there, there)], np.ones(there.sum()))
    information = weights.sum() + 1 / start
    return weights @ z[there] / information, 1 / information


def test_uneven_times_and_gaps_are_those_of_generalized_least_squares():
    rng = np.random.default_rng(2)
    steps = rng.uniform(0.01, 0.5, 30)
    z = 3 + rng.standard_normal(30)
    z[rng.random(30) < 0.3] = np.nan
    model = augment_linear([[1]], [[0]], [[1]], [[0.04]], [0], [[100]], sigma=0.7, tau=TAU, T=steps)
    track = kf(z[:, None], *model)
    mean, variance = batch(z, np.cumsum(steps), 0.7, 0.2, 100)
    assert track.x[-1, 0] == pytest.approx(mean, rel=1e-9)
    assert track.P[-1, 0, 0] == pytest.approx(variance, rel=1e-9)


def test_functions_give_what_matrices_give(world):
    steps = np.random.default_rng(3).uniform(0.05, 0.2, 20)
    sigma = np.linspace(0.5, 2.0, 20)[:, None]
    errors = {"sigma": sigma, "tau": TAU, "T": steps}
    F_each = [ncv_transition(step, dim=1) for step in steps]
    z, x0 = world[1][:3, :20], np.zeros(2)
    want = kf(z, *augment_linear(F_each, Q, H, R, x0, P0, **errors))
    move = [lambda x, F=F: x @ F.T for F in F_each]
    slope = [lambda x, F=F: F for F in F_each]
    f, F_all, *rest = augment_functions(
        move, slope, Q, lambda x: x @ H.T, lambda x: H, R, x0, P0, **errors
    )
    Q_all, h, H_all, *start = rest
    for track in (
        ekf_records(z, f, F_all, Q_all, h, H_all, *start),
        ukf(z, f, Q_all, h, *start),
    ):
        np.testing.assert_allclose(track.x, want.x, atol=1e-9)
        np.testing.assert_allclose(track.P, want.P, atol=1e-9)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"sigma": 0.0}, "sigma must be positive"),
        ({"sigma": np.ones(2)}, r"sigma must broadcast to \(K, m\), m = 1"),
        ({"tau": -1.0}, "tau must be positive"),
        ({"tau": np.ones((3, 1))}, r"tau must broadcast to \(m,\)"),
        ({"T": np.ones((2, 2))}, r"T must be one number or have shape \(K,\)"),
        ({"T": np.ones(3), "sigma": np.ones((4, 1))}, "R must have the samples of T and sigma"),
        ({"F": np.stack([F] * 4), "T": np.ones(3)}, "F must have the samples of T and sigma"),
    ],
)
def test_wrong_arguments_are_named(changed, message):
    given = {"sigma": 1.0, "tau": 1.0, "T": 0.1, "F": F} | changed
    with pytest.raises(ValueError, match=message):
        augment_linear(given.pop("F"), Q, H, R, np.zeros(2), P0, **given)
