"""The figures of the linear filter draw what they are given."""

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.figures import macaveiu_filter as draw
from dopplerlib.systems import macaveiu2013 as system

MADE_UP = {"nis_and_nees"}


TIME = np.arange(6.0)


@pytest.fixture
def runs():
    truth = np.tile([1.0, 10.0, 2.0, -5.0], (6, 1))
    path = system.VehiclePath(7, "straight", truth)
    return system.VehicleRuns(
        path, truth[None] + 1, np.stack([truth, truth + 2]), np.eye(4), np.ones((2, 6))
    )


def test_three_panels_are_in_kilometers_per_hour(runs):
    position, v_x, v_y = draw.three_panels(TIME, runs).axes
    assert position.lines[2].get_xydata()[0].tolist() == [1.0, 2.0]
    assert v_x.lines[2].get_ydata() == pytest.approx(np.full(6, 36.0))
    assert v_y.lines[0].get_ydata() == pytest.approx(np.full(6, -4 * 3.6))
    corners = v_x.collections[0].get_paths()[0].vertices[:, 1]
    assert corners.max() == pytest.approx(3.6 * (10 + 0.975 * 2))


def test_a_claim_map_tells_what_is_sure_and_what_is_not():
    share = np.array([[0.0, 0.5], [1.0, 0.9]])
    shares = np.stack([share, [[0.0, 0.4], [0.98, 0.85]], [[0.02, 0.6], [1.0, 0.94]]])
    rows, columns = ("sigma_x", (0.5, 1.0)), ("w", (0.01, 0.1))
    ours = system.automotive_settings().with_(sigma_x=0.5, w=0.1)
    figure = draw.claim_map(rows, columns, {str(i): shares for i in range(4)}, ours)
    ax = figure.axes[0]
    texts = [text.get_text() for text in ax.texts]
    assert texts == ["0", "50", "100", "90"]
    hatched, choice = ax.patches
    assert hatched.get_xy() == (0.5, 0.5) and hatched.get_hatch()
    assert choice.get_center().tolist() == pytest.approx([1.0, 0.0])
    rim, border = ax.collections
    ends = border.get_segments()  # four sides of the one place that is sure
    assert len(ends) == len(rim.get_segments()) == 4
    assert {tuple(end) for line in ends for end in line} == {
        (-0.5, 0.5), (0.5, 0.5), (-0.5, 1.5), (0.5, 1.5),
    }  # fmt: skip
    assert figure.axes[2].get_xlabel() == "velocity step $w$ of the filter (m/s)"
    assert ax.get_ylabel().endswith("(m)")


def test_lags_carry_their_intervals():
    w = np.array([0.01, 0.1])
    measured = {0.01: (ConfidenceInterval(0.5, 0.4, 0.6), ConfidenceInterval(0.2, 0.1, 0.3))}
    figure = draw.lags(w, np.ones((2, 2)), np.ones((2, 2)), measured)
    for ax, value in zip(figure.axes, (0.5, 0.2), strict=True):
        (points,) = ax.containers
        assert points.lines[0].get_ydata().tolist() == [value]
        assert ax.lines[2].get_ydata() == pytest.approx([2**0.5, 2**0.5])


def test_averages_of_nis_and_nees_stand_in_their_panels():
    pair = (TIME + 1, TIME + 2)
    nis, nees = draw.nis_and_nees(TIME, {"a": pair}, ((3, 5), (2, 6))).axes
    assert nis.lines[0].get_ydata()[0] == 1 and nees.lines[0].get_ydata()[0] == 2
