"""Figures of the comparison of trackers show what they are given."""

import numpy as np
import pytest
from scipy.stats import chi2

from dopplerlib.figures import consistent_tracker as draw
from dopplerlib.figures.style import SENSOR, looks
from dopplerlib.workspace.errors import ErrorSummary
from dopplerlib.workspace.stop_study import LABELS
from dopplerlib.workspace.trackers import TRACKERS


def summary(level, bound=0.01):
    n = np.full(3, 100.0)
    one = np.ones(3)
    return ErrorSummary(
        runs=n, nees=level * one, nees_error=0.1 * level * one, nees_median=one, inside=one,
        axes=np.ones((3, 6)), position=0.02 * one, velocity=one, position_error=one,
        velocity_error=one, position_bound=bound * one, velocity_bound=one, lost=0 * one,
        nees_worst=np.ones((3, 3)), position_worst=np.ones((3, 3)),
    )  # fmt: skip


def test_members_are_ellipses_as_dark_as_they_are_likely():
    weights = np.array([[0.8, 0.2, 0.0], [1.0, 0.0, 0.0]])
    means = np.array([[[0.1, 0.2], [-0.1, 0.3], [np.nan] * 2], [[0.1, 0.1]] + [[np.nan] * 2] * 2])
    P = np.broadcast_to(np.diag([0.01, 0.0025]), (2, 3, 2, 2))
    figure = draw.members(
        [0.1, 0.2], weights, means, P, np.zeros((2, 2)), np.ones((2, 2)) / 4, P[:, 0]
    )
    first, second = figure.axes
    *blue, other = first.patches
    assert [tuple(ellipse.center) for ellipse in blue] == [(0.1, 0.2), (-0.1, 0.3)]
    assert {(round(e.width, 9), round(e.height, 9)) for e in blue} == {(0.2, 0.4)}
    assert all(abs(e.angle) % 180 == 90 for e in blue)  # eigenvalues come from the smallest on
    assert blue[0].get_alpha() == 1 > blue[1].get_alpha() > 0
    assert tuple(other.center) == (0.25, 0.25)
    assert len(second.patches) == 2
    assert (first.get_title("left"), second.get_title("left")) == (
        "100 ms: 2 Gaussians", "200 ms: 1 Gaussian",
    )  # fmt: skip


def test_nees_and_errors_over_bounds_are_those_given():
    cases = {"A": {"sum": summary(6.0), "paper": summary(60.0)}, "B": {"sum": summary(7.0)}}
    left, right, median, _ = draw.nees(cases).axes
    one, two, _ = left.lines
    np.testing.assert_allclose(one.get_data(), [[0.02, 0.04, 0.06], [6, 6, 6]])
    np.testing.assert_allclose(two.get_ydata(), 60)
    assert left.get_yscale() == "log"
    (band, _) = left.collections
    assert band.get_datalim(left.transData).y0 == pytest.approx(6 - 1.2)
    assert (left.get_title("left"), right.get_title("left")) == ("A", "B")
    np.testing.assert_allclose(
        [line.get_ydata()[0] for line in median.lines], [1, 1, chi2.median(6)], 1e-3
    )
    panel, _ = draw.over_bound(cases).axes
    np.testing.assert_allclose(panel.lines[0].get_ydata(), 2)


def test_settings_are_drawn_side_by_side():
    left, right = draw.wrong_settings({"right": summary(6.0), "wrong": summary(30.0, 0.04)}).axes
    np.testing.assert_allclose(left.lines[1].get_ydata(), 30)
    np.testing.assert_allclose(right.lines[1].get_ydata(), 0.5)


def test_a_tracker_has_one_look_in_both_chapters():
    labels = {name: tracker.label for name, tracker in TRACKERS.items()}
    shared = "bank", "paper", "ekf_bayes", "ekf", "ukf", "ring_iekf"
    here = looks([labels[name] for name in shared], draw.TRACKERS)
    there = looks([LABELS[name] for name in shared], draw.TRACKERS)
    assert list(here.values()) == list(there.values())
    assert len(set(here.values())) == len(shared)
    assert SENSOR not in {color for color, *_ in draw.TRACKERS.values()}
