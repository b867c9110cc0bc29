"""Positions from two radars: bilaterated as published, or from one filter in the plane."""

import numpy as np
import pytest

from dopplerlib import chi2_interval, nees
from dopplerlib.estimation.track import Track
from dopplerlib.evaluation.range_bounds import range_crlb
from dopplerlib.model.motion import cwna_process_noise, ncv_transition
from dopplerlib.model.range_rate import range_rate, range_rate_jacobian
from dopplerlib.systems import asheim2015 as thesis
from dopplerlib.systems.asheim2015.cartesian_tracker import (
    range_and_angle,
    range_and_angle_jacobian,
)


@pytest.fixture(scope="module")
def records():
    return thesis.simulate_radars(40, rng=np.random.default_rng(1), duration=30, rate="exact")


def test_without_noise_every_chain_finds_the_truth(records):
    exact = thesis.RadarRecords(
        records.time, records.truth, records.sensors, records.ranges, records.ranges[None], 0.0
    )
    raw = thesis.raw_positions(exact)
    np.testing.assert_allclose(raw.p[0], records.truth[:, :2], atol=1e-6)
    fused = thesis.filter_then_bilaterate(exact, thesis.filter_settings("modern"))
    central = thesis.central_filter(exact, thesis.filter_settings("modern"))
    # The filters lag behind the bend of the ranges near the start, and forget it.
    for track in (fused, central):
        assert thesis.position_errors(track.p, records.truth)[0, 100:].max() < 0.02


def test_where_the_circles_do_not_meet_y_is_zero_and_it_is_said():
    p, valid = thesis.clipped_bilateration(4.0, 1.0, 1.0)
    assert p.tolist() == [7.5, 0.0] and not valid
    p, valid = thesis.clipped_bilateration(np.nan, 1.0, 1.0)
    assert np.isnan(p).all() and not valid


def test_the_error_area_has_the_size_that_the_thesis_prints():
    s, q = thesis.reported().scenario.error_area, thesis.reported().quoted.error_area
    off = np.abs(thesis.error_area(snr_db=s.snr) - s.position).max(axis=0)
    np.testing.assert_allclose(off, [q.x, q.y], atol=0.05)


def test_the_corners_of_the_area_are_a_linear_map_of_the_square_of_ranges():
    """To first order, for small noise: the corner is at p plus J^-1 times three deviations."""
    p = np.array([0.5, 2.0])
    corners = thesis.error_area(p, snr_db=60.0)
    J = range_rate_jacobian([*p, 0.0, 0.0], thesis.radar_positions())[:, 0, :2]
    sigma = 0.15 / np.sqrt(2e6)
    signs = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]])
    expected = p + 3 * sigma * np.linalg.solve(J, signs.T).T
    np.testing.assert_allclose(corners, expected, atol=1e-5)


def test_a_position_follows_both_ranges_alike():
    """The lengths of both columns of the inverse Jacobian are the same wherever the target is."""
    for p in np.random.default_rng(2).uniform(0.5, 5, (20, 2)):
        J = range_rate_jacobian([*p, 0.0, 0.0], thesis.radar_positions())[:, 0, :2]
        follows = np.linalg.norm(np.linalg.inv(J), axis=0)
        assert follows[0] == pytest.approx(follows[1], rel=1e-9)


def test_h_x_in_place_of_h_leaves_the_whole_angle_as_an_innovation():
    x = np.array([2.0, 1.0, 0.1, 0.1])
    np.testing.assert_allclose(range_and_angle_jacobian(x) @ x, [np.sqrt(5), 0.0], atol=1e-12)
    assert range_and_angle(x)[1] == pytest.approx(np.arctan(0.5))


def test_the_jacobian_of_polar_coordinates_is_their_derivative():
    x = np.array([2.0, 1.0, 0.1, 0.1])
    for i in range(4):
        step = 1e-6 * np.eye(4)[i]
        expected = (range_and_angle(x + step) - range_and_angle(x - step)) / 2e-6
        np.testing.assert_allclose(range_and_angle_jacobian(x)[:, i], expected, atol=1e-9)


def test_table_3_2_follows_the_track(records):
    """Median error at 20 to 30 s below half a meter; the measurements alone have about 0.4 m."""
    track = thesis.table_3_2(records)
    error = thesis.position_errors(track.p, records.truth)
    assert np.median(error[:, 200:]) < 0.5


def test_the_filter_in_the_plane_is_consistent_once_it_has_settled(records):
    """NEES of 40 runs at two times, on average: below the 99.95 % bound, by chance 1e-3.

    No lower bound: the target moves straight, so that the filter with process noise is too careful.
    """
    central = thesis.central_filter(records, thesis.filter_settings("modern"))
    track = Track(central.x, central.P, None, None, None, None)
    value = nees(track, records.truth)
    _, upper = chi2_interval(4, 40, 0.999)
    assert value[:, [150, 290]].mean(axis=0).max() < upper
    assert (central.updated[:, :, 50:].mean(axis=2) > 0.97).all()


def test_both_radars_in_one_filter_beat_two_filters(records):
    """At equal settings, at 25 to 30 s; by far more than the spread of 40 runs."""
    own = thesis.filter_settings("modern")
    apart, together = (
        thesis.rmse(thesis.position_errors(f(records, own).p, records.truth), records.time, 28, 2)
        for f in (thesis.filter_then_bilaterate, thesis.central_filter)
    )
    assert together < apart
    sigma = thesis.noise_std(records.ranges[:, 280, 0])[:, 0]
    single = range_crlb(records.truth[280, :2], records.sensors, sigma)
    assert together < np.sqrt(np.trace(single)) / 3  # many scans are better than one


@pytest.mark.parametrize("offset", [0.05, 0.1])
def test_a_late_radar_does_no_harm_if_its_time_is_known(offset):
    late = thesis.simulate_radars(20, rng=np.random.default_rng(3), duration=30, offset=offset)
    truth = thesis.straight_track(late.time + offset)
    error = thesis.position_errors(
        thesis.central_filter(late, thesis.filter_settings("modern")).p, truth
    )
    assert thesis.rmse(error, late.time, 25, 1) < 0.1


def test_the_nis_of_the_filter_in_the_plane_is_that_of_its_first_prediction(records):
    """By hand, with both components of radar 1 and the covariance between them."""
    own, start = thesis.filter_settings("modern"), np.array([0.05, 0.1, 0.1, 0.1])
    found = thesis.central_filter(records.first(1), own, start=start).nis[0, 0, 1]
    F = ncv_transition(own.T, dim=2, order="derivative")
    Q = cwna_process_noise(own.T, own.Q[1, 1] / own.T, dim=2, order="derivative")
    x = F @ start
    P = F @ (thesis.reported().scenario.cartesian.start_covariance * np.eye(4)) @ F.T + Q
    predicted = range_rate(x, records.sensors[:1])[0]
    H = range_rate_jacobian(x, records.sensors[:1])[0]
    S = H @ P @ H.T + np.diag(own.R(predicted[0]))
    nu = records.z[0, 0, 1] - predicted
    assert abs(S[0, 1]) > 0.01 * S[0, 0]
    assert found == pytest.approx(nu @ np.linalg.solve(S, nu), rel=1e-9)
