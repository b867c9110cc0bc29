"""A record of Doppler shifts: every window is estimated alone, and its time is the stated one.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest
from scipy.stats import chi2

from dopplerlib import doppler_shift
from dopplerlib.signal import interpolation
from dopplerlib.signal.frequency import ml_frequency, ml_frequency_dc
from dopplerlib.signal.sliding import sliding_doppler
from dopplerlib.signal.synthesis import iq_from_geometry, tone
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


def test_amplitude_and_noise_are_those_of_the_fit_that_remains(x):
    """What is left after a fit of the tone, over n - 1.5 of n."""
    d = sliding_doppler(x, FS, WINDOW, HOP)
    w = windows(x)
    wave = np.exp(2j * np.pi * d.frequency[..., None] / FS * np.arange(WINDOW))
    a = np.mean(w * wave.conj(), axis=-1)
    left = np.sum(np.abs(w - a[..., None] * wave) ** 2, axis=-1) / (WINDOW - 1.5)
    np.testing.assert_allclose(d.amp2, np.abs(a) ** 2, rtol=1e-6)
    np.testing.assert_allclose(d.noise_variance, left, rtol=1e-6)


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
    assert np.mean(d.snr) == pytest.approx(snr, rel=0.015)
    score = np.sum(((d.frequency - 77.7) / d.frequency_std) ** 2)
    # the deviation comes from a measured ratio: 1 % more in the mean of its square
    assert chi2.ppf(FALSE_ALARM / 2, count) < score < chi2.isf(FALSE_ALARM / 2, count) * 1.02


@pytest.mark.parametrize(("tag", "first"), [("start", 0), ("center", 249 / 2), ("end", 249)])
def test_the_time_is_that_of_the_tag(x, tag, first):
    d = sliding_doppler(x, FS, WINDOW, HOP, tag=tag)
    np.testing.assert_allclose(d.time, (first + HOP * np.arange(len(d.time))) / FS)
    assert (len(d.time) - 1) * HOP + WINDOW <= N < len(d.time) * HOP + WINDOW


def test_the_frequency_of_a_chirp_is_that_at_the_center():
    """And at the end it is half a window late: chirp * T / 2."""
    x = tone([100.0], FS, N, None, rng=np.random.default_rng(3), chirp=200.0)
    f = {}
    for tag in ("center", "end"):
        d = sliding_doppler(x, FS, WINDOW, HOP, tag=tag)
        f[tag] = d.frequency[:, 0] - (100 + 200 * (d.time - (N - 1) / 2 / FS))
    np.testing.assert_allclose(f["center"], 0, atol=1e-6)
    np.testing.assert_allclose(f["end"], -200 * 249 / 2 / FS, atol=1e-6)


def test_the_doppler_shifts_of_table_2_come_back_from_its_iq():
    """Without noise: what is left is the curvature of the shift, f'' T^2 / 40, 0.05 Hz at most."""
    scenario = mittermaier2016.scenario()
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


def test_a_record_without_noise_has_no_negative_noise():
    x = tone([50.0], FS, N, None, rng=np.random.default_rng(5))
    d = sliding_doppler(x, FS, WINDOW, HOP)
    assert (d.noise_variance >= 0).all()
    assert d.noise_variance.max() < 1e-12


def test_one_window_may_be_the_whole_record(x):
    d = sliding_doppler(x, FS, N, 1)
    assert d.frequency.shape == (2, 1, 3)
    np.testing.assert_allclose(d.frequency[:, 0], ml_frequency(x, FS), atol=1e-9)


def test_what_makes_no_sense_is_refused_by_name(x):
    for kwargs, message in [
        ({"window": N + 1}, "window must be at most the 2000 samples of the record, got 2001"),
        ({"window": 2}, "window must be a whole number of at least 3, got 2"),
        ({"hop": 0}, "hop must be a whole number of at least 1, got 0"),
        ({"tag": "middle"}, "tag must be one of 'start', 'center', 'end', got 'middle'"),
        ({"band": (0, 2 * FS)}, "band must not be wider than fs = 10000"),
        ({"fs": -1}, "fs must be positive, got -1"),
        ({"x": x[0, 0]}, r"x must have shape \(\.\.\., any, any\), got \(2000,\)"),
    ]:
        arguments = {"x": x, "fs": FS, "window": WINDOW, "hop": HOP} | kwargs
        with pytest.raises(ValueError, match=message):
            sliding_doppler(**arguments)
