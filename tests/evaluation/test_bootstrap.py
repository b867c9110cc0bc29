"""Intervals of functions of means, from runs that are drawn with replacement."""

import numpy as np
import pytest
from scipy.stats import bootstrap

from dopplerlib.evaluation.bootstrap import bootstrap_interval

VALUES = np.random.default_rng(1).normal(size=200)


def test_a_mean_of_normal_values_has_the_interval_that_students_t_gives():
    """Within a fifth of its length for 200 values: the bootstrap of a mean is known to agree."""
    found = bootstrap_interval(np.positive, [VALUES], rng=np.random.default_rng(2), resamples=2000)
    half = 1.97 * VALUES.std(ddof=1) / np.sqrt(200)
    assert found.value == pytest.approx(VALUES.mean())
    assert found.high - found.low == pytest.approx(2 * half, rel=0.2)


def test_draws_and_percentiles_are_those_of_scipy():
    """Its percentiles lie between two of 999 draws, ours are the lower one of them."""
    squares = VALUES**2, (VALUES + 1) ** 2

    def ratio(a, b):
        return np.sqrt(a / b)

    found = bootstrap_interval(ratio, squares, rng=np.random.default_rng(3), resamples=999)
    expected = bootstrap(
        squares, lambda a, b: ratio(a.mean(), b.mean()), paired=True, vectorized=False,
        n_resamples=999, method="percentile", random_state=np.random.default_rng(3),
    )  # fmt: skip
    low, high = np.percentile(expected.bootstrap_distribution, [2.5, 97.5], method="lower")
    assert found.value == pytest.approx(ratio(*(one.mean() for one in squares)))
    assert (found.low, found.high) == pytest.approx((low, high))


def test_an_infinite_statistic_makes_an_end_infinite_and_nothing_missing():
    """Of draws of three runs, those without the last one have a mean below the limit: 8 of 27."""

    def reach(mean):
        return np.where(mean > 1, 5.0, np.inf)

    found = bootstrap_interval(reach, [[0.0, 1.0, 3.0]], rng=np.random.default_rng(4))
    assert (found.value, found.low, found.high) == (5.0, 5.0, np.inf)


def test_arrays_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="arrays must have one number of runs"):
        bootstrap_interval(np.add, [[1.0, 2.0], [1.0]], rng=np.random.default_rng(1))
    with pytest.raises(ValueError, match=r"statistic\(\.\.\.\) must have shape \(401,\)"):
        bootstrap_interval(np.mean, [[1.0, 2.0]], rng=np.random.default_rng(1))
