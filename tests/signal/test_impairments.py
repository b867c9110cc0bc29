"""Impairments of the receiver do what their formulas say, and corrections take them back."""

import numpy as np
import pytest
from scipy.stats import chi2

from dopplerlib.signal.impairments import (
    add_dc,
    add_iq_imbalance,
    correct_iq_imbalance,
    quantize,
    remove_mean,
)
from dopplerlib.signal.synthesis import complex_noise, tone

N = 200
WHOLE = np.exp(2j * np.pi * 17 * np.arange(N) / N + 0.3j)  # whole cycles


def test_a_constant_comes_and_goes_with_the_mean():
    x = np.stack([WHOLE, 2 * WHOLE])
    shifted = add_dc(x, np.array([[0.3 - 2j], [5]]))
    np.testing.assert_allclose(shifted.mean(axis=-1), [0.3 - 2j, 5], atol=1e-12)
    np.testing.assert_allclose(remove_mean(shifted), x, atol=1e-12)


def test_the_mean_of_a_slow_tone_goes_with_the_constant():
    """Half a cycle has a mean of 2 / pi: 40 % of its power are lost."""
    x = np.exp(1j * np.pi * (np.arange(1000) + 0.5) / 1000)
    left = np.mean(np.abs(remove_mean(x)) ** 2)
    assert left == pytest.approx(1 - (2 / np.pi) ** 2, abs=1e-6)


@pytest.mark.parametrize(("gain_db", "phase_deg"), [(0, 0), (1, 5), (-2, -10), (0.5, 30)])
def test_the_image_has_the_stated_power_and_the_mirrored_frequency(gain_db, phase_deg):
    X = np.fft.fft(add_iq_imbalance(WHOLE, gain_db, phase_deg)) / N
    power = np.abs(X) ** 2
    others = np.delete(power, [17, N - 17])
    assert others.max() < 1e-25
    # I + j g (Q cos phi + I sin phi) of a tone, in parts that turn with it and against it.
    g, phi = 10 ** (gain_db / 20), np.radians(phase_deg)
    parts = [abs(1 + sign * g * np.exp(1j * phi)) ** 2 / 4 for sign in (1, -1)]
    np.testing.assert_allclose(power[[17, N - 17]], parts, rtol=1e-12, atol=1e-25)


def test_q_leads_by_the_angle_and_is_larger_by_the_gain():
    """The branches of a tone of phase a are cos(a) and g sin(a + phi)."""
    a = np.angle(WHOLE)
    x = add_iq_imbalance(WHOLE, 20 * np.log10(1.3), 12.0)
    np.testing.assert_allclose(x.real, np.cos(a), atol=1e-12)
    np.testing.assert_allclose(x.imag, 1.3 * np.sin(a + np.radians(12)), atol=1e-12)


@pytest.mark.parametrize(("gain_db", "phase_deg"), [(1, 5), (-2, -10), (6, 40)])
def test_whole_cycles_are_corrected_to_rounding(gain_db, phase_deg):
    x = np.stack([WHOLE, 3 * WHOLE])
    np.testing.assert_allclose(
        correct_iq_imbalance(add_iq_imbalance(x, gain_db, phase_deg)), x, atol=1e-12
    )


def test_what_needs_no_correction_is_left_alone():
    np.testing.assert_allclose(correct_iq_imbalance(WHOLE), WHOLE, atol=1e-12)


def test_noise_limits_the_correction_as_its_moments_do():
    """The image that is left comes from mean x^2, whose parts have variance sigma^4 / n each.

    So n |image|^2 is exponential for pure noise, and half of it in amplitude; one in a million
    sums of 400 exceeds the bound. Second order in 1 / sqrt(n): 5 %.
    """
    runs, n = 400, 2000
    noise = complex_noise((runs, n), 1.0, rng=np.random.default_rng(1))
    left = correct_iq_imbalance(add_iq_imbalance(noise, 1.0, 5.0))
    before = correct_iq_imbalance(noise)
    np.testing.assert_allclose(left, before, atol=1e-9)  # the blemish leaves no trace of itself
    image = np.abs(np.mean(noise**2, axis=-1)) ** 2 * n / 2
    assert chi2.ppf(5e-7, 2 * runs) * 0.95 < 2 * image.sum() < chi2.isf(5e-7, 2 * runs) * 1.05
    assert np.abs(np.mean(before**2, axis=-1)).max() < 1e-12


