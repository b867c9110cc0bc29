"""Tracks and records are those of the thesis."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dopplerlib.model.ranging_noise import fourth_power_snr
from dopplerlib.systems import asheim2015 as thesis


def test_the_turn_is_the_path_of_a_body_that_turns_at_a_constant_rate():
    """Integrated numerically, tolerance 1e-9."""
    rate = np.deg2rad(12)

    def motion(t, x):
        w = rate if 10 < t < 20 else 0.0
        return [x[2], x[3], -w * x[3], w * x[2]]

    end = solve_ivp(motion, (0, 50), [0, 0, 0.1, 0.1], rtol=1e-10, atol=1e-12, max_step=0.5)
    np.testing.assert_allclose(
        thesis.maneuver_track([50.0])[0],
        end.y[:, -1],
        atol=1e-4,  # the rate jumps within a step
    )


def test_the_velocity_is_the_derivative_of_the_position():
    t = np.arange(0, 50, 0.01)
    for track in (thesis.straight_track, thesis.maneuver_track):
        x = track(t)
        middle = (x[2:, :2] - x[:-2, :2]) / 0.02
        np.testing.assert_allclose(middle, x[1:-1, 2:], atol=2e-4)  # the turn begins in a step


def test_radar_1_is_farther_than_six_meters_when_it_is_left():
    q = thesis.reported().quoted.departure
    p = thesis.straight_track([q.R1_time, *q.R1_times])[:, :2]
    d = np.hypot(*(p - thesis.radar_positions()[0]).T)
    assert (d > q.R1_distance + 0.4).all()


def test_the_noise_has_the_deviations_of_the_law():
    """200 runs in 501 scans: the mean square is 1 within 5 of its deviations, by chance 1e-6."""
    records = thesis.simulate_radars(200, rng=np.random.default_rng(1))
    unit = (records.z - records.ranges) / thesis.noise_std(records.ranges[..., 0])
    for part in np.moveaxis(unit, -1, 0):
        assert abs(np.mean(part**2) - 1) < 5 * np.sqrt(2 / part.size)
        assert abs(np.mean(part[..., 1:] * part[..., :-1])) < 5 / np.sqrt(part[..., 1:].size)


def test_overlapping_integrations_correlate_by_what_they_share():
    """One scan apart nine tenths, ten scans apart nothing: within 0.02, some 7 deviations."""
    records = thesis.simulate_radars(200, rng=np.random.default_rng(2), correlated=10)
    unit = (records.z - records.ranges) / thesis.noise_std(records.ranges[..., 0])
    for lag in (0, 1, 5, 10):
        product = unit[..., lag:, :] * unit[..., : unit.shape[-2] - lag, :]
        assert abs(product.mean() - (1 - lag / 10)) < 0.02


def test_a_run_is_the_same_whether_few_or_many_are_asked_for():
    few, many = (thesis.simulate_radars(n, rng=np.random.default_rng(3)).z for n in (2, 5))
    np.testing.assert_array_equal(few, many[:2])


def test_the_rate_of_the_code_is_a_difference_and_the_exact_one_is_not():
    code = thesis.simulate_radars(1, rng=np.random.default_rng(4)).ranges
    exact = thesis.simulate_radars(1, rng=np.random.default_rng(4), rate="exact").ranges
    np.testing.assert_allclose(code[:, :-1, 1], np.diff(code[..., 0]) / 0.1, atol=1e-12)
    np.testing.assert_array_equal(code[..., 0], exact[..., 0])
    # Half a scan of the acceleration 0.02 m/s^2 that a passing target has half a meter away.
    assert np.abs(code - exact)[0, 0, 1] == pytest.approx(0.1 / 2 * 0.02, rel=0.05)


def test_a_second_radar_that_is_late_sees_a_later_target():
    late = thesis.simulate_radars(1, rng=np.random.default_rng(5), offset=1.0, rate="exact").ranges
    sync = thesis.simulate_radars(1, rng=np.random.default_rng(5), rate="exact").ranges
    np.testing.assert_allclose(late[0], sync[0])
    np.testing.assert_allclose(late[1, :-10], sync[1, 10:], atol=1e-12)


def test_another_law_is_used():
    far = thesis.simulate_radars(
        1, rng=np.random.default_rng(6), law=lambda d: fourth_power_snr(d, 42.0)
    )
    near = thesis.simulate_radars(1, rng=np.random.default_rng(6))
    assert (
        np.abs(far.z - far.ranges)[..., -1, 0].max()
        < np.abs(near.z - near.ranges)[..., -1, 0].max() / 10
    )


def test_the_same_number_for_both_axes_makes_a_line():
    p, noisy = thesis.noisy_positions(
        thesis.straight_track, rng=np.random.default_rng(7), same=True
    )
    np.testing.assert_allclose(*(noisy - p).T)
    p, noisy = thesis.noisy_positions(thesis.straight_track, rng=np.random.default_rng(7))
    assert abs(np.corrcoef((noisy - p).T / thesis.noise_std(np.hypot(*p.T))[:, 0])[0, 1]) < 0.3


def test_the_tracks_end_where_the_thesis_says_up_to_sign_and_order():
    q, s = thesis.reported().quoted.track, thesis.reported().scenario.tracks
    straight, turned = (
        track([s.duration])[0, :2] for track in (thesis.straight_track, thesis.maneuver_track)
    )
    np.testing.assert_allclose(straight, q.straight_end)
    assert np.hypot(*straight) == pytest.approx(q.straight_end_distance, abs=0.005)
    assert np.abs(turned - q.maneuver_end).max() > 6
    np.testing.assert_allclose(np.abs(turned[::-1]), q.maneuver_end, atol=0.11)
    # The published distance is that of the published place.
    assert np.hypot(*q.maneuver_end) == pytest.approx(q.maneuver_end_distance, abs=0.005)
    assert abs(np.hypot(*turned) - q.maneuver_end_distance) > 0.03


def test_the_person_creeps():
    v = np.hypot(*thesis.reported().scenario.tracks.velocity)
    assert v < thesis.reported().quoted.track.speed_limit


def test_records_up_to_a_time_hold_the_scan_at_that_time():
    records = thesis.simulate_radars(1, rng=np.random.default_rng(1), duration=2.0)
    for end, scans in ((0.0, 1), (0.5, 6), (0.55, 6), (2.0, 21), (9.0, 21)):
        cut = records.until(end)
        assert len(cut.time) == len(cut.truth) == cut.z.shape[2] == cut.ranges.shape[1] == scans
