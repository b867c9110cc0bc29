"""What the modules record: the delayed echo, its strength, and noise of the stated size.

Seeds were written down once and are not chosen.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dopplerlib.chain.simulation import simulate_baseband
from dopplerlib.systems import mittermaier2016 as paper

S = paper.reported().scenario


def ranges(t):
    path = S.x0[:3] + t[:, None] * S.x0[3:]
    return np.linalg.norm(path[:, None] - S.array.positions, axis=-1).T


def test_a_run_is_the_same_in_any_number_of_runs():
    few, more = (
        simulate_baseband(paper.reported().scenario, runs, rng=np.random.default_rng(71))
        for runs in (2, 4)
    )
    assert_array_equal(few.x, more.x[:2])


def test_the_samples_begin_when_the_filter_is_full_and_show_the_delayed_echo():
    """Without noise and faults a sample is the echo of a moment one group delay before."""
    clean = simulate_baseband(
        paper.reported().scenario, 1, rng=np.random.default_rng(72), snr_db=None, faults=False
    )
    t = clean.first + np.arange(clean.x.shape[-1]) / clean.fs
    assert clean.first == pytest.approx(2 * clean.delay)
    wave = np.exp(-4j * np.pi * ranges(t - clean.delay) / S.array.wavelength)
    product = clean.x[0] * wave.conj()
    # The phase at the start is free; the passband is flat to 1 %, and 5 ms of the filter blur the
    # chirp of 300 Hz/s by far less.
    off = product / product.mean(axis=-1, keepdims=True) - 1
    assert np.abs(off).max() < 0.02
    late = wave[:, :-10] * clean.x[0][:, 10:].conj()
    assert np.abs(late / late.mean(axis=-1, keepdims=True) - 1).max() > 0.5


@pytest.mark.parametrize(("amplitude", "power"), [("constant", 0), ("r^-2", -2)])
def test_an_echo_has_amplitude_one_at_the_first_position_and_falls_as_told(amplitude, power):
    """There the distance is that to the center of the ring; no filter, no noise, no faults."""
    settings = {"fs": 2000.0, "snr_db": None, "factor": 1, "faults": False}
    iq = simulate_baseband(
        paper.reported().scenario, 1, rng=np.random.default_rng(74), amplitude=amplitude, **settings
    )
    t = np.arange(iq.x.shape[-1]) / iq.fs
    relative = ranges(t) / np.linalg.norm(S.x0[:3])
    assert_allclose(np.abs(iq.x[0]), relative**power, rtol=1e-9)


@pytest.mark.parametrize("amplitude", ["constant", "r^-2"])
def test_the_noise_is_that_far_below_the_echo_of_the_first_position(amplitude):
    """The same generators give the same phases, so the difference is the noise: 3 % is 7 sigma."""
    settings = {"fs": 10e3, "factor": 1, "faults": False, "amplitude": amplitude}
    noisy, clean = (
        simulate_baseband(
            paper.reported().scenario, 1, rng=np.random.default_rng(75), snr_db=level, **settings
        ).x
        for level in (20.0, None)
    )
    assert np.mean(np.abs(noisy - clean) ** 2) == pytest.approx(0.01, rel=0.03)


def test_the_noise_of_the_low_pass_is_what_its_gain_says():
    """White noise of variance 1 becomes the gain over the factor; 1.5 % is 6 deviations."""
    quiet = simulate_baseband(
        paper.reported().scenario, 30, rng=np.random.default_rng(73), snr_db=0.0, faults=False
    )
    loud = simulate_baseband(
        paper.reported().scenario, 30, rng=np.random.default_rng(73), snr_db=None, faults=False
    )
    # The same generators give the same phases, so that the difference is the noise.
    noise = np.mean(np.abs(quiet.x - loud.x) ** 2)
    assert noise == pytest.approx(quiet.noise_gain / 5, rel=0.015)
    assert 0.9 < quiet.noise_gain < 1


def test_an_amplitude_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="amplitude must be one of"):
        simulate_baseband(
            paper.reported().scenario, 1, rng=np.random.default_rng(1), amplitude="r^-4"
        )
