"""Each waveform measures what Section II says, within the size of its approximations."""

import numpy as np
import pytest

from dopplerlib.systems.macaveiu2013 import settings, two_tones
from dopplerlib.systems.macaveiu2013 import waveforms as w

S = settings()
ONE = [[30.0, -5.0]]
T1 = S.T / 2
SLOPE = S.bandwidth / T1


def test_a_pulse_shows_the_range_within_its_length_and_the_doppler_over_pulses():
    distance, signal = w.pulse_train(ONE)
    seen = np.abs(signal[0]) > 0
    assert distance[seen][0] == pytest.approx(30, abs=0.3)  # a sample is 0.25 m
    assert np.ptp(distance[seen]) == pytest.approx(S.range_resolution, abs=0.5)
    sample = np.flatnonzero(seen)[2]
    turns = np.angle(signal[1:, sample] / signal[:-1, sample]) / (2 * np.pi)
    v = -turns * w.C / (2 * S.carrier * 20e-6)
    np.testing.assert_allclose(v, -5, rtol=1e-6)


def test_a_pulse_is_missed_at_the_sampling_rate_that_rapid_chirps_need():
    """3.4 MHz: samples are 44 m apart, and a pulse of a meter falls between them."""
    rate = 256 * 512 / S.T
    _, signal = w.pulse_train(ONE, rate=rate)
    assert rate < S.bandwidth / 40 and np.abs(signal).max() == 0


@pytest.mark.parametrize(("slope", "begin"), [(SLOPE, 0.0), (-SLOPE, T1)])
def test_a_chirp_gives_one_equation_for_two_unknowns(slope, begin):
    signal = w.chirp_beat(ONE, slope, T1, 1024, begin)
    (beat,) = w.tones(signal, 1024 / T1, 1)
    moved = np.array([30 - 5 * (begin + T1 / 2), -5])  # in the middle of the chirp
    # A bin, padded 16 times, is 3.3 Hz; the speed changes the slope of the echo by 2 v / c.
    assert beat == pytest.approx(w.chirp_relation(slope) @ moved, abs=6)


def test_two_chirps_and_two_targets_give_two_ghosts():
    targets = np.array([[30.0, -5.0], [50.0, 8.0]])
    chirps = [(SLOPE, 0.0), (-SLOPE, T1)]
    found = [w.tones(w.chirp_beat(targets, a, T1, 1024, t), 1024 / T1, 2) for a, t in chirps]
    relations = np.stack([w.chirp_relation(a) for a, _ in chirps])
    pairs, _ = w.intersections(relations, found)
    moved = targets + np.stack([targets[:, 1] * T1, [0, 0]], axis=-1)
    off = np.linalg.norm(pairs[:, None] - moved, axis=-1).min(axis=1)
    # A quarter of a meter: the targets move by that during the measurement.
    assert sorted(off < 0.5) == [False, False, True, True]


def test_a_third_slope_tells_the_ghosts():
    targets = np.array([[30.0, -5.0], [50.0, 8.0]])
    slopes = np.array([1.0, -1.0, 0.6]) * SLOPE
    relations = np.stack([w.chirp_relation(a) for a in slopes])
    pairs, misfit = w.intersections(relations, [targets @ row for row in relations])
    real = np.linalg.norm(pairs[:, None] - targets, axis=-1).min(axis=1) < 1e-6
    assert (misfit[real] < 1e-6).all() and (misfit[~real] > 100).all()


def test_fsk_measures_one_target():
    r, v = two_tones.fsk_range(*two_tones.fsk(ONE))
    assert r == pytest.approx(30 - 5 * S.T / 2, abs=0.1)
    assert v == pytest.approx(-5, abs=0.01)


def test_fsk_confuses_targets_of_the_same_speed_and_sees_none_that_stand():
    r, _ = two_tones.fsk_range(*two_tones.fsk([[30.0, -5.0], [55.0, -5.0]]))
    assert abs(r - 30) > 5 and abs(r - 55) > 5
    # The echo of a target at rest is a constant, like that of every wall and tree.
    a, b = two_tones.fsk([[30.0, 0.0]])
    assert np.ptp(np.abs(np.diff(a))) < 1e-9 and np.ptp(np.angle(b / a)) < 1e-9
    assert two_tones.fsk_range(*two_tones.fsk([[30.0, 0.0], [55.0, 0.0]]))[0] not in (30, 55)


@pytest.mark.parametrize("target", [[30.0, -5.0], [10.0, 3.0], [90.0, 12.0], [60.0, 0.0]])
def test_mfsk_solves_for_range_and_speed_at_once(target):
    """Unambiguous as long as the phase stays within half a turn."""
    assert abs((two_tones.mfsk_relations() @ target)[1]) < 0.5
    ((r, v),) = two_tones.mfsk_solve(*two_tones.mfsk([target]))
    # During the measurement the target moves by v T, and its Doppler grows with the carrier.
    assert r == pytest.approx(target[0] + target[1] * S.T / 2, abs=0.02 + 0.02 * abs(target[1]))
    # On average half the bandwidth above the carrier: 0.3 % of the speed.
    assert v == pytest.approx(target[1], abs=0.02 + 0.004 * abs(target[1]))


def test_mfsk_tells_two_targets_unless_they_share_a_beat():
    targets = np.array([[30.0, -5.0], [50.0, 8.0]])
    found = two_tones.mfsk_solve(*two_tones.mfsk(targets), count=2)
    np.testing.assert_allclose(found, targets, atol=0.5)
    A = two_tones.mfsk_relations()
    other = np.array([60.0, (A[0] @ ONE[0] - A[0, 0] * 60.0) / A[0, 1]])  # on the same beat
    ((r, _),) = two_tones.mfsk_solve(*two_tones.mfsk([*ONE, other]), count=1)
    assert abs(r - 30) > 3 and abs(r - 60) > 3


def test_a_map_shows_each_target_where_it_is():
    targets = np.array([[20.0, -5.0], [20.0, 8.0], [60.0, -5.0]])
    r, v, power = w.range_doppler_map(w.rapid_chirps(targets))
    for target in targets:
        near = np.ix_(np.abs(v - target[1]) < 1, np.abs(r - target[0]) < 3)
        found = w.strongest(r[np.abs(r - target[0]) < 3], v[np.abs(v - target[1]) < 1], power[near])
        # Half a cell, and what the target moves during the measurement.
        assert found[0] == pytest.approx(target[0], abs=0.5 + 0.4)
        assert found[1] == pytest.approx(target[1], abs=0.09 + 0.05)


def test_the_cells_of_the_map_are_the_resolutions():
    r, v, _ = w.range_doppler_map(np.ones((512, 256), complex))
    assert r[1] == pytest.approx(S.range_resolution, rel=1e-3)
    assert v[1] - v[0] == pytest.approx(S.wavelength / (2 * S.T))


def test_a_target_faster_than_the_limit_is_folded():
    limit = w.speed_limit()
    fast = limit + 10
    _, v = w.strongest(*w.range_doppler_map(w.rapid_chirps([[60.0, fast]])))
    assert v == pytest.approx(fast - 2 * limit, abs=0.5)


def test_noise_has_the_power_it_is_asked_for():
    """Mean power of 40 000 samples: off by 5 deviations, 2.5 %, with probability 6e-7."""
    noise = w.noisy(np.zeros(40_000, complex), 3.0, rng=np.random.default_rng(2))
    assert np.mean(np.abs(noise) ** 2) == pytest.approx(10**-0.3, rel=0.025)
