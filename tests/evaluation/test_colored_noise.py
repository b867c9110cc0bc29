"""A filter that believes its noise white: right if it is, and wrong unseen by NIS if not.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest

from dopplerlib.estimation.thinning import remedy_errors, thinning
from dopplerlib.evaluation.colored_noise import random_walk_filter, remedy_runs
from dopplerlib.evaluation.intervals import mean_interval
from dopplerlib.model.motion import cwna_process_noise, ncv_transition
from dopplerlib.signal.laws import overlap_correlation_discrete
from dopplerlib.systems import mittermaier2016 as paper

RUNS, K, WINDOW, HOP = 200, 1000, 250, 10


@pytest.fixture(scope="module")
def white():
    return np.random.default_rng(1).standard_normal((RUNS, K))


@pytest.fixture(scope="module")
def overlapping():
    """Return errors of windows of 250 samples, 10 apart: white noise weighted with the time."""
    weights = np.arange(WINDOW) - (WINDOW - 1) / 2
    raw = np.random.default_rng(2).standard_normal((RUNS, K * HOP + WINDOW))
    kernel = np.fft.rfft(weights[::-1], raw.shape[1])
    sums = np.fft.irfft(np.fft.rfft(raw) * kernel, raw.shape[1])
    return sums[:, WINDOW : WINDOW + K * HOP : HOP] / np.sqrt(weights @ weights)


def test_the_overlapping_errors_have_the_correlation_of_the_law(overlapping):
    """Of 200 000 pairs that depend over 25 steps: 8000 independent ones, so 0.06 is five sigma."""
    for lag in (1, 10, 20):
        measured = np.mean(overlapping[:, lag:] * overlapping[:, :-lag])
        assert measured == pytest.approx(overlap_correlation_discrete(WINDOW, lag * HOP), abs=0.06)


def test_white_noise_leaves_a_consistent_filter(white):
    """NIS: 140 000 independent values, deviation 0.4 %. NEES has a memory of 30 steps: 2 %."""
    result = random_walk_filter(white, 1e-3, rng=np.random.default_rng(3))
    assert result.nis.value == pytest.approx(1, abs=0.02)
    assert result.nees.value == pytest.approx(1, abs=0.1)
    lags = [e.value for e in result.autocorrelation]
    assert lags[0] == pytest.approx(1)
    assert np.abs(lags[1:]).max() < 0.02


def test_with_overlap_nis_is_right_while_the_error_is_twice_what_is_believed(overlapping):
    result = random_walk_filter(overlapping, 1e-3, rng=np.random.default_rng(4))
    assert result.nis.value == pytest.approx(1, abs=0.1)
    assert 1.5 < result.nees.low < result.nees.high < 2.5
    assert result.autocorrelation[1].low > 0.8


def test_lowering_r_until_nis_is_right_makes_the_covariance_worse(overlapping):
    before, after = (
        random_walk_filter(overlapping, 0.1, r, rng=np.random.default_rng(5)) for r in (1, 0.25)
    )
    assert before.nis.value < 0.6
    assert after.nis.value == pytest.approx(1, abs=0.1)
    assert after.nees.value > 2 * before.nees.value > 4


def test_windows_side_by_side_cure_it(overlapping):
    apart = overlapping[:, :: WINDOW // HOP]
    result = random_walk_filter(apart, 1e-2, rng=np.random.default_rng(6), lags=2, settle=20)
    # 4000 values: deviation of the mean NIS 2 %, of NEES with its memory of ten steps 8 %
    assert result.nis.value == pytest.approx(1, abs=0.1)
    assert result.nees.value == pytest.approx(1, abs=0.35)
    assert abs(result.autocorrelation[1].value) < 0.1


@pytest.fixture(scope="module")
def treated():
    """Return a model of position and velocity, and runs with each remedy."""
    F, Q = ncv_transition(1.0, dim=1), cwna_process_noise(1.0, 1e-3, dim=1)
    model = F, Q, np.array([[1.0, 0.0]]), 0.8, thinning(0.8, 300).every
    return model, remedy_runs(*model, rng=np.random.default_rng(8), runs=150)


def test_each_remedy_errs_as_the_steady_state_says(treated):
    """Two components of four filters: an interval of 99.99 % misses for one seed in 1200."""
    model, found = treated
    for name, want in remedy_errors(*model).items():
        for i in range(2):
            interval = mean_interval(found[name].squared_error[:, i], 0.9999)
            assert interval.low < want.actual[i, i] < interval.high, name
        reported = np.trace(np.linalg.solve(want.reported, want.actual)) / 2
        if name != "thinned":  # between its samples the covariance is another one
            interval = mean_interval(found[name].nees, 0.9999)
            assert interval.low < reported < interval.high, name


def test_only_thinned_and_colored_pass_as_white_and_only_colored_has_the_right_nis(treated):
    """At 5 %: 18 of 150 rejections or more come once in 1800; of 10 %, 28 once in 1100."""
    _, found = treated
    rejected = {name: np.sum(run.p_value < 0.05) for name, run in found.items()}
    assert rejected["white"] == rejected["inflated"] == 150
    assert rejected["colored"] < 18 and rejected["thinned"] < 28
    nis = {name: mean_interval(run.nis, 0.999) for name, run in found.items()}
    assert nis["colored"].low < 1 < nis["colored"].high
    assert nis["inflated"].high < nis["white"].high < 1


def test_what_makes_no_sense_is_refused_by_name(white):
    rng = np.random.default_rng(7)
    for rho in (0.0, -0.5, 1.0):
        with pytest.raises(ValueError, match=r"rho must be inside \(0, 1\), got"):
            remedy_runs([[1]], [[1]], [[1]], rho, rng=rng)
    with pytest.raises(ValueError, match=r"samples must be above settle \+ lags every = 150"):
        remedy_runs([[1]], [[1]], [[1]], 0.5, 5, rng=rng, samples=150)
    with pytest.raises(ValueError, match=r"noise must have more than settle \+ lags = 330"):
        random_walk_filter(white[:, :330], 0.1, rng=rng)
    with pytest.raises(ValueError, match="q must be positive, got 0"):
        random_walk_filter(white, 0, rng=rng)
    with pytest.raises(ValueError, match="r must be positive, got -1"):
        random_walk_filter(white, 1, -1, rng=rng)
    with pytest.raises(ValueError, match=r"rng must be a numpy\.random\.Generator"):
        random_walk_filter(white, 1, rng=None)


def test_what_is_said_about_the_signal_chain_fits_the_scenario():
    said, scenario = paper.reported().signal_chain, paper.reported().scenario
    assert said.update_interval_s == scenario.T
    assert scenario.sigma_f in said.sigma_f_hz
    assert max(said.sigma_f_hz) ** 2 <= said.frequency_variance_below_hz2
