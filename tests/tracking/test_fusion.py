"""Fusion of two estimates against closed forms, one joint filter, and its own promise.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest
from scipy.stats import chi2

from dopplerlib import kf_predict, kf_update
from dopplerlib.tracking.fusion import (
    covariance_intersection,
    cross_covariance_step,
    fuse_measurements,
    fuse_state_vectors,
)

FALSE_ALARM = 1e-6
ROUNDING = 1e-12  # some tens of operations on numbers of about one


def covariances(rng, shape=(7,), n=3):
    A = rng.standard_normal((*shape, n, n))
    return A @ np.swapaxes(A, -1, -2) + 0.1 * np.eye(n)


@pytest.fixture
def two():
    rng = np.random.default_rng(1)
    x1, x2 = rng.standard_normal((2, 7, 3))
    return x1, covariances(rng), x2, covariances(rng)


def test_independent_estimates_fuse_to_the_mean_weighted_with_their_information(two):
    x1, P1, x2, P2 = two
    x, P = fuse_state_vectors(*two)
    I1, I2 = np.linalg.inv(P1), np.linalg.inv(P2)
    expected = np.linalg.inv(I1 + I2)
    mean = (expected @ (I1 @ x1[..., None] + I2 @ x2[..., None]))[..., 0]
    np.testing.assert_allclose(P, expected, rtol=0, atol=1e-10)
    np.testing.assert_allclose(x, mean, rtol=0, atol=1e-10)


def test_correlated_estimates_fuse_as_a_least_squares_problem_with_their_joint_covariance():
    rng = np.random.default_rng(2)
    joint = covariances(rng, (7,), 6)
    x1, x2 = rng.standard_normal((2, 7, 3))
    P1, P12, P2 = joint[:, :3, :3], joint[:, :3, 3:], joint[:, 3:, 3:]
    x, P = fuse_state_vectors(x1, P1, x2, P2, P12)
    H = np.vstack([np.eye(3)] * 2)
    information = H.T @ np.linalg.inv(joint)
    expected = np.linalg.inv(information @ H)
    mean = (expected @ information @ np.concatenate([x1, x2], -1)[..., None])[..., 0]
    np.testing.assert_allclose(P, expected, rtol=0, atol=1e-9)
    np.testing.assert_allclose(x, mean, rtol=0, atol=1e-9)


def test_the_order_of_the_two_does_not_matter(two):
    x1, P1, x2, P2 = two
    for fuse in (fuse_state_vectors, covariance_intersection):
        for one, other in zip(fuse(x1, P1, x2, P2), fuse(x2, P2, x1, P1), strict=True):
            # The slope of the determinant is zero at the best weight: half the digits are lost.
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-6)
    P12 = 0.1 * np.arange(9).reshape(3, 3) / 9
    one, other = fuse_state_vectors(*two, P12), fuse_state_vectors(x2, P2, x1, P1, P12.T)
    np.testing.assert_allclose(one[0], other[0], rtol=0, atol=1e-10)
    np.testing.assert_allclose(one[1], other[1], rtol=0, atol=1e-10)


def test_the_same_estimate_twice_is_worth_no_more_than_once_unless_taken_for_independent(two):
    x1, P1, *_ = two
    _, naive = fuse_state_vectors(x1, P1, x1, P1)
    np.testing.assert_allclose(naive, P1 / 2, rtol=0, atol=1e-10)
    x, P = covariance_intersection(x1, P1, x1, P1)
    np.testing.assert_allclose(P, P1, rtol=0, atol=1e-10)
    np.testing.assert_allclose(x, x1, rtol=0, atol=1e-10)


def test_fused_measurements_serve_one_filter_as_well_as_both_of_them():
    rng = np.random.default_rng(3)
    x, P = rng.standard_normal(2), covariances(rng, (), 2)
    H = np.array([[1.0, -0.1]])
    z1, z2 = rng.standard_normal((2, 1))
    R1, R2 = np.array([[0.3]]), np.array([[0.7]])
    both = kf_update(x, P, np.r_[z1, z2], np.vstack([H, H]), np.diag([0.3, 0.7]))
    z, R = fuse_measurements(z1, R1, z2, R2)
    one = kf_update(x, P, z, H, R)
    np.testing.assert_allclose(one[0], both[0], rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(one[1], both[1], rtol=0, atol=ROUNDING)


def steps(count, x0, P0, rng, runs):
    """Run two filters on one target; return their errors, covariances and P12 at the end."""
    T, q = 0.1, 2.0
    F = np.array([[1, T], [0, 1]])
    Q = q * np.array([[T**3 / 3, T**2 / 2], [T**2 / 2, T]])
    H = np.array([[1.0, 0.0]])
    R = np.array([[[0.5]], [[0.2]]])
    truth = rng.standard_normal((runs, 2)) @ np.linalg.cholesky(P0).T + x0
    x, P, P12 = np.tile(x0, (2, runs, 1)), np.stack([P0] * 2), P0
    for _ in range(count):
        truth = truth @ F.T + rng.standard_normal((runs, 2)) @ np.linalg.cholesky(Q).T
        K = []
        for s in range(2):
            xs, Ps = kf_predict(x[s], P[s], F, Q)
            K.append(Ps @ H.T / (H @ Ps @ H.T + R[s]))
            z = truth @ H.T + rng.standard_normal((runs, 1)) * np.sqrt(R[s, 0, 0])
            x[s], P[s], *_ = kf_update(xs, Ps, z, H, R[s])
        P12 = cross_covariance_step(P12, F, Q, K[0], H, K[1], H)
    return x, P, P12, truth


def mean_nees(x, P, truth):
    e = truth - x
    return float(np.mean(np.sum(e * np.linalg.solve(P, e[..., None])[..., 0], axis=-1)))


def test_errors_of_two_filters_on_one_target_have_the_cross_covariance_that_is_predicted():
    """NEES of 4000 runs: outside of the limits once in a million seeds."""
    runs = 4000
    x, P, P12, truth = steps(30, np.zeros(2), np.eye(2), np.random.default_rng(4), runs)
    low, high = chi2.ppf([FALSE_ALARM / 2, 1 - FALSE_ALARM / 2], 2 * runs) / runs
    right = mean_nees(*fuse_state_vectors(x[0], P[0], x[1], P[1], P12), truth)
    naive = mean_nees(*fuse_state_vectors(x[0], P[0], x[1], P[1]), truth)
    careful = mean_nees(*covariance_intersection(x[0], P[0], x[1], P[1]), truth)
    assert low < right < high
    assert naive > high  # it believes too much
    assert careful < high  # it may believe too little, never too much


def test_an_intersection_is_never_too_small_whatever_the_errors_have_in_common(two):
    x1, P1, x2, P2 = two
    L1, L2 = np.linalg.cholesky(P1), np.linalg.cholesky(P2)
    for w in (None, 0.3):
        _, P = covariance_intersection(x1, P1, x2, P2, w)
        weight = _weight(P, P1, P2) if w is None else np.full(7, w)
        rng = np.random.default_rng(5)
        for _ in range(50):
            turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
            P12 = L1 @ turn @ np.swapaxes(L2, -1, -2)  # fully correlated, in some way
            A = weight[:, None, None] * P @ np.linalg.inv(P1)
            B = (1 - weight)[:, None, None] * P @ np.linalg.inv(P2)
            cross = A @ P12 @ np.swapaxes(B, -1, -2)
            true = A @ P1 @ np.swapaxes(A, -1, -2) + B @ P2 @ np.swapaxes(B, -1, -2)
            true = true + cross + np.swapaxes(cross, -1, -2)
            assert np.linalg.eigvalsh(P - true).min() > -1e-9


def _weight(P, P1, P2):
    """Return the weights that a result of an intersection belongs to."""
    inverse, I1, I2 = np.linalg.inv(P), np.linalg.inv(P1), np.linalg.inv(P2)
    return np.trace(inverse - I2, axis1=-2, axis2=-1) / np.trace(I1 - I2, axis1=-2, axis2=-1)


def test_the_weight_of_an_intersection_has_the_least_determinant(two):
    best = np.linalg.det(covariance_intersection(*two)[1])
    for w in np.linspace(0, 1, 101):
        assert (best <= np.linalg.det(covariance_intersection(*two, w)[1]) * (1 + 1e-9)).all()


def test_an_estimate_and_itself_or_what_cannot_be_are_refused():
    """Their difference is known to be zero; or its variance would be 1 + 1 - 3 = -1."""
    for P12, least in (([[1.0]], "0"), ([[1.5]], "-1")):
        with pytest.raises(ValueError, match=f"^P12 must leave .* smallest eigenvalue of {least}$"):
            fuse_state_vectors([0.0], [[1.0]], [2.0], [[1.0]], P12)


def test_what_does_not_fit_is_refused():
    x, P = np.zeros(2), np.eye(2)
    with pytest.raises(ValueError, match="P2 must be positive semidefinite"):
        fuse_state_vectors(x, P, x, -P)
    with pytest.raises(ValueError, match="x2 must have shape"):
        fuse_state_vectors(x, P, np.zeros(3), P)
    with pytest.raises(ValueError, match=r"^x1, P1, x2, P2 must have leading axes that broadcast"):
        fuse_state_vectors(np.zeros((2, 2)), P, np.zeros((3, 2)), P)
    with pytest.raises(ValueError, match=r"P12 must have leading axes .* of P12$"):
        fuse_state_vectors(np.zeros((3, 2)), P, x, P, np.zeros((4, 2, 2)))
    with pytest.raises(ValueError, match=r"w must have leading axes .* of w$"):
        covariance_intersection(np.zeros((3, 2)), P, x, P, np.full(4, 0.5))
    with pytest.raises(ValueError, match=r"H2 must have leading axes .* of H2$"):
        K, H = np.ones((2, 1)), np.ones((1, 2))
        cross_covariance_step(np.stack([P] * 3), P, P, K, H, K, np.stack([H] * 4))
    with pytest.raises(ValueError, match=r"^R2 must be positive definite"):
        fuse_measurements(x, P, x, -P)
    with pytest.raises(ValueError, match="w must be from 0 to 1"):
        covariance_intersection(x, P, x, P, 1.5)
    with pytest.raises(ValueError, match="H2 must have shape"):
        cross_covariance_step(P, P, P, np.ones((2, 1)), [[1, 0]], np.ones((2, 1)), [[1, 0, 0]])
