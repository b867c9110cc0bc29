"""The alarm comes when the target may be too near, in the light of what is known by then."""

import numpy as np
import pytest

from dopplerlib import RadarArray, Track, doppler_shift, ekf_online
from dopplerlib.chain.alarm import stop_alarm, stop_alarm_online
from dopplerlib.chain.setup import example
from dopplerlib.chain.simulation import simulate_recording
from dopplerlib.chain.track import IqTrack


def straight(std, speed=1.0, late=0.0, samples=20):
    """Return a track of a target that approaches the origin along x from 2 m."""
    time = 0.1 * np.arange(samples + 1)
    x = np.zeros((1, samples + 1, 6))
    x[..., 0], x[..., 3] = 2 - speed * time, -speed
    P = np.tile(np.diag([std**2] * 3 + [0.0] * 3), (1, samples + 1, 1, 1))
    z, nu, S = np.ones((samples + 1, 1)), np.zeros((1, samples, 1)), np.ones((1, samples, 1, 1))
    rest = nu[..., 0], 0.0, np.ones((1, samples + 1)), 0, 1e-9
    return IqTrack(time, time + late, z, z, 1, x, P, nu, S, *rest)


@pytest.mark.parametrize(
    ("std", "probability", "far"), [(1e-9, 0.5, 0.0), (0.1, 1e-3, 0.309), (0.1, 0.5, 0.0)]
)
def test_the_alarm_leaves_room_for_the_error(std, probability, far):
    """Quantile of 0.001 of a normal error: 3.09 standard deviations."""
    alarm = stop_alarm(straight(std), [0, 0, 0], 0.75, probability)
    first = next(t for t in 0.1 * np.arange(21) if 2 - t - far <= 0.75)
    assert alarm.first == pytest.approx(first)


def test_a_late_track_is_predicted_to_the_time_from_which_it_is_known():
    alarm = stop_alarm(straight(1e-9, late=0.3), [0, 0, 0], 0.75)
    assert alarm.time[0] == pytest.approx(0.3)
    np.testing.assert_allclose(alarm.distance[:3], 2 - alarm.time[:3])


def test_a_track_that_stays_away_raises_none():
    alarm = stop_alarm(straight(0.01, speed=-1.0), [0, 0, 0], 0.75)
    assert alarm.first == np.inf and not alarm.alarm.any()


def test_it_comes_before_the_target_does_in_a_room():
    """In 10 simulated records, each with a probability of 0.001 of being late by the error."""
    setup = example()
    time = np.arange(8000) / 4000
    for run in range(10):
        rng = np.random.default_rng([7, run])
        path = [4.8, 1.5, 1.2] + time[:, None] * [-1.4, 0.4, 0]
        recording = simulate_recording(path, setup.array, 4000, rng=rng)
        found = setup.track(setup.baseband(recording))
        alarm = stop_alarm(found, setup.point, setup.distance)
        near = time[np.linalg.norm(path - setup.point, axis=1) <= setup.distance][0]
        assert near - 0.1 < alarm.first < near + setup.window + 1e-9


def test_estimates_that_come_one_by_one_are_decided_alike():
    rng = np.random.default_rng(3)
    found = straight(0.1)
    away = [0.4, -0.3, 0.2]
    P = rng.normal(size=(1, 21, 6, 6)) / 10
    found = IqTrack(**{**vars(found), "P": P @ P.mT})
    alarm, decide = stop_alarm(found, away, 0.75), stop_alarm_online(away, 0.75)
    _, x, P = found.live
    for k in range(len(alarm.time)):
        one = decide(Track(x[k], P[k], None, None, 0.0, True))
        assert one.alarm == alarm.alarm[k]
        assert one.distance == pytest.approx(alarm.distance[k], rel=1e-12)  # rounding
        assert one.distance_std == pytest.approx(alarm.distance_std[k], rel=1e-12)


def test_a_track_without_numbers_is_an_alarm():
    x = np.full(6, np.nan)
    assert stop_alarm_online([0, 0, 0], 0.1)(Track(x, np.eye(6), None, None, 0.0, True)).alarm


def test_a_machine_stops_in_time():
    """A target straight at the point: with errors of millimeters it stops within them."""
    array, x = RadarArray.ring(6, 0.2), np.array([0.8, 0.0, 0.0, -0.7, 0.0, 0.0])
    update = ekf_online(array, x, 1e-6 * np.eye(6), 0.001, 0.01, 0.1)
    decide, rng, decision = stop_alarm_online([0, 0, 0], 0.5), np.random.default_rng(4), None
    while decision is None or not decision.alarm:
        x[:3] += 0.001 * x[3:]
        decision = decide(update(doppler_shift(x, array) + 0.1 * rng.standard_normal(6)))
    assert x[0] == pytest.approx(0.5, abs=0.02)
