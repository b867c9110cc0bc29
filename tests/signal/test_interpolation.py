"""Estimators in closed form: exact where their derivation is, near the bound as published.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest
from scipy.signal import periodogram
from scipy.stats import chi2

from dopplerlib.signal.interpolation import (
    _kappa,
    aboutanios_mulgrew,
    candan,
    jacobsen,
    parabolic,
    parabolic_three_highest,
    peak_bin,
    quinn1,
    quinn2,
)
from dopplerlib.signal.laws import crlb_frequency_std
from dopplerlib.signal.phase import kay, pulse_pair
from dopplerlib.signal.synthesis import tone

FS, N = 1000.0, 100
BIN = FS / N
FALSE_ALARM = 1e-6
SPECTRAL = [
    peak_bin,
    parabolic,
    parabolic_three_highest,
    jacobsen,
    candan,
    quinn1,
    quinn2,
    aboutanios_mulgrew,
]
ALL = [*SPECTRAL, kay, pulse_pair]


def make(fractions, n=N, snr_db=None, bin_number=12, seed=1):
    """Return frequencies, this many bins off `bin_number`, and tones of them."""
    f = (bin_number + np.asarray(fractions, dtype=float)) * FS / n
    return f, tone(f, FS, n, snr_db, rng=np.random.default_rng(seed))


def test_the_peak_bin_is_that_of_scipy():
    rng = np.random.default_rng(2)
    x = tone(rng.uniform(-500, 500, 50), FS, N, 0.0, rng=rng)
    f, power = periodogram(x, FS, nfft=256, return_onesided=False, detrend=False)
    np.testing.assert_allclose(peak_bin(x, FS, nfft=256), f[power.argmax(axis=-1)], atol=1e-9)


@pytest.mark.parametrize("estimator", ALL, ids=lambda e: e.__name__)
def test_a_tone_on_a_bin_is_found(estimator):
    """The three highest bins of such a tone are one and two zeros: rounding decides which."""
    if estimator is not parabolic_three_highest:
        f, x = make([0.0])
        np.testing.assert_allclose(estimator(x, FS), f, atol=1e-9)


@pytest.mark.parametrize(
    ("estimator", "order", "largest"),
    # The offset is wrong by this times its size over n to the power of `order`.
    [(jacobsen, 2, 1.7), (candan, 2, 1.0), (quinn1, 2, 3.3), (aboutanios_mulgrew, 2, 1e-3)],
    ids=lambda v: getattr(v, "__name__", v),
)
def test_the_bias_without_noise_vanishes_as_the_window_grows(estimator, order, largest):
    for n in (32, 64, 128):
        f, x = make(np.linspace(-0.45, 0.45, 19), n)
        bias = np.abs(estimator(x, FS) - f).max() * n / FS
        assert bias * n**order < largest


def test_candans_factor_takes_away_the_bias_of_jacobsen():
    """To order n^-2: pi^2 / 3 n^2 of the offset is what tan stands for."""
    for n in (8, 16, 32):
        f, x = make(np.linspace(-0.3, 0.3, 7), n, bin_number=3)
        before, after = (np.abs(e(x, FS) - f).max() for e in (jacobsen, candan))
        assert after < before / 4


def test_padding_brings_the_parabola_to_the_top():
    """The error of a parabola through points h apart goes with h^2, here of the magnitudes."""
    f, x = make(np.linspace(-0.5, 0.5, 81))
    errors = [np.abs(parabolic(x, FS, nfft=pad * N) - f).max() for pad in (2, 4, 8, 16)]
    ratio = np.array(errors[:-1]) / errors[1:]
    assert (ratio > 5).all()
    assert errors[0] < 0.05 * BIN


def test_adjacent_and_highest_bins_are_the_same_with_padding_only():
    """Without, the third highest is often the noise somewhere else."""
    f, x = make(np.linspace(-0.49, 0.49, 200), snr_db=10.0)
    with np.errstate(all="raise"):
        padded = parabolic(x, FS, nfft=4 * N), parabolic_three_highest(x, FS, nfft=4 * N)
    np.testing.assert_allclose(*padded, atol=1e-9)
    adjacent, highest = (np.abs(e(x, FS) - f) for e in (parabolic, parabolic_three_highest))
    assert adjacent.max() < BIN / 2
    assert np.mean(highest > BIN / 2) > 0.1


def test_a_parabola_in_logarithms_is_exact_for_a_gaussian():
    """A Gaussian in time is one in frequency: its logarithm is a parabola."""
    t = np.arange(N) - (N - 1) / 2
    f = 123.4
    x = np.exp(-(t**2) / (2 * 8.0**2) + 2j * np.pi * f / FS * t)
    assert parabolic(x, FS, scale="log") == pytest.approx(f, abs=1e-6 * BIN)


def kappa_slope(x):
    """Return the derivative of the function kappa of Quinn (1997)."""
    return (3 * x + 2) / (2 * (3 * x**2 + 6 * x + 1))


def quinn2_ratio(d):
    """Return the variance of Quinn's second estimate over the bound, for a long window.

    To first order in the noise of three bins, of which the neighbors are d / (d + 1) and
    d / (d - 1) times the highest one.
    """
    a, b = d / (d + 1), d / (d - 1)
    left = (0.5 - 2 * d * kappa_slope(d**2)) / (1 - a) ** 2
    right = -(0.5 + 2 * d * kappa_slope(d**2)) / (1 - b) ** 2
    noise = left**2 * (1 + a**2) + right**2 * (1 + b**2) + 2 * left * right * a * b
    return noise / (2 * np.sinc(d) ** 2) / (6 / (2 * np.pi) ** 2)


def test_kappa_has_the_slope_for_which_it_was_made():
    """By a complex step: exact to rounding."""
    x = np.linspace(0, 2, 21)
    np.testing.assert_allclose(_kappa(x + 1e-30j).imag / 1e-30, kappa_slope(x), rtol=1e-14)


@pytest.mark.parametrize(
    ("estimator", "fraction", "ratio"),
    [
        # Variance over the bound for long windows. On the bin and half way between two:
        # Jacobsen: the closed form of its linear part, pi^2 / 6 on the bin ...
        (jacobsen, 0.0, np.pi**2 / 6),
        (candan, 0.0, np.pi**2 / 6),
        # Quinn (1994): the same on the bin, and pi^4 / 96 half way, for one neighbor.
        (quinn1, 0.5, np.pi**4 / 96),
        # Aboutanios and Mulgrew (2005): pi^4 / 96 after the iteration, wherever the tone is.
        (aboutanios_mulgrew, 0.0, np.pi**4 / 96),
        (aboutanios_mulgrew, 0.3, np.pi**4 / 96),
        (aboutanios_mulgrew, 0.5, np.pi**4 / 96),
    ],
    ids=lambda v: getattr(v, "__name__", None),
)
def test_the_variance_is_the_published_multiple_of_the_bound(estimator, fraction, ratio):
    """Within 5 %: of second order in the noise, and 1 / n^2; the rest is the chi-square's."""
    runs = 8000
    f, x = make(np.full(runs, fraction), snr_db=25.0, seed=3)
    total = np.sum((estimator(x, FS) - f) ** 2) / crlb_frequency_std(10**2.5, N, FS) ** 2 / ratio
    assert chi2.ppf(FALSE_ALARM / 2, runs) * 0.95 < total
    assert total < chi2.isf(FALSE_ALARM / 2, runs) * 1.05


