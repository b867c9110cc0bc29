"""A record of Doppler shifts: every window is estimated alone, and its time is the stated one.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest
from scipy.stats import binom, chi2, norm

from dopplerlib import doppler_shift, ekf, ml_initialize
from dopplerlib.signal import interpolation, phase
from dopplerlib.signal.frequency import ml_frequency, ml_frequency_dc
from dopplerlib.signal.impairments import remove_mean
from dopplerlib.signal.laws import crlb_frequency_std
from dopplerlib.signal.real_tone import ml_frequency_real, ml_frequency_real_dc
from dopplerlib.signal.sliding import sliding_doppler
from dopplerlib.signal.synthesis import complex_noise, iq_from_geometry, tone
from dopplerlib.systems import mittermaier2016

FS, N, WINDOW, HOP = 10e3, 2000, 250, 70
FALSE_ALARM = 1e-6


@pytest.fixture(scope="module")
def x():
    rng = np.random.default_rng(1)
    return tone([[100.0, 120.0, -80.0], [30.0, 3000.0, 5.0]], FS, N, 10.0, rng=rng, chirp=50.0)


def windows(x):
    firsts = range(0, N - WINDOW + 1, HOP)
    return np.stack([x[..., first : first + WINDOW] for first in firsts], axis=-3)


@pytest.mark.parametrize(
    "estimator",
    [ml_frequency, ml_frequency_dc, interpolation.candan, interpolation.aboutanios_mulgrew],
    ids=lambda e: e.__name__,
)
@pytest.mark.parametrize("band", [None, (-200.0, 200.0)])
def test_every_window_gives_what_it_gives_alone(x, estimator, band):
    """Alone, the transform of a window has other neighbors in memory: rounding differs."""
    x = x[..., :2, :] if band is None else x[:1]
    d = sliding_doppler(x, FS, WINDOW, HOP, estimator, band=band)
    alone = estimator(windows(x), FS, band)
    assert d.frequency.shape == alone.shape == (len(x), len(d.time), x.shape[1])
    np.testing.assert_allclose(d.frequency, alone, atol=1e-6)


@pytest.mark.parametrize(
    "estimator",
    [ml_frequency, ml_frequency_dc, interpolation.candan, phase.kay, interpolation.peak_bin],
    ids=lambda e: e.__name__,
)
def test_amplitude_and_noise_are_those_of_the_fit_that_remains(x, estimator):
    """Least squares of the tone, over n - 1.5 of n; beside a constant of both, over n - 2.5."""
    x = x + 3.0
    d = sliding_doppler(x, FS, WINDOW, HOP, estimator)
    constant = estimator is ml_frequency_dc
    assert d.dc_fitted == constant
    for at in np.ndindex(d.frequency.shape):
        wave = np.exp(2j * np.pi * d.frequency[at] / FS * np.arange(WINDOW))
        basis = np.stack([wave, np.ones(WINDOW)][: 1 + constant], axis=-1)
        w = windows(x)[at]
        fit = np.linalg.lstsq(basis, w, rcond=None)[0]
        left = np.sum(np.abs(w - basis @ fit) ** 2) / (WINDOW - (2.5 if constant else 1.5))
        assert d.amp2[at] == pytest.approx(np.abs(fit[0]) ** 2, rel=1e-6)
        assert d.noise_variance[at] == pytest.approx(left, rel=1e-6)


@pytest.mark.parametrize("n", [20, 50])
@pytest.mark.parametrize("estimator", [ml_frequency, ml_frequency_dc], ids=lambda e: e.__name__)
def test_the_measured_ratio_has_no_bias_in_short_windows_either(estimator, n):
    """At 3 dB, well above the threshold. The mean of `runs` ratios is normal, by its own spread.

    0.4 % more for what is of second order in the noise. Left in, the noise at the peak would make
    the ratio 3.8 and 1.5 % too large, and the mean of 1 / noise_variance 5.7 and 2.1 %.
    """
    runs, snr, fs = 16000, 2.0, 1.0
    x = tone(np.full(runs, 4.3 / n), fs, n, 10 * np.log10(snr), rng=np.random.default_rng(6))
    d = sliding_doppler(x + 5 if estimator is ml_frequency_dc else x, fs, n, n, estimator)
    spread = norm.isf(FALSE_ALARM / 8) * d.snr.std() / np.sqrt(runs)
    assert spread + 0.004 * snr < {20: 0.02, 50: 0.014}[n] * snr
    assert abs(d.snr.mean() - snr) < spread + 0.004 * snr


@pytest.mark.parametrize(("estimator", "n"), [(ml_frequency, 5), (ml_frequency_dc, 6)])
def test_the_measured_ratio_has_no_bias_where_hardly_anything_is_left_to_see_the_noise(
    estimator, n
):
    """At 30 dB. Each unknown too few or too many would change the mean by 4 % or more."""
    runs, snr = 40000, 1000.0
    x = tone(np.full(runs, 1.7 / n), 1.0, n, 30.0, rng=np.random.default_rng(11))
    d = sliding_doppler(x, 1.0, n, n, estimator)
    spread = norm.isf(FALSE_ALARM / 4) * d.snr.std() / np.sqrt(runs)
    assert spread < 0.03 * snr
    assert abs(d.snr.mean() - snr) < spread + 0.004 * snr


def test_noise_adds_as_much_to_a_slow_tone_as_the_constant_leaves_of_it_to_see():
    """1.5 of its variance over the energy of a tone of amplitude 1 less its mean."""
    n = 40
    x = tone(np.linspace(0.3, 2, 30) / n, 1.0, n, 20.0, rng=np.random.default_rng(12)) + 2
    d = sliding_doppler(x, 1.0, n, n, ml_frequency_dc)
    wave = np.exp(2j * np.pi * d.frequency[0, :, None] * np.arange(n))
    energy = np.sum(np.abs(wave - wave.mean(axis=-1, keepdims=True)) ** 2, axis=-1)
    expected = d.amp2 / d.noise_variance * (n - 3.5) / (n - 2.5) - 1.5 / energy
    np.testing.assert_allclose(d.snr[0], expected[0], rtol=1e-9)


@pytest.mark.parametrize("cycles", [0.4, 1.0, 4.3])
def test_the_deviation_beside_a_constant_is_right_in_the_mean(cycles):
    """A few percent more: of second order in the noise, at 30 dB; most of it at 0.4 cycles."""
    runs, n, fs = 4000, 100, 100.0
    x = 5 + tone(np.full(runs, cycles), fs, n, 30.0, rng=np.random.default_rng(7))
    d = sliding_doppler(x, fs, n, n, ml_frequency_dc)
    score = np.sum(((d.frequency - cycles) / d.frequency_std) ** 2)
    assert chi2.ppf(FALSE_ALARM / 6, runs) < score < chi2.isf(FALSE_ALARM / 6, runs) * 1.05


@pytest.mark.parametrize(
    "estimator",
    [ml_frequency, ml_frequency_dc, interpolation.candan, phase.kay, interpolation.peak_bin],
    ids=lambda e: e.__name__,
)
def test_a_window_of_zeros_is_missing_and_the_others_stay(estimator):
    x = tone([100.0, 110.0], FS, N, 10.0, rng=np.random.default_rng(8))
    whole = sliding_doppler(x, FS, WINDOW, WINDOW, estimator)
    x[1, : 3 * WINDOW] = 0
    d = sliding_doppler(x, FS, WINDOW, WINDOW, estimator)
    z, std = d.measurements()
    for value in (d.frequency, z):
        assert np.isnan(value[:3, 1]).all()
        assert np.isfinite(value).sum() == value.size - 3
    assert (d.snr[:3, 1] == 0).all()
    assert np.isinf(d.frequency_std[:3, 1]).all()
    assert np.isfinite(std).all()
    assert (std > 0).all()
    for name in ("frequency", "amp2", "noise_variance", "snr", "frequency_std"):
        for part in ((slice(None), 0), (slice(3, None), 1)):
            np.testing.assert_allclose(getattr(d, name)[part], getattr(whole, name)[part])


@pytest.mark.parametrize(
    "estimator", [ml_frequency, ml_frequency_dc, ml_frequency_real, ml_frequency_real_dc]
)
@pytest.mark.parametrize("band", [None, (50.0, 400.0)])
def test_noise_is_a_measurement_as_often_as_its_probability_says(estimator, band):
    """Of power that varies by ten orders. Rice's formula counts crossings, of which a peak beside
    the end of a band has one, and two peaks have two: at 5 % it is too large by a tenth or so.
    The test holds for all but a millionth of seeds.
    """
    n, K, chance = 64, 1200, 0.05
    rng = np.random.default_rng(12)
    x = complex_noise((1, K * n), 1.0, rng=rng) * np.repeat(10 ** rng.uniform(-5, 5, K), n)
    d = sliding_doppler(x, 1e3, n, n, estimator, band=band)
    count = np.isfinite(d.measurements(chance)[0]).sum()
    assert count == (d.noise_probability <= chance).sum()
    assert binom.ppf(5e-7, K, 0.75 * chance) <= count <= binom.isf(5e-7, K, 1.05 * chance)


def test_a_window_whose_ratio_is_not_positive_keeps_its_estimate_and_is_missing():
    """Mere noise; in a band of a few bins its highest peak is often lower than its share."""
    x = complex_noise((1, 400 * WINDOW), 1.0, rng=np.random.default_rng(9))
    d = sliding_doppler(x, FS, WINDOW, WINDOW, band=(-40, 40))
    z, std = d.measurements(false_alarm=1 - 1e-12)
    assert 0.02 < (d.snr <= 0).mean() < 0.5
    assert np.isfinite(d.frequency).all()
    np.testing.assert_array_equal(np.isinf(d.frequency_std), d.snr <= 0)
    weak = (d.snr <= 0) | (d.noise_probability == 1)
    np.testing.assert_array_equal(np.isnan(z), weak)
    np.testing.assert_array_equal(z[~weak], d.frequency[~weak])
    np.testing.assert_array_equal(std[~weak], crlb_frequency_std(d.snr[~weak], WINDOW, FS))
    np.testing.assert_array_equal(std[weak], FS)


@pytest.mark.parametrize("constant", [0.0, 0.3 - 0.2j])
def test_five_good_modules_and_a_dead_one_still_find_and_track_the_target(constant):
    """NEES of one state: above 40 with a chance of 5e-7. With zeros as measurements it is 1e6.

    The filter's errors are not white in truth, but its windows lie side by side.
    """
    scenario = mittermaier2016.reported().scenario
    t = np.arange(5000) / FS
    path = scenario.x0[:3] + t[:, None] * scenario.x0[3:]
    x = iq_from_geometry(path, scenario.array, 20.0, rng=np.random.default_rng(10))
    x[2] = constant
    T = WINDOW / FS
    d = sliding_doppler(remove_mean(x), FS, WINDOW, WINDOW, band=(-200, 200))
    z, std = d.measurements()
    assert np.isnan(z[:, 2]).all()
    assert np.isfinite(np.delete(z, 2, axis=1)).all()
    near = np.array([0.2, 0.2, 0.2, 0.3, 0.3, 0.3])
    box = scenario.x0 - near, scenario.x0 + near
    start = ml_initialize(z[:8], scenario.array, std[:8], T, box, at="last")
    track = ekf(z[8:], scenario.array, start.x, start.P, T, 1e-3, std[8:])
    truth = np.concatenate([scenario.x0[:3] + d.time[-1] * scenario.x0[3:], scenario.x0[3:]])
    error = track.x[-1] - truth
    assert error @ np.linalg.solve(track.P[-1], error) < 40
    assert track.updated.all()


def test_the_measured_ratio_is_right_in_the_mean_and_so_is_the_deviation():
    """Windows side by side: 2 (n - 1.5) noise / sigma^2 is chi-square distributed."""
    runs, snr = 400, 2.0
    f = np.full(runs, 77.7)
    x = tone(f, FS, 10 * WINDOW, 10 * np.log10(snr), rng=np.random.default_rng(2))
    d = sliding_doppler(x, FS, WINDOW, WINDOW)
    count = d.noise_variance.size
    total, dof = 2 * (WINDOW - 1.5) * snr * d.noise_variance.sum(), count * (2 * WINDOW - 3)
    assert chi2.ppf(FALSE_ALARM / 2, dof) < total < chi2.isf(FALSE_ALARM / 2, dof)
    # a ratio of the snr has a deviation of 9 % here; its mean over 4000 windows 0.15 %
    assert np.mean(d.snr) == pytest.approx(snr, rel=0.01)
    score = np.sum(((d.frequency - 77.7) / d.frequency_std) ** 2)
    # the deviation comes from a measured ratio: 1 % more in the mean of its square
    assert chi2.ppf(FALSE_ALARM / 2, count) < score < chi2.isf(FALSE_ALARM / 2, count) * 1.02


@pytest.mark.parametrize(("timestamp", "first"), [("start", 0), ("center", 249 / 2), ("end", 249)])
def test_the_time_is_that_of_the_tag(x, timestamp, first):
    d = sliding_doppler(x, FS, WINDOW, HOP, timestamp=timestamp)
    np.testing.assert_allclose(d.time, (first + HOP * np.arange(len(d.time))) / FS)
    assert (len(d.time) - 1) * HOP + WINDOW <= N < len(d.time) * HOP + WINDOW


def test_the_frequency_of_a_chirp_is_that_at_the_center():
    """And at the end it is half a window late: chirp * T / 2."""
    x = tone([100.0], FS, N, None, rng=np.random.default_rng(3), chirp=200.0)
    f = {}
    for timestamp in ("center", "end"):
        d = sliding_doppler(x, FS, WINDOW, HOP, timestamp=timestamp)
        f[timestamp] = d.frequency[:, 0] - (100 + 200 * (d.time - (N - 1) / 2 / FS))
    np.testing.assert_allclose(f["center"], 0, atol=1e-6)
    np.testing.assert_allclose(f["end"], -200 * 249 / 2 / FS, atol=1e-6)


def test_the_doppler_shifts_of_table_2_come_back_from_its_iq():
    """Without noise: what is left is the curvature of the shift, f'' T^2 / 40, 0.05 Hz at most."""
    scenario = mittermaier2016.reported().scenario
    t = np.arange(10000) / FS
    path = scenario.x0[:3] + t[:, None] * scenario.x0[3:]
    x = iq_from_geometry(path, scenario.array, None, rng=np.random.default_rng(4))
    d = sliding_doppler(x, FS, 250, 100, band=(0, 200))
    states = np.hstack(
        [
            scenario.x0[:3] + d.time[:, None] * scenario.x0[3:],
            np.tile(scenario.x0[3:], (len(d.time), 1)),
        ]
    )
    expected = doppler_shift(states, scenario.array)
    curvature = np.gradient(np.gradient(expected, d.time, axis=0), d.time, axis=0)
    bias = curvature * (250 / FS) ** 2 / 40
    inner = slice(2, -2)  # numerical differences are one-sided at the ends
    np.testing.assert_allclose(d.frequency[inner], (expected + bias)[inner], atol=0.003)
    assert np.abs(d.frequency - expected).max() < 0.05


def test_a_record_without_noise_has_no_negative_noise_and_no_deviation_of_zero():
    """The search for the peak leaves a millionth of a bin."""
    x = tone([50.0], FS, N, None, rng=np.random.default_rng(5))
    for estimator in (ml_frequency, ml_frequency_dc):
        d = sliding_doppler(x, FS, WINDOW, HOP, estimator)
        assert (d.noise_variance >= 0).all()
        assert d.noise_variance.max() < 1e-12
        assert (d.frequency_std >= 1e-6 * FS / WINDOW).all()
        assert (d.frequency_std < 1e-4).all()
        assert (np.abs(d.frequency - 50.0) <= d.frequency_std).all()


def test_one_window_may_be_the_whole_record(x):
    d = sliding_doppler(x, FS, N, 1)
    assert d.frequency.shape == (2, 1, 3)
    np.testing.assert_allclose(d.frequency[:, 0], ml_frequency(x, FS), atol=1e-9)


def test_what_makes_no_sense_is_refused_by_name(x):
    for kwargs, message in [
        ({"window": N + 1}, "window must be at most the 2000 samples of the record, got 2001"),
        ({"window": 2}, "window must be a whole number of at least 3, got 2"),
        (
            {"window": 3, "estimator": ml_frequency_dc},
            "window must be a whole number of at least 4, got 3",
        ),
        ({"hop": 0}, "hop must be a whole number of at least 1, got 0"),
        (
            {"timestamp": "middle"},
            "timestamp must be one of 'start', 'center', 'end', got 'middle'",
        ),
        ({"band": (0, 2 * FS)}, "band must not be wider than fs = 10000"),
        ({"fs": -1}, "fs must be positive, got -1"),
        ({"x": x[0, 0]}, r"x must have shape \(\.\.\., any, any\), got \(2000,\)"),
    ]:
        arguments = {"x": x, "fs": FS, "window": WINDOW, "hop": HOP} | kwargs
        with pytest.raises(ValueError, match=message):
            sliding_doppler(**arguments)


@pytest.mark.parametrize(
    ("estimator", "message"),
    [
        (1, "estimator must be a function, got 1"),
        (lambda x: x, r"estimator must take 3 argument\(s\), got a function with"),
        (lambda x, fs, band: 1.0, r"estimator\(x, fs, band\) must have shape \(4,\), got \(\)"),
        (lambda x, fs, band: "text", r"estimator\(x, fs, band\) must be an array of real numbers"),
    ],
)
def test_what_does_not_estimate_frequencies_is_refused_by_name(estimator, message):
    with pytest.raises(ValueError, match=message):
        sliding_doppler(np.ones((1, 20)), 1e3, 5, 5, estimator)
