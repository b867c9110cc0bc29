"""Correlated errors of a start, and covariances that do not believe the given deviations."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from dopplerlib import RadarArray, doppler_shift, ml_initialize
from dopplerlib.signal.laws import overlap_correlation_discrete

ROAD = RadarArray([[0.0, 0.0, 0.0]])  # one module beside a road
LANE = [-100, 0.5, 0, 3, 0, 0], [0, 15, 0, 30, 0, 0]
X = np.array([-30, 4, 0, 12, 0, 0.0])
FREE = [0, 1, 3]
K, T, SIGMA = 100, 0.05, 5.0
TIMES = T * np.arange(K)
LAG = np.abs(np.subtract.outer(np.arange(K), np.arange(K)))


def shifts(x):
    states = np.tile(x, (K, 1))
    states[:, :3] += TIMES[:, None] * states[:, 3:]
    return doppler_shift(states, ROAD)


def starts(C, runs, seed, **options):
    """Return errors (runs, 3) and claimed covariances with errors of covariance C (K, K)."""
    rng, L = np.random.default_rng(seed), np.linalg.cholesky(C)
    noise = rng.standard_normal((runs, K)) @ L.T
    found = ml_initialize(shifts(X) + noise[..., None], ROAD, SIGMA, T, LANE, rng=rng, **options)
    return (found.x - X)[:, FREE], found.P[:, *np.ix_(FREE, FREE)], found


def mean_nees(errors, P):
    return np.mean(np.einsum("ri,rij,rj->r", errors, np.linalg.inv(P), errors)) / 3


AUTOREGRESSIVE = SIGMA**2 * 0.7**LAG
LOUD = SIGMA**2 * np.diag(np.where(abs(TIMES - 2.5) < 0.5, 16.0, 1.0))  # where it passes


@pytest.mark.parametrize("covariance", ["sandwich", "bootstrap"])
@pytest.mark.parametrize("C", [AUTOREGRESSIVE, LOUD], ids=["autoregressive", "loud"])
def test_claimed_deviations_follow_errors_that_are_not_as_assumed(C, covariance):
    """The median claimed deviation of the miss distance, over that of linear theory.

    A fit to errors of covariance C has the covariance G C G', G = (J'J)^-1 J'. The information is
    off by a factor of 1.7 and more. Within 1.6 is asked for of a sandwich and a bootstrap from 100
    windows, few of which see the vehicle pass; the median of 16 is good to 10 % or so.
    """
    step = 1e-4 * np.eye(6)[FREE]
    J = np.stack([(shifts(X + d) - shifts(X - d)).ravel() / 2e-4 for d in step], axis=1)
    G = np.linalg.solve(J.T @ J, J.T)
    exact = np.sqrt((G @ C @ G.T)[1, 1])
    _, P, found = starts(C, 16, 30, covariance=covariance, resamples=40)
    claimed = np.sqrt(np.median(P[:, 1, 1]))
    assert 1 / 1.6 < claimed / exact < 1.6
    assert not found.P[:, [2, 4, 5]].any()  # the box fixes them
    plain = ml_initialize(shifts(X), ROAD, SIGMA, T, LANE).P[1, 1]
    assert np.sqrt(plain) < exact / 1.7


def test_the_sandwich_is_that_of_white():
    # White (1980) by hand, with residuals over one less their leverage: HC3.
    rng = np.random.default_rng(31)
    z = shifts(X) + SIGMA * rng.standard_normal((K, 1))
    start = ml_initialize(z, ROAD, SIGMA, T, LANE, covariance="sandwich", lags=0)

    def residuals(u):
        return ((shifts(np.array([u[0], u[1], 0, u[2], 0, 0])) - z) / SIGMA).ravel()

    fit = least_squares(residuals, start.x[FREE], "3-point", x_scale="jac")
    J, r = fit.jac, fit.fun
    bread = np.linalg.inv(J.T @ J)
    r = r / (1 - np.einsum("ki,ij,kj->k", J, bread, J))
    by_hand = bread @ (J.T * r**2) @ J @ bread
    # Derivatives by differences are good to 1e-8.
    np.testing.assert_allclose(start.P[np.ix_(FREE, FREE)], by_hand, rtol=1e-4)


def test_known_correlation_gives_the_generalized_least_squares_estimate():
    correlation = overlap_correlation_discrete(100, np.arange(0, 100, 25))
    C = np.where(LAG < 4, correlation[np.minimum(LAG, 3)], 0.0)
    errors, P, found = starts(SIGMA**2 * C, 60, 32, correlation=correlation)
    # Chi-square of 120 squares of normal numbers: six deviations either way.
    assert mean_nees(errors, P) == pytest.approx(1, abs=6 * np.sqrt(2 / 180))
    assert found.converged.all()
    assert abs(found.cost.mean() - (K - 3)) < 6 * np.sqrt(2 * (K - 3) / 60)
    # Without it the same windows are used badly, and the covariance is that of other errors.
    worse, claimed, _ = starts(SIGMA**2 * C, 60, 32)
    assert np.mean(worse[:, 1] ** 2) > 1.2 * np.mean(errors[:, 1] ** 2)
    assert abs(mean_nees(worse, claimed) - 1) > 0.5
    # By SciPy, for one run: minimize r' C^-1 r.
    rng, L = np.random.default_rng(32), np.linalg.cholesky(SIGMA**2 * C)
    z = shifts(X).ravel() + (rng.standard_normal((60, K)) @ L.T)[0]

    def white(u):
        return np.linalg.solve(L, shifts(np.array([u[0], u[1], 0, u[2], 0, 0])).ravel() - z)

    fit = least_squares(white, X[FREE], "3-point", x_scale="jac", xtol=1e-14, ftol=1e-14)
    np.testing.assert_allclose(found.x[0, FREE], fit.x, rtol=1e-6)
    assert found.cost[0] == pytest.approx(2 * fit.cost, rel=1e-8)


@pytest.mark.parametrize("scale", ["given", "estimated"])
def test_a_correlation_that_residuals_contradict_is_not_passed_over(scale):
    # Errors as of a body: white, or alike over several windows; and the law of a tone in noise.
    correlation = overlap_correlation_discrete(100, np.arange(0, 100, 25))
    for C in (SIGMA**2 * np.eye(K), AUTOREGRESSIVE):
        _, _, found = starts(C, 4, 34, correlation=correlation, scale=scale)
        assert not found.converged.any()


def test_wrong_windows_are_left_out_of_correlated_ones():
    correlation = np.array([1, 0.4])
    C = np.where(LAG < 2, correlation[np.minimum(LAG, 1)], 0.0)
    rng = np.random.default_rng(33)
    z = shifts(X) + SIGMA * (np.linalg.cholesky(C) @ rng.standard_normal(K))[:, None]
    wrong = rng.random((K, 1)) < 0.15
    found = ml_initialize(
        np.where(wrong, 2500.0, z), ROAD, SIGMA, T, LANE, correlation=correlation,
        loss="bisquare", rng=rng,
    )  # fmt: skip
    assert ((found.weights == 0) == wrong).all() and set(np.unique(found.weights)) == {0, 1}
    without = ml_initialize(
        np.where(wrong, np.nan, z), ROAD, SIGMA, T, LANE, correlation=correlation
    )
    np.testing.assert_allclose(found.x, without.x, rtol=1e-6)
    np.testing.assert_allclose(found.P, without.P, rtol=1e-4, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"covariance": "jackknife"}, "covariance must be one of 'information', 'sandwich'"),
        ({"covariance": "bootstrap", "rng": None}, "rng must be a numpy.random.Generator"),
        ({"lags": -1}, "lags must be a whole number of at least 0"),
        ({"resamples": 1}, "resamples must be a whole number of at least 2"),
        ({"correlation": [0.5, 0.1]}, "correlation must begin with 1, at lag zero, got 0.5"),
        ({"correlation": [1.0, 0.9]}, "correlation must be that of some errors, a positive"),
    ],
)
def test_a_wrong_argument_is_named(change, message):
    arguments = {"z": shifts(X), "array": ROAD, "sigma_f": SIGMA, "T": T, "box": LANE}
    with pytest.raises(ValueError, match=message):
        ml_initialize(**arguments | change)
