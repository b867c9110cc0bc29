"""Each waveform measures what it should, within the size of its approximations."""

import numpy as np
import pytest

from dopplerlib.signal import waveforms as w

RADAR = w.ChirpRadar(carrier=24e9, bandwidth=150e6, duration=38e-3)
ONE = [[30.0, -5.0]]
T1 = RADAR.duration / 2
SLOPE = RADAR.bandwidth / T1


def test_a_pulse_shows_the_range_within_its_length_and_the_doppler_over_pulses():
    distance, signal = w.pulse_train(RADAR, ONE)
    seen = np.abs(signal[0]) > 0
    assert distance[seen][0] == pytest.approx(30, abs=0.3)  # a sample is 0.25 m
    assert np.ptp(distance[seen]) == pytest.approx(RADAR.range_resolution, abs=0.5)
    sample = np.flatnonzero(seen)[2]
    turns = np.angle(signal[1:, sample] / signal[:-1, sample]) / (2 * np.pi)
    v = -turns * RADAR.wavelength / (2 * 20e-6)
    np.testing.assert_allclose(v, -5, rtol=1e-6)


@pytest.mark.parametrize(("slope", "begin"), [(SLOPE, 0.0), (-SLOPE, T1)])
def test_a_chirp_gives_one_equation_for_two_unknowns(slope, begin):
    signal = w.chirp_beat(RADAR, ONE, slope, duration=T1, begin=begin)
    (beat,) = w.strongest_tones(signal, 1024 / T1, 1)
    moved = np.array([30 - 5 * (begin + T1 / 2), -5])  # in the middle of the chirp
    # A bin, padded 16 times, is 3.3 Hz; the speed changes the slope of the echo by 2 v / c.
    assert beat == pytest.approx(w.chirp_relation(RADAR, slope) @ moved, abs=6)


def test_a_third_slope_tells_the_ghosts():
    targets = np.array([[30.0, -5.0], [50.0, 8.0]])
    slopes = np.array([1.0, -1.0, 0.6]) * SLOPE
    relations = np.stack([w.chirp_relation(RADAR, a) for a in slopes])
    pairs, misfit = w.chirp_intersections(relations, [targets @ row for row in relations])
    real = np.linalg.norm(pairs[:, None] - targets, axis=-1).min(axis=1) < 1e-6
    assert (misfit[real] < 1e-6).all() and (misfit[~real] > 100).all()


def test_a_spread_counts_the_cells_that_are_nearly_as_strong():
    power = np.array([[-30.0, -9.0, -30.0], [-30.0, 0.0, -11.0], [-30.0, -8.0, -30.0]])
    assert w.occupied_cells(power) == (1, 3)
    assert w.occupied_cells(power, 12.0) == (2, 3)


def test_a_map_shows_each_target_where_it_is():
    targets = np.array([[20.0, -5.0], [20.0, 8.0], [60.0, -5.0]])
    r, v, power = w.range_doppler_map(RADAR, w.rapid_chirps(RADAR, targets))
    for target in targets:
        near = np.ix_(np.abs(v - target[1]) < 1, np.abs(r - target[0]) < 3)
        found = w.strongest_cell(
            r[np.abs(r - target[0]) < 3], v[np.abs(v - target[1]) < 1], power[near]
        )
        # Half a cell, and what the target moves during the measurement.
        assert found[0] == pytest.approx(target[0], abs=0.5 + 0.4)
        assert found[1] == pytest.approx(target[1], abs=0.09 + 0.05)


def test_the_cells_of_the_map_are_the_resolutions():
    r, v, _ = w.range_doppler_map(RADAR, np.ones((512, 256), complex))
    assert r[1] == pytest.approx(RADAR.range_resolution, rel=1e-12)
    assert v[1] - v[0] == pytest.approx(RADAR.speed_resolution)