@pytest.mark.parametrize(("fraction", "ratio"), [(0.0, np.pi**2 / 6), (0.25, 1.30), (0.5, 1.01)])
def test_quinns_second_estimate_has_the_variance_of_his_weights(fraction, ratio):
    """In 400 samples: half way, the square of the bias is a tenth of the variance in 100.

    Within 2 % for what is left of it, and of second order in the noise.
    """
    runs, n, snr = 8000, 4 * N, 10**2.5
    assert quinn2_ratio(fraction) == pytest.approx(ratio, rel=0.005)
    f, x = make(np.full(runs, fraction), n, snr_db=25.0, seed=10)
    total = np.sum((quinn2(x, FS) - f) ** 2) / crlb_frequency_std(snr, n, FS) ** 2
    total /= quinn2_ratio(fraction)
    assert chi2.ppf(FALSE_ALARM / 6, runs) * 0.98 < total < chi2.isf(FALSE_ALARM / 6, runs) * 1.02


def test_quinns_second_estimate_beats_his_first_on_a_bin():
    runs = 4000
    f, x = make(np.zeros(runs), snr_db=20.0, seed=4)
    first, second = (np.mean((e(x, FS) - f) ** 2) for e in (quinn1, quinn2))
    assert second < first  # by a fifth or more, twenty deviations of these means


def test_kay_reaches_the_bound_and_the_pulse_pair_does_not():
    """At 25 dB. The pulse pair's variance is 1 / (snr (n - 1)^2) of a sample's angle: n/6 times."""
    runs = 8000
    f, x = make(np.full(runs, 0.2), snr_db=25.0, seed=5)
    bound = crlb_frequency_std(10**2.5, N, FS) ** 2
    tail = chi2.ppf(FALSE_ALARM / 2, runs) / runs, chi2.isf(FALSE_ALARM / 2, runs) / runs
    assert tail[0] < np.mean((kay(x, FS) - f) ** 2) / bound < tail[1] * 1.02
    snr = 10**2.5
    phase = 1 / (snr * (N - 1) ** 2) + 1 / (2 * snr**2 * (N - 1))  # Lank et al. (1973)
    ratio = np.mean((pulse_pair(x, FS) - f) ** 2) / (phase * (FS / (2 * np.pi)) ** 2)
    assert tail[0] * 0.97 < ratio < tail[1] * 1.03


