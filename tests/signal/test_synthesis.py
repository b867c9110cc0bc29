"""IQ samples: the phase is that of the path, the noise that of the stated ratio.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.stats import chi2, kstest, norm

from dopplerlib import RadarArray, doppler_shift
from dopplerlib.signal.synthesis import (
    complex_noise,
    iq_from_geometry,
    iq_from_velocity,
    tone,
    velocity_profile,
)
from dopplerlib.systems import mittermaier2016

FALSE_ALARM = 1e-6
ARRAY = RadarArray.ring(6, 0.2)
T = 1e-4
TIME = np.arange(2000) * T
STATE = np.array([0.5, 0.1, 0.05, -0.75, -0.3, 0.2])
PATH = STATE[:3] + TIME[:, None] * STATE[3:]


def rng(seed=1):
    return np.random.default_rng(seed)


def slope(x):
    """Return the frequency half way between samples in Hz, from the steps of the phase."""
    return np.angle(x[..., 1:] * x[..., :-1].conj()) / (2 * np.pi * T)


def test_the_phase_turns_with_the_doppler_shift_of_equation_6():
    """A step of the phase is a mean over T: off by T^2 / 24 times the second derivative."""
    x = iq_from_geometry(PATH, ARRAY, None, rng=rng())
    middle = np.hstack([PATH[:-1] + T / 2 * STATE[3:], np.tile(STATE[3:], (len(PATH) - 1, 1))])
    np.testing.assert_allclose(slope(x), doppler_shift(middle, ARRAY).T, atol=1e-4)


def test_approaching_is_positive():
    toward = iq_from_geometry([[1, 0, 0], [0.999, 0, 0]], RadarArray([[0, 0, 0]]), None, rng=rng())
    assert slope(toward) > 0


def test_a_quarter_of_a_wavelength_is_half_a_turn():
    path = [[1.0, 0, 0], [1 + ARRAY.wavelength / 4, 0, 0], [1 + ARRAY.wavelength / 2, 0, 0]]
    x = iq_from_geometry(path, RadarArray([[0, 0, 0]]), None, rng=rng())[0]
    np.testing.assert_allclose(x / x[0], [1, -1, 1], atol=1e-11)


def test_velocity_and_geometry_tell_the_same_when_the_target_flies_head_on():
    v = 0.7 + 0.3 * np.sin(20 * TIME)
    r = 1.0 - cumulative_trapezoid(v, dx=T, initial=0)
    path = np.stack([r, 0 * r, 0 * r], axis=-1)
    a = iq_from_velocity(v, T, 0.0125, None, rng=rng())
    b = iq_from_geometry(path, RadarArray([[0, 0, 0]], 0.0125), None, rng=rng())[0]
    np.testing.assert_allclose(a / a[0], b / b[0], atol=1e-9)


def test_the_amplitude_falls_with_the_square_of_the_range():
    x = iq_from_geometry(PATH, ARRAY, None, rng=rng(), amplitude="r^-2")
    r = np.linalg.norm(PATH - ARRAY.positions[:, None], axis=-1)
    np.testing.assert_allclose(np.abs(x), 1 / r**2)
    np.testing.assert_allclose(np.abs(iq_from_geometry(PATH, ARRAY, None, rng=rng())), 1)


def test_every_sensor_and_record_has_a_phase_of_its_own_on_all_the_circle():
    x = iq_from_geometry(PATH[:1], ARRAY, None, rng=rng(), size=500)
    assert x.shape == (500, 6, 1)
    assert kstest(np.angle(x).ravel() / (2 * np.pi) + 0.5, "uniform").pvalue > FALSE_ALARM
    turn = np.angle(x[:, 1:] / x[:, :-1]).ravel()
    assert kstest(turn / (2 * np.pi) + 0.5, "uniform").pvalue > FALSE_ALARM


@pytest.mark.parametrize("snr_db", [-10.0, 0.0, 20.0])
def test_the_noise_has_the_stated_ratio_to_the_signal(snr_db):
    """The same seed without noise gives the signal; what is left has a chi-square sum."""
    clean, noisy = (iq_from_geometry(PATH, ARRAY, snr, rng=rng(2)) for snr in (None, snr_db))
    left = noisy - clean
    total = 2 * np.sum(np.abs(left) ** 2) * 10 ** (snr_db / 10)
    assert (
        chi2.ppf(FALSE_ALARM / 2, 2 * left.size) < total < chi2.isf(FALSE_ALARM / 2, 2 * left.size)
    )


def test_the_noise_is_circular_gaussian_and_white():
    noise = complex_noise((20, 1000), 3.0, rng=rng(3))
    parts = np.stack([noise.real, noise.imag]) / np.sqrt(1.5)
    assert kstest(parts.ravel(), norm.cdf).pvalue > FALSE_ALARM
    z = norm.isf(FALSE_ALARM / 2 / 3)
    # a mean of products of two independent unit normals has variance 1 / size
    assert abs(np.mean(parts[0] * parts[1])) * np.sqrt(noise.size) < z
    for part in parts:
        assert abs(np.mean(part[:, 1:] * part[:, :-1])) * np.sqrt(part[:, 1:].size) < z


def test_a_tone_has_its_frequency_at_the_middle_of_the_window():
    x = tone([50.0, -50.0], 1 / T, 101, None, rng=rng(), chirp=[2000.0, 0.0])
    f = slope(x)
    np.testing.assert_allclose(f[:, 49:51].mean(axis=-1), [50, -50], atol=1e-6)
    np.testing.assert_allclose(np.diff(f[0]) / T, 2000, atol=1e-4)


def test_a_velocity_profile_is_the_integral_of_its_acceleration():
    t = np.linspace(0, 15, 150001)
    v, a = velocity_profile(t, 250, [(3, 6.6, -37.0), (9, 12.6, 37.0), (4, 5, 2.0)])
    # the trapezoidal rule is off by half a step at each of the six jumps
    np.testing.assert_allclose(v, 250 + cumulative_trapezoid(a, t, initial=0), atol=6 * 37e-4)
    assert v[-1] == pytest.approx(252)


def test_the_acceleration_at_the_ends_of_a_segment_is_that_of_what_follows():
    """So that one segment after the other leaves no sample with both or none of them."""
    _, a = velocity_profile([1.0, 2.0, 3.0, 4.0], 0, [(2, 3, 5.0), (3, 4, 7.0)])
    assert a.tolist() == [0, 5, 7, 0]


def test_the_same_seed_gives_the_same_bits():
    for make in (
        lambda g: tone([1.0, 2.0], 100.0, 50, 3.0, rng=g),
        lambda g: iq_from_velocity(np.ones(50), T, 0.0125, 3.0, rng=g, size=4),
        lambda g: iq_from_geometry(PATH, ARRAY, 3.0, rng=g),
    ):
        np.testing.assert_array_equal(make(rng(4)), make(rng(4)))
        assert (make(rng(4)) != make(rng(5))).all()


def test_a_whole_batch_of_paths_is_taken():
    paths = np.stack([PATH, PATH + 0.1])
    x = iq_from_geometry(paths, ARRAY, 10.0, rng=rng(), size=3)
    assert x.shape == (3, 2, 6, len(TIME))
    assert iq_from_velocity(np.ones((2, 50)), T, 0.0125, 3.0, rng=rng(), size=4).shape == (4, 2, 50)


def test_the_track_of_table_2_can_be_heard():
    scenario = mittermaier2016.reported().scenario
    x = iq_from_geometry(scenario.truth[:, :3], scenario.array, None, rng=rng())
    step = np.angle(x[:, 1:] * x[:, :-1].conj()) / (2 * np.pi * scenario.T)
    expected = doppler_shift(scenario.truth, scenario.array).T
    # over the millisecond from one sample to the next the shift changes by 0.3 Hz at most
    np.testing.assert_allclose(step, (expected[:, 1:] + expected[:, :-1]) / 2, atol=0.01)


def test_what_makes_no_sense_is_refused_by_name():
    with pytest.raises(ValueError, match=r"position must not lie on a sensor"):
        iq_from_geometry([ARRAY.positions[2]], ARRAY, None, rng=rng())
    with pytest.raises(ValueError, match=r"amplitude must be one of 'constant', 'r\^-2', got 'r'"):
        iq_from_geometry(PATH, ARRAY, None, rng=rng(), amplitude="r")
    with pytest.raises(ValueError, match=r"position must have shape \(\.\.\., any, 3\)"):
        iq_from_geometry(PATH[:, :2], ARRAY, None, rng=rng())
    with pytest.raises(ValueError, match="array must be a RadarArray, got"):
        iq_from_geometry(PATH, [0, 0, 0], None, rng=rng())
    with pytest.raises(ValueError, match="snr_db must be finite, got nan"):
        tone(1.0, 10.0, 5, np.nan, rng=rng())
    with pytest.raises(ValueError, match=r"rng must be a numpy\.random\.Generator"):
        tone(1.0, 10.0, 5, None, rng=1)
    with pytest.raises(ValueError, match=r"variance must not be negative, got -1\.0"):
        complex_noise(3, -1, rng=rng())
    with pytest.raises(
        ValueError, match=r"segments\[1\] must end after its start, got \(3, 3, 1\)"
    ):
        velocity_profile(TIME, 0, [(1, 2, 1), (3, 3, 1)])
    with pytest.raises(ValueError, match="T must be positive, got 0"):
        iq_from_velocity(np.ones(4), 0, 1.0, None, rng=rng())
    with pytest.raises(ValueError, match="wavelength must be positive, got -1"):
        iq_from_velocity(np.ones(4), 1, -1, None, rng=rng())
