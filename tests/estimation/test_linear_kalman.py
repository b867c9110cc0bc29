"""The linear Kalman filter is conditioning of one big Gaussian, done a sample at a time."""

import re

import numpy as np
import pytest
from scipy.stats import chi2, multivariate_normal

from dopplerlib import chi2_interval, kf, kf_predict, kf_update
from dopplerlib.model.motion import cwna_process_noise, ncv_transition

K, n, m = 7, 4, 2


def linear_model(seed=5):
    """Return a random F, Q, H, R, x0, P0 of states of length 4 seen by 2 measurements."""
    rng = np.random.default_rng(seed)

    def covariance(size):
        root = rng.standard_normal((size, size))
        return root @ root.T + 0.1 * np.eye(size)

    F = np.eye(n) + 0.3 * rng.standard_normal((n, n))
    H = rng.standard_normal((m, n))
    return F, covariance(n), H, covariance(m), rng.standard_normal(n), covariance(n)


def big_gaussian(F, Q, H, R, x0, P0):
    """Return mean and covariance of (x_K, z_1, ..., z_K), all at once and without recursion.

    Everything is a linear function of the independent (x_0, w_1, ..., w_K, n_1, ..., n_K).
    """
    sources = n + K * n + K * m
    spread = np.zeros((sources, sources))
    spread[:n, :n] = P0
    spread[n : n + K * n, n : n + K * n] = np.kron(np.eye(K), Q)
    spread[n + K * n :, n + K * n :] = np.kron(np.eye(K), R)
    state = np.zeros((n, sources))
    state[:, :n] = np.eye(n)
    rows = []
    for k in range(K):
        state = F @ state
        state[:, n + k * n : n + (k + 1) * n] += np.eye(n)
        noise = np.zeros((m, sources))
        noise[:, n + K * n + k * m : n + K * n + (k + 1) * m] = np.eye(m)
        rows.append(H @ state + noise)
    linear = np.vstack([state, *rows])
    return linear[:, :n] @ x0, linear @ spread @ linear.T


def test_filtered_state_is_that_of_the_big_gaussian():
    model = linear_model()
    z = np.random.default_rng(6).standard_normal((K, m))
    mean, joint = big_gaussian(*model)
    gain = np.linalg.solve(joint[n:, n:], joint[n:, :n]).T
    track = kf(z, *model)
    # Both are sums of some hundred terms of size 10 at most; the joint has condition 1e4.
    np.testing.assert_allclose(
        track.x[-1], mean[:n] + gain @ (z.ravel() - mean[n:]), rtol=1e-10, atol=1e-10
    )
    np.testing.assert_allclose(
        track.P[-1], joint[:n, :n] - gain @ joint[n:, :n], rtol=1e-10, atol=1e-10
    )


def test_likelihood_and_nis_of_the_innovations_are_those_of_the_big_gaussian():
    model = linear_model()
    z = np.random.default_rng(7).standard_normal((K, m))
    mean, joint = big_gaussian(*model)
    mean, joint = mean[n:], joint[n:, n:]
    track = kf(z, *model)
    parts = sum(
        multivariate_normal(cov=S).logpdf(nu)
        for nu, S in zip(track.innovation, track.S, strict=True)
    )
    assert parts == pytest.approx(multivariate_normal(mean, joint).logpdf(z.ravel()), rel=1e-10)
    whole = (z.ravel() - mean) @ np.linalg.solve(joint, z.ravel() - mean)
    assert track.nis.sum() == pytest.approx(whole, rel=1e-10)


