"""The settled Kalman filter has the gains and the lag of the alpha-beta filter."""

import numpy as np
import pytest

from dopplerlib import kf
from dopplerlib.estimation.steady_state import steady_state_gain, steady_state_lag
from dopplerlib.model.motion import ncv_transition

T = 0.1
F, H = ncv_transition(T, dim=1), np.array([[1.0, 0.0]])


def kalata(sigma_a, sigma_z):
    """Return alpha and beta of position-only tracking in closed form (Kalata 1984)."""
    index = sigma_a * T**2 / sigma_z
    alpha = -(index**2 + 8 * index - (index + 4) * np.sqrt(index**2 + 8 * index)) / 8
    beta = (index**2 + 4 * index - index * np.sqrt(index**2 + 8 * index)) / 4
    return alpha, beta


@pytest.mark.parametrize("sigma_a", [0.1, 1.0, 30.0])
def test_gain_of_position_only_tracking_is_that_of_kalata(sigma_a):
    G = np.array([[T**2 / 2], [T]])
    K, _ = steady_state_gain(F, sigma_a**2 * G @ G.T, H, [[0.5**2]])
    alpha, beta = kalata(sigma_a, 0.5)
    # SciPy solves the Riccati equation by an ordered Schur form, good to about 1e-10 here.
    np.testing.assert_allclose(K[:, 0], [alpha, beta / T], rtol=1e-8)


def test_the_covariance_is_that_of_a_long_run():
    Q, H, R = np.diag([0.0, 0.01**2]), np.eye(2), np.diag([0.25, 1.0])
    K, P = steady_state_gain(F, Q, H, R)
    track = kf(np.zeros((3000, 2)), F, Q, H, R, np.zeros(2), R)
    # The slowest error decays as exp(-0.01 k).
    np.testing.assert_allclose(track.P[-1], P, rtol=1e-9)
    np.testing.assert_allclose(K, P @ H.T @ np.linalg.inv(R), rtol=1e-9)  # optimal: K = P H' / R


@pytest.mark.parametrize(("alpha", "beta"), [(0.5, 0.2), (0.1, 0.01)])
def test_lag_of_position_only_tracking_is_that_of_the_alpha_beta_filter(alpha, beta):
    """Position (1 - alpha) a T^2 / beta, velocity (2 alpha - beta) a T / (2 beta)."""
    a = 3.0
    K = np.array([[alpha], [beta / T]])
    lag = steady_state_lag(F, H, K, np.array([T**2 / 2, T]) * a)
    expected = [(1 - alpha) * a * T**2 / beta, (2 * alpha - beta) * a * T / (2 * beta)]
    np.testing.assert_allclose(lag, expected, rtol=1e-9)


def test_a_filter_without_noise_trails_an_accelerating_target_by_the_lag():
    a, Q, R = 2.0, np.diag([0.0, 0.05**2]), np.diag([0.25, 1.0])
    time = np.arange(2000) * T
    truth = np.stack([a * time**2 / 2, a * time], axis=-1)
    K, _ = steady_state_gain(F, Q, np.eye(2), R)
    track = kf(truth, F, Q, np.eye(2), R, truth[0], R)
    lag = steady_state_lag(F, np.eye(2), K, np.array([T**2 / 2, T]) * a)
    # Positions reach 40 km: rounding leaves 1e-11 m in each of them.
    np.testing.assert_allclose(truth[-1] - track.x[-1], lag, atol=1e-8)
    assert (lag > 0).all()


def test_lags_of_many_pushes_come_at_once():
    K = np.array([[0.5], [0.2 / T]])
    push = np.random.default_rng(1).normal(size=(3, 2, 2))
    lags = steady_state_lag(F, H, K, push)
    for i in np.ndindex(3, 2):
        np.testing.assert_allclose(lags[i], steady_state_lag(F, H, K, push[i]), rtol=1e-12)


def test_what_does_not_settle_is_refused():
    with pytest.raises(ValueError, match="F, H, Q must be detectable and stabilizable"):
        steady_state_gain(F, np.zeros((2, 2)), [[0.0, 1.0]], [[1.0]])
    with pytest.raises(ValueError, match="K must give a stable filter"):
        steady_state_lag(F, H, [[0.0], [0.0]], [0.0, 1.0])
    with pytest.raises(ValueError, match="R must be positive definite"):
        steady_state_gain(F, np.eye(2), H, [[0.0]])
    with pytest.raises(ValueError, match="Q must "):
        steady_state_gain(F, -np.eye(2), H, [[1.0]])
