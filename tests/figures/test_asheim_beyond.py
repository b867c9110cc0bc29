"""The figures of better trackers show the data they are given."""

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.figures import asheim_beyond as draw
from tests.drawn import lines

MADE_UP = {"bound_map"}

TIME = np.arange(1.0, 50.0)
NAMES = "thesis, its code", "modern, apart", "modern, one filter"
SENSORS = np.array([[-0.5, 0.0], [0.5, 0.0]])


@pytest.fixture(scope="module")
def bound():
    x, y = np.linspace(-5, 5, 41), np.linspace(0.25, 5, 31)
    X, Y = np.meshgrid(x, y)
    return draw.bound_map(
        x, y, 0.005 * (X**2 + Y**2), SENSORS, np.array([[0.0, 1.0]]),
        np.diag([0.04, 0.01])[None], 2, TIME, {"x": TIME},
    )  # fmt: skip


def test_an_ellipse_of_the_bound_has_the_axes_of_its_covariance(bound):
    (ellipse,) = bound.axes[0].patches
    np.testing.assert_allclose((ellipse.width, ellipse.height), (0.8, 0.4))


def test_the_contours_of_the_bound_are_labeled_large_enough_to_read(bound):
    """At 7 inches on a page of about 6, a label of 11 points is one of 9."""
    labels = [text for text in bound.axes[0].texts if text.get_text().endswith(" m")]
    assert {text.get_text() for text in labels} >= {"0.01 m", "0.03 m", "0.1 m"}
    assert all(text.get_fontsize() >= 11 for text in labels)


def test_a_range_beyond_the_record_is_drawn_as_an_arrow_at_the_edge():
    found = dict.fromkeys(NAMES, ConfidenceInterval(5.0, 4.9, 5.2)) | {
        NAMES[-1]: ConfidenceInterval(np.inf, 6, np.inf)
    }
    (ax,) = draw.reach({"a": found}).axes
    points = [line for line in ax.lines if len(line.get_xdata()) == 1]
    assert [(one.get_xdata()[0], one.get_marker()) for one in points] == [
        (5.0, "s"), (5.0, "^"), (7.2, ">"),
    ]  # fmt: skip


def test_a_sweep_shows_every_value_with_its_interval():
    (ax,) = draw.sweep(
        [0.0, 1.0], {"one filter": [ConfidenceInterval(1.0, 0.9, 1.1)] * 2}, "delay (s)"
    ).axes
    assert lines(ax)["one filter"].get_xydata().tolist() == [[0.0, 1.0], [1.0, 1.0]]
    ends = ax.collections[0].get_paths()[0].vertices[:, 1]
    assert (ends.min(), ends.max()) == (0.9, 1.1)


def test_averages_are_those_given():
    (ax,) = draw.consistency(TIME, {"a": {"one filter": TIME}}, [(0.9, 1.1)]).axes
    np.testing.assert_array_equal(lines(ax)["one filter"].get_xydata().T, [TIME, TIME])