def test_without_process_noise_it_is_recursive_least_squares():
    """A constant seen K times: the weighted least-squares fit with the prior as one more row."""
    _, _, H, R, x0, P0 = linear_model()
    z = np.random.default_rng(8).standard_normal((K, m))
    white = np.linalg.inv(np.linalg.cholesky(R))
    prior = np.linalg.inv(np.linalg.cholesky(P0))
    A = np.vstack([prior, *[white @ H] * K])
    b = np.concatenate([prior @ x0, *(white @ z_k for z_k in z)])
    x = np.linalg.lstsq(A, b, rcond=None)[0]
    track = kf(z, np.eye(n), np.zeros((n, n)), H, R, x0, P0)
    np.testing.assert_allclose(track.x[-1], x, rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(track.P[-1], np.linalg.inv(A.T @ A), rtol=1e-9, atol=1e-10)


def test_scalar_random_walk_reaches_the_golden_ratio():
    """F = Q = H = R = 1: the Riccati equation P = (P + 1) / (P + 2) has the root 1 / phi."""
    one = np.eye(1)
    track = kf(np.zeros((40, 1)), one, one, one, one, [0.0], one)
    # The error shrinks by phi^-4 = 0.146 a step: after 40 steps it is below rounding.
    assert track.P[-1, 0, 0] == pytest.approx((np.sqrt(5) - 1) / 2, rel=1e-14)


def test_mean_nis_and_nees_of_a_true_model_are_those_of_chi_square():
    """False-alarm probability 2e-6: two intervals of probability 1 - 1e-6."""
    F, Q, H, R, x0, P0 = linear_model()
    rng = np.random.default_rng(9)
    runs = 4000
    x = rng.multivariate_normal(x0, P0, size=runs)
    z = np.empty((runs, K, m))
    for k in range(K):
        x = x @ F.T + rng.multivariate_normal(np.zeros(n), Q, size=runs)
        z[:, k] = x @ H.T + rng.multivariate_normal(np.zeros(m), R, size=runs)
    track = kf(z, F, Q, H, R, x0, P0)
    lower, upper = chi2_interval(m, runs * K, confidence=1 - 1e-6)
    assert lower < track.nis.mean() < upper
    error = track.x[:, -1] - x
    nees = np.sum(error * np.linalg.solve(track.P[:, -1], error[..., None])[..., 0], axis=-1)
    lower, upper = chi2_interval(n, runs, confidence=1 - 1e-6)
    assert lower < nees.mean() < upper
    assert chi2.ppf(0.5e-6, n * runs) / runs == pytest.approx(lower)


def test_runs_in_a_batch_are_the_runs_alone():
    F, Q, H, R, x0, P0 = linear_model()
    rng = np.random.default_rng(10)
    z = rng.standard_normal((2, 3, K, m))
    x0 = x0 + rng.standard_normal((3, n))
    P0 = P0 * np.array([1.0, 2.0])[:, None, None, None]
    track = kf(z, F, Q, H, R, x0, P0)
    assert track.x.shape == (2, 3, K, n) and track.S.shape == (2, 3, K, m, m)
    for i, j in np.ndindex(2, 3):
        alone = kf(z[i, j], F, Q, H, R, x0[j], P0[i, 0])
        # Stacked products may be summed in another order than single ones.
        np.testing.assert_allclose(track.x[i, j], alone.x, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(track.P[i, j], alone.P, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(track.nis[i, j], alone.nis, rtol=1e-11)
    assert track.updated.all()


def test_update_agrees_with_the_information_form():
    _, _, H, R, x, P = linear_model(11)
    z = np.array([0.3, -0.7])
    x_new, P_new, innovation, S = kf_update(x, P, z, H, R)
    information = np.linalg.inv(P) + H.T @ np.linalg.solve(R, H)
    vector = np.linalg.solve(P, x) + H.T @ np.linalg.solve(R, z)
    np.testing.assert_allclose(P_new, np.linalg.inv(information), rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(x_new, np.linalg.solve(information, vector), rtol=1e-10)
    np.testing.assert_allclose(innovation, z - H @ x, rtol=1e-12)
    np.testing.assert_allclose(S, H @ P @ H.T + R, rtol=1e-12)


def test_predict_moves_and_spreads():
    x, P = kf_predict([1.0, 2.0], np.eye(2), [[1, 3], [0, 1]], [[0, 0], [0, 5]])
    assert x.tolist() == [7, 2]
    assert P.tolist() == [[10, 3], [3, 6]]  # by hand


def test_steps_take_one_jacobian_for_every_run():
    _, _, H, R, x, P = linear_model(12)
    H = H * np.array([1.0, 2.0, 3.0])[:, None, None]
    together = kf_update(x, P, np.zeros(m), H, R)
    for run in range(3):
        alone = kf_update(x, P, np.zeros(m), H[run], R)
        for got, want in zip(together, alone, strict=True):
            np.testing.assert_allclose(got[run], want, rtol=1e-11, atol=1e-12)


GOOD = {
    "z": np.zeros((K, m)), "F": np.eye(n), "Q": np.eye(n), "H": np.ones((m, n)),
    "R": np.eye(m), "x0": np.zeros(n), "P0": np.eye(n), "x": np.zeros(n), "P": np.eye(n),
}  # fmt: skip
ARGUMENTS = {
    kf: ("z", "F", "Q", "H", "R", "x0", "P0"),
    kf_predict: ("x", "P", "F", "Q"),
    kf_update: ("x", "P", "z", "H", "R"),
}
BAD = [
    # function, argument, value, the value as the message must give it, what was expected
    (kf, "z", np.zeros(K), "(7,)", "shape (..., any, 2)"),
    (kf, "z", np.zeros((K, m + 1)), "(7, 3)", "shape (..., any, 2)"),
    (kf, "z", np.zeros((0, m)), "(0, 2)", "at least one run and one sample"),
    (kf, "z", np.zeros((0, K, m)), "(0, 7, 2)", "at least one run and one sample"),
    (kf, "z", np.full((K, m), np.inf), "inf at index (0, 0)", "finite, or NaN where it is missing"),
    (kf, "z", np.zeros((K, m)) + 1j, "1.j", "real numbers"),
    (kf, "z", "text", "'text'", "real numbers"),
    (kf, "F", np.eye(n + 1), "(5, 5)", "shape (..., 4, 4)"),
    (kf, "F", np.stack([np.eye(n)] * 6), "(6, 4, 4)", "(7, 4, 4) with one for each sample"),
    (kf, "Q", -np.eye(n), "-1", "positive semidefinite"),
    (kf, "Q", np.triu(np.ones((n, n))), "1", "symmetric"),
    (kf, "Q", np.stack([np.eye(n)] * 6), "(6, 4, 4)", "(7, 4, 4) with one for each sample"),
    (kf, "H", np.ones(n), "(4,)", "shape (..., any, 4)"),
    (kf, "H", np.ones((K + 1, m, n)), "(8, 2, 4)", "one for each sample"),
    (kf, "R", np.zeros((m, m)), "0", "positive definite"),
    (kf, "R", 1.0, "()", "shape (..., 2, 2)"),
    (kf, "R", np.stack([np.eye(m)] * (K + 1)), "(8, 2, 2)", "one for each sample"),
    (kf, "x0", 0.0, "()", "shape (..., any)"),
    (kf, "x0", np.zeros((3, n)), "(3,)", "broadcast against the runs ()"),
    (kf, "P0", -np.eye(n), "-1", "positive semidefinite"),
    (kf, "P0", np.stack([np.eye(n)] * 3), "(3,)", "broadcast against the runs ()"),
    (kf_predict, "x", 0.0, "()", "shape (..., any)"),
    (kf_predict, "x", [0.0, np.nan, 0.0, 0.0], "nan at index (1,)", "finite"),
    (kf_predict, "P", np.ones(n), "(4,)", "shape (..., 4, 4)"),
    (kf_predict, "P", -np.eye(n), "-1", "positive semidefinite"),
    (kf_predict, "F", np.ones((1, n)), "(1, 4)", "shape (..., 4, 4)"),
    (kf_predict, "F", np.eye(n) * 1j, "1.j", "real numbers"),
    (kf_predict, "Q", 0, "()", "shape (..., 4, 4)"),
    (kf_predict, "Q", None, "None", "real numbers"),
    (kf_predict, "x", np.zeros((3, n)), "(3,) of x", "broadcast"),
    (kf_update, "x", "a", "'a'", "real numbers"),
    (kf_update, "P", np.eye(n + 1), "(5, 5)", "shape (..., 4, 4)"),
    (kf_update, "z", 0.0, "()", "shape (..., any)"),
    (kf_update, "z", [-np.inf, 0.0], "-inf at index (0,)", "finite, or NaN where it is missing"),
    (kf_update, "H", np.ones((m, n + 1)), "(2, 5)", "shape (..., 2, 4)"),
    (kf_update, "H", np.ones(n), "(4,)", "shape (..., 2, 4)"),
    (kf_update, "R", 1.0, "()", "shape (..., 2, 2)"),
    (kf_update, "R", np.zeros((m, m)), "0", "positive definite"),
    (kf_update, "z", np.zeros((3, m)), "(3,) of z", "broadcast"),
]


@pytest.mark.parametrize(("function", "name", "value", "got", "expected"), BAD)
def test_bad_input_is_named(function, name, value, got, expected):
    arguments = {key: GOOD[key] for key in ARGUMENTS[function]} | {name: value}
    if function is kf_update:
        arguments["z"] = arguments["z"] if name == "z" else np.zeros(m)
    if got in ("(3,) of x", "(3,) of z"):  # three runs against two
        arguments["P"] = np.stack([np.eye(n)] * 2)
    with pytest.raises(ValueError, match=rf"\b{name}\b.* must ") as raised:
        function(**arguments)
    message = str(raised.value)
    assert re.search(rf"got .*{re.escape(got)}", message, re.DOTALL), message
    assert expected in message


def test_runs_that_share_their_first_covariance_are_filtered_as_if_each_had_its_own():
    rng = np.random.default_rng(71)
    z, F, H = rng.standard_normal((3, 6, 1)), np.array([[1.0, 0.5], [0.0, 1.0]]), np.eye(1, 2)
    P0 = np.diag([2.0, 3.0])
    together = kf(z, F, 0.1 * np.eye(2), H, np.eye(1), np.zeros(2), P0)
    each = kf(z, F, 0.1 * np.eye(2), H, np.eye(1), np.zeros(2), np.stack([P0] * 3))
    for name in ("x", "P", "innovation", "S", "nis"):
        ours, theirs = getattr(together, name), getattr(each, name)
        assert ours.shape == theirs.shape
        np.testing.assert_allclose(ours, theirs, rtol=1e-13, atol=1e-15)


def test_a_component_that_is_missing_is_a_row_that_is_missing():
    """Filtered sample by sample with the rows that are there; two of the runs miss the same."""
    F, Q, H, R, x0, P0 = linear_model(13)
    z = np.random.default_rng(14).standard_normal((3, K, m))
    z[:, 1, 0] = z[:, 3] = z[1, 4, 1] = np.nan
    for runs in (z, z[[0, 2]]):  # covariances of their own, and shared
        track = kf(runs, F, Q, H, R, x0, P0)
        there = ~np.isnan(runs)
        np.testing.assert_array_equal(track.updated, there.any(axis=-1))
        np.testing.assert_array_equal(np.isnan(track.innovation), ~there)
        np.testing.assert_array_equal(np.isnan(track.nis), ~there.any(axis=-1))
        for run, record in enumerate(runs):
            x, P = x0, P0
            for k, row in enumerate(there[run]):
                x, P = kf_predict(x, P, F, Q)
                np.testing.assert_allclose(track.S[run, k], H @ P @ H.T + R, rtol=1e-10)
                x, P, nu, S = kf_update(x, P, record[k, row], H[row], R[row][:, row])
                np.testing.assert_allclose(track.x[run, k], x, rtol=1e-11, atol=1e-12)
                np.testing.assert_allclose(track.P[run, k], P, rtol=1e-11, atol=1e-12)
                if row.any():
                    expected = nu @ np.linalg.solve(S, nu)
                    np.testing.assert_allclose(track.nis[run, k], expected, rtol=1e-9)


def test_uneven_times_are_even_ones_with_samples_that_are_missing():
    """White acceleration adds up over intervals exactly, so that a gap is one longer interval."""
    kept = [0, 1, 4, 5, 11]
    z = np.full((12, 1), np.nan)
    z[kept] = np.random.default_rng(15).standard_normal((5, 1))
    H, R, start = np.eye(1, 2), [[0.1]], ([0.0, 1.0], np.eye(2))
    even = kf(z, ncv_transition(0.1, dim=1), cwna_process_noise(0.1, 2.0, dim=1), H, R, *start)
    steps = 0.1 * np.diff(kept, prepend=-1)
    F = np.stack([ncv_transition(T, dim=1) for T in steps])
    Q = np.stack([cwna_process_noise(T, 2.0, dim=1) for T in steps])
    track = kf(z[kept], F, Q, H, R, *start)
    np.testing.assert_allclose(track.x, even.x[kept], rtol=0, atol=1e-13)
    np.testing.assert_allclose(track.P, even.P[kept], rtol=0, atol=1e-13)
    together = kf(np.stack([z[kept]] * 2), F, Q, H, R, *start)
    np.testing.assert_allclose(together.x[1], track.x, rtol=0, atol=1e-13)


def test_one_matrix_means_the_same_for_all_samples():
    model = linear_model()
    z = np.random.default_rng(16).standard_normal((K, m))
    F, Q, *rest = model
    each = kf(z, np.stack([F] * K), np.stack([Q] * K), *rest)
    np.testing.assert_array_equal(each.x, kf(z, *model).x)
    np.testing.assert_array_equal(each.P, kf(z, *model).P)


def test_a_prediction_that_overflows_names_the_arguments():
    with pytest.raises(ValueError, match=r"^x, P, F, Q must keep the estimates within .* got inf"):
        kf_predict([1e200], [[1.0]], [[1e200]], [[1.0]])
    with pytest.raises(ValueError, match=r"^F, Q, H, R, x0, P0, z must keep .* at index"):
        kf(np.zeros((9, 1)), [[1e99]], [[1.0]], [[0.0]], [[1.0]], [1.0], [[1.0]])
