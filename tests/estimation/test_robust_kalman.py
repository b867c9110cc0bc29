"""Robust filters minimize what they say they do, and without outliers they are the plain one."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import chi2

from dopplerlib import ekf_records
from dopplerlib.estimation.robust_kalman import robust_ekf

RNG = np.random.default_rng(53)
K, n, m, runs = 12, 4, 5, 6
F = np.eye(n) + 0.2 * RNG.standard_normal((n, n))
H = RNG.standard_normal((m, n))
ROOT = RNG.standard_normal((2, n, n))
Q, P0 = ROOT @ ROOT.mT
R = np.diag(RNG.uniform(0.2, 2, m))
x0 = RNG.standard_normal(n)
z = 3 * RNG.standard_normal((runs, K, m))  # there are outliers among them
z[0, 2] = z[1, 3:6, 0] = z[:, 8, 1] = np.nan
MODEL = [lambda x: x @ F.T, lambda x: F, Q, lambda x: x @ H.T, lambda x: H, R, x0, P0]
STILL = [lambda x: x, lambda x: np.eye(n), 0 * Q, *MODEL[3:]]
METHODS = "huber", "student-t", "gate", "adaptive"
PLAIN = {"threshold": 1e9, "degrees": 1e18, "gate_probability": 1 - 1e-16, "memory": 1e20}


@pytest.mark.parametrize("method", METHODS)
def test_where_nothing_is_doubted_it_is_the_extended_filter(method):
    track, want = robust_ekf(z, *MODEL, method, **PLAIN), ekf_records(z, *MODEL)
    for field in ("x", "P", "innovation", "S", "nis"):
        got, expected = getattr(track, field), getattr(want, field)
        # 1e-16 of the smallest eigenvalue: P of both is rounded in another order.
        np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-9 * np.nanmax(expected))
    np.testing.assert_array_equal(track.updated, want.updated)


def test_huber_minimizes_its_loss():
    """The sum of prior and Huber's loss is convex: any optimizer finds its minimum."""
    one = robust_ekf(z[2:, :1], *STILL, "huber").x[:, 0]
    for x, measured in zip(one, z[2:, 0], strict=True):

        def cost(x, measured=measured):
            r = np.abs(measured - H @ x) / np.sqrt(np.diag(R))
            loss = np.where(r < 1.345, r**2 / 2, 1.345 * (r - 1.345 / 2))
            return (x - x0) @ np.linalg.solve(P0, x - x0) / 2 + loss.sum()

        best = minimize(cost, x0, method="BFGS", options={"gtol": 1e-7})
        # Weights have settled to 1e-4, and the cost is flat.
        assert cost(x) - best.fun < 1e-4


def test_student_t_is_at_the_variational_fixed_point():
    """The same in information form: two formulas that have to agree with one another."""
    track = robust_ekf(z[2:, :1], *STILL, "student-t", degrees=3.0)
    information = np.linalg.inv(P0)
    for x, P, measured in zip(track.x[:, 0], track.P[:, 0], z[2:, 0], strict=True):
        w = np.ones(m)
        for _ in range(200):
            P_want = np.linalg.inv(information + H.T @ np.diag(w / np.diag(R)) @ H)
            x_want = P_want @ (information @ x0 + H.T @ (w / np.diag(R) * measured))
            square = (measured - H @ x_want) ** 2 + np.diag(H @ P_want @ H.T)
            w = 4 / (3 + square / np.diag(R))
        P_want = np.linalg.inv(information + H.T @ np.diag(w / np.diag(R)) @ H)
        x_want = P_want @ (information @ x0 + H.T @ (w / np.diag(R) * measured))
        np.testing.assert_allclose(x, x_want, rtol=0, atol=1e-3)  # weights have settled to 1e-4
        np.testing.assert_allclose(P, P_want, rtol=0, atol=1e-3)


def test_what_the_gate_refuses_counts_as_missing():
    track = robust_ekf(z, *MODEL, "gate", gate_probability=0.7)
    square = track.innovation**2 / np.diagonal(track.S, axis1=-2, axis2=-1)
    refused = square > chi2.ppf(0.7, 1)
    assert 0.1 < refused.mean() < 0.9
    left = ekf_records(np.where(refused, np.nan, z), *MODEL)
    np.testing.assert_allclose(track.x, left.x, rtol=1e-9)
    np.testing.assert_array_equal(track.updated, left.updated)


def test_adaptive_is_the_recursion_of_a_scalar_filter():
    measured, variance, x, P, factor = [4.0, 5.5, np.nan, 3.0, 4.4], 0.25, 3.0, 2.0, 1.0
    track = robust_ekf(
        np.reshape(measured, (5, 1)), lambda x: x, lambda x: [[1.0]], [[0.1]], lambda x: x,
        lambda x: [[1.0]], [[variance]], [x], [[P]], "adaptive", memory=4.0,
    )  # fmt: skip
    for k, value in enumerate(measured):
        P += 0.1
        S = P + factor * variance
        assert track.S[k, 0, 0] == pytest.approx(S, rel=1e-12)
        if not np.isnan(value):
            x, P = x + P / S * (value - x), P * factor * variance / S
            factor += (((value - x) ** 2 + P) / variance - factor) / 4
        assert track.x[k, 0] == pytest.approx(x, rel=1e-12)


def test_adaptive_finds_the_noise_of_one_sensor():
    """Of three that measure a constant velocity, the second has three times its deviation."""
    rng, T = np.random.default_rng(7), 0.01
    motion, see = np.array([[1, T], [0, 1]]), np.array([[1.0, 0], [1, 0], [0, 1]])
    path = np.stack([T * np.arange(4000), np.ones(4000)], axis=-1)
    noise = rng.standard_normal((4000, 3)) * [1, 3, 1]
    track = robust_ekf(
        path @ see.T + noise, lambda x: x @ motion.T, lambda x: motion, 1e-8 * np.eye(2),
        lambda x: x @ see.T, lambda x: see, np.eye(3), [0.0, 1.0], np.eye(2), "adaptive",
        memory=300.0,
    )  # fmt: skip
    # The mean of squares over 2 x 300 samples is off by sqrt(2 / 600) = 6 % of R: 5 sigma, 1e-6.
    np.testing.assert_allclose(np.diagonal(track.S[-1]), [1, 9, 1], rtol=0.3)


def test_sample_by_sample_it_is_the_whole_record():
    whole = robust_ekf(z, *MODEL, "student-t")
    state = [x0, P0]
    for k in range(K):
        track = robust_ekf(z[:, k : k + 1], *MODEL[:6], *state, "student-t")
        state = [track.x[:, -1], track.P[:, -1]]
        np.testing.assert_array_equal(track.x[:, 0], whole.x[:, k])


def test_dependent_errors_and_no_memory_are_refused():
    with pytest.raises(ValueError, match=r"^R must be diagonal, got"):
        robust_ekf(z, *MODEL[:5], R + 0.01, *MODEL[6:], "huber")
    with pytest.raises(ValueError, match=r"^memory must be at least one sample, got 0.5"):
        robust_ekf(z, *MODEL, "adaptive", memory=0.5)
