"""The figures of one radar show the data they are given."""

import numpy as np
import pytest
from matplotlib.patches import Ellipse, Rectangle

from dopplerlib.figures import asheim as draw
from tests.drawn import lines

MADE_UP = {"tracks"}

TIME = np.arange(50.0)
SENSORS = np.array([[-0.5, 0.0], [0.5, 0.0]])
PLACES = np.random.default_rng(1).normal(size=(9, 2))
TARGET = np.array([1.0, 2.0, 0.1, 0.1])
S, DETECTIONS = np.diag([0.04, 0.01]), np.array([[0.1, 0.0], [1.0, 0.9]])
MOMENTS = {"now": (S, DETECTIONS), "later": (S, DETECTIONS)}


def test_both_circles_pass_through_the_target():
    figure = draw.geometry(TARGET, SENSORS)
    circles = [
        line.get_xydata() for line in figure.axes[0].get_lines() if len(line.get_xdata()) == 200
    ]
    assert len(circles) == 2
    for circle in circles:
        assert np.hypot(*(circle - TARGET[:2]).T).min() < 0.05  # the step along the circle


def test_the_drawn_box_and_ellipse_have_the_size_of_the_gates():
    figure = draw.gates(MOMENTS, (0.9, 0.6), 9.0)
    box, ellipse = figure.axes[0].patches
    assert isinstance(box, Rectangle) and isinstance(ellipse, Ellipse)
    assert (box.get_width(), box.get_height()) == (1.8, 1.2)
    # Three deviations each, the longer axis along the range.
    np.testing.assert_allclose((ellipse.width, ellipse.height), (2 * 0.6, 2 * 0.3))
    assert ellipse.angle % 180 == pytest.approx(0)
    shown = lines(figure.axes[0])
    assert shown["inside the ellipse"].get_ydata().tolist() == [0.0]
    assert shown["outside"].get_ydata().tolist() == [0.9]


def test_a_record_is_shown_in_three_scales():
    truth, estimate = TIME / 10, TIME / 10 + 0.1
    figure = draw.radar_record(TIME, truth, truth, estimate, TIME < 40, [(10, 20), (12, 15)])
    shown = [lines(ax) for ax in figure.axes]
    assert [len(one["filtered"].get_ydata()) for one in shown] == [50, 11, 4]
    assert [len(one["outside the gate"].get_ydata()) for one in shown] == [10, 0, 0]


def test_the_error_is_the_root_mean_square_over_runs():
    error = np.array([3.0, 4.0])[:, None] * np.ones(50)
    (ax,) = draw.with_without(TIME, {"radar": {"range only": error}}).axes
    np.testing.assert_allclose(lines(ax)["range only, 2 runs"].get_ydata(), np.sqrt(12.5))


def test_departures_that_never_come_are_not_counted():
    times = np.array([[41.0, 50.0], [42.0, np.inf]])
    figure = draw.departures(times, (46.0, 49.0), ("1", "2"))
    assert [sum(p.get_height() for p in ax.patches) for ax in figure.axes] == [2, 1]


def test_noisy_positions_belong_to_their_tracks():
    noisy = [PLACES, PLACES + 1]
    figure = draw.tracks([PLACES] * 2, ("a", "b"), SENSORS, noisy)
    for ax, positions in zip(figure.axes, noisy, strict=True):
        np.testing.assert_array_equal(lines(ax)["with noise"].get_xydata(), positions)
    assert "with noise" not in lines(draw.tracks([PLACES], ("a",), SENSORS).axes[0])


def test_what_has_nothing_to_compare_is_drawn_as_well():
    law = {"a": TIME}
    draw.system_path()
    draw.noise_law(TIME + 1, law, {"a": TIME + 1}, {"a": TIME / 50})
    draw.one_range(TIME, TIME, TIME, law, (10, 20))
    draw.gate_on_off(TIME, *[np.ones((2, 50))] * 4, ("a", "b"))
