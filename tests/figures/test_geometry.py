"""What the figures of geometry draw is what the Doppler model says."""

import json
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.collections import LineCollection
from numpy.testing import assert_allclose

from dopplerlib import RadarArray, doppler_jacobian, doppler_shift
from dopplerlib.figures import geometry as draw
from dopplerlib.figures import scene as scene_parts
from dopplerlib.figures.demonstration import doppler_demonstration
from dopplerlib.figures.preface import hero
from dopplerlib.systems import mittermaier2016 as paper

SCENARIO = paper.scenario()
RING, X0 = SCENARIO.array, SCENARIO.x0
PAIR = RadarArray.linear(2, 0.4)
FLAT = np.array([0.6, 0.2, 0, -0.5, -0.6, 0])
AROUND = np.linspace(0, 2 * np.pi, 37)

coordinate = st.floats(-2, 2)
# Neither on a sensor nor at rest: at least 1 cm before the ring, and 1 cm/s fast.
states = st.tuples(st.floats(0.01, 2), coordinate, coordinate, st.floats(0.01, 2), coordinate,
                   coordinate).map(np.array)  # fmt: skip


def at_velocity(places, velocity):
    """Return states at `places` with `velocity`."""
    return np.concatenate([places, np.broadcast_to(velocity, places.shape)], axis=-1)


@given(states, st.floats(0.01, 100))
def test_every_point_of_an_iso_doppler_cone_has_the_shift_of_the_target(x, distance):
    places = RING.positions[:, None] + distance * draw.iso_doppler_directions(RING, x, AROUND)
    seen = doppler_shift(at_velocity(places, x[3:]), RING)
    of_its_own_cone = np.diagonal(seen, axis1=0, axis2=2)
    # Shifts stay below 600 Hz, and a place 1 cm from a sensor has lost two of sixteen digits.
    assert_allclose(of_its_own_cone, np.tile(doppler_shift(x, RING), (37, 1)), atol=1e-9)


@given(states)
def test_the_directions_of_a_cone_are_unit_vectors_and_the_first_meets_the_target(x):
    directions = draw.iso_doppler_directions(RING, x, AROUND)
    to_target = x[:3] - RING.positions
    # Rounding of unit vectors and of distances below 4 m: some units in the 16th digit.
    assert_allclose(np.linalg.norm(directions, axis=-1), 1, atol=1e-12)
    assert_allclose(np.cross(directions[:, 0], to_target), 0, atol=1e-12)
    assert ((directions[:, 0] * to_target).sum(axis=1) > 0).all()


def test_a_target_that_comes_straight_at_the_sensor_makes_the_cone_a_ray():
    sensor = RadarArray([[0, 0, 0]])
    directions = draw.iso_doppler_directions(sensor, [1, 0, 0, -1, 0, 0], AROUND)
    assert_allclose(directions, np.tile([1.0, 0, 0], (1, 37, 1)), atol=1e-15)


def test_the_cut_of_the_cones_lies_in_the_targets_plane_and_keeps_its_shifts():
    cut = draw.iso_doppler_cut(RING, X0, AROUND)
    seen = np.diagonal(doppler_shift(at_velocity(cut, X0[3:]), RING), axis1=0, axis2=2)
    # As above: rounding only.
    assert_allclose(cut[..., 0], X0[0], rtol=1e-12)
    assert_allclose(seen, np.tile(doppler_shift(X0, RING), (37, 1)), atol=1e-9)
    assert_allclose(cut[:, 0], np.tile(X0[:3], (6, 1)), atol=1e-12)


def test_lines_of_a_cone_that_never_reach_the_plane_are_left_out():
    # Zero shift: the cone is a plane through the sensor, and half of it lies behind the sensor.
    sensor = RadarArray([[0, 0, 0]])
    cut = draw.iso_doppler_cut(sensor, [1, 1, 0, 1, -1, 0], [0, np.pi])[0]
    assert_allclose(cut[0], [1, 1, 0], atol=1e-12)
    assert np.isnan(cut[1]).all()


def test_the_view_has_z_upwards_and_hides_the_direction_to_the_viewer():
    assert_allclose(scene_parts.project([0, 0, 1], 30, 0), [0, 1], atol=1e-15)
    assert_allclose(scene_parts.project([0, 1, 0], 0, 20), [1, 0], atol=1e-15)
    to_viewer = [np.cos(1.1) * np.cos(0.5), np.cos(1.1) * np.sin(0.5), np.sin(1.1)]
    assert_allclose(scene_parts.project(to_viewer, *np.rad2deg([0.5, 1.1])), [0, 0], atol=1e-15)


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=8), st.floats(0.01, 1))
def test_labels_are_spread_until_none_is_closer_than_the_gap(values, gap):
    moved = scene_parts.spread(values, gap)
    assert (np.diff(np.sort(moved)) >= gap * (1 - 1e-6)).all()
    assert (np.diff(moved[np.argsort(values, kind="stable")]) >= 0).all()
    assert_allclose(np.mean(moved), np.mean(values), atol=1e-9)


