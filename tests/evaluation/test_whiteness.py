"""The tests of an innovation's mean and memory, on innovations made to pass or to fail.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest
from scipy.stats import chi2, kstest

from dopplerlib import innovation_mean, innovation_whiteness

FALSE_ALARM = 1e-6
RUNS, SAMPLES, M = 300, 400, 3


@pytest.fixture(scope="module")
def white():
    """Return innovations without memory, (runs, K, m), and covariances that change with time."""
    rng = np.random.default_rng(21)
    factor = 0.3 * rng.normal(size=(SAMPLES, M, M)) + np.eye(M)
    S = factor @ factor.swapaxes(-1, -2)
    normal = rng.standard_normal((RUNS, SAMPLES, M))
    return (np.linalg.cholesky(S) @ normal[..., None])[..., 0], S


def with_memory(rng, shape, rho):
    """Return Gaussian records of variance one whose neighbors have the correlation `rho`."""
    x = rng.standard_normal(shape)
    for k in range(1, shape[-2]):
        x[..., k, :] = rho * x[..., k - 1, :] + np.sqrt(1 - rho**2) * x[..., k, :]
    return x


def identity(samples, m):
    return np.tile(np.eye(m), (samples, 1, 1))


def test_the_mean_is_the_average_and_its_error_that_of_an_average():
    innovation = [[1.0, 10.0], [3.0, 30.0]]
    S = [np.diag([9.0, 1.0]), np.diag([16.0, 1.0])]
    mean, error = innovation_mean(innovation, S)
    assert mean.tolist() == [2, 20]
    # var((a + b) / 2) = (var a + var b) / 4
    np.testing.assert_allclose(error, [5 / 2, np.sqrt(2) / 2], rtol=1e-15)


def test_the_mean_of_a_right_filter_spreads_over_runs_as_its_standard_error_says(white):
    mean, error = innovation_mean(*white)
    assert mean.shape == (RUNS, M)
    total = np.sum((mean / error) ** 2, axis=0)  # chi-square distributed, one for each component
    tail = FALSE_ALARM / 2 / M
    assert (chi2.ppf(tail, RUNS) < total).all()
    assert (total < chi2.isf(tail, RUNS)).all()


def test_the_statistic_is_the_one_that_ljung_and_box_define():
    """Recomputed term by term, for one component of variance one, from its definition."""
    x = with_memory(np.random.default_rng(22), (30, 1), 0.4)[:, 0]
    result = innovation_whiteness(x[:, None], identity(30, 1), lags=4)
    centered = [value - sum(x) / 30 for value in x]
    r = [
        sum(centered[k] * centered[k - lag] for k in range(lag, 30)) / sum(c * c for c in centered)
        for lag in (1, 2, 3, 4)
    ]
    statistic = 30 * 32 * sum(r[lag - 1] ** 2 / (30 - lag) for lag in (1, 2, 3, 4))
    np.testing.assert_allclose(result.autocorrelation[:, 0], r, rtol=1e-12)
    assert result.statistic == pytest.approx(statistic, rel=1e-12)
    assert result.dof == 4
    # For an even number of degrees of freedom the tail is a finite sum.
    tail = np.exp(-statistic / 2) * (1 + statistic / 2)
    assert result.p_value == pytest.approx(tail, rel=1e-12)


def test_p_values_of_innovations_without_memory_are_uniform(white):
    result = innovation_whiteness(*white, lags=5)
    assert result.autocorrelation.shape == (RUNS, 5, M)
    assert result.statistic.shape == result.p_value.shape == (RUNS,)
    assert result.dof == 5 * M
    assert kstest(result.p_value, "uniform").pvalue > FALSE_ALARM


def test_the_correlation_at_any_lag_of_innovations_without_memory_is_as_small_as_chance(white):
    r = innovation_whiteness(*white, lags=5).autocorrelation
    # Each is nearly normal with variance 1/K; the sum of n squares lies in its interval.
    total = np.sum(SAMPLES * r**2)
    assert chi2.ppf(FALSE_ALARM / 2, r.size) < total < chi2.isf(FALSE_ALARM / 2, r.size)


def test_covariances_shared_by_all_runs_give_what_their_copies_give(white):
    innovation, S = white[0][:6], white[1]
    shared = innovation_whiteness(innovation.reshape(2, 3, SAMPLES, M), S[None, None])
    copied = innovation_whiteness(innovation, np.tile(S, (6, 1, 1, 1)))
    np.testing.assert_allclose(shared.statistic.ravel(), copied.statistic, rtol=1e-10)


@pytest.mark.parametrize("rho", [0.3, -0.3])
def test_memory_is_detected(rho):
    """Neighbors correlated by 0.3 raise the statistic from 15 by about 3 K 0.3^2 = 108.

    Its deviation is then about 20, so that hardly a run stays below 38, the bound at 0.001.
    """
    x = with_memory(np.random.default_rng(23), (RUNS, SAMPLES, M), rho)
    result = innovation_whiteness(x, identity(SAMPLES, M), lags=5)
    assert (result.p_value < 0.001).mean() > 0.98
    # Estimated from K samples it is too low by about (1 + 3 rho) / K = 0.005.
    assert result.autocorrelation[:, 0].mean() == pytest.approx(rho, abs=0.015)


def test_memory_in_one_component_of_three_is_detected():
    rng = np.random.default_rng(24)
    x = rng.standard_normal((RUNS, SAMPLES, M))
    x[..., 1:2] = with_memory(rng, (RUNS, SAMPLES, 1), 0.4)
    result = innovation_whiteness(x, identity(SAMPLES, M), lags=5)
    assert (result.p_value < 0.001).mean() > 0.98
    r = np.abs(result.autocorrelation[:, 0]).mean(axis=0)
    assert r[1] > 0.3 > 0.1 > max(r[0], r[2])


def test_the_unit_of_the_innovation_does_not_matter(white):
    innovation, S = white
    in_hz = innovation_whiteness(innovation, S)
    in_khz = innovation_whiteness(innovation / 1000, S / 1000**2)
    np.testing.assert_allclose(in_khz.statistic, in_hz.statistic, rtol=1e-9)
    mean, error = innovation_mean(innovation, S)
    mean_khz, error_khz = innovation_mean(innovation / 1000, S / 1000**2)
    np.testing.assert_allclose(mean_khz / error_khz, mean / error, rtol=1e-9)


def test_mixing_components_in_a_triangle_does_not_matter(white):
    """The Cholesky factor takes out any such mixture, and with it correlation within a sample."""
    innovation, S = white
    L = np.array([[2.0, 0, 0], [-1.5, 1.0, 0], [0.5, 3.0, 0.7]])
    mixed = L @ S @ L.T
    mixed = (mixed + mixed.swapaxes(-1, -2)) / 2
    np.testing.assert_allclose(
        innovation_whiteness(innovation @ L.T, mixed).autocorrelation,
        innovation_whiteness(innovation, S).autocorrelation,
        rtol=1e-9,
        atol=1e-11,  # 1e-16 times the condition numbers, some 1e3, with room
    )


def test_a_constant_offset_is_left_to_the_test_of_the_mean():
    x = np.random.default_rng(25).standard_normal((SAMPLES, M))
    S = identity(SAMPLES, M)
    np.testing.assert_allclose(
        innovation_whiteness(x + 5, S).statistic, innovation_whiteness(x, S).statistic, rtol=1e-9
    )
    mean, error = innovation_mean(x + 5, S)
    assert (mean / error > 50).all()


def test_a_batch_is_its_members(white):
    innovation, S = white
    each = np.broadcast_to(S, (RUNS, *S.shape))
    batch, mean = innovation_whiteness(innovation, S), innovation_mean(innovation, S)[0]
    again = innovation_whiteness(innovation, each)
    for run in (0, RUNS - 1):
        alone = innovation_whiteness(innovation[run], S)
        for result in (batch, again):
            np.testing.assert_allclose(result.statistic[run], alone.statistic, rtol=1e-12)
            np.testing.assert_allclose(result.p_value[run], alone.p_value, rtol=1e-9)
        np.testing.assert_allclose(innovation_mean(innovation[run], S)[0], mean[run], atol=1e-14)


X = np.random.default_rng(26).standard_normal((30, 2))
S2 = identity(30, 2)
NAN, INF = (np.where(np.arange(60).reshape(30, 2) == 7, bad, X) for bad in (np.nan, np.inf))


@pytest.mark.parametrize("function", [innovation_mean, innovation_whiteness])
@pytest.mark.parametrize(
    ("innovation", "S", "message"),
    [
        (INF, S2, "innovation must be finite, or NaN where it is missing, got inf"),
        (NAN, S2 * [[-1, 0], [0, 1]], "S must be positive definite"),
        (X, np.full((30, 2, 2), np.inf), "S must be finite, got inf"),
        (X[:, 0], S2, r"innovation must have shape|S must have shape"),
        (X, S2[:29], r"S must have shape \(\.\.\., 30, 2, 2\), got \(29, 2, 2\)"),
        (X, np.eye(2), r"S must have shape \(\.\.\., 30, 2, 2\), got \(2, 2\)"),
        (X, identity(30, 3), r"S must have shape \(\.\.\., 2, 2\), got \(30, 3, 3\)"),
        (X, 0 * S2, "S must be positive definite, got a smallest eigenvalue of 0"),
        (X, -S2, "S must be positive definite, got a smallest eigenvalue of -1"),
        (X, S2 + np.eye(2, k=1), "S must be symmetric"),
        (np.stack([X] * 5), np.stack([S2] * 4), r"innovation must have leading .*\(4,\) of S"),
    ],
)
def test_what_is_no_innovation_with_its_covariance_is_refused(function, innovation, S, message):
    with pytest.raises(ValueError, match=message):
        function(innovation, S)


@pytest.mark.parametrize("lags", [30, 31, 1000])
def test_too_few_samples_for_the_lags_are_refused(lags):
    message = f"lags must be less than the number of samples 30, got {lags}"
    with pytest.raises(ValueError, match=message):
        innovation_whiteness(X, S2, lags)
    assert innovation_whiteness(X, S2, 29).dof == 58


@pytest.mark.parametrize("lags", [0, -1, 2.0, True])
def test_a_number_of_lags_that_is_none_is_refused(lags):
    with pytest.raises(ValueError, match=f"lags must be a whole number of at least 1, got {lags}"):
        innovation_whiteness(X, S2, lags)


@pytest.mark.parametrize("value", [0.0, 0.1])
def test_an_innovation_that_never_changes_has_no_autocorrelation_and_is_refused(value):
    stuck = X.copy()
    stuck[:, 1] = value
    with pytest.raises(ValueError, match="innovation must vary in time, got a component"):
        innovation_whiteness(stuck, S2)


def test_outliers_hide_the_correlation_of_the_others_unless_there_is_a_limit():
    """Of 200 records at 5 %, 24 rejections of white ones or more come once in 10 000.

    Limited outliers add a third to the variance: a correlation of 0.44 becomes 0.33, 4.7 deviations
    of 199 values, which a test with five lags finds in 97 %: fewer than 180 come once in 10 000.
    """
    rng = np.random.default_rng(27)
    new = rng.standard_normal((200, 200, 1))
    colored = new[:, 1:] + 0.6 * new[:, :-1]
    outliers = np.where(rng.random(new.shape) < 0.02, 50.0, 0.0)
    S = identity(200, 1)

    def rejected(x, limit):
        return np.sum(innovation_whiteness(x, S[1:], 5, limit=limit).p_value < 0.05)

    assert rejected(colored + outliers[:, 1:], None) < 100
    assert rejected(colored + outliers[:, 1:], 4) > 180
    assert rejected(new[:, 1:] + outliers[:, 1:], 4) < 24


def test_a_limit_that_no_value_reaches_changes_nothing_also_where_some_are_missing():
    x = np.where(np.random.default_rng(28).random(X.shape) < 0.3, np.nan, X)
    x[:, 1] = np.nan
    some, all_ = innovation_whiteness(x, S2, 5, limit=100.0), innovation_whiteness(x, S2, 5)
    assert some.statistic == all_.statistic and some.dof == all_.dof == 5
    with pytest.raises(ValueError, match="limit must be positive, got 0"):
        innovation_whiteness(X, S2, 5, limit=0.0)
