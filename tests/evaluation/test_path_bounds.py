"""Bounds along paths, against the Kalman filter where the problem is linear, and each other."""

import numpy as np
import pytest

from dopplerlib import RadarArray, constant_velocity, doppler_jacobian, fisher_information
from dopplerlib.estimation.linear_kalman import kf_predict, kf_update
from dopplerlib.evaluation.path_bounds import path_crlb, pcrlb

RING = RadarArray.ring(6, 0.2)
PRIOR = np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
MEAN = np.array([0.8, 0, 0, -0.75, 0, 0])
T, SIGMA_F, K = 1e-3, 0.4, 120


def paths(runs, sigma_a, seed, spread=PRIOR):
    """Return true paths (runs, K, 6) drawn from the model, of which none comes near the ring."""
    rng = np.random.default_rng(seed)
    x = MEAN + rng.standard_normal((runs, 6)) @ np.sqrt(spread)
    x[:, 0] = 0.5 + np.abs(x[:, 0] - 0.5)
    found = np.empty((runs, K, 6))
    for k in range(K):
        a = sigma_a * rng.standard_normal((runs, 3))
        x = np.c_[x[:, :3] + T * x[:, 3:] + T**2 / 2 * a, x[:, 3:] + T * a]
        found[:, k] = x
    return found


def kalman(H, sigma_a, noise, sigma_f=SIGMA_F, T=T):
    """Return the covariances of `kf_predict` and `kf_update` for Jacobians H (K, N, 6)."""
    P, found, at = PRIOR, [], np.zeros(6)
    for k, rows in enumerate(H):
        F, Q = constant_velocity(np.broadcast_to(T, len(H))[k], sigma_a, noise)
        _, P = kf_predict(at, P, F, Q)
        sigma = np.broadcast_to(sigma_f, H.shape[:2])[k]
        z = np.where(np.isnan(sigma), np.nan, 0.0)
        _, P, *_ = kf_update(at, P, z, rows, np.diag(np.nan_to_num(sigma, nan=1.0) ** 2))
        found.append(P)
    return np.array(found)


def equal(got, want, tolerance):
    """Compare covariances as correlations."""
    deviation = np.sqrt(np.diagonal(want, axis1=-2, axis2=-1))
    scale = deviation[..., :, None] * deviation[..., None, :]
    np.testing.assert_allclose(got / scale, want / scale, atol=tolerance)


@pytest.mark.parametrize("noise", ["shared", "per_axis"])
def test_along_a_path_the_bound_is_the_covariance_of_a_kalman_filter(noise):
    x = paths(1, 0.4, 1)[0]
    sigma_f = np.random.default_rng(2).uniform(0.2, 1, (K, 6))
    sigma_f[3:9, 2] = sigma_f[40] = np.nan
    T_k = np.random.default_rng(3).uniform(5e-4, 2e-3, K)
    want = kalman(doppler_jacobian(x, RING), 0.4, noise, sigma_f, T_k)
    # The variance falls by a factor of 1e5 at most; both lose as many of sixteen digits.
    equal(path_crlb(x, RING, sigma_f, PRIOR, T_k, 0.4, noise), want, 1e-10)
    equal(pcrlb(x, RING, sigma_f, PRIOR, T_k, 0.4, noise), want, 1e-10)


def test_both_bounds_are_the_kalman_filter_where_the_shift_is_linear():
    """Sensors beyond all planets see the velocity alone, from everywhere along one direction."""
    rng = np.random.default_rng(4)
    direction = rng.standard_normal((4, 3))
    far = RadarArray(1e12 * direction / np.linalg.norm(direction, axis=1, keepdims=True))
    x = paths(30, 0.4, 5)
    want = kalman(doppler_jacobian(x[0], far), 0.4, "per_axis")
    # What is left of a derivative by position is 1e-10 of that by velocity.
    equal(path_crlb(x, far, SIGMA_F, PRIOR, T, 0.4), np.broadcast_to(want, (30, K, 6, 6)), 1e-9)
    equal(pcrlb(x, far, SIGMA_F, PRIOR, T, 0.4), want, 1e-9)


def test_at_constant_velocity_the_bound_is_the_inverse_of_prior_and_fisher_information():
    x = paths(8, 0.0, 6)
    J = fisher_information(x[:, 0], RING, SIGMA_F, K, T, "constant_velocity")
    back = np.linalg.inv(np.eye(6) + T * np.eye(6, k=3))  # from the first sample to the prior
    J += back.T @ np.linalg.inv(PRIOR) @ back
    F = np.eye(6) + (K - 1) * T * np.eye(6, k=3)
    equal(path_crlb(x, RING, SIGMA_F, PRIOR, T)[:, -1], F @ np.linalg.inv(J) @ F.T, 1e-9)


@pytest.mark.parametrize("sigma_a", [0.0, 0.4])
def test_the_posterior_bound_is_below_the_mean_along_paths(sigma_a):
    """Jensen, as matrices: no eigenvalue of the difference is negative but for rounding."""
    x = paths(200, sigma_a, 7)
    mean = path_crlb(x, RING, SIGMA_F, PRIOR, T, sigma_a).mean(axis=0)
    strict = pcrlb(x, RING, SIGMA_F, PRIOR, T, sigma_a)
    assert (np.linalg.eigvalsh(mean - strict)[:, 0] > -1e-12).all()
    assert np.trace(mean[-1, :3, :3]) > 4 * np.trace(strict[-1, :3, :3])


def test_a_path_that_has_ended_counts_no_longer():
    x = paths(3, 0.0, 8)
    x[0, 50:] = np.nan
    P, whole = (path_crlb(part, RING, SIGMA_F, PRIOR, every=20) for part in (x, paths(3, 0.0, 8)))
    assert np.isnan(P[0, 2:]).all()
    np.testing.assert_array_equal(P[0, :2], whole[0, :2])
    np.testing.assert_array_equal(P[1:], whole[1:])
    strict, whole = (pcrlb(part, RING, SIGMA_F, PRIOR, every=20) for part in (x, paths(3, 0.0, 8)))
    np.testing.assert_array_equal(strict[:2], whole[:2])
    assert np.isfinite(strict).all()


def test_a_path_has_the_same_bits_alone_and_on_any_number_of_workers():
    x = paths(130, 0.4, 9)[:, :20]
    one, three = (path_crlb(x, RING, SIGMA_F, PRIOR, T, 0.4, workers=w) for w in (1, 3))
    np.testing.assert_array_equal(one, three)
    np.testing.assert_array_equal(one[77], path_crlb(x[77], RING, SIGMA_F, PRIOR, T, 0.4))


@pytest.mark.parametrize("bound", [path_crlb, pcrlb])
def test_wrong_paths_are_named(bound):
    x = paths(2, 0.0, 10)
    gap, half, on_sensor = x.copy(), x.copy(), x.copy()
    gap[0, 5], half[1, 40:, 2], on_sensor[1, 7, :3] = np.nan, np.nan, RING.positions[3]
    for wrong in (gap, half):
        with pytest.raises(ValueError, match="x must be NaN from the end of a path on, got a gap"):
            bound(wrong, RING, SIGMA_F, PRIOR)
    with pytest.raises(ValueError, match=r"^x"):
        bound(on_sensor, RING, SIGMA_F, PRIOR)
