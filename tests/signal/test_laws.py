"""Bounds and laws: against numerical Fisher information, integrals, minimizers and simulation.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar
from scipy.stats import binom, norm

from dopplerlib.signal.frequency import ml_frequency
from dopplerlib.signal.laws import (
    crlb_frequency_std,
    crlb_frequency_std_dc,
    integrated_snr_for_std,
    optimal_window_center,
    optimal_window_detection,
    optimal_window_end,
    outlier_probability,
    overlap_correlation,
    overlap_correlation_discrete,
    window_for_std,
)
from dopplerlib.signal.synthesis import tone

FALSE_ALARM = 1e-6


@pytest.mark.parametrize(("n", "snr", "fs"), [(2, 1.0, 1.0), (17, 0.3, 50.0), (250, 100.0, 1e4)])
def test_the_bound_is_the_inverse_of_the_fisher_information(n, snr, fs):
    """Of amplitude, phase and frequency, the derivatives taken by a complex step in each part."""
    t = np.arange(n) / fs
    a, phi, f = np.sqrt(snr), 0.7, 0.12 * fs
    wave = np.exp(1j * (2 * np.pi * f * t + phi))
    columns = np.stack([wave, 1j * a * wave, 2j * np.pi * t * a * wave])
    information = 2 * (columns.conj() @ columns.T).real  # the noise has variance 1
    expected = np.sqrt(np.linalg.inv(information)[2, 2])
    np.testing.assert_allclose(crlb_frequency_std(snr, n, fs), expected, rtol=1e-9)


@pytest.mark.parametrize("cycles", [0.01, 0.5, 1.0, 1.5, 4.3, 124.9, -0.5, 250.5])
def test_the_bound_beside_a_constant_is_the_inverse_of_the_fisher_information(cycles):
    """Of five numbers; the one of the frequency is what the four others leave, by least squares.

    The closed form loses digits where tone and constant are nearly the same, as cycles^-4.
    """
    n, snr, fs = 250, 3.0, 1e4
    f = cycles * fs / n
    t = (np.arange(n) - 40.0) / fs  # the moment to which the phase belongs does not matter
    a, wave = np.sqrt(snr), np.exp(1j * (2 * np.pi * f * t + 0.7))
    columns = np.stack([wave, 1j * wave, np.ones(n), 1j * np.ones(n), 2j * np.pi * t * a * wave])
    real = np.concatenate([columns.real, columns.imag], axis=1)
    others, own = real[:4].T, real[4]
    left = own - others @ np.linalg.lstsq(others, own, rcond=1e-15)[0]
    expected = 1 / np.sqrt(2 * left @ left)  # the noise has variance 1
    np.testing.assert_allclose(crlb_frequency_std_dc(f, snr, n, fs), expected, rtol=1e-6)


def test_a_constant_costs_nothing_beside_many_cycles_and_everything_beside_none():
    alone = crlb_frequency_std(1.0, 100, 100.0)
    beside = crlb_frequency_std_dc([0.0, 1e-9, 0.5, 1.0, 30.5], 1.0, 100, 100.0)
    assert np.isinf(beside[0])
    assert beside[1] > 1e3 * alone
    assert (beside[2:] >= alone).all()
    assert beside[-1] == pytest.approx(alone, rel=1e-3)


def test_the_window_is_the_one_in_which_the_bound_has_the_wanted_size():
    fs, cn0 = 1e6, 3e4
    for std in (0.1, 0.4, 1.0):
        T = window_for_std(std, cn0)
        # n^2 - 1 instead of n^2
        assert crlb_frequency_std(cn0 / fs, np.rint(T * fs), fs) == pytest.approx(std, rel=1e-3)
        assert integrated_snr_for_std(std, T) == pytest.approx(cn0 * T, rel=1e-12)


def test_how_often_a_window_is_sampled_does_not_matter():
    """Twice the rate with half the ratio in each sample, to 1 / n^2."""
    slow, fast = crlb_frequency_std(1.0, 250, 1e4), crlb_frequency_std(0.5, 500, 2e4)
    assert slow == pytest.approx(fast, rel=2e-5)


def test_neighboring_windows_share_their_errors_as_the_integral_says():
    for tau in (0.0, 0.1, 0.37, 0.8, 1.0):
        integral = quad(lambda u, tau=tau: 12 * u * (u - tau), tau - 0.5, 0.5)[0]
        assert overlap_correlation(tau) == pytest.approx(integral, abs=1e-12)
    assert overlap_correlation(1.5) == 0
    np.testing.assert_array_equal(overlap_correlation([-0.3]), overlap_correlation([0.3]))


@pytest.mark.parametrize("n", [2, 3, 10, 251])
def test_the_discrete_law_is_the_correlation_of_shifted_weights(n):
    weights = np.zeros(3 * n)
    weights[n : 2 * n] = np.arange(n) - (n - 1) / 2
    lags = np.arange(n + 2)
    shifted = np.array([weights @ np.roll(weights, lag) for lag in lags]) / (weights @ weights)
    np.testing.assert_allclose(overlap_correlation_discrete(n, lags), shifted, atol=1e-12)


def test_the_discrete_law_tends_to_the_continuous_one():
    tau = np.linspace(0, 1.2, 13)
    np.testing.assert_allclose(
        overlap_correlation_discrete(10000, np.rint(tau * 10000)),
        overlap_correlation(tau),
        atol=1e-7,
    )


def test_estimates_of_overlapping_windows_are_correlated_as_the_law_says():
    """Correlation of 20000 pairs: its z-transform is normal with variance 1 / runs."""
    n, runs = 64, 20000
    x = tone(np.zeros(runs), 1.0, n + 48, 15.0, rng=np.random.default_rng(1))
    first = ml_frequency(x[:, :n], 1.0)
    for lag in (4, 16, 48):
        measured = np.corrcoef(first, ml_frequency(x[:, lag : lag + n], 1.0))[0, 1]
        score = np.arctanh(measured) - np.arctanh(overlap_correlation_discrete(n, lag))
        # 0.005 more: the law is that of small errors, and 15 dB leave a little of second order
        assert abs(score) < norm.isf(FALSE_ALARM / 6) / np.sqrt(runs) + 0.005


@pytest.mark.parametrize("cn0", [1e3, 1e6])
def test_the_best_window_minimizes_the_mean_square_error(cn0):
    """The bias of either tag comes from fitting a straight phase, here to many samples."""
    t = np.linspace(-0.5, 0.5, 20001)
    weight = 12 * t / np.sum(12 * t**2)

    def bias(phase_cycles, at):
        return weight @ phase_cycles - at

    for law, rate, off in (
        # frequencies chirp * t at t = 1/2 and curvature * t^2 / 2 at t = 0, in units of T
        (optimal_window_end, 50.0, bias(t**2 / 2, 0.5)),
        (optimal_window_center, 400.0, bias(t**3 / 6, 0.0)),
    ):
        power = 1 if law is optimal_window_end else 2

        def error(log_T, rate=rate, off=off, power=power):
            T = np.exp(log_T)
            return 6 / ((2 * np.pi) ** 2 * cn0 * T**3) + (rate * off * T**power) ** 2

        best = np.exp(minimize_scalar(error, bracket=(-6, -1), tol=1e-12).x)
        assert law(cn0, rate) == pytest.approx(best, rel=1e-4)
        assert law(cn0, -rate) == law(cn0, rate)


@pytest.mark.parametrize(("snr_db", "candidates"), [(-12.0, 64), (-9.0, 64), (-7.0, 64)])
def test_outliers_are_as_frequent_as_the_law_says(snr_db, candidates):
    """A peak between two bins gets part of two chances, so the law is a little too small.

    By at most 60 %; below it never, but with a chance of one in a million.
    """
    runs = 20000
    x = tone(np.zeros(runs), 64.0, 64, snr_db, rng=np.random.default_rng(2))
    outliers = np.sum(np.abs(ml_frequency(x, 64.0)) > 1)
    p = float(outlier_probability(64 * 10 ** (snr_db / 10), candidates))
    assert binom.ppf(FALSE_ALARM / 2, runs, p) <= outliers
    assert outliers <= binom.isf(FALSE_ALARM / 2, runs, 1.6 * p)


def test_the_law_of_outliers_is_its_alternating_sum_where_that_can_be_computed():
    """Four candidates: sum over m of (-1)^m C(4, m) / 4 exp(-s (m - 1) / m)."""
    s = np.array([0.1, 1.0, 5.0, 20.0])
    expected = sum(
        sign * c / 4 * np.exp(-s * (m - 1) / m) for m, c, sign in ((2, 6, 1), (3, 4, -1), (4, 1, 1))
    )
    np.testing.assert_allclose(outlier_probability(s, 4), expected, rtol=1e-6)


def test_what_makes_no_sense_is_refused_by_name():
    for call, message in [
        (lambda: crlb_frequency_std(-1, 10, 1), "snr must be positive, got -1"),
        (lambda: crlb_frequency_std(1, 1, 1), "n must be at least 2, got 1"),
        (lambda: crlb_frequency_std(1, 10, 0), "fs must be positive, got 0"),
        (lambda: crlb_frequency_std_dc(np.nan, 1, 9, 1), "f must be finite, got nan"),
        (lambda: crlb_frequency_std_dc(1, 0, 9, 1), "snr must be positive, got 0"),
        (lambda: crlb_frequency_std_dc(1, 1, 2, 1), "n must be at least 3, got 2"),
        (lambda: window_for_std(0, 1), "std must be positive, got 0"),
        (lambda: integrated_snr_for_std(1, -1), "T must be positive, got -1"),
        (lambda: outlier_probability(1, 1), "candidates must be at least 2, got 1"),
        (lambda: overlap_correlation(np.nan), "tau must be finite, got nan"),
        (lambda: overlap_correlation_discrete(1, 0), "n must be a whole number of at least 2"),
        (lambda: optimal_window_end(1, 0), "chirp must not be zero, got 0"),
        (lambda: optimal_window_center(0, 1), "cn0 must be positive, got 0"),
    ]:
        with pytest.raises(ValueError, match=message):
            call()


@pytest.mark.parametrize(("taper", "chirp"), [("rectangular", 800.0), ("hann", -3000.0)])
def test_the_best_window_for_a_chirp_has_the_highest_peak_over_the_noise(taper, chirp):
    def ratio(T):
        t = np.linspace(-T / 2, T / 2, 4001)
        w = np.ones(len(t)) if taper == "rectangular" else np.cos(np.pi * t / T) ** 2
        tone = np.trapezoid(w * np.exp(1j * np.pi * chirp * t**2), t)
        return -(np.abs(tone) ** 2) / np.trapezoid(w**2, t)

    best = minimize_scalar(ratio, bounds=(0.01, 0.1), method="bounded", options={"xatol": 1e-9}).x
    assert float(optimal_window_detection(chirp, taper)) == pytest.approx(best, rel=1e-4)
