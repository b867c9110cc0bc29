"""The frequency of a real tone reaches its own bound, over few cycles too, and says no sign."""

import numpy as np
import pytest
from scipy.io import wavfile
from scipy.signal import hilbert
from scipy.stats import chi2

from dopplerlib.signal._quadratures import explained
from dopplerlib.signal.frequency import ml_frequency
from dopplerlib.signal.laws import crlb_frequency_std
from dopplerlib.signal.real_tone import (
    crlb_frequency_std_real,
    ml_frequency_real,
    ml_frequency_real_dc,
)
from dopplerlib.signal.recording import read_wav
from dopplerlib.signal.sliding import sliding_doppler

FS = 6000.0
RUNS = 400
# Mean squares of so many errors: outside of this in one of 1e5 tests, of which there are some 20.
LOW, HIGH = chi2.ppf([5e-6, 1 - 5e-6], RUNS) / RUNS
ESTIMATORS = {False: ml_frequency_real, True: ml_frequency_real_dc}


def tones(f, phase, snr, n, rng, dc=0.0):
    """Return RUNS windows (RUNS, n) of a tone with this phase (RUNS or 1) in the middle."""
    t = (np.arange(n) - (n - 1) / 2) / FS
    x = np.cos(2 * np.pi * f * t + np.reshape(phase, (-1, 1))) + dc
    return x + rng.standard_normal((RUNS, n)) / np.sqrt(2 * snr)


def columns(f, n, dc):
    """Return the cosine, the sine and the constant, shape (n, 2 or 3)."""
    w = 2 * np.pi * f / FS * (np.arange(n) - (n - 1) / 2)
    return np.stack([np.cos(w), np.sin(w), *([np.ones(n)] if dc else [])], axis=1)


@pytest.mark.parametrize("dc", [False, True])
@pytest.mark.parametrize("n, cycles", [(20, 0.3), (21, 1.0), (50, 2.7), (20, 9.7), (21, 10.2)])
def test_the_bound_is_the_inverse_of_the_information(dc, n, cycles):
    """Of frequency, both amplitudes and the constant, with derivatives by differences."""
    f, snr, phase = cycles * FS / n, 10.0, 0.4
    amplitudes = [np.cos(phase), -np.sin(phase), *([0.0] if dc else [])]
    h = 1e-3
    slope = (columns(f + h, n, dc) - columns(f - h, n, dc)) @ amplitudes / (2 * h)
    G = np.column_stack([slope, columns(f, n, dc)])
    bound = np.sqrt(np.linalg.inv(G.T @ G)[0, 0] / (2 * snr))
    assert crlb_frequency_std_real(f, phase, snr, n, FS, dc) == pytest.approx(bound, rel=1e-5)


def test_over_many_cycles_the_bound_is_that_of_a_complex_tone_of_half_the_ratio():
    """Terms of one over the number of cycles are left."""
    few = crlb_frequency_std(5.0, 1000, FS)
    assert crlb_frequency_std_real([900.0, -900.0], 1.0, 10.0, 1000, FS) == pytest.approx(
        few, rel=5e-3
    )
    assert crlb_frequency_std_real(0.0, 0.0, 1.0, 10, FS) == np.inf


@pytest.mark.parametrize("dc", [False, True])
def test_nothing_in_the_band_explains_more(dc):
    """Against least squares at 2000 frequencies, for noise alone and tones beside an edge."""
    rng = np.random.default_rng(1)
    n, band = 40, (100.0, 2900.0)
    x = tones(rng.uniform(0, 3000, (RUNS, 1)), rng.uniform(0, 6, RUNS), 1.0, n, rng, dc)[:30]
    f = ESTIMATORS[dc](x, FS, band)
    y = x - x.mean(axis=1, keepdims=True) if dc else x
    total = np.sum(y**2, axis=1)
    energy, _ = explained(y, f, FS, dc)
    for one in np.linspace(*band, 2000):
        fit = columns(one, n, dc)
        left = y.T - fit @ np.linalg.lstsq(fit, y.T)[0]
        assert (total - np.sum(left**2, axis=0) <= energy + 1e-9 * total).all()
    assert ((f >= band[0]) & (f <= band[1])).all()


