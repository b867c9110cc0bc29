"""The paths are those of the document: kinematics by hand, and numbers that follow from it."""

import numpy as np
import pytest

from dopplerlib.systems import macaveiu2013 as paper

PATHS = paper.vehicle_paths()
S = paper.automotive_settings()


@pytest.mark.parametrize("path", [*PATHS.values(), paper.hard_turn()[0]], ids=lambda p: p.title)
def test_velocity_is_the_derivative_of_position(path):
    """Central differences: their error is T^2 / 6 times the jerk, at most 0.046 m/s^3 (Fig 11).

    Where the hard turn begins and ends, the acceleration jumps by 1.45 m/s^2 within T.
    """
    tolerance = 0.05 * S.T**2 / 6 if path.figure else 0.25 * 1.46 * S.T
    for axis in (0, 2):
        slope = (path.truth[2:, axis] - path.truth[:-2, axis]) / (2 * S.T)
        np.testing.assert_allclose(slope, path.truth[1:-1, axis + 1], atol=tolerance)


def test_speeds_are_those_printed_in_km_h():
    v = {figure: path.truth[:, 1::2] / paper.KMH for figure, path in PATHS.items()}
    np.testing.assert_allclose(v[7], [[0, 10]] * S.samples, atol=1e-12)
    np.testing.assert_allclose(v[8], [[5, 0]] * S.samples, atol=1e-12)
    np.testing.assert_allclose(v[9], [[-2, 10]] * S.samples, atol=1e-12)
    np.testing.assert_allclose(v[10][:, 1], 10)
    np.testing.assert_allclose(np.diff(v[10][:, 0], n=2), 0, atol=1e-12)  # linear
    assert v[10][0, 0] == pytest.approx(-5) and v[10][-1, 0] == pytest.approx(5, abs=0.03)
    np.testing.assert_allclose(v[11][:, 0], 5)
    assert np.abs(v[11][:, 1]).max() == pytest.approx(1.5, rel=1e-4)


def test_the_record_lasts_19_seconds():
    assert pytest.approx(19.0) == S.samples * S.T
    assert S.time[-1] == pytest.approx(18.962)


def test_the_lane_change_of_one_period_is_a_lane_wide_and_comes_back():
    """The largest displacement is amplitude x period / pi."""
    y = PATHS[11].truth[:, 2]
    assert np.ptp(y) == pytest.approx(1.5 * paper.KMH * 19 / np.pi, rel=1e-4)
    assert y[-1] == pytest.approx(y[0], abs=1e-3)


def test_bandwidth_and_range_resolution_belong_together():
    assert 299_792_458.0 / (2 * S.bandwidth) == pytest.approx(S.range_resolution, rel=1e-3)
    one_cell = S.wavelength / (2 * S.T)
    assert paper.reported().scenario.polar.v_min == pytest.approx(
        one_cell, rel=3e-3
    )  # three digits


def test_the_hard_turn_turns_by_a_quarter_at_constant_speed():
    path, turning = paper.hard_turn()
    speed = np.hypot(path.truth[:, 1], path.truth[:, 3])
    np.testing.assert_allclose(speed, 10 * paper.KMH)
    assert path.truth[0, 1] == 0 and path.truth[-1, 3] == pytest.approx(0, abs=1e-12)
    assert turning.sum() * S.T == pytest.approx(3, abs=S.T)


def test_whether_speed_is_less_accurate_than_range_depends_on_what_they_are_compared_with():
    """lambda / 2T = 0.164 m/s beside 1 m; 5.9 % of 10 km/h beside 1 m of 5 to 58 m of range."""
    fine = 299_792_458.0 / 24e9 / (2 * 0.038)
    assert fine == pytest.approx(S.wavelength / (2 * S.T)) and fine < S.range_resolution
    relative = fine / PATHS[7].truth[:, 3] / (S.range_resolution / PATHS[7].truth[:, 2])
    assert relative[0] < 1 < relative[-1]
