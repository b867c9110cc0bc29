"""What the figures of geometry draw is what the Doppler model says."""

import numpy as np
from numpy.testing import assert_allclose

from dopplerlib import RadarArray, doppler_jacobian, doppler_shift
from dopplerlib.figures import geometry as draw
from dopplerlib.systems import mittermaier2016 as paper

SCENARIO = paper.reported().scenario
RING, X0 = SCENARIO.array, SCENARIO.x0
PAIR = RadarArray.linear(2, 0.4)
FLAT = np.array([0.6, 0.2, 0, -0.5, -0.6, 0])


def at_velocity(places, velocity):
    """Return states at `places` with `velocity`."""
    return np.concatenate([places, np.broadcast_to(velocity, places.shape)], axis=-1)


def test_the_doppler_curves_show_every_sensors_shift_under_its_number():
    shifts = doppler_shift(SCENARIO.truth, RING)
    ax = draw.doppler_curves(SCENARIO.time, shifts).axes[0]
    curves = {line.get_label(): line.get_ydata() for line in ax.lines}
    assert list(curves) == ["1", "2", "3", "4", "5", "6"]
    assert np.array_equal(np.transpose(list(curves.values())), shifts)
    assert [text.get_text() for text in ax.texts] == list(curves)
    assert ax.get_ylabel() == "Doppler shift (Hz)"


def test_curves_that_meet_at_their_ends_are_labeled_where_they_part():
    shifts = doppler_shift(SCENARIO.truth, RING)
    whole, close = draw.doppler_curves(SCENARIO.time, shifts, close=(0.25, 0.5)).axes
    assert [len(line.get_xdata()) for line in whole.lines] == [len(shifts)] * 6
    assert [len(line.get_xdata()) for line in close.lines] == [250] * 6
    assert len(close.texts) == 6 and not whole.texts


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
    places = np.stack([np.column_stack([0 * rim[:, 0] + X0[0], rim]) for rim in rims.values()])
    seen = np.diagonal(doppler_shift(at_velocity(places, X0[3:]), RING), axis1=0, axis2=2)
    assert_allclose(seen, np.tile(doppler_shift(X0, RING), (181, 1)), atol=1e-9)
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


def test_lines_of_a_cone_that_never_reach_the_plane_are_left_out():
    # Zero shift: the cone is a plane through the sensor, and half of it lies behind the sensor.
    sensor = RadarArray([[0, 0, 0]])
    plane = draw.iso_doppler_cones(sensor, [1, 0.5, 0.5, 1, -1, -1]).axes[1]
    rim = plane.lines[0].get_xydata()
    assert_allclose(rim[0], [0.5, 0.5], atol=1e-12)
    assert np.isnan(rim[90]).all() and np.nanmax(np.abs(rim)) < 100