@pytest.mark.parametrize("phase", [0.0, np.pi / 2])
@pytest.mark.parametrize("cycles", [0.7, 1.0, 1.5, 2.9, 70.0])
@pytest.mark.parametrize("dc", [False, True])
def test_errors_are_those_of_the_bound(dc, cycles, phase):
    """At 30 dB, where the bound is reached with cycles of any number."""
    n, rng = 150, np.random.default_rng(2)
    f = cycles * FS / n
    error = ESTIMATORS[dc](tones(f, phase, 1e3, n, rng, 3.0 * dc), FS) - f
    bound = crlb_frequency_std_real(f, phase, 1e3, n, FS, dc)
    assert LOW < np.mean((error / bound) ** 2) < HIGH


@pytest.mark.parametrize("f", [40.0, 117.0, 900.0])
@pytest.mark.parametrize("dc", [False, True])
def test_deviations_and_noise_of_windows_are_right(dc, f):
    """Whatever the phase. The variance of the noise is determined to 0.6 %: five deviations."""
    n, rng = 150, np.random.default_rng(3)
    x = tones(f, rng.uniform(0, 2 * np.pi, RUNS), 100.0, n, rng, 2.0 * dc)
    d = sliding_doppler(x[:, None], FS, n, n, ESTIMATORS[dc], band=(5, 2900))
    assert LOW < np.mean(((d.frequency - f) / d.frequency_std) ** 2) < HIGH
    assert d.noise_variance.mean() == pytest.approx(4 * 0.005, rel=0.03)
    assert d.snr.mean() == pytest.approx(50, rel=0.05)


def test_the_analytic_signal_is_wrong_over_few_cycles():
    """Three cycles at 20 dB, in windows of a long record: more than twice its own deviation."""
    rng = np.random.default_rng(4)
    t = np.arange(150 * RUNS) / FS
    x = np.cos(2 * np.pi * 117 * t) + rng.standard_normal(len(t)) / np.sqrt(200)
    as_complex = sliding_doppler([hilbert(x)], FS, 150, 150, ml_frequency, band=(5, 400))
    real = sliding_doppler([hilbert(x)], FS, 150, 150, ml_frequency_real, band=(5, 400))
    assert np.mean(((as_complex.frequency - 117) / as_complex.frequency_std) ** 2) > 1.5
    assert LOW < np.mean(((real.frequency - 117) / real.frequency_std) ** 2) < HIGH


def test_the_band_says_the_sign():
    x = tones(117.0, 1.0, 1e4, 150, np.random.default_rng(5))[:3]
    plus, minus = (ml_frequency_real(x, FS, band) for band in [(5, 400), (-400, -5)])
    np.testing.assert_array_equal(plus, -minus)
    np.testing.assert_allclose(ml_frequency_real(x, FS), plus, rtol=1e-6)
    d = sliding_doppler(x[:, None], FS, 150, 150, ml_frequency_real, band=(-400, -5))
    np.testing.assert_array_equal(d.frequency[:, 0, 0], minus)
    for band, message in [
        ((-400, 400), "band must be of one sign, .*, got"),
        ((0, 4000), "band must not exceed fs / 2 = 3000, got"),
    ]:
        with pytest.raises(ValueError, match=message):
            ml_frequency_real(x, FS, band)
    with pytest.raises(ValueError, match="window must be a whole number of at least 5, got 4"):
        sliding_doppler(x, FS, 4, 4, ml_frequency_real)


def test_a_mono_file_from_end_to_end(tmp_path):
    """Of a target that approaches at 117 Hz and sticks for a while, 20 dB above the noise."""
    rng = np.random.default_rng(6)
    t = np.arange(int(4 * FS)) / FS
    x = np.cos(2 * np.pi * 117 * t + 1) + rng.standard_normal(len(t)) / np.sqrt(200)
    x[6000:9000] = x[6000]
    wavfile.write(tmp_path / "mono.wav", int(FS), (8000 * x).astype(np.int16))
    r = read_wav(tmp_path / "mono.wav", 24e9, layout="real")
    d = sliding_doppler(r.x, r.fs, 150, 150, ml_frequency_real, band=(5, 400), valid=r.valid)
    z, sigma = d.measurements()
    gone = np.isnan(z[:, 0])
    assert gone[40:60].all() and not gone[:39].any() and not gone[61:].any()
    nis = ((z - 117) / sigma)[~gone] ** 2
    low, high = chi2.ppf([5e-6, 1 - 5e-6], len(nis)) / len(nis)
    assert low < nis.mean() < high


def test_samples_that_never_move_have_no_frequency():
    x = np.stack([np.zeros(20), np.full(20, 3.0), np.cos(np.arange(20.0))])
    assert np.isnan(ml_frequency_real(x, FS)).tolist() == [True, True, False]
