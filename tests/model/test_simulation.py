"""Simulated measurements: repeatable, and with the noise that is promised.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2, kstest, norm

from dopplerlib import Scenario, doppler_shift, simulate

SHIPPED = Path(__file__).resolve().parents[2] / "data" / "mittermaier2016" / "scenario.toml"
RUNS, FALSE_ALARM = 40, 1e-6


@pytest.fixture(scope="module")
def scenario():
    return Scenario.from_toml(SHIPPED)


@pytest.fixture(scope="module")
def noise(scenario):
    """Return what stands on top of the true shifts, in standard deviations, (runs, K, N)."""
    truth, z = simulate(scenario, RUNS, rng=np.random.default_rng(7))
    return (z - doppler_shift(truth, scenario.array)) / scenario.sigma_f


def bound(checks):
    """Return what none of `checks` standard normal values exceeds, but in one of 1e6 cases."""
    return norm.isf(FALSE_ALARM / 2 / checks)


def test_there_is_one_record_a_run_and_one_truth(scenario):
    truth, z = simulate(scenario, 3, rng=np.random.default_rng(1))
    assert z.shape == (3, scenario.samples, len(scenario.array))
    np.testing.assert_array_equal(truth, scenario.truth)


def test_the_same_seed_gives_the_same_bits(scenario):
    first, again = (simulate(scenario, 3, rng=np.random.default_rng(1))[1] for _ in range(2))
    np.testing.assert_array_equal(first, again)


def test_a_run_is_the_same_among_five_and_among_fifty(scenario):
    few = simulate(scenario, 5, rng=np.random.default_rng(1))[1]
    many = simulate(scenario, 50, rng=np.random.default_rng(1))[1]
    np.testing.assert_array_equal(few, many[:5])


def test_a_run_begins_the_same_however_long_it_is(scenario):
    """Runs do not share one stream: a run does not move when those before it grow longer."""
    short = replace(scenario, samples=100)
    few = simulate(short, 5, rng=np.random.default_rng(1))[1]
    many = simulate(scenario, 5, rng=np.random.default_rng(1))[1]
    np.testing.assert_array_equal(few, many[:, :100])


def test_another_seed_and_a_second_call_give_other_noise(scenario):
    rng = np.random.default_rng(1)
    first, second = simulate(scenario, 2, rng=rng)[1], simulate(scenario, 2, rng=rng)[1]
    other = simulate(scenario, 2, rng=np.random.default_rng(2))[1]
    for a, b in [(first, second), (first, other), (first[0], first[1])]:
        assert (a != b).all()


def test_noise_has_mean_zero_at_every_sensor(noise):
    score = noise.mean(axis=(0, 1)) * np.sqrt(RUNS * noise.shape[1])
    assert np.abs(score).max() < bound(score.size)


def test_noise_has_the_variance_of_the_scenario_at_every_sensor_and_over_all(noise):
    """Over all, a deviation that is off by 1 % would show."""
    each = np.sum(noise**2, axis=(0, 1))  # chi-square distributed
    total = np.append(each, each.sum())
    dof = np.append(np.full(each.size, RUNS * noise.shape[1]), noise.size)
    tail = FALSE_ALARM / 2 / total.size
    assert (chi2.ppf(tail, dof) < total).all()
    assert (total < chi2.isf(tail, dof)).all()


def test_noise_is_gaussian(noise):
    assert kstest(noise.ravel(), norm.cdf).pvalue > FALSE_ALARM


def test_noise_is_independent_between_sensors(noise):
    rows = noise.reshape(-1, noise.shape[-1])
    correlation = np.corrcoef(rows.T)[np.triu_indices(noise.shape[-1], 1)]
    # Of n independent pairs the correlation is normal with variance 1 / n, very nearly.
    assert np.abs(correlation).max() * np.sqrt(len(rows)) < bound(correlation.size)


@pytest.mark.parametrize("lag", [1, 2, 10])
def test_noise_is_independent_between_samples(noise, lag):
    products = noise[:, lag:] * noise[:, :-lag]  # mean 0, variance 1
    score = products.mean(axis=(0, 1)) * np.sqrt(products[..., 0].size)
    assert np.abs(score).max() < bound(score.size)


def test_noise_is_independent_between_runs(noise):
    correlation = np.corrcoef(noise.reshape(RUNS, -1))[np.triu_indices(RUNS, 1)]
    assert np.abs(correlation).max() * np.sqrt(noise[0].size) < bound(correlation.size)


def test_twice_the_deviation_gives_twice_the_same_noise(scenario):
    louder = replace(scenario, sigma_f=2 * scenario.sigma_f)
    shift = doppler_shift(scenario.truth, scenario.array)
    once, twice = (
        simulate(s, 2, rng=np.random.default_rng(3))[1] - shift for s in (scenario, louder)
    )
    np.testing.assert_allclose(twice, 2 * once, atol=1e-12)  # shifts of 1e2 Hz, rounded twice


@pytest.mark.parametrize("runs", [0, -1, 2.5, 3.0, True, "3", None])
def test_a_number_of_runs_that_is_none_is_refused(scenario, runs):
    with pytest.raises(
        ValueError, match=f"runs must be a whole number of at least 1, got {runs!r}"
    ):
        simulate(scenario, runs, rng=np.random.default_rng(1))


@pytest.mark.parametrize("rng", [None, 1, np.random, np.random.RandomState(1)])
def test_anything_but_a_generator_is_refused_as_a_source_of_randomness(scenario, rng):
    with pytest.raises(ValueError, match=r"rng must be a numpy\.random\.Generator, .*, got"):
        simulate(scenario, 1, rng=rng)


def test_randomness_has_to_be_asked_for_by_name(scenario):
    with pytest.raises(TypeError, match="rng"):
        simulate(scenario, 1)
    with pytest.raises(TypeError, match="positional"):
        simulate(scenario, 1, np.random.default_rng(1))
