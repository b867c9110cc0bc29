"""The low-pass delays by what it says, keeps the band and takes the rest."""

import numpy as np
import pytest
from scipy import signal

from dopplerlib.signal.frequency import ml_frequency
from dopplerlib.signal.front_end import lowpass, lowpass_decimate
from dopplerlib.signal.synthesis import complex_noise, tone

FS = 10e3


def test_a_slow_chirp_comes_out_delayed_by_the_group_delay():
    """In the passband: what comes out at t is what went in at t - delay."""
    n, factor = 4000, 5
    t = np.arange(n) / FS

    def chirp(t):
        return np.exp(2j * np.pi * (100 * t + 300 * t**2))

    y, fs_out, delay = lowpass_decimate(chirp(t), FS, factor)
    out = np.arange(len(y)) / fs_out
    settled = out >= 2 * delay
    # the ripple of the passband, 0.35 % for a Hamming window
    np.testing.assert_allclose(y[settled], chirp(out - delay)[settled], atol=4e-3)


def test_the_delay_is_that_of_scipy():
    impulse = np.zeros(200)
    impulse[0] = 1
    y, delay = lowpass(impulse, FS, 500.0, 81)
    _, samples = signal.group_delay((y.real, 1), w=[10, 100, 400], fs=FS)
    np.testing.assert_allclose(samples / FS, delay, rtol=1e-9)


def test_ignoring_the_delay_of_a_chirp_gives_its_slope_times_the_delay():
    """The front end is late by its delay: df = chirp * delay, 60 Hz/s * 10 ms here."""
    t = np.arange(4000) / FS
    x = np.exp(2j * np.pi * (100 * t + 30 * t**2))
    y, fs_out, delay = lowpass_decimate(x, FS, 10)
    window = y[100:200]
    middle = (100 + 99 / 2) / fs_out
    assert ml_frequency(window, fs_out) == pytest.approx(100 + 60 * (middle - delay), abs=1e-3)
    assert 60 * delay == pytest.approx(0.6)


def test_what_lies_beyond_the_new_band_is_gone():
    """A Hamming window leaves 0.2 %."""
    x = np.exp(2j * np.pi * 3000 / FS * np.arange(3000))
    y, fs_out, delay = lowpass_decimate(x, FS, 4)
    assert np.abs(y[int(2 * delay * fs_out) + 1 :]).max() < 3e-3


def test_the_noise_falls_with_the_rate():
    """White noise keeps the part in the passband: 1 / factor, and 2 % for the filter's edges.

    The 20 records of 1000 samples determine a variance to 0.7 %: five deviations.
    """
    noise = complex_noise((20, 10000), 1.0, rng=np.random.default_rng(1))
    for factor in (2, 5, 10):
        y, fs_out, delay = lowpass_decimate(noise, FS, factor)
        settled = y[:, int(2 * delay * fs_out) + 1 :]
        assert np.mean(np.abs(settled) ** 2) * factor == pytest.approx(1, abs=0.04 + 0.005 * factor)


def test_a_tone_keeps_its_frequency_and_its_integrated_ratio():
    x = tone(np.full(50, 123.4), FS, 5000, 10.0, rng=np.random.default_rng(2))
    y, fs_out, delay = lowpass_decimate(x, FS, 10)
    settled = y[:, int(2 * delay * fs_out) + 1 :]
    error = ml_frequency(settled, fs_out) - 123.4
    # 0.45 s at C/N0 = 50 dB: the bound is 4 mHz, and 50 errors stay within 6 of it
    assert np.abs(error).max() < 0.025


def test_nothing_happens_with_a_factor_of_one():
    x = complex_noise(30, 1.0, rng=np.random.default_rng(3))
    y, fs_out, delay = lowpass_decimate(x, FS, 1)
    np.testing.assert_array_equal(y, x)
    assert (fs_out, delay) == (FS, 0.0)


def test_leading_axes_are_a_batch_and_lengths_need_not_divide():
    x = complex_noise((2, 3, 1003), 1.0, rng=np.random.default_rng(4))
    y, _, _ = lowpass_decimate(x, FS, 4)
    assert y.shape == (2, 3, 251)
    np.testing.assert_allclose(y[1, 2], lowpass_decimate(x[1, 2], FS, 4)[0], atol=1e-12)


def test_what_makes_no_sense_is_refused_by_name():
    x = np.ones(100)
    with pytest.raises(ValueError, match=r"taps must be odd, .*, got 20"):
        lowpass(x, FS, 100.0, 20)
    with pytest.raises(ValueError, match="cutoff must be less than fs / 2 = 5000, got 5000"):
        lowpass(x, FS, 5000.0, 21)
    with pytest.raises(ValueError, match="factor must be a whole number of at least 1, got 0"):
        lowpass_decimate(x, FS, 0)
    with pytest.raises(ValueError, match="fs must be positive"):
        lowpass(x, 0, 100.0, 21)
