"""The saved benchmark of estimators: made again in part, and against laws that are not its own."""

import numpy as np
import pytest

from dopplerlib._data import read_json, results
from dopplerlib.evaluation import frequency_benchmark as benchmark
from dopplerlib.evaluation.intervals import ConfidenceInterval, mean_interval, proportion_interval
from dopplerlib.signal.laws import (
    crlb_frequency_std,
    crlb_frequency_std_dc,
    outlier_probability,
)
from studies.frequency_benchmark import COLUMNS, level


@pytest.fixture(scope="module")
def saved():
    return benchmark.saved_benchmark()


def test_cells_of_the_saved_benchmark_can_be_made_again():
    """Near the thresholds of both: some of the estimates are outliers, and some are not."""
    saved = read_json("frequency_benchmark.json", folder=results)
    k = saved["snr_db"].index(-7)
    for name, found in level(-7, ["maximum likelihood", "Kay"]).items():
        assert found == [saved[column][name][k] for column in COLUMNS]
        assert 0 < found[0] < benchmark.WINDOWS


def test_the_benchmark_has_every_estimator_at_every_level(saved):
    assert set(saved.ratio) == set(saved.outliers) == set(benchmark.ESTIMATORS)
    for name in benchmark.ESTIMATORS:
        assert len(saved.ratio[name]) == len(saved.outliers[name]) == len(benchmark.LEVELS)
        assert all(e.low <= e.value <= e.high for e in saved.ratio[name])
    assert saved.windows == benchmark.WINDOWS
    assert tuple(saved.snr_db) == benchmark.LEVELS


def test_maximum_likelihood_attains_the_bound_from_zero_decibels_on(saved):
    """With 20 000 windows the deviation of the ratio is 0.5 %: 2.5 % are five of them.

    The law of outliers says that there are none.
    """
    for k in range(saved.at(0), len(saved.snr_db)):
        assert saved.ratio["maximum likelihood"][k].value == pytest.approx(1, abs=0.025)


def test_beside_a_constant_the_estimator_attains_the_bound_of_that(saved):
    """The tones lie anywhere from 50 to 350 Hz; 2.5 % are some four deviations, as above."""
    f = np.linspace(50, 350, 3001)
    dc = crlb_frequency_std_dc(f, 1.0, benchmark.SAMPLES, benchmark.FS)
    expected = np.sqrt(np.mean(dc**2)) / crlb_frequency_std(1.0, benchmark.SAMPLES, benchmark.FS)
    for k in range(saved.at(0), len(saved.snr_db)):
        assert saved.ratio["ML with DC offset"][k].value == pytest.approx(expected, rel=0.025)


def test_no_estimator_is_better_than_the_bound_where_it_has_no_outliers(saved):
    for name, ratio in saved.ratio.items():
        assert min(e.value for e in ratio[saved.at(0) :]) > 0.975, name


def test_outliers_are_as_frequent_as_the_law_says(saved):
    """The law takes n places for all there are: measured, up to half as many more."""
    shares = saved.outliers["maximum likelihood"]
    for dB in (-12, -10, -8):
        law = outlier_probability(benchmark.SAMPLES * 10 ** (dB / 10), benchmark.SAMPLES)
        assert 0.95 < shares[saved.at(dB)].value / law < 1.6


def test_the_threshold_is_where_the_shares_cross(saved):
    for name in ("maximum likelihood", "Quinn 2", "Kay"):
        found = saved.threshold(name)
        k = np.searchsorted(saved.snr_db, found.value)
        assert saved.outliers[name][k - 1].value > 0.01 > saved.outliers[name][k].value
        assert found.low < found.value < found.high < found.low + 0.5


def test_a_share_that_falls_evenly_is_interpolated_evenly():
    shares = [ConfidenceInterval(p, p / 10, 1.0) for p in (1.0, 0.1, 0.001)]
    line = benchmark.FrequencyBenchmark(np.arange(3.0), np.ones(3), 10_000, {}, {"a": shares})
    found = line.threshold("a", 0.01)
    assert (found.value, found.low, found.high) == pytest.approx((1.5, 1.0, np.inf))
    assert line.threshold("a", 0.2).value == pytest.approx(np.log10(5))
    with pytest.raises(ValueError, match="fraction must lie between 0 and 1, got 1"):
        line.threshold("a", 1)


def test_an_interval_joins_errors_near_the_truth_and_outliers():
    """Made by hand: three errors of 1, 2 and 3 Hz, and one outlier."""
    bound = 1 / benchmark.saved_benchmark().bound[benchmark.LEVELS.index(0)]
    errors = np.array([1.0, 2.0, 3.0, 4000.0])
    f = np.zeros(4)
    x = np.exp(2j * np.pi * errors[:, None] / benchmark.FS * np.arange(benchmark.SAMPLES))
    ratio, outliers = benchmark.benchmark_cell("maximum likelihood", x, f, 0)
    near = mean_interval([1.0, 4.0, 9.0, 0.0], 0.975)
    share = proportion_interval(np.arange(4) < 1, 0.975)
    assert outliers == 1
    assert ratio.value == pytest.approx(bound * np.sqrt(np.mean(errors**2)), rel=1e-9)
    assert ratio.high == pytest.approx(bound * np.sqrt(near.high + share.high * 4000**2), rel=1e-9)


def test_what_is_not_in_the_benchmark_is_refused():
    with pytest.raises(ValueError, match=r"snr_db must be one of -15, .* got 99"):
        benchmark.benchmark_windows(99)
    with pytest.raises(ValueError, match=r"name must be one of 'highest bin'.* got 'guess'"):
        benchmark.benchmark_cell("guess", np.ones((2, 5)), np.zeros(2), 0)