def test_labels_that_are_far_apart_stay():
    assert scene_parts.spread([3, 1, 2], 0.5).tolist() == [3, 1, 2]


def test_the_doppler_curves_show_every_sensors_shift_under_its_number():
    shifts = doppler_shift(SCENARIO.truth, RING)
    ax = draw.doppler_curves(SCENARIO.time, shifts).axes[0]
    curves = {line.get_label(): line.get_ydata() for line in ax.lines}
    assert list(curves) == ["1", "2", "3", "4", "5", "6"]
    assert np.array_equal(np.transpose(list(curves.values())), shifts)
    assert [text.get_text() for text in ax.texts] == list(curves)
    assert ax.get_ylabel() == "Doppler shift (Hz)"


def test_the_two_frames_show_the_shifts_and_opposite_velocities():
    platform, target = draw.two_sensors(PAIR, FLAT).axes
    written = {text.get_text() for text in target.texts}
    assert {f"{shift:+.0f} Hz" for shift in doppler_shift(FLAT, PAIR)} <= written
    u, v = (
        next(np.subtract(text.xy, text.xyann) for text in ax.texts if not text.get_text())
        for ax in (platform, target)
    )
    assert_allclose(u, -v, atol=1e-12)
    assert_allclose(np.cross([*v, 0], [*FLAT[3:5], 0]), 0, atol=1e-12)


def test_the_iso_doppler_lines_end_where_the_shift_is_the_targets():
    row = RadarArray.linear(6, 0.5)
    every = draw.iso_doppler_lines(row, FLAT).axes[1]
    branches = [line.get_xydata() for line in every.lines if len(line.get_xydata()) == 2]
    ends = np.array([branch[1] for branch in branches])
    assert len(ends) == 12  # two for each sensor
    seen = doppler_shift(at_velocity(np.column_stack([ends, np.zeros(12)]), FLAT[3:]), row)
    own = seen[np.arange(12), np.arange(12) // 2]
    assert_allclose(own, np.repeat(doppler_shift(FLAT, row), 2), atol=1e-9)


def test_the_rims_of_the_cones_are_drawn_through_the_target():
    plane = draw.iso_doppler_cones(RING, X0).axes[1]
    rims = {line.get_label(): line.get_xydata() for line in plane.lines[:6]}
    assert list(rims) == ["1", "2", "3", "4", "5", "6"]
    for rim in rims.values():
        assert_allclose(rim[[0, -1]], np.tile(X0[1:3], (2, 1)), atol=1e-12)


def test_the_sensitivities_are_in_hertz_per_centimeter():
    jacobian = doppler_jacobian(SCENARIO.truth, RING)
    position, velocity = draw.sensitivities(SCENARIO.time, jacobian, SCENARIO.sigma_f).axes
    labels = [line.get_label() for ax in (position, velocity) for line in ax.lines[:3]]
    assert labels == ["$x$", "$y$", "$z$", "$v_x$", "$v_y$", "$v_z$"]
    # 1 mm to the side is a thousandth of the distance: curvature adds less than 1 %.
    change = doppler_shift(np.add(X0, [0, 1e-3, 0, 0, 0, 0]), RING) - doppler_shift(X0, RING)
    assert_allclose(position.lines[1].get_ydata()[0], 10 * np.linalg.norm(change), rtol=0.01)


def test_the_first_picture_draws_every_run_from_the_start_to_its_end():
    result = paper.figure6(3, rng=np.random.default_rng(5), keep=())
    start, z = paper.table2().x_ml, doppler_shift(SCENARIO.truth, RING)
    scene, curves, errors = hero(SCENARIO, z, result.track.x, start, -50, 10).axes
    fan = next(c for c in scene.collections if isinstance(c, LineCollection)).get_segments()
    expected = [[start[:3], run[-1, :3]] for run in result.track.x]
    assert_allclose([line[[0, -1]] for line in fan], scene_parts.project(expected, -50, 10))
    assert np.array_equal([line.get_ydata() for line in curves.lines], z.T)
    # The median of three runs is the middle one.
    middle = np.sort(np.linalg.norm(result.error, axis=-1), axis=0)[1]
    assert_allclose(errors.lines[0].get_ydata(), 100 * middle)


def test_the_demonstration_holds_its_formula_and_settings_and_loads_nothing():
    text = doppler_demonstration("function doppler_shift() { return [0]; }", PAIR, FLAT)
    assert "function doppler_shift() { return [0]; }" in text
    settings = json.loads(re.search(r'= (\{"sensors".*\});', text).group(1))
    assert settings == {
        "sensors": PAIR.positions.tolist(),
        "dopplerPerSpeed": 160.0,
        "x": FLAT.tolist(),
    }
    assert not re.search(r"https?:|src=|import|fetch|/\*[A-Z]", text)
    assert "This drawing needs JavaScript" in text


@pytest.mark.parametrize("n", [1, 2, 5, 6])
def test_sensors_have_colors_of_their_own(n):
    assert len(set(scene_parts.sensor_colors(n))) == n
