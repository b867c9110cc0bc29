"""The figures of decisions show the numbers that they are given, with units on every axis."""

import numpy as np
import pytest

from dopplerlib.figures import stopping as draw

TIME = np.array([0.005, 0.01, 0.015])
CURVE = np.array([[0.2, 0.3], [0.1, 0.2], [0.0, -np.inf]])
ALARMS = np.array([0.02, np.inf, 0.1, 0.04])
STOPPED = np.array([[1.0, 0.9, 1.0], [np.nan] * 3, [0.5, 0.4, 0.6]])


@pytest.fixture(scope="module")
def figures():
    panels = {
        "collision": {"sum": TIME, "EKF (paper)": 2 * TIME},
        "passing": {"sum": TIME, "EKF (paper)": TIME},
    }
    marks = {"collision": {"in the ball": 0.012}, "passing": {}}
    return {
        "one_approach": draw.one_approach(TIME, panels, marks, 0.5),
        "lead_by_false_alarms": draw.lead_by_false_alarms(
            {"ever": {"truth": CURVE, "sum": CURVE}}, 1, {"ever": "at any time"}
        ),
        "warned_by_time": draw.warned_by_time({"truth": ALARMS}, (0.04, 0.08)),
        "stopped_by_miss": draw.stopped_by_miss([0.0, 0.05, 0.1, 0.3], {"sum": STOPPED}),
    }


def test_probabilities_and_times_that_are_named_are_drawn(figures):
    first, second = figures["one_approach"].axes
    np.testing.assert_array_equal(first.lines[1].get_ydata(), 2 * TIME)
    assert [text.get_text() for text in first.texts] == ["in the ball"]
    assert not second.texts and second.get_title(loc="left") == "passing"


def test_no_lead_is_drawn_as_none_and_one_threshold_is_filled(figures):
    curve, filled = figures["lead_by_false_alarms"].axes[0].lines[:2]
    np.testing.assert_allclose(curve.get_xdata(), [20, 10, 0])
    np.testing.assert_allclose(curve.get_ydata(), [0.3, 0.2, 0])
    np.testing.assert_allclose(filled.get_xydata(), [[10, 0.2]])


def test_what_is_never_foreseen_is_missing_from_the_share(figures):
    line = figures["warned_by_time"].axes[0].lines[0]
    np.testing.assert_allclose(line.get_xdata()[:3], [0.02, 0.04, 0.1])
    np.testing.assert_allclose(line.get_ydata()[:3], [25, 50, 75])


def test_shares_stand_in_the_middle_of_their_class_in_centimeters(figures):
    line = next(
        one for one in figures["stopped_by_miss"].axes[0].lines if len(one.get_xdata()) == 3
    )
    np.testing.assert_allclose(line.get_xdata(), [2.5, 7.5, 20])
    np.testing.assert_allclose(line.get_ydata(), [100, np.nan, 50])
