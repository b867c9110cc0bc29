"""The figures of two radars show the data they are given."""

import numpy as np
import pytest

from dopplerlib.figures import asheim_two as draw
from tests.drawn import lines

MADE_UP = {"error_over_distance"}

TIME = np.arange(50.0)
SENSORS = np.array([[-0.5, 0.0], [0.5, 0.0]])
TARGET = np.array([0.0, 4.0])
PLACES = np.random.default_rng(1).normal(size=(50, 2))
UNIT = ((0.0, 1.0), (0.0, 1.0))


def test_the_error_is_the_root_mean_square_over_runs():
    error = np.array([3.0, 4.0])[:, None] * np.ones(50)
    (ax,) = draw.error_over_distance(TIME, {"one filter": error}, published=5.66).axes
    shown = lines(ax)
    np.testing.assert_allclose(shown["one filter"].get_ydata(), np.sqrt(12.5))
    assert shown["usable range in the thesis"].get_xdata() == [5.66, 5.66]


def test_the_rings_enclose_the_target_from_both_sides():
    figure = draw.error_areas(
        TARGET, SENSORS, [np.array([0.3, 0.2])], [np.ones((4, 2))], ("a", "b")
    )
    rings = [line.get_xydata() for line in figure.axes[1].get_lines() if len(line.get_xdata()) > 9]
    closest = [np.hypot(*(ring - TARGET).T).min() for ring in rings]
    assert closest == pytest.approx([0.3, 0.3, 0.2, 0.2], abs=0.01)


def test_the_last_positions_of_a_panel_are_the_estimate():
    figure = draw.plane(PLACES, [{"raw": PLACES + 1, "filtered": PLACES + 2}], SENSORS, UNIT)
    shown = lines(figure.axes[0])
    assert shown["raw"].get_marker() == "." and shown["filtered"].get_linestyle() == "-"
    np.testing.assert_array_equal(shown["filtered"].get_xydata(), PLACES + 2)


def test_positions_from_two_ranges_are_drawn():
    figure = draw.triangulated(TIME, PLACES, PLACES, PLACES, SENSORS, UNIT)
    drawn = [line.get_xydata() for ax in figure.axes for line in ax.lines]
    assert any(np.array_equal(one, PLACES) for one in drawn)
