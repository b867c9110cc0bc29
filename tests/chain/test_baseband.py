"""The front end keeps times, noise and validity."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dopplerlib import RadarArray
from dopplerlib.chain.baseband import Baseband
from dopplerlib.signal.recording import Recording
from dopplerlib.signal.synthesis import complex_noise

FS, CARRIER, FACTOR = 8000.0, 24e9, 8
ARRAY = RadarArray([[0, -0.1, 0], [0, 0.1, 0]], 299_792_458 / CARRIER)


def recording(x):
    return Recording(x, FS, CARRIER)


def noise(n, seed=111):
    return complex_noise((2, n), 1.0, rng=np.random.default_rng(seed))


def test_a_sample_shows_what_happened_one_delay_before_it_comes_out():
    t = np.arange(8000) / FS
    x = np.exp(2j * np.pi * (50 * t + 10 * t**2))
    iq = Baseband.from_recording(recording([x, 2 * x]), ARRAY, factor=FACTOR)
    assert iq.fs == FS / FACTOR
    then = iq.first - iq.delay + np.arange(iq.x.shape[-1]) / iq.fs
    expected = np.exp(2j * np.pi * (50 * then + 10 * then**2))
    # The passband is flat to 1 %.
    assert_allclose(iq.x, [expected, 2 * expected], atol=0.02)


@pytest.mark.parametrize("taps", [None, 33])
def test_the_noise_gain_is_that_of_white_noise(taps):
    """The variance of 2 times 20 000 samples is good to 0.7 % or so: 4 % are five deviations."""
    iq = Baseband.from_recording(recording(noise(160_000)), ARRAY, factor=FACTOR, taps=taps)
    assert np.mean(np.abs(iq.x) ** 2) * FACTOR == pytest.approx(iq.noise_gain, rel=0.04)


def test_without_a_low_pass_nothing_changes():
    one = recording(noise(100))
    iq = Baseband.from_recording(one, ARRAY)
    assert_array_equal(iq.x, one.x)
    assert (iq.fs, iq.delay, iq.first, iq.noise_gain) == (FS, 0.0, 0.0, 1.0)


def test_what_is_no_measurement_before_the_low_pass_is_none_behind_it():
    """Of a sample that is missing, those that the filter makes of it: 161 taps, every 8th."""
    x = noise(4000)
    x[1, 2000] = np.nan
    iq = Baseband.from_recording(recording(x), ARRAY, factor=FACTOR)
    assert iq.valid[0].all()
    gone = np.flatnonzero(~iq.valid[1])
    out = np.round((iq.first + gone / iq.fs) * FS).astype(int)
    assert_array_equal(out, np.arange(2000, 2161, FACTOR))
    x, valid = iq.samples()
    assert_array_equal(valid, iq.valid)
    assert (x[~valid] == 0).all()


def test_what_does_not_fit_is_refused_by_name():
    one = recording(noise(400))
    three = RadarArray(np.eye(3), one.wavelength)
    for arguments, message in [
        ((one, three), "array must have the 2 sensors of recording, got 3"),
        ((one, replace(ARRAY, wavelength=0.03)), r"array must have the wavelength 0.0124914 m"),
        ((one.x, ARRAY), "recording must be a Recording"),
        ((one, ARRAY.positions), "array must be a RadarArray"),
    ]:
        with pytest.raises(ValueError, match=message):
            Baseband.from_recording(*arguments)
    for settings, message in [
        ({"factor": 20}, "factor must leave samples .*, got 20 for 400 samples and 401 taps"),
        ({"factor": 0}, "factor must be"),
        ({"factor": 2, "taps": 20}, "taps must be odd"),
    ]:
        with pytest.raises(ValueError, match=message):
            Baseband.from_recording(one, ARRAY, **settings)
    for field, message in [
        ({"fs": 0}, "fs must be positive"),
        ({"delay": np.nan}, "delay must be finite"),
        ({"array": 1}, "array must be a RadarArray"),
        ({"noise_gain": -1}, "noise_gain must be positive"),
        ({"x": ["text"]}, "x must be an array of numbers"),
        ({"valid": [1]}, "valid must be an array of booleans"),
    ]:
        with pytest.raises(ValueError, match=message):
            Baseband(**{"x": one.x, "fs": FS, "array": ARRAY} | field)
