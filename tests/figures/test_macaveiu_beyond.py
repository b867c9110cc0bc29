"""The figures of polar measurements, clutter, maneuvers and crossings draw what they are given."""

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.figures import macaveiu_beyond as draw

TIME = np.arange(6.0)
TURN = TIME > 3


def test_some_runs_of_each_filter_are_drawn_beside_the_truth():
    truth = np.ones((6, 4))
    left, right = draw.side_by_side(TIME, truth, {"a": np.ones((12, 6, 4))}, (0, 3)).axes
    assert len(left.lines) == 11 and left.get_ylim() == (0, 3)
    assert right.lines[0].get_ydata() == pytest.approx(np.full(6, 3.6))


def test_the_start_of_a_track_is_not_drawn_as_an_error():
    _, right = draw.hole(TIME, {"a": TIME}, 0.2, {"b": TIME + 1}).axes
    assert right.lines[0].get_xdata()[0] == 1


def test_the_probability_of_a_model_has_a_panel_of_its_own():
    assert len(draw.over_time(TIME, {"a": TIME + 1}, TURN, "error (m)").axes) == 1
    top, below = draw.over_time(TIME, {"a": TIME + 1}, TURN, "error (m)", TIME / 6).axes
    assert top.get_ylabel() == "error (m)" and below.get_ylim() == (0, 1)


def test_crossings_show_a_share_with_its_interval_at_every_angle():
    shares = {"a": [ConfidenceInterval(0.5, 0.4, 0.6), ConfidenceInterval(0.1, 0.0, 0.2)]}
    truth = np.zeros((2, 6, 4))
    left, right = draw.crossings(truth, truth + 1, shares, (10, 20)).axes
    assert len(left.lines) == 4
    assert right.containers[0].lines[0].get_xydata().tolist() == [[10, 0.5], [20, 0.1]]
