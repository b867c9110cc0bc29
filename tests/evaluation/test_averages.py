"""Averages of correlated values: closed forms, and right filters on average.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest

from dopplerlib import (
    average_interval,
    chi2_interval,
    constant_velocity,
    effective_samples,
    kf,
    nees,
    nees_samples,
)


@pytest.mark.parametrize(("dof", "runs"), [(1, 1), (6, 1), (2, 50), (6, 1001)])
def test_the_interval_of_independent_values_is_that_of_chi_square(dof, runs):
    np.testing.assert_allclose(
        average_interval(dof, runs, 0.9), chi2_interval(dof, runs, 0.9), rtol=1e-12
    )


def test_a_fractional_number_of_samples_lies_between_its_neighbors():
    low, high = zip(*(average_interval(6, m) for m in (3, 3.5, 4)), strict=True)
    assert low[0] < low[1] < low[2] < 6 < high[2] < high[1] < high[0]


def test_the_interval_has_the_mean_and_the_variance_of_the_average():
    """Few degrees of freedom in all: a chi-square of 4 dof, scaled to the mean 2, by hand.

    With two dof each, and worth two samples, the average is chi-square(4) / 2, whose upper tail is
    exp(-q) (1 + q) at q.
    """
    _, upper = average_interval(2, 2.0, 0.95)
    assert np.exp(-upper) * (1 + upper) == pytest.approx(0.025, rel=1e-9)


@pytest.mark.parametrize("rho", [-0.5, 0.3, 0.9, 0.99])
def test_an_autoregressive_average_is_worth_what_its_closed_form_says(rho):
    """The variance of the mean of K AR(1) values, summed by hand as a geometric series."""
    K = 200
    ratio = (1 + rho) / (1 - rho) - 2 * rho * (1 - rho**K) / (K * (1 - rho) ** 2)
    assert effective_samples(rho ** np.arange(1, K), K) == pytest.approx(K / ratio, rel=1e-10)


def test_values_without_memory_are_worth_themselves_and_equal_ones_a_single_one():
    assert effective_samples(np.zeros(5), 100) == 100
    assert effective_samples(np.ones(99), 100) == pytest.approx(1, rel=1e-12)


def test_leading_axes_are_kept():
    assert effective_samples(np.zeros((2, 3, 4)), 10).shape == (2, 3)


def test_scalar_nees_forgets_with_the_square_of_what_the_error_forgets():
    """In the steady state the error is AR(1) with a = P / (P + Q), its square AR(1) with a^2.

    P is the steady state of a random walk with Q = 0.5 and R = 1: P_pred^2 = Q P_pred + Q R.
    """
    Q, R, K = 0.5, 1.0, 300
    predicted = (Q + np.sqrt(Q**2 + 4 * Q * R)) / 2
    P = predicted * R / (predicted + R)
    a = P / predicted
    expected = effective_samples(a ** (2 * np.arange(1, K)), K)
    assert nees_samples(np.full((K, 1, 1), P), [[1]], [[Q]]) == pytest.approx(expected, rel=1e-10)


def test_nees_of_states_that_are_forgotten_at_once_is_worth_all_its_samples():
    P = np.tile(np.eye(2), (50, 1, 1))
    assert nees_samples(P, np.zeros((2, 2)), np.eye(2)) == pytest.approx(50, rel=1e-12)


def test_nees_of_an_error_that_never_changes_is_worth_one_sample():
    P = np.tile(np.diag([1.0, 4.0]), (50, 1, 1))
    assert nees_samples(P, np.eye(2), np.zeros((2, 2))) == pytest.approx(1, rel=1e-12)


def test_units_do_not_matter():
    rng = np.random.default_rng(31)
    A = rng.normal(size=(20, 3, 3))
    P = A @ A.swapaxes(-1, -2) + np.eye(3)
    F, Q, U = np.eye(3) + 0.1 * rng.normal(size=(3, 3)), np.eye(3), np.diag([1, 1e3, 1e-3])
    scaled = nees_samples(U @ P @ U, U @ F @ np.linalg.inv(U), U @ Q @ U)
    assert scaled == pytest.approx(nees_samples(P, F, Q), rel=1e-9)


@pytest.fixture(scope="module")
def right():
    """Return NEES (runs, K) of a right filter of position and velocity, and what it is worth."""
    rng = np.random.default_rng(32)
    runs, K, axis = 2000, 200, np.ix_([0, 3], [0, 3])
    F, Q = (m[axis] for m in constant_velocity(0.1, 1.0, "per_axis"))
    H, R, P0 = np.array([[1.0, 0.0]]), np.array([[0.25]]), np.eye(2)
    x = rng.standard_normal((runs, 2))
    truth = np.empty((runs, K, 2))
    for k in range(K):
        x = x @ F.T + rng.standard_normal((runs, 1)) * [0.1**2 / 2, 0.1]
        truth[:, k] = x
    z = truth @ H.T + 0.5 * rng.standard_normal((runs, K, 1))
    track = kf(z, F, Q, H, R, [0, 0], P0)
    return nees(track, truth), nees_samples(track.P[0], F, Q)


def test_time_averages_of_a_right_filter_spread_as_predicted(right):
    """The sample variance of M averages is relatively off by sqrt(2/M), more as they are skewed.

    With the excess kurtosis 12 / (n worth) of a scaled chi-square.
    """
    squared, worth = right
    average = squared.mean(axis=1)
    assert 10 < worth < 100  # far from both ends, 1 and 200
    spread = np.sqrt((2 + 12 / (2 * worth)) / len(average))
    assert average.var() == pytest.approx(2 * 2 / worth, rel=5 * spread)  # one seed in a million


def test_the_effective_interval_holds_its_share_and_the_naive_one_does_not(right):
    squared, worth = right
    average = squared.mean(axis=1)

    def share(interval):
        return ((interval[0] < average) & (average < interval[1])).mean()

    # The binomial share is off by 0.005 (one sigma); the fitted chi-square by about 0.01 at most.
    assert share(average_interval(2, worth)) == pytest.approx(0.95, abs=0.035)
    assert share(chi2_interval(2, runs=200)) < 0.75


@pytest.mark.parametrize(
    ("function", "arguments", "message"),
    [
        (average_interval, (0, 5), "dof must be"),
        (average_interval, (6, 0.0), "samples must be positive"),
        (average_interval, (6, 5, 1.5), "confidence must lie"),
        (effective_samples, ([0.1, 0.1], 2), "fewer lags than samples 2, got 2"),
        (effective_samples, ([-0.9], 100), "positive variance"),
        (effective_samples, (0.5, 100), "must have shape"),
        (nees_samples, (np.eye(2), np.eye(2), np.eye(2)), "P must have shape"),
        (nees_samples, (-np.ones((3, 1, 1)), [[1]], [[0]]), "P must be positive definite"),
        (nees_samples, (np.ones((3, 1, 1)), [[1]], [[-1]]), "Q must be"),
        (
            nees_samples,
            ([np.diag([1e-12, 1e12])] * 3, [[1, 1e-3], [0, 1]], np.zeros((2, 2))),
            "F and",
        ),
    ],
)
def test_wrong_arguments_are_named(function, arguments, message):
    with pytest.raises(ValueError, match=message):
        function(*arguments)
