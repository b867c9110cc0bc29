"""The correlation of errors comes out right with gaps, uneven times and outliers.

Numbers of records whose interval holds the truth are compared with binomial limits.
"""

import numpy as np
import pytest
from scipy.stats import binom

from dopplerlib.evaluation.error_correlation import error_correlation

RUNS, K = 30, 600


def errors(rho, steps, rng):
    """Return Gauss-Markov errors of variance 1, with the correlation rho over a time of 1."""
    y = rng.standard_normal((RUNS, len(steps)))
    for k in range(1, len(steps)):
        keep = rho ** steps[k]
        y[:, k] = keep * y[:, k - 1] + np.sqrt(1 - keep**2) * y[:, k]
    return y


def covered(records, T, expected, **settings):
    """Return for each of the expected values how many intervals of 90 % hold it."""
    found = [error_correlation(y, T, confidence=0.9, **settings) for y in records]
    return {
        name: sum(getattr(f, name).low < value < getattr(f, name).high for f in found)
        for name, value in expected.items()
    }


# An interval of 90 % from twenty blocks holds the truth in 85 % or more; one seed in 10 000 is out.
LEAST = binom.ppf(1e-4, RUNS, 0.85)


def test_intervals_hold_in_spite_of_gaps_and_outliers():
    rng = np.random.default_rng(1)
    y = 0.3 + 2 * errors(0.8, np.ones(K), rng)
    y += np.where(rng.random(y.shape) < 0.03, 100 * rng.random(y.shape), 0)
    y[rng.random(y.shape) < 0.2] = np.nan
    held = covered(y, 0.1, {"mean": 0.3, "sigma": 2.0, "rho": 0.8})
    assert min(held.values()) >= LEAST, held


def test_uneven_times_and_a_white_part():
    rng = np.random.default_rng(2)
    steps = rng.uniform(0.5, 1.5, K)
    y = errors(0.8, steps, rng) + 0.5 * rng.standard_normal((RUNS, K))
    steps *= 1 / np.median(steps)  # then rho is that of the median interval
    rho = 0.8 ** (1 / np.median(steps))
    wanted = {"sigma": np.sqrt(1.25), "rho": rho, "colored": 0.8}
    held = covered(y[:15], steps, wanted, white=True)
    assert min(held.values()) >= binom.ppf(1e-4, 15, 0.85), held


def test_the_first_correlation_of_white_errors_may_be_negative_and_their_time_constant_is_zero():
    y = errors(0.0, np.ones(K), np.random.default_rng(3))[:10]
    found = error_correlation(y, 2.0)
    assert found.rho.low < 0 < found.rho.high
    alternating = y[:, 1:] - y[:, :-1]  # a moving average: -1/2 at lag 1
    found = error_correlation(alternating, 2.0, lags=1)
    assert found.rho.low < -0.5 < found.rho.high
    assert found.tau == 0


def test_pooled_records_are_the_estimate_by_products():
    """Without outliers at lag one: the pairs' Gaussian likelihood, the sum of products."""
    y = errors(0.6, np.ones(K), np.random.default_rng(4))[:10]
    found = error_correlation(y, 0.5, lags=1)
    product = np.mean(y[:, 1:] * y[:, :-1]) / np.mean(y**2)
    assert found.rho.value == pytest.approx(product, abs=2e-3)  # the ends are counted otherwise
    assert found.sigma.value == pytest.approx(y.std(), rel=5e-3)
    assert found.tau == pytest.approx(-0.5 / np.log(found.rho.value))
    assert found.T == 0.5
    assert (found.sigma_colored, found.sigma_white) == (found.sigma.value, 0.0)


def test_both_parts_make_the_whole_variance():
    y = errors(0.8, np.ones(K), np.random.default_rng(5))[:5]
    y += 0.5 * np.random.default_rng(6).standard_normal(y.shape)
    found = error_correlation(y, 0.5, white=True)
    assert np.hypot(found.sigma_colored, found.sigma_white) == pytest.approx(found.sigma.value)
    # About 300 independent values of the colored part, and of the white part 3000.
    assert found.sigma_colored == pytest.approx(1.0, abs=0.15)
    assert found.sigma_white == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize(
    ("y", "T", "message"),
    [
        (np.ones(50), 0.1, "residual must vary"),
        (np.full(50, np.nan), 0.1, "residual must vary, and hold pairs"),
        (np.ones(3), 0.1, "lags must be less than the number of samples 3, got 3"),
        (np.arange(50.0), np.ones(49), r"T must be one number or have shape \(50,\)"),
        (np.sin(np.arange(40.0)), 0.1, "residual must hold 5 blocks"),
    ],
)
def test_wrong_arguments_are_named(y, T, message):
    with pytest.raises(ValueError, match=message):
        error_correlation(y, T)
