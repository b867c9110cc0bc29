"""What Section II says of its waveforms, within the size of their approximations."""

import numpy as np
import pytest

from dopplerlib.signal import fsk
from dopplerlib.signal import waveforms as w
from dopplerlib.systems import macaveiu2013 as paper

RADAR = paper.automotive_settings().radar
ONE = [[30.0, -5.0]]
T1 = RADAR.duration / 2
SLOPE = RADAR.bandwidth / T1


def test_a_pulse_is_missed_at_the_sampling_rate_that_rapid_chirps_need():
    """3.4 MHz: samples are 44 m apart, and a pulse of a meter falls between them."""
    rate = 256 * 512 / RADAR.duration
    _, signal = w.pulse_train(RADAR, ONE, rate=rate)
    assert rate < RADAR.bandwidth / 40 and np.abs(signal).max() == 0


def test_two_chirps_and_two_targets_give_two_ghosts():
    targets = np.array([[30.0, -5.0], [50.0, 8.0]])
    chirps = [(SLOPE, 0.0), (-SLOPE, T1)]
    beats = [w.chirp_beat(RADAR, targets, a, duration=T1, begin=t) for a, t in chirps]
    found = [w.strongest_tones(one, 1024 / T1, 2) for one in beats]
    relations = np.stack([w.chirp_relation(RADAR, a) for a, _ in chirps])
    pairs, _ = w.chirp_intersections(relations, found)
    moved = targets + np.stack([targets[:, 1] * T1, [0, 0]], axis=-1)
    off = np.linalg.norm(pairs[:, None] - moved, axis=-1).min(axis=1)
    # A quarter of a meter: the targets move by that during the measurement.
    assert sorted(off < 0.5) == [False, False, True, True]


def test_fsk_confuses_targets_of_the_same_speed_and_sees_none_that_stand():
    r, _ = fsk.fsk_solve(RADAR, *fsk.fsk_beats(RADAR, [[30.0, -5.0], [55.0, -5.0]]))
    assert abs(r - 30) > 5 and abs(r - 55) > 5
    # The echo of a target at rest is a constant, like that of every wall and tree.
    a, b = fsk.fsk_beats(RADAR, [[30.0, 0.0]])
    assert np.ptp(np.abs(np.diff(a))) < 1e-9 and np.ptp(np.angle(b / a)) < 1e-9
    assert fsk.fsk_solve(RADAR, *fsk.fsk_beats(RADAR, [[30.0, 0.0], [55.0, 0.0]]))[0] not in (
        30,
        55,
    )


def test_mfsk_tells_two_targets_unless_they_share_a_beat():
    targets = np.array([[30.0, -5.0], [50.0, 8.0]])
    found = fsk.mfsk_solve(RADAR, *fsk.mfsk_beats(RADAR, targets), count=2)
    np.testing.assert_allclose(found, targets, atol=0.5)
    A = fsk.mfsk_relations(RADAR)
    other = np.array([60.0, (A[0] @ ONE[0] - A[0, 0] * 60.0) / A[0, 1]])  # on the same beat
    ((r, _),) = fsk.mfsk_solve(RADAR, *fsk.mfsk_beats(RADAR, [*ONE, other]), count=1)
    assert abs(r - 30) > 3 and abs(r - 60) > 3


def test_mfsk_tells_two_targets_in_one_measurement_where_slopes_need_three():
    """Chirps that last as long as the measurement: two leave ghosts, the third one tells them."""
    targets = np.array([[30.0, -5.0], [40.0, 4.0]])
    T = RADAR.duration
    relations = [w.chirp_relation(RADAR, a * RADAR.bandwidth / T) for a in (1.0, -1.0, 0.6)]
    left = []
    for number in (2, 3):
        rows = np.stack(relations[:number])
        _, misfit = w.chirp_intersections(rows, [targets @ row for row in rows])
        left.append(np.sum(misfit < 0.5 / T))
    assert left == [4, 2]
    found = fsk.mfsk_solve(RADAR, *fsk.mfsk_beats(RADAR, targets), count=2)
    np.testing.assert_allclose(found, targets, atol=0.5)


def test_a_car_is_long_in_range_and_a_pedestrian_in_range_rate():
    """4 m in cells of 1 m, 3 m/s in cells of 0.16 m/s, and the width of the window, 2 cells or 3.

    A point target fills as many of either.
    """

    def spread(case):
        return w.occupied_cells(w.range_doppler_map(RADAR, w.rapid_chirps(RADAR, case))[2])

    point = spread([[20.0, 2.8]])
    assert max(point) <= 3
    car, pedestrian = spread(paper.CAR), spread(paper.PEDESTRIAN)
    assert car[0] >= 4 and car[1] <= point[1] + 1
    assert pedestrian[0] <= point[0] + 1 and pedestrian[1] >= 10


def test_a_target_faster_than_the_limit_is_folded():
    limit = RADAR.speed_limit()
    fast = limit + 10
    _, v = w.strongest_cell(*w.range_doppler_map(RADAR, w.rapid_chirps(RADAR, [60.0, fast])))
    assert v == pytest.approx(fast - 2 * limit, abs=0.5)
    _, v = w.strongest_cell(
        *w.range_doppler_map(RADAR, w.rapid_chirps(RADAR, [60.0, fast], chirps=1024))
    )
    assert fast < RADAR.speed_limit(1024) and v == pytest.approx(fast, abs=0.5)


def test_noise_has_the_power_it_is_asked_for():
    """Mean power of 40 000 samples: off by 5 deviations, 2.5 %, with probability 6e-7."""
    noise = paper.noisy_echoes(np.zeros(40_000, complex), 3.0, rng=np.random.default_rng(2))
    assert np.mean(np.abs(noise) ** 2) == pytest.approx(10**-0.3, rel=0.025)