def test_a_longer_lag_sharpens_the_pulse_pair_and_narrows_what_is_unambiguous():
    runs = 2000
    f, x = make(np.full(runs, 0.2), snr_db=25.0, seed=6)
    middle = (100.0, 140.0)
    short, long = (np.std(pulse_pair(x, FS, middle, lag=lag)) for lag in (1, 50))
    assert long < short / 3
    alias = pulse_pair(x[0], FS, lag=50)  # around zero: FS / 50 = 20 Hz apart
    assert abs(alias) < 10
    assert (f[0] - alias) % 20 == pytest.approx(0, abs=1) or (f[0] - alias) % 20 > 19


@pytest.mark.parametrize("lag", [1, 2, 7, 50])
@pytest.mark.parametrize("middle", [-301.0, 0.0, 118.0, 999.0])
def test_the_pulse_pair_finds_the_tone_that_lies_around_the_middle_of_its_band(lag, middle):
    """Anywhere within fs / (2 lag) of it, without noise."""
    f = middle + np.array([-0.49, -0.1, 0.3, 0.49]) * FS / lag
    x = tone(f, FS, N, None, rng=np.random.default_rng(9))
    np.testing.assert_allclose(pulse_pair(x, FS, (middle - 20, middle + 20), lag), f, atol=1e-9)


@pytest.mark.parametrize("estimator", ALL, ids=lambda e: e.__name__)
def test_phase_and_size_do_not_matter_and_conjugation_turns_the_sign(estimator):
    rng = np.random.default_rng(7)
    x = tone(rng.uniform(-200, 200, 40), FS, N, 20.0, rng=rng)
    f = estimator(x, FS)
    np.testing.assert_allclose(estimator(1e-6j * x, FS), f, atol=1e-6)
    np.testing.assert_allclose(estimator(x.conj(), FS), -f, atol=1e-6)


@pytest.mark.parametrize("estimator", ALL, ids=lambda e: e.__name__)
def test_a_shift_by_whole_bins_shifts_the_estimate(estimator):
    rng = np.random.default_rng(8)
    x = tone(rng.uniform(-200, 200, 40), FS, N, 20.0, rng=rng)
    shifted = x * np.exp(2j * np.pi * 5 * np.arange(N) / N)
    np.testing.assert_allclose(estimator(shifted, FS), estimator(x, FS) + 5 * BIN, atol=1e-6)


@pytest.mark.parametrize("estimator", ALL, ids=lambda e: e.__name__)
def test_the_same_tone_is_found_in_a_band_above_half_the_rate(estimator):
    _, x = make([0.2, 0.4], snr_db=40.0)
    there = estimator(x, FS, (FS, FS + 300))
    np.testing.assert_allclose(there, estimator(x, FS, (0, 300)) + FS, atol=1e-6)


@pytest.mark.parametrize("estimator", ALL, ids=lambda e: e.__name__)
def test_leading_axes_are_a_batch(estimator):
    _, x = make(np.linspace(-0.4, 0.4, 6), snr_db=20.0)
    np.testing.assert_allclose(
        estimator(x.reshape(2, 3, N), FS), estimator(x, FS).reshape(2, 3), rtol=1e-12
    )
    assert np.shape(estimator(x[0], FS)) == ()


def test_the_band_keeps_a_strong_tone_out():
    x = 10 * make([0.0], bin_number=-20)[1] + make([0.0], bin_number=7)[1]
    for estimator in SPECTRAL:
        if estimator is not parabolic_three_highest:
            assert estimator(x, FS, (50, 90))[0] == pytest.approx(70, abs=2), estimator.__name__


@pytest.mark.parametrize("estimator", SPECTRAL, ids=lambda e: e.__name__)
def test_a_band_without_a_bin_is_refused(estimator):
    with pytest.raises(ValueError, match=r"band must hold .*bin"):
        estimator(make([0.0])[1], FS, (12.0, 13.0))


def test_settings_that_make_no_sense_are_refused_by_name():
    x = make([0.0])[1]
    with pytest.raises(ValueError, match="nfft must be a whole number of at least 100, got 64"):
        peak_bin(x, FS, nfft=64)
    with pytest.raises(ValueError, match="scale must be one of 'magnitude', 'log', got 'power'"):
        parabolic(x, FS, scale="power")
    with pytest.raises(ValueError, match="iterations must be a whole number of at least 1, got 0"):
        aboutanios_mulgrew(x, FS, iterations=0)
    with pytest.raises(ValueError, match="lag must be less than the 100 samples, got 100"):
        pulse_pair(x, FS, lag=100)
    for estimator in ALL:
        with pytest.raises(ValueError, match="fs must be positive, got -1"):
            estimator(x, -1)
        with pytest.raises(ValueError, match="x must have at least"):
            estimator(x[..., :1], FS)
