"""The measured spectrum of noise: its mean, its uncertainty, its lines.

Random tests hold for all but the stated share of seeds; the seeds are not chosen.
"""

import numpy as np
import pytest
from scipy.signal import freqz, lfilter
from scipy.stats import binom, norm

from dopplerlib.signal.noise_spectrum import NoiseSpectrum, noise_spectrum

FS, N = 1000.0, 64
FALSE_ALARM = 1e-6


def noise(rng, *shape):
    return rng.standard_normal((*shape, 2)) @ [1, 1j] / np.sqrt(2)


@pytest.mark.parametrize("quantile", [0.3, 0.5])
@pytest.mark.parametrize("windows", [1, 8])
def test_the_mean_is_right_for_any_quantile_of_few_windows(quantile, windows):
    """The mean over 1000 records, of variance one; its deviation from their scatter."""
    x = noise(np.random.default_rng(1), 1000, windows * N)
    measured = noise_spectrum(x, FS, N, N, quantile=quantile, taper="rectangular")
    values = measured.power[:, 10]
    reach = norm.isf(FALSE_ALARM / 2)
    assert abs(values.mean() - 1) < reach * values.std() / np.sqrt(1000)
    # The variance of k values of relative variance 1 / degrees; 4 covers its own heavy tail.
    expected = 1 / measured.degrees
    assert abs(values.var() - expected) < reach * expected * 4 / np.sqrt(1000)


def test_overlap_leaves_fewer_degrees_and_at_most_those_that_are_seen():
    """Of the median levels overlap correlates less than the powers: the claim is cautious."""
    x = noise(np.random.default_rng(2), 700, 16 * N)
    measured = noise_spectrum(x, FS, N, N // 4)
    seen = 1 / measured.power[:, 20].var()
    assert 0.9 * measured.degrees < seen < 1.8 * measured.degrees


def test_colored_noise_has_the_spectrum_of_its_filter():
    """Where the spectrum is smooth across a few bins; the deviation is that of its degrees."""
    rng = np.random.default_rng(3)
    x = lfilter([1.0], [1.0, -0.5], noise(rng, 1000 * N))
    measured = noise_spectrum(x, FS, N)
    _, response = freqz([1.0], [1.0, -0.5], worN=measured.frequency, fs=FS)
    far = np.abs(measured.frequency) > 150
    ratio = measured.power / np.abs(response) ** 2
    np.testing.assert_allclose(
        ratio[far], 1.0, atol=norm.isf(FALSE_ALARM / N) / np.sqrt(measured.degrees)
    )


def test_a_target_that_passes_moves_the_median_as_its_quantile_tells():
    """A fifth of the time at one frequency: the 0.625 quantile, 1.42 times the median."""
    rng = np.random.default_rng(4)
    x = noise(rng, 1000, N)
    x[:200] += 100 * np.exp(2j * np.pi * 0.25 * np.arange(N))
    measured = noise_spectrum(x.ravel(), FS, N, N)
    expected = np.log(1 - 0.625) / np.log(0.5)
    at = np.argmin(np.abs(measured.frequency - 250))
    assert measured.power[at] == pytest.approx(expected, rel=0.25)


def test_lines_are_found_and_white_noise_has_none():
    rng = np.random.default_rng(5)
    t = np.arange(40 * N)
    records = noise(rng, 200, len(t))
    false = [len(found) > 0 for found in noise_spectrum(records, FS, N).lines(0.05)]
    assert sum(false) <= binom.isf(FALSE_ALARM, 200, 0.05)
    line = records[:5] + np.exp(2j * np.pi * 0.25 * t)
    for found in noise_spectrum(line, FS, N).lines():
        assert found.tolist() == [250.0]


def test_windows_with_a_bad_sample_do_not_count():
    rng = np.random.default_rng(6)
    x = noise(rng, 20 * N)
    spoiled = x.copy()
    spoiled[5 * N : 10 * N] = np.nan
    valid = np.isfinite(spoiled)
    kept = np.concatenate([x[: 5 * N], x[10 * N :]])
    expected = noise_spectrum(kept, FS, N, N)
    measured = noise_spectrum(spoiled, FS, N, N, valid=valid)
    np.testing.assert_allclose(measured.power, expected.power, rtol=1e-12)
    assert measured.degrees == expected.degrees
    assert np.isnan(noise_spectrum(x, FS, N, valid=False).power).all()


def test_a_spectrum_is_checked():
    with pytest.raises(ValueError, match="power must not be negative"):
        NoiseSpectrum(np.zeros(1), -np.ones(1), 5.0, N, FS, "hann")
