"""The spectrogram agrees with SciPy's, respects the mask, and stays small."""

import tracemalloc

import numpy as np
import pytest
from scipy import signal

from dopplerlib.signal.spectrogram import spectrogram
from dopplerlib.signal.synthesis import complex_noise

FS = 1000.0


def noise(shape, seed=1):
    return complex_noise(shape, 1.0, rng=np.random.default_rng(seed))


@pytest.mark.parametrize("window, hop", [(100, 50), (101, 30), (64, None), (1000, 7)])
def test_columns_are_those_of_the_older_function_of_scipy(window, hop):
    x = noise((2, 1003))
    s = spectrogram(x, FS, window, hop, columns=10**6)
    f, t, expected = signal.spectrogram(
        x, FS, signal.get_window("hann", window), noverlap=window - (hop or window // 2),
        detrend=False, return_onesided=False, scaling="density",
    )  # fmt: skip
    np.testing.assert_allclose(s.frequency, np.fft.fftshift(f), atol=1e-9)
    np.testing.assert_allclose(s.time, t - 0.5 / FS, atol=1e-12)  # theirs is half a sample late
    np.testing.assert_allclose(s.density, np.fft.fftshift(expected, axes=-2), rtol=1e-9)


def test_white_noise_has_its_density_and_a_tone_its_power():
    """1 / fs; 200 windows of independent noise determine a mean of 256 bins to 0.4 %: 5 deviations.

    The power of a tone, off a bin as well, is what stands out, summed over its main lobe.
    """
    s = spectrogram(noise(200 * 256), FS, 256, 256, columns=1, combine="mean")
    assert s.density.mean() * FS == pytest.approx(1, abs=0.022)
    t = np.arange(1000) / FS
    line = spectrogram(3 * np.exp(2j * np.pi * 123.4 * t), FS, 250)
    assert line.density[:, 0].sum() * 4 == pytest.approx(9, rel=1e-9)


@pytest.mark.parametrize("combine, reduce", [("max", np.max), ("mean", np.mean)])
def test_windows_that_share_a_column(combine, reduce):
    """Also across the blocks in which it is computed: 400 windows of 2048 bins are a few."""
    x = noise(410 * 1024)
    one = spectrogram(x, FS, 2048, columns=10**6)
    few = spectrogram(x, FS, 2048, columns=30, combine=combine)
    assert few.density.shape == (2048, 30)
    groups = np.split(one.density, range(14, 409, 14), axis=1)
    np.testing.assert_allclose(
        few.density, np.stack([reduce(g, axis=1) for g in groups], axis=1), rtol=1e-12
    )
    middles = [t.mean() for t in np.split(one.time, range(14, 409, 14))]
    np.testing.assert_allclose(few.time, middles, rtol=1e-12)


def test_a_window_that_touches_an_invalid_sample_does_not_count():
    x, valid = noise((2, 1000)), np.ones((2, 1000), dtype=bool)
    valid[1, 249] = False
    x[1, 249] = np.nan
    s = spectrogram(x, FS, 100, 50, valid=valid)
    assert np.flatnonzero(np.isnan(s.density[1, 0])).tolist() == [3, 4]
    assert not np.isnan(s.density[0]).any()
    pairs = spectrogram(x, FS, 100, 50, valid=valid, columns=10)
    np.testing.assert_array_equal(pairs.density[1, :, 1], s.density[1, :, 2])
    assert np.isnan(spectrogram(x, FS, 100, valid=False).density).all()


def test_memory_does_not_grow_with_the_length():
    """A block has a million values of 16 bytes, in a few copies; all windows would take 128 MB."""
    x = np.ones(68_000, complex)
    tracemalloc.start()
    spectrogram(x, FS, 4000, 32, columns=10)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 80e6


def test_no_power_is_minus_infinity_in_db():
    assert (spectrogram(np.zeros(100), FS, 10).db == -np.inf).all()


@pytest.mark.parametrize(
    "change, message",
    [
        ({"window": 101}, "window must be at most the 100 samples of the record, got 101"),
        ({"window": 1}, "window must be a whole number of at least 2, got 1"),
        ({"hop": 0}, "hop must be a whole number of at least 1, got 0"),
        ({"columns": 0}, "columns must be a whole number of at least 1, got 0"),
        ({"combine": "sum"}, "combine must be one of 'max', 'mean', got 'sum'"),
        ({"fs": 0.0}, "fs must be positive"),
        ({"x": np.full(100, 1e200)}, "x must"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(change, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        spectrogram(**{"x": np.ones(100), "fs": FS, "window": 10} | change)
