"""The algebra of all filters, against conditioning of one Gaussian and what its docstring says."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from dopplerlib.estimation import covariances, densities, gaussian

n, m, runs = 4, 3, 5
RNG = np.random.default_rng(21)


def covariance(size, *batch):
    root = RNG.standard_normal((*batch, size, size))
    return root @ root.mT + 0.1 * np.eye(size)


x, P = RNG.standard_normal((runs, n)), covariance(n, runs)
F, Q, H, R = RNG.standard_normal((n, n)), covariance(n), RNG.standard_normal((m, n)), covariance(m)
innovation = RNG.standard_normal((runs, m))


@pytest.mark.parametrize("there", [[True, False, True], [False, True, False]])
def test_missing_components_are_as_if_they_had_no_row(there):
    """The marginal of a Gaussian is what is left of it without the row: states, NIS, likelihood."""
    holes = np.where(there, innovation, np.nan)
    few = innovation[:, there]
    got, got_P, S = gaussian.update(x, P, holes, H, R)
    want, want_P, small = gaussian.update(x, P, few, H[there], R[there][:, there])
    # The same sums in another order, of numbers of about one.
    np.testing.assert_allclose(got, want, rtol=0, atol=1e-12)
    np.testing.assert_allclose(got_P, want_P, rtol=0, atol=1e-12)
    np.testing.assert_allclose(S, H @ P @ H.T + R, rtol=1e-12)
    nis, density = densities.quadratic_form(holes, S), densities.log_density(holes, S)
    np.testing.assert_allclose(nis, densities.quadratic_form(few, small), rtol=1e-11)
    expected = [multivariate_normal(cov=one).logpdf(v) for v, one in zip(few, small, strict=True)]
    np.testing.assert_allclose(density, expected, rtol=1e-11)


def test_each_run_may_miss_something_else_and_one_that_misses_all_keeps_every_bit():
    holes = innovation.copy()
    holes[1, 0] = holes[2, 1:] = holes[3] = np.nan
    got, got_P, S = gaussian.update(x, P, holes, H, R)
    for run in range(runs):
        there = ~np.isnan(holes[run])
        want, want_P, _ = gaussian.update(
            x[run], P[run], holes[run][there], H[there], R[there][:, there]
        )
        np.testing.assert_allclose(got[run], want, rtol=0, atol=1e-12)
        np.testing.assert_allclose(got_P[run], want_P, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(got[3], x[3])
    np.testing.assert_array_equal(got_P[3], P[3])
    nis = densities.quadratic_form(holes, S)
    assert np.isnan(nis).tolist() == [False, False, False, True, False]
    assert densities.log_density(holes, S)[3] == 0


def test_many_vectors_with_one_covariance_are_each_a_quadratic_form():
    v = RNG.standard_normal((runs, 7, m))
    S = covariance(m, runs)
    each = densities.quadratic_form(v, S[:, None])
    np.testing.assert_allclose(densities.quadratic_forms(v, S), each, rtol=1e-11)
    v[2, 3] = np.nan
    v[2, 4, 0] = np.nan
    np.testing.assert_allclose(
        densities.quadratic_forms(v, S), densities.quadratic_form(v, S[:, None]), rtol=1e-11
    )
    assert densities.quadratic_forms(v[:, :0], S).shape == (runs, 0)


def test_the_moments_of_a_mixture_are_those_of_its_draws():
    """Five moments of 200 000 draws, each within 5 of its deviations: by chance not at 3e-6."""
    weight, means, spread = np.array([0.2, 0.5, 0.3]), 3 * x[:3, :2], covariance(2, 3)
    mean, cov = densities.mixture(means, spread, weight)
    rng = np.random.default_rng(22)
    part = rng.choice(3, size=200_000, p=weight)
    noise = rng.standard_normal((len(part), 2, 1))
    draws = means[part] + (np.linalg.cholesky(spread)[part] @ noise)[..., 0]
    off = draws - mean
    assert (np.abs(off.mean(axis=0)) < 5 * off.std(axis=0) / np.sqrt(len(off))).all()
    squares = off[:, :, None] * off[:, None, :]
    assert (np.abs(squares.mean(axis=0) - cov) < 5 * squares.std(axis=0) / np.sqrt(len(off))).all()


def test_results_are_symmetric_whatever_rounding_the_arguments_have_across_the_diagonal():
    lopsided = 1e-10 * np.triu(np.ones((n, n)), 1)
    _, predicted = gaussian.predict(x, P + lopsided, F, Q + lopsided)
    _, updated, S = gaussian.update(x, P + lopsided, innovation, H, R + lopsided[:m, :m])
    _, smoothed = gaussian.smooth(x, P + lopsided, F, Q + lopsided, x, P + lopsided)
    for matrix in (predicted, updated, S, smoothed, covariances.squared(F)):
        np.testing.assert_array_equal(matrix, matrix.mT)


def test_a_square_root_is_one_also_of_what_is_singular():
    flat = P[0].copy()
    flat[1] = flat[:, 1] = 0
    turn = np.linalg.qr(RNG.standard_normal((n, n)))[0]
    tilted = turn @ np.diag([3.0, 1.0, 0.0, 0.0]) @ turn.T
    for matrix in (P, flat, (tilted + tilted.T) / 2, np.zeros((n, n)), np.stack([P[0], flat])):
        root = covariances.square_root(matrix)
        np.testing.assert_allclose(root @ root.mT, matrix, rtol=0, atol=1e-14 * 50)
    assert (covariances.square_root(flat)[1] == 0).all()  # known exactly stays known exactly


def test_solving_with_a_singular_matrix_solves_what_can_be_solved():
    turn = np.linalg.qr(RNG.standard_normal((n, n)))[0]
    singular = turn @ np.diag([3.0, 1.0, 0.5, 0.0]) @ turn.T
    singular = (singular + singular.T) / 2
    b = singular @ RNG.standard_normal((n, 2))
    solution = covariances.solve(singular, b)
    np.testing.assert_allclose(singular @ solution, b, rtol=0, atol=1e-13)
    units = np.diag([1.0, 1e-6, 1e3, 1e6])
    scaled = covariances.solve(units @ singular @ units, units @ b)
    np.testing.assert_allclose(units @ scaled, solution, rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        covariances.solve(P, np.eye(n)), np.linalg.inv(P), rtol=0, atol=1e-10
    )


def test_what_is_not_finite_stays_so_and_does_not_reach_the_other_runs():
    broken = P.copy()
    broken[1, 0, 0] = np.inf
    _, got_P = gaussian.predict(x, broken, F, Q)
    _, want_P = gaussian.predict(x, P, F, Q)
    others = [0, 2, 3, 4]
    np.testing.assert_allclose(got_P[others], want_P[others], rtol=1e-12)
    assert not np.isfinite(got_P[1]).all()
    _, updated, _ = gaussian.update(x, broken, innovation, H, R)
    assert np.isfinite(updated[others]).all() and not np.isfinite(updated[1]).any()
