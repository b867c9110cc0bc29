"""The smoothed path is the least-squares path of the whole record."""

import numpy as np
import pytest

from dopplerlib import kf
from dopplerlib.estimation.smoother import rts_smooth
from dopplerlib.model.motion import cwna_process_noise, ncv_transition

K, n = 12, 2
F, Q = ncv_transition(0.5, dim=1), cwna_process_noise(0.5, 0.3, dim=1)
H, R = np.array([[1.0, 0.0]]), np.array([[0.4]])
x0, P0 = np.array([1.0, -1.0]), np.diag([4.0, 2.0])


def least_squares_path(z):
    """Return all states and their covariance from one regression: prior, motion, measurements."""
    root_Q, root_R = np.linalg.inv(np.linalg.cholesky(Q)), np.linalg.inv(np.linalg.cholesky(R))
    start = F @ P0 @ F.T + Q
    root_P = np.linalg.inv(np.linalg.cholesky(start))
    rows, right = [], []
    for k in range(K):
        at = np.zeros((n, K * n))
        at[:, k * n : (k + 1) * n] = np.eye(n)
        if k == 0:
            rows.append(root_P @ at)
            right.append(root_P @ F @ x0)
        else:
            before = np.roll(at, -n, axis=1)
            rows.append(root_Q @ (at - F @ before))
            right.append(np.zeros(n))
        rows.append(root_R @ H @ at)
        right.append(root_R @ z[k])
    A, b = np.vstack(rows), np.concatenate(right)
    x = np.linalg.lstsq(A, b, rcond=None)[0]
    return x.reshape(K, n), np.linalg.inv(A.T @ A).reshape(K, n, K, n)


def test_states_and_covariances_are_those_of_one_regression_over_the_record():
    z = np.random.default_rng(4).normal(size=(K, 1))
    track = kf(z, F, Q, H, R, x0, P0)
    x, P = rts_smooth(track.x, track.P, F, Q)
    path, joint = least_squares_path(z)
    # The regression has a condition number of 1e3, its normal equations 1e6.
    np.testing.assert_allclose(x, path, rtol=1e-9, atol=1e-9)
    for k in range(K):
        np.testing.assert_allclose(P[k], joint[k, :, k], rtol=1e-8, atol=1e-9)


def test_the_last_state_has_nothing_to_learn_and_the_others_gain():
    z = np.random.default_rng(5).normal(size=(3, K, 1))
    track = kf(z, F, Q, H, R, x0, P0)
    x, P = rts_smooth(track.x, track.P, F, Q)
    np.testing.assert_array_equal(x[:, -1], track.x[:, -1])
    np.testing.assert_array_equal(P[:, -1], track.P[:, -1])
    gain = np.linalg.eigvalsh(track.P[0, :-1] - P[0, :-1])
    # One scalar is left at the last sample but one: it teaches one direction, and not the other.
    assert (gain[:, 1] > 0.1).all() and (gain[:-1, 0] > 1e-6).all()
    assert abs(gain[-1, 0]) < 1e-14
    for run in range(3):
        alone, _ = rts_smooth(track.x[run], track.P[run], F, Q)
        np.testing.assert_allclose(x[run], alone, rtol=1e-12, atol=1e-13)


def test_one_covariance_serves_all_runs():
    z = np.random.default_rng(6).normal(size=(3, K, 1))
    track = kf(z, F, Q, H, R, x0, P0)
    x, _ = rts_smooth(track.x, track.P, F, Q)
    x_shared, P_shared = rts_smooth(track.x, track.P[0], F, Q)
    np.testing.assert_allclose(x_shared, x, rtol=1e-12, atol=1e-13)
    assert P_shared.shape == (K, n, n)


def test_uneven_times_are_even_ones_with_samples_that_are_missing():
    """White acceleration adds up over intervals exactly, so that a gap is one longer interval."""
    kept = [0, 1, 4, 5, 11]
    z = np.full((3, K, 1), np.nan)
    z[:, kept] = np.random.default_rng(7).normal(size=(3, 5, 1))
    full = kf(z, F, Q, H, R, x0, P0)
    steps = 0.5 * np.diff(kept, prepend=-1)
    moves = np.stack([ncv_transition(T, dim=1) for T in steps])
    noises = np.stack([cwna_process_noise(T, 0.3, dim=1) for T in steps])
    track = kf(z[:, kept], moves, noises, H, R, x0, P0)
    x, P = rts_smooth(track.x, track.P, moves, noises)
    even_x, even_P = rts_smooth(full.x, full.P, F, Q)
    np.testing.assert_allclose(x, even_x[:, kept], rtol=0, atol=1e-12)
    np.testing.assert_allclose(P, even_P[:, kept], rtol=0, atol=1e-12)


def test_shapes_that_do_not_fit_are_refused():
    x, P = np.zeros((K, n)), np.stack([np.eye(n)] * K)
    with pytest.raises(ValueError, match="P must have shape"):
        rts_smooth(x, P[1:], F, Q)
    with pytest.raises(ValueError, match="F must have shape"):
        rts_smooth(x, P, np.eye(3), Q)
    with pytest.raises(ValueError, match="x must be finite"):
        rts_smooth(x * np.nan, P, F, Q)


def test_from_a_state_that_forgot_the_one_before_there_is_nothing_to_learn():
    x, P = np.arange(8.0).reshape(4, n), np.stack([np.eye(n)] * 4)
    smoothed, covariance = rts_smooth(x, P, np.zeros((n, n)), 0 * Q)
    np.testing.assert_array_equal(smoothed, x)
    np.testing.assert_array_equal(covariance, P)
