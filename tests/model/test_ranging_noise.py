"""The laws of noise are those of the formulas, and an echo is detected as often as it should be."""

import numpy as np
import pytest

from dopplerlib.model.ranging_noise import (
    detection_probability,
    fourth_power_snr,
    linear_snr,
    range_std,
)


def test_the_fourth_power_loses_twelve_decibels_per_doubling_and_the_line_per_meter():
    d = np.array([1.0, 2.0, 4.0, 8.0])
    np.testing.assert_allclose(np.diff(fourth_power_snr(d, 42)), -40 * np.log10(2))
    np.testing.assert_allclose(linear_snr(d, 52, 12), [40, 28, 4, -44])


def test_a_deviation_shrinks_with_the_square_root_of_twice_the_ratio():
    assert range_std(0.15, 10 * np.log10(0.5)) == pytest.approx(0.15)
    assert range_std(0.15, 10 * np.log10(50)) == pytest.approx(0.015)


def test_an_echo_is_detected_as_often_as_in_a_simulation_of_the_detector():
    """20 000 trials: each share is off by more than 5 deviations with a chance below 1e-6."""
    rng, trials, false_alarm = np.random.default_rng(2), 20_000, 1e-2
    for snr_db in (-5.0, 5.0, 10.0):
        amplitude = np.sqrt(2 * 10 ** (snr_db / 10))
        i, q = rng.standard_normal((2, trials))
        hit = ((i + amplitude) ** 2 + q**2 > -2 * np.log(false_alarm)).mean()
        p = float(detection_probability(snr_db, false_alarm))
        assert abs(hit - p) < 5 * np.sqrt(p * (1 - p) / trials)


def test_noise_alone_is_detected_with_the_probability_of_a_false_alarm():
    assert float(detection_probability(-200.0, 1e-3)) == pytest.approx(1e-3, rel=1e-6)


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ValueError, match="d must be positive"):
        fourth_power_snr(0.0, 42)
    with pytest.raises(ValueError, match="false_alarm must lie between 0 and 1"):
        detection_probability(3.0, 0.0)
    with pytest.raises(ValueError, match="resolution must be positive"):
        range_std(-1.0, 3.0)
