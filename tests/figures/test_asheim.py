"""The figures of one radar and of two show the data they are given, and simulated ones say so."""

import numpy as np
import pytest
from matplotlib.patches import Ellipse, Rectangle

from dopplerlib.evaluation.intervals import Estimate
from dopplerlib.figures import (
    asheim_beyond,
    asheim_gate,
    asheim_position,
    asheim_radar,
    asheim_scene,
    asheim_stand_in,
)

TIME = np.arange(50.0)
SENSORS = np.array([[-0.5, 0.0], [0.5, 0.0]])
RNG = np.random.default_rng(1)
PLACES, ONES = RNG.normal(size=(9, 2)), np.ones((9, 2))


def lines(ax):
    """Return {label: ydata} of the lines of an axes that have one."""
    return {
        line.get_label(): line.get_ydata()
        for line in ax.get_lines()
        if not line.get_label().startswith("_")
    }


def test_both_circles_pass_through_the_target():
    figure = asheim_scene.geometry(np.array([1.0, 2.0, 0.1, 0.1]), SENSORS)
    circles = [
        line.get_xydata() for line in figure.axes[0].get_lines() if len(line.get_xdata()) == 200
    ]
    assert len(circles) == 2
    for circle in circles:
        assert np.hypot(*(circle - [1.0, 2.0]).T).min() < 0.05  # the step along the circle


def test_the_drawn_box_and_ellipse_have_the_size_of_the_gates():
    S = np.diag([0.04, 0.01])
    moment = {"title": "now", "S": S, "detections": np.array([[0.1, 0.0], [1.0, 0.9]])}
    figure = asheim_gate.gates([moment, moment], (0.9, 0.6), 9.0)
    box, ellipse = figure.axes[0].patches
    assert isinstance(box, Rectangle) and isinstance(ellipse, Ellipse)
    assert (box.get_width(), box.get_height()) == (1.8, 1.2)
    # Three deviations each, the longer axis along the range.
    np.testing.assert_allclose((ellipse.width, ellipse.height), (2 * 0.6, 2 * 0.3))
    assert ellipse.angle % 180 == pytest.approx(0)
    shown = lines(figure.axes[0])
    assert shown["inside the ellipse"].tolist() == [0.0]
    assert shown["outside"].tolist() == [0.9]


def test_a_record_is_shown_in_three_scales():
    truth, estimate = TIME / 10, TIME / 10 + 0.1
    used = TIME < 40
    figure = asheim_radar.radar_record(TIME, truth, truth, estimate, used, [(10, 20), (12, 15)])
    shown = [lines(ax) for ax in figure.axes]
    assert [len(one["filtered"]) for one in shown] == [50, 11, 4]
    assert len(shown[0]["outside the gate"]) == 10 and len(shown[1]["outside the gate"]) == 0


def test_the_error_is_the_root_mean_square_over_runs():
    error = np.array([3.0, 4.0])[:, None] * np.ones(50)
    figure = asheim_position.error_over_distance(TIME, {"ours": error}, published=5.66)
    np.testing.assert_allclose(lines(figure.axes[0])["ours"], np.sqrt(12.5))
    figure = asheim_radar.with_without(TIME, {"radar": {"ours": error}})
    np.testing.assert_allclose(lines(figure.axes[0])["ours, 2 runs"], np.sqrt(12.5))


def test_departures_that_never_come_are_not_counted():
    times = np.array([[41.0, 50.0], [42.0, np.inf]])
    figure = asheim_radar.departures(times, (46.0, 49.0), ("1", "2"))
    assert [sum(p.get_height() for p in ax.patches) for ax in figure.axes] == [2, 1]


@pytest.mark.parametrize(
    "figure",
    [
        asheim_scene.system_path(),
        asheim_scene.tracks([PLACES] * 2, "ab", SENSORS, [PLACES] * 2),
        asheim_scene.noise_law(TIME + 1, {"a": TIME}, {"a": TIME + 1}, {"a": TIME / 50}),
        asheim_radar.one_range(TIME, TIME, TIME, {"a": TIME, "b": TIME}, (10, 20)),
        asheim_position.plane(PLACES, [{"a": ONES, "b": ONES}], SENSORS, ((0, 1), (0, 1)), ["t"]),
        asheim_position.error_areas(np.array([0.0, 4.0]), SENSORS, [np.ones(2)], [ONES], "ab"),
        asheim_radar.gate_on_off(TIME, *[np.ones((2, 50))] * 4, "ab"),
        asheim_position.triangulated(TIME, *[np.ones((50, 2))] * 3, SENSORS, ((0, 1), (0, 1))),
        asheim_beyond.consistency(TIME, {"a": {"b": TIME + 1}}, [(0.9, 1.1)]),
        asheim_beyond.reach({"a": dict.fromkeys("xyz", Estimate(5.0, 4.9, np.inf))}),
        asheim_beyond.sweep(TIME[:2], {"a": [Estimate(1.0, 0.9, 1.1)] * 2}, "delay in s"),
    ],
)  # fmt: skip
def test_every_panel_has_units_or_is_a_diagram(figure):
    for ax in figure.axes:
        if ax.axison:
            assert ax.get_xlabel()
    figure.canvas.draw()


def test_an_ellipse_of_the_bound_has_the_axes_of_its_covariance():
    x, y = np.linspace(-1, 1, 5), np.linspace(1, 2, 4)
    figure = asheim_beyond.bound_map(
        x, y, np.linspace(0.02, 2, 20).reshape(4, 5), SENSORS, np.array([[0.0, 1.0]]),
        np.diag([0.04, 0.01])[None], 2, TIME[1:], {"x": TIME[1:]},
    )  # fmt: skip
    (ellipse,) = figure.axes[0].patches
    np.testing.assert_allclose((ellipse.width, ellipse.height), (0.8, 0.4))


def test_every_panel_of_the_stand_in_says_that_it_is_simulated():
    d, p = np.ones((50, 3)), np.ones((50, 2))
    track = {"scan": np.arange(3), "x": np.ones((3, 2))}
    one = {"detections": d, "chosen": TIME, "filtered": TIME, "truth": TIME}
    for figure in (
        asheim_stand_in.records(TIME, {"a": one, "b": {"detections": d}}, (1.5, 4.5), (25, 42)),
        asheim_stand_in.positions(p, p, p, SENSORS),
        asheim_stand_in.coasting(TIME, [TIME] * 2, [np.ones((4, 50))] * 2, (25, 42), "ab"),
        asheim_stand_in.managed(TIME, d, [track], TIME, (25, 42), TIME),
    ):
        assert all(ax.get_title(loc="left").startswith("SIMULATED") for ax in figure.axes)


def test_the_contours_of_the_bound_are_labeled_large_enough_to_read():
    """At 7 inches on a page of about 6, a label of 11 points is one of 9."""
    x, y = np.linspace(-5, 5, 41), np.linspace(0.25, 5, 31)
    X, Y = np.meshgrid(x, y)
    figure = asheim_beyond.bound_map(
        x, y, 0.005 * (X**2 + Y**2), SENSORS, np.array([[0.0, 1.0]]),
        np.diag([0.04, 0.01])[None], 2, TIME[1:], {"x": TIME[1:]},
    )  # fmt: skip
    labels = [text for text in figure.axes[0].texts if text.get_text().endswith(" m")]
    assert {text.get_text() for text in labels} >= {"0.01 m", "0.03 m", "0.1 m"}
    assert all(text.get_fontsize() >= 11 for text in labels)
