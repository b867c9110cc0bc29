"""Quadratic forms, densities and mixtures, against SciPy's, marginals and draws."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from dopplerlib.estimation import densities

m, runs = 3, 5
RNG = np.random.default_rng(24)


def covariance(size, *batch):
    root = RNG.standard_normal((*batch, size, size))
    return root @ root.mT + 0.1 * np.eye(size)


v, S = RNG.standard_normal((runs, m)), covariance(m, runs)


@pytest.mark.parametrize("there", [[True, True, True], [True, False, True], [False, True, False]])
def test_missing_components_leave_the_marginal(there):
    holes, few, small = np.where(there, v, np.nan), v[:, there], S[:, there][:, :, there]
    form = [one @ np.linalg.solve(C, one) for one, C in zip(few, small, strict=True)]
    np.testing.assert_allclose(densities.quadratic_form(holes, S), form, rtol=1e-11)
    np.testing.assert_allclose(densities.quadratic_form(few, small), form, rtol=1e-11)
    expected = [multivariate_normal(cov=C).logpdf(one) for one, C in zip(few, small, strict=True)]
    np.testing.assert_allclose(densities.log_density(holes, S), expected, rtol=1e-11)


def test_each_vector_may_miss_something_else_and_one_that_misses_all_has_no_form():
    holes = v.copy()
    holes[1, 0] = holes[2, 1:] = holes[3] = np.nan
    form, density = densities.quadratic_form(holes, S), densities.log_density(holes, S)
    for run in (0, 1, 2, 4):
        there = ~np.isnan(holes[run])
        marginal = multivariate_normal(cov=S[run][there][:, there])
        np.testing.assert_allclose(density[run], marginal.logpdf(v[run][there]), rtol=1e-11)
    assert np.isnan(form).tolist() == [False, False, False, True, False]
    assert density[3] == 0


def test_many_vectors_with_one_covariance_are_each_a_quadratic_form():
    many = RNG.standard_normal((runs, 7, m))
    each = densities.quadratic_form(many, S[:, None])
    np.testing.assert_allclose(densities.quadratic_forms(many, S), each, rtol=1e-11)
    many[2, 3] = np.nan
    many[2, 4, 0] = np.nan
    np.testing.assert_allclose(
        densities.quadratic_forms(many, S), densities.quadratic_form(many, S[:, None]), rtol=1e-11
    )
    assert densities.quadratic_forms(many[:, :0], S).shape == (runs, 0)


def test_the_moments_of_a_mixture_are_those_of_its_draws():
    """Five moments of 200 000 draws, each within 5 standard errors: by chance not at 3e-6."""
    weight, spread = np.array([0.2, 0.5, 0.3]), covariance(2, 3)
    means = 3 * RNG.standard_normal((3, 2))
    mean, cov = densities.mixture(means, spread, weight)
    rng = np.random.default_rng(22)
    part = rng.choice(3, size=200_000, p=weight)
    noise = rng.standard_normal((len(part), 2, 1))
    draws = means[part] + (np.linalg.cholesky(spread)[part] @ noise)[..., 0]
    off = draws - mean
    assert (np.abs(off.mean(axis=0)) < 5 * off.std(axis=0) / np.sqrt(len(off))).all()
    squares = off[:, :, None] * off[:, None, :]
    assert (np.abs(squares.mean(axis=0) - cov) < 5 * squares.std(axis=0) / np.sqrt(len(off))).all()
