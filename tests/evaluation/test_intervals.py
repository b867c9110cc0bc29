"""An interval holds what it estimates as often as it says."""

import numpy as np
import pytest
from scipy.stats import binomtest, bootstrap, ttest_1samp

from dopplerlib.evaluation.intervals import (
    mean_interval,
    proportion_interval,
    quantile_interval,
    rms_interval,
)

TRIALS = 2000


def test_the_interval_of_a_mean_is_that_of_a_t_test():
    values = np.random.default_rng(1).normal(3, 2, 40)
    expected = ttest_1samp(values, 0).confidence_interval(0.9)
    found = mean_interval(values, 0.9)
    np.testing.assert_allclose([found.low, found.high], expected, rtol=1e-12)
    assert found.value == values.mean()


def test_the_interval_of_a_root_mean_square_holds_it_as_often_as_it_says():
    """Squares of 300 normal errors are skewed a little: 93 % at least, false alarm 1e-6."""
    draws = np.random.default_rng(5).normal(0, 2, (TRIALS, 300))
    held = [(e := rms_interval(row)).low <= 2 <= e.high for row in draws]
    assert binomtest(sum(held), TRIALS, 0.93, alternative="less").pvalue > 1e-6
    assert rms_interval(draws[0]).value == pytest.approx(np.sqrt(np.mean(draws[0] ** 2)))


def test_an_interval_of_one_large_error_reaches_down_to_zero():
    found = rms_interval([0.1] * 20 + [-50.0])
    assert found.low == 0 < found.value < found.high
    assert found.half_width == found.high / 2


@pytest.mark.parametrize("hits", [0, 1, 7, 29, 30])
def test_the_interval_of_a_share_is_the_exact_one_of_scipy(hits):
    found = proportion_interval(np.arange(30) < hits, 0.99)
    expected = binomtest(hits, 30).proportion_ci(0.99, method="exact")
    np.testing.assert_allclose([found.low, found.high], expected, rtol=1e-9, atol=1e-12)
    assert found.value == hits / 30


@pytest.mark.parametrize("q", [0.05, 0.5, 0.9])
def test_the_interval_of_a_quantile_holds_it_as_often_as_it_says(q):
    """False-alarm probability 1e-6 for each q: the coverage is at least 95 %."""
    draws = np.random.default_rng(2).uniform(size=(TRIALS, 99))
    held = [(e := quantile_interval(row, q)).low <= q <= e.high for row in draws]
    assert binomtest(sum(held), TRIALS, 0.95, alternative="less").pvalue > 1e-6


def test_the_interval_of_a_median_is_near_that_of_the_bootstrap():
    values = np.random.default_rng(3).exponential(size=1001)
    found = quantile_interval(values)
    rng = {"random_state": np.random.default_rng(4)}  # `rng` from SciPy 1.15 on
    expected = bootstrap((values,), np.median, method="percentile", **rng).confidence_interval
    # Both are random to about a tenth of their width of 0.12.
    np.testing.assert_allclose([found.low, found.high], expected, atol=0.03)


def test_too_few_runs_leave_a_quantile_open():
    found = quantile_interval([1.0, 2.0, 3.0])
    assert (found.low, found.value, found.high) == (-np.inf, 2, np.inf)


def test_infinite_runs_have_a_median_but_no_mean():
    assert quantile_interval([1.0] * 20 + [np.inf]).high == 1
    with pytest.raises(ValueError, match="values must be finite, got inf"):
        mean_interval([1.0, np.inf])


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: mean_interval([1.0]), r"values must hold at least 2 runs, got shape \(1,\)"),
        (
            lambda: quantile_interval([[1.0]]),
            r"values must hold at least 1 runs, got shape \(1, 1\)",
        ),
        (lambda: quantile_interval([np.nan]), "values must be finite, got nan"),
        (lambda: quantile_interval([1.0], q=1.0), "q must lie between 0 and 1, got 1.0"),
        (lambda: proportion_interval([]), "hits must be an array of booleans"),
        (lambda: proportion_interval([0, 1]), r"hits must be an array of booleans, got \[0, 1\]"),
        (lambda: proportion_interval([True], 95), "confidence must lie between 0 and 1, got 95"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
