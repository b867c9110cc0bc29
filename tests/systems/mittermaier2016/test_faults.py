"""The linear world is right, its tests alarm as often as they promise, and a fault is found or not.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from dopplerlib import average_interval, chi2_interval, constant_velocity, nees, nees_samples
from dopplerlib.evaluation.power import TESTS, rejections
from dopplerlib.systems import mittermaier2016 as paper

FALSE_ALARM = 1e-6
RUNS = 160
SCENARIO = paper.reported().scenario


@pytest.fixture(scope="module")
def world():
    return paper.linear_world(RUNS, rng=np.random.default_rng(51))


@pytest.fixture(scope="module")
def refused(world):
    """Return {fault: {test: records refused}}."""
    return {
        label: rejections(track, world[0], F, Q, lags=10)
        for label, track, F, Q in paper.faulty_filters(*world)
    }


def test_the_first_filter_has_no_fault_and_there_are_ten(refused):
    assert next(iter(refused)) == "nothing"
    assert len(refused) == 10
    for results in refused.values():
        assert tuple(results) == TESTS
        assert all(len(results[name]) == RUNS for name in TESTS[:-1])
        assert len(results["NEES of a group"]) == RUNS // 20


@pytest.mark.parametrize("name", TESTS)
def test_a_right_filter_is_refused_as_often_as_promised(refused, name):
    """Five in a hundred; fitted and combined tests may be off by three more, or be cautious."""
    values = refused["nothing"][name]
    assert values.sum() <= binom.isf(FALSE_ALARM / len(TESTS), len(values), 0.08)
    if name in ("NIS average", "innovation whiteness", "NEES at the end"):
        assert values.sum() >= binom.ppf(FALSE_ALARM, len(values), 0.04)


def test_wrong_noise_shows_in_the_average_of_nis(refused):
    for label in ("noise assumed 10 % too small", "noise assumed 10 % too large"):
        assert refused[label]["NIS average"].mean() > 0.95


def test_noise_with_a_memory_shows_in_the_whiteness(refused):
    assert refused["colored noise, 0.3"]["innovation whiteness"].mean() > 0.95


def test_a_biased_sensor_hides_from_the_innovations_and_shows_in_the_errors(refused):
    results = refused["one sensor off by sigma_f / 4"]
    assert max(results[name].mean() for name in TESTS[:3]) < 0.3
    assert results["NEES average"].mean() > 0.7


def test_a_start_wrong_along_the_blind_direction_hides_from_the_innovations(refused):
    results = refused["start 5 deviations off, blind direction"]
    assert max(results[name].mean() for name in TESTS[:3]) < 0.2
    assert results["NEES average"].mean() > 0.2


def test_nees_of_the_linear_world_averages_to_six_and_nis_too(world):
    """Averages over time and runs; spread from the number of independent values, times five."""
    truth, z = world
    track = paper.linear_filter(z)
    _, Q = constant_velocity(SCENARIO.T, SCENARIO.sigma_a, "per_axis")
    F, _ = constant_velocity(SCENARIO.T, SCENARIO.sigma_a)
    squared = nees(track, truth)
    worth = RUNS * nees_samples(track.P[0], F, Q)
    assert squared.mean() == pytest.approx(6, abs=5 * np.sqrt(12 / worth))
    assert track.nis.mean() == pytest.approx(6, abs=5 * np.sqrt(12 / track.nis.size))
    # Time averages lie where that number says. Their tails are heavier than those of the fitted
    # chi-square, so that a share is looked at and not their variance.
    low, high = average_interval(6, worth / RUNS)
    narrow = chi2_interval(6, runs=SCENARIO.samples)
    average = squared.mean(axis=1)
    assert ((low < average) & (average < high)).mean() > 0.88
    assert ((narrow[0] < average) & (average < narrow[1])).mean() < 0.4


def test_nees_with_one_covariance_for_all_runs_is_that_of_the_library(world):
    truth, z = world
    track = paper.linear_filter(z[:4])
    F, Q = constant_velocity(SCENARIO.T, SCENARIO.sigma_a, "per_axis")
    results = rejections(track, truth[:4], F, Q, group=2, lags=1)
    values = nees(track, truth[:4])
    lower, upper = chi2_interval(6)
    outside = (values[:, -1] < lower) | (values[:, -1] > upper)
    np.testing.assert_array_equal(results["NEES at the end"], outside)


def test_a_covariance_for_each_run_gives_what_one_for_all_gives(world):
    truth, z = world
    track = paper.linear_filter(z[:2])
    F, Q = constant_velocity(SCENARIO.T, SCENARIO.sigma_a, "per_axis")
    one = rejections(track, truth[:2], F, Q, group=2, lags=1)
    track = replace(track, P=np.repeat(track.P, 2, axis=0))
    each = rejections(track, truth[:2], F, Q, group=2, lags=1)
    for name in TESTS:
        np.testing.assert_array_equal(each[name], one[name])