def test_quantization_is_off_by_half_a_step_at_most_and_idempotent():
    x = tone(np.linspace(1, 40, 30), 100.0, N, None, rng=np.random.default_rng(2))
    for bits in (1, 3, 8, 12):
        step = 2 * 1.2 / 2**bits
        q = quantize(x, bits, 1.2)
        assert max(np.abs((q - x).real).max(), np.abs((q - x).imag).max()) <= step / 2 * (1 + 1e-12)
        assert len(np.unique(q.real)) <= 2**bits
        np.testing.assert_array_equal(quantize(q, bits, 1.2), q)


def test_the_error_of_many_bits_has_the_variance_of_a_uniform_one():
    """Steps of 1/64 over a signal of 1: uniform within a few percent."""
    x = tone(np.linspace(1, 40, 300), 100.0, N, None, rng=np.random.default_rng(3))
    error = quantize(x, 7, 1.0) - x
    assert np.mean(np.abs(error) ** 2) == pytest.approx(2 * (2 / 2**7) ** 2 / 12, rel=0.05)


def test_beyond_full_scale_the_last_step_is_what_there_is():
    np.testing.assert_array_equal(
        quantize([10 + 1e9j, -10 - 1e9j], 2, 1.0), [0.75 + 0.75j, -0.75 - 0.75j]
    )


def test_a_dead_module_stays_dead_and_the_others_are_corrected():
    """Zeros, or stuck at a value: less its mean, that is zeros to the last bit."""
    x = np.stack([WHOLE, 0 * WHOLE, 0 * WHOLE + (0.1 - 0.7j)])
    left = correct_iq_imbalance(remove_mean(add_iq_imbalance(x, 1.0, 5.0)))
    np.testing.assert_allclose(left[0], WHOLE, atol=1e-12)
    np.testing.assert_array_equal(left[1:], 0)


@pytest.mark.parametrize("correlation", [0.5, 0.99, 0.999999])
def test_branches_that_are_hardly_apart_are_still_set_at_right_angles(correlation):
    """What of Q does not follow I may be little: here down to two millionths of its power."""
    q = correlation * WHOLE.real + np.sqrt(1 - correlation**2) * WHOLE.imag
    np.testing.assert_allclose(correct_iq_imbalance(WHOLE.real + 1j * q), WHOLE, atol=1e-8)


def test_what_makes_no_sense_is_refused_by_name():
    with pytest.raises(ValueError, match="x must have an I and a Q that are not proportional"):
        correct_iq_imbalance(np.ones(4) * (1 + 2j))
    with pytest.raises(ValueError, match="x must have an I and a Q that are not proportional"):
        correct_iq_imbalance(np.ones(4))
    with pytest.raises(ValueError, match=r"got powers 1 and 4 with a .* of 2 at index \(1,\)"):
        correct_iq_imbalance(np.stack([WHOLE, np.full(N, 1 + 2j)]))
    with pytest.raises(ValueError, match="bits must be a whole number of at least 1, got 0"):
        quantize(WHOLE, 0, 1.0)
    with pytest.raises(ValueError, match="full_scale must be positive, got 0"):
        quantize(WHOLE, 8, 0)
    with pytest.raises(ValueError, match="gain_db must be finite, got inf"):
        add_iq_imbalance(WHOLE, np.inf, 0)
    with pytest.raises(ValueError, match="offset must be finite"):
        add_dc(WHOLE, np.nan)
    with pytest.raises(ValueError, match=r"x must have shape \(\.\.\., any\), got \(\)"):
        remove_mean(1.0)
