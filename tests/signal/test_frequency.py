"""Maximum likelihood: the highest peak wherever it is, and the bound where it can be reached.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.stats import chi2, kstest, norm

from dopplerlib.signal.frequency import ml_frequency, ml_frequency_dc
from dopplerlib.signal.laws import crlb_frequency_std
from dopplerlib.signal.synthesis import tone

FS, N = 1000.0, 64
BIN = FS / N
FALSE_ALARM = 1e-6
BOTH = [ml_frequency, ml_frequency_dc]


def tones(runs, snr_db, seed, low=-FS / 2, high=FS / 2, n=N):
    rng = np.random.default_rng(seed)
    f = rng.uniform(low, high, runs)
    return f, tone(f, FS, n, snr_db, rng=rng)


def periodogram(x, f):
    wave = np.exp(-2j * np.pi * np.asarray(f)[..., None] / FS * np.arange(x.shape[-1]))
    return np.abs(np.sum(x * wave, axis=-1)) ** 2


def around(difference):
    """Return differences of frequencies, of which FS more or less is the same."""
    return (difference + FS / 2) % FS - FS / 2


@pytest.mark.parametrize("n", [2, 3, 16, 17, 64, 97, 250, 1001])
def test_a_tone_without_noise_is_found_to_rounding(n):
    """A step of STOP leaves an error of its cube; the next is taken only if it was longer."""
    f, x = tones(500, None, 1, n=n)
    np.testing.assert_allclose(around(ml_frequency(x, FS) - f), 0, atol=1e-6 * FS / n)


@pytest.mark.parametrize("snr_db", [-4, 0, 10, 40])
def test_no_point_of_a_fine_grid_is_higher_than_the_peak(snr_db):
    """64 points a bin; above the threshold, where a tone makes the peak."""
    _, x = tones(2000, snr_db, 2)
    grid = np.abs(np.fft.fft(x, 64 * N)) ** 2
    found = periodogram(x, ml_frequency(x, FS))
    highest = grid.max(axis=-1)
    assert (found >= highest * (1 - 1e-12)).all()
    # a peak is at most this much higher than the nearest of the grid's points
    assert (found <= highest * 1.001).all()


def test_below_the_threshold_the_peak_of_noise_is_found_in_nearly_every_window():
    """There the coarse grid may hide a peak; it was 1 % at -10 dB, and the tone is lost anyhow."""
    _, x = tones(2000, -10, 3)
    highest = (np.abs(np.fft.fft(x, 16 * N)) ** 2).max(axis=-1)
    assert np.mean(periodogram(x, ml_frequency(x, FS)) < highest) < 0.03


def test_a_tone_half_way_between_bins_is_as_safe_as_one_on_a_bin():
    """Half way an unpadded transform sees 3.9 dB less; near the threshold that would show.

    Both counts are of the same chance p if the grid does not matter; their difference then has a
    standard deviation of at most sqrt(2 p (1 - p) / runs).
    """
    runs = 20000
    outliers = []
    for fraction in (0.0, 0.5):
        x = tone(np.full(runs, (7 + fraction) * BIN), FS, N, -7.0, rng=np.random.default_rng(4))
        outliers.append(np.mean(np.abs(ml_frequency(x, FS) - (7 + fraction) * BIN) > BIN))
    p = np.mean(outliers)
    assert 0.01 < p < 0.2
    assert abs(outliers[1] - outliers[0]) < norm.isf(FALSE_ALARM / 2) * np.sqrt(
        2 * p * (1 - p) / runs
    )


@pytest.mark.parametrize("snr_db", [0, 10, 30, 60])
def test_above_the_threshold_the_error_has_the_variance_of_the_bound(snr_db):
    """The sum of squares over the bound is chi-square distributed.

    Up to 1.5 % more at 0 dB, where the bound is not exact yet: hence the factor.
    """
    runs = 10000
    f, x = tones(runs, snr_db, 5)
    error = around(ml_frequency(x, FS) - f)
    bound = crlb_frequency_std(10 ** (snr_db / 10), N, FS)
    total = np.sum(error**2) / bound**2
    assert chi2.ppf(FALSE_ALARM / 2, runs) < total
    assert total < chi2.isf(FALSE_ALARM / 2, runs) * (1.03 if snr_db == 0 else 1)
    assert abs(error.mean()) < norm.isf(FALSE_ALARM / 2) * bound / np.sqrt(runs)


def test_above_the_threshold_the_error_is_gaussian():
    """And with outliers it is not: 5000 errors each, in standard deviations of the bound."""
    for snr_db, gaussian in ((0, True), (-8, False)):
        f, x = tones(5000, snr_db, 16)
        error = around(ml_frequency(x, FS) - f) / crlb_frequency_std(10 ** (snr_db / 10), N, FS)
        assert (kstest(error, norm.cdf).pvalue > FALSE_ALARM) == gaussian


@pytest.mark.parametrize("estimator", BOTH)
def test_a_shift_of_the_tone_shifts_the_estimate(estimator):
    """But for the constant, which does not move with it."""
    _, x = tones(200, 10, 6, 50, 90)
    if estimator is ml_frequency:
        shifted = x * np.exp(2j * np.pi * 217.3 / FS * np.arange(N))
        expected = estimator(x, FS) + 217.3
        np.testing.assert_allclose(estimator(shifted, FS), expected, atol=1e-6 * BIN)
    else:
        shifted = x + (3 - 2j)
        np.testing.assert_allclose(estimator(shifted, FS), estimator(x, FS), atol=1e-6 * BIN)


@pytest.mark.parametrize("estimator", BOTH)
def test_phase_and_size_do_not_matter_and_conjugation_turns_the_sign(estimator):
    _, x = tones(200, 3, 7)
    f = estimator(x, FS)
    np.testing.assert_allclose(estimator(1e-9j * x, FS), f, atol=1e-6 * BIN)
    np.testing.assert_allclose(estimator(1e9 * x, FS), f, atol=1e-6 * BIN)
    np.testing.assert_allclose(around(estimator(x.conj(), FS) + f), 0, atol=1e-6 * BIN)
    np.testing.assert_allclose(around(estimator(x[:, ::-1], FS) + f), 0, atol=1e-6 * BIN)


@pytest.mark.parametrize("estimator", BOTH)
def test_the_sampling_rate_is_a_unit(estimator):
    _, x = tones(50, 10, 8)
    np.testing.assert_allclose(estimator(x, 7 * FS), 7 * estimator(x, FS), atol=1e-6 * FS)


@pytest.mark.parametrize("estimator", BOTH)
def test_leading_axes_are_a_batch(estimator):
    _, x = tones(12, 10, 9)
    np.testing.assert_array_equal(estimator(x.reshape(3, 4, N), FS), estimator(x, FS).reshape(3, 4))
    assert estimator(x[0], FS).shape == ()
    assert estimator(x[:0], FS).shape == (0,)


@pytest.mark.parametrize("estimator", BOTH)
@pytest.mark.parametrize("band", [(0, FS), (-FS, 0), (100, 100 + FS)])
def test_a_band_as_wide_as_the_rate_gives_the_same_frequency_elsewhere(estimator, band):
    _, x = tones(300, 10, 10)
    f = estimator(x, FS, band)
    assert ((f >= band[0]) & (f < band[1])).all()
    np.testing.assert_allclose(around(f - estimator(x, FS)), 0, atol=1e-6 * BIN)


@pytest.mark.parametrize("band", [(60, 140), (99, 101), (-200, 200), (60 + FS, 140 + FS)])
def test_a_band_that_holds_the_tone_changes_nothing(band):
    _, x = tones(300, 20, 11, 99.9, 100.1)
    f, free = ml_frequency(x, FS, band), ml_frequency(x, FS)
    inside = np.abs(free - 100) < 1  # else the peak lies outside of the narrow band
    assert inside.mean() > 0.5
    np.testing.assert_allclose(around(f - free)[inside], 0, atol=1e-5 * BIN)


def test_a_band_without_the_tone_gives_the_highest_of_what_is_in_it():
    """Side lobes of a strong tone outside, often two to a bin: in 2 % the other one is higher."""
    _, x = tones(500, 20, 12, -300, -200)
    for band in [(50, 90), (100, 300), (3, 4)]:
        f = ml_frequency(x, FS, band)
        assert ((f >= band[0]) & (f <= band[1])).all()
        grid = periodogram(x[:, None], np.linspace(*band, 500))
        assert np.mean(periodogram(x, f) < grid.max(axis=-1) * (1 - 1e-9)) <= 0.02


@pytest.mark.parametrize("band", [None, (50.0, 130.0)])
@pytest.mark.parametrize("estimator", BOTH)
def test_zeros_have_no_frequency_and_no_constant_has(estimator, band):
    """0.1 - 0.7j and its like are no multiples of a power of two: their mean is rounded."""
    x = np.zeros((4, N), dtype=complex)
    x[1] = np.exp(2j * np.pi * 0.1 * np.arange(N))
    x[2:] = [[0.1 - 0.7j], [1e-3j / 3]]
    f = estimator(x, FS, band)
    assert np.isnan(f[0])
    assert f[1] == pytest.approx(100)
    assert np.isnan(f[2:]).all()


def test_a_tone_on_a_bin_leaves_zeros_at_the_others_and_that_stops_nothing():
    """Without noise, all other bins of an unpadded transform are zero to the last bit."""
    x = np.stack([(-1.0) ** np.arange(N), np.exp(2j * np.pi * np.arange(N) / 4)])
    for band in [(50, 130), (300, 400), (5, 6)]:
        f = ml_frequency(x, FS, band)
        assert ((f >= band[0]) & (f <= band[1])).all()


@pytest.mark.parametrize("f", [25.0, -40.0, 7.0, 300.0])
def test_beside_a_constant_the_estimate_is_that_of_least_squares(f):
    """SciPy fits tone and constant, five numbers, from the truth."""
    rng = np.random.default_rng(13)
    t = np.arange(N) / FS
    for x in tone(np.full(5, f), FS, N, 20.0, rng=rng) + 3:

        def residuals(p, x=x):
            left = x - (p[1] + 1j * p[2]) * np.exp(2j * np.pi * p[0] * t) - (p[3] + 1j * p[4])
            return np.concatenate([left.real, left.imag])

        a = np.mean((x - 3) * np.exp(-2j * np.pi * f * t))
        start = [f, a.real, a.imag, 3, 0]
        scale = [1, 0.1, 0.1, 0.1, 0.1]
        fit = least_squares(residuals, start, x_scale=scale, xtol=1e-14, ftol=1e-14, gtol=1e-14)
        # SciPy's numerical Jacobian leaves 1e-6 bins
        assert ml_frequency_dc(x, FS) == pytest.approx(fit.x[0], abs=1e-5 * BIN)


@pytest.mark.parametrize("cycles", [0.3, 0.8, 1.5, 4.3])
def test_beside_a_constant_a_tone_without_noise_is_found_to_rounding(cycles):
    f = np.array([cycles, -cycles]) * BIN
    x = tone(f, FS, N, None, rng=np.random.default_rng(14)) + (5 - 1j)
    np.testing.assert_allclose(ml_frequency_dc(x, FS), f, atol=1e-5 * BIN)


def test_a_constant_of_ten_times_the_tone_hides_it_from_a_single_peak_only():
    f, x = tones(100, 20, 15, 20, 90)
    np.testing.assert_allclose(ml_frequency(x + 10, FS), 0, atol=BIN / 2)
    assert np.abs(ml_frequency_dc(x + 10, FS) - f).max() < BIN / 4


@pytest.mark.parametrize("estimator", BOTH)
def test_what_is_no_signal_is_refused_by_name(estimator):
    x = np.ones(8, dtype=complex)
    for bad, message in [
        (x[:1], "x must have at least . samples, got 1"),
        (np.array([1, np.nan, 1]), r"x must be finite, got nan at index \(1,\)"),
        (np.array([1, np.inf + 1j, 1]), "x must be finite"),
        ("IQ", "x must be an array of numbers"),
    ]:
        with pytest.raises(ValueError, match=message):
            estimator(bad, FS)
    with pytest.raises(ValueError, match=r"fs must be positive, got 0\.0"):
        estimator(x, 0)
    with pytest.raises(ValueError, match=r"band must be two numbers, the smaller one first"):
        estimator(x, FS, (100, 0))
    with pytest.raises(ValueError, match=r"band must not be wider than fs = 1000"):
        estimator(x, FS, (0, 1001))
