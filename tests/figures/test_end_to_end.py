"""Figures of the whole chain show what they are given."""

import numpy as np

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.figures import end_to_end as draw


def labels(ax):
    return {line.get_label(): line for line in ax.lines if not line.get_label().startswith("_")}


def marked(ax):
    """Return the heights of the markers that are drawn."""
    drawn = (line for line in ax.lines if line.get_marker() in "so" and len(line.get_xdata()))
    return [np.ravel(line.get_ydata())[0] for line in drawn]


def test_a_window_belongs_to_its_middle_less_the_delay():
    ax = draw.when(delay=0.005, window=0.03).axes[0]
    heard, seen = (patch.get_bbox() for patch in ax.patches[:2][::-1])
    np.testing.assert_allclose([heard.x0, heard.x1], [-30, 0])
    np.testing.assert_allclose([seen.x0, seen.x1], [-35, -5])
    np.testing.assert_allclose(ax.lines[0].get_xdata(), [-20, -20])


def test_the_budget_has_a_row_for_each_name_in_millimeters():
    rows = [
        ("first", [ConfidenceInterval(0.01, 0.008, 0.02)], [0.03]),
        ("", [], []),
        ("second", [ConfidenceInterval(0.1, 0.08, 0.2)], [0.3]),
    ]
    figure = draw.budget([(n, m * 2, w * 2) for n, m, w in rows], (0.5, 1.0))
    left = figure.axes[0]
    assert [label.get_text() for label in left.get_yticklabels()] == ["first", "second"]
    assert list(left.get_yticks()) == [0, 2]
    dots = [line for line in left.lines if line.get_marker() == "o"]
    np.testing.assert_allclose([dot.get_xdata()[0] for dot in dots], [10, 100])
    ticks = [line for line in left.lines if line.get_marker() == "|"]
    np.testing.assert_allclose([tick.get_xdata()[0] for tick in ticks], [30, 300])
    assert [ax.get_title("left") for ax in figure.axes] == ["at 0.5 s", "at 1 s"]


def test_wrong_times_are_drawn_in_both_panels_with_their_intervals():
    time, one, two = (
        np.arange(3.0),
        [ConfidenceInterval(1, 0.5, 2)] * 3,
        [ConfidenceInterval(3, 2, 5)] * 3,
    )
    left, right = draw.wrong_time(time, [one, one], [one, two], ["a", "b"]).axes
    np.testing.assert_array_equal(labels(left)["b"].get_ydata(), [1, 1, 1])
    np.testing.assert_array_equal(labels(right)["b"].get_ydata(), [3, 3, 3])
    assert len(left.collections) == 1 and len(right.collections) == 2
    heights = right.collections[1].get_paths()[0].vertices[:, 1]
    assert (heights.min(), heights.max()) == (2, 5)


def test_starts_show_the_middle_of_the_errors_and_the_shares():
    errors = {"one": [np.linspace(0.01, 0.03, 11)], "all": [np.linspace(0.001, 0.003, 11)]}
    shares = {
        "one": [ConfidenceInterval(0.5, 0.4, 0.6)],
        "all": [ConfidenceInterval(0.1, 0.0, 0.2)],
    }
    left, right = draw.starts([0.1], errors, shares, limit=0.05).axes
    np.testing.assert_allclose(marked(left), [20, 2])
    np.testing.assert_allclose(marked(right), [50, 10])


def test_medians_are_drawn_beside_the_bounds():
    bounds = {"windows": [0.015, 0.005], "samples": [0.002, 0.001]}
    ax = draw.achievable([40, 50], [ConfidenceInterval(0.02, 0.01, 0.03)] * 2, bounds).axes[0]
    np.testing.assert_allclose(labels(ax)["windows"].get_ydata(), [15, 5])
    np.testing.assert_allclose(labels(ax)["samples"].get_ydata(), [2, 1])
    np.testing.assert_allclose(labels(ax)["from IQ samples"].get_ydata(), [20, 20])
