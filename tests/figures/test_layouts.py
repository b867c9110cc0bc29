"""The figures of the layouts show the numbers that they are given, with units on every axis."""

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.figures import layouts as draw
from dopplerlib.workspace.layout_results import LayoutErrors
from dopplerlib.workspace.layouts import named_layouts

ARRAYS = named_layouts()
PLACES = np.arange(1.0, 4), np.arange(2.0)
VALUES = {name: np.arange(6.0).reshape(2, 3) for name in ("one", "two")}

SHARES = ((0.2, 0.1, 0.3), (0.1, 0.05, 0.2), (0.05, 0.0, 0.1))
WRONG = {name: ConfidenceInterval(*one) for name, one in zip("abc", SHARES, strict=True)}


def errors(size):
    many = tuple(ConfidenceInterval(size * k, size * k / 2, size * k * 2) for k in (4, 3, 2, 1))
    part = tuple(ConfidenceInterval(each, 0.1, 0.9) for each in (0.4, 0.3, 0.2, 0.2))
    return LayoutErrors(many, many, (1.0,) * 4, many, part, part)


@pytest.fixture(scope="module")
def figures():
    found = {"one": errors(1.0), "two": errors(2.0)}
    return {
        "gallery": draw.gallery(ARRAYS, dict.fromkeys(ARRAYS, "20 mm")),
        "goals": draw.goals(dict(zip("abc", (15.0, 20.0, 30.0), strict=True)), WRONG),
        "errors": draw.errors(found, found),
        "losses": draw.losses(found, {"one": [errors(3.0)] * 2, "two": [errors(4.0)] * 3}),
        "maps": draw.maps(*PLACES, VALUES, VALUES),
    }


def test_every_sensor_is_drawn_where_it_stands_and_hollow_if_it_is_set_back(figures):
    for ax, array in zip(figures["gallery"].axes, ARRAYS.values(), strict=False):
        _, *dots = ax.lines
        drawn = np.array([dot.get_xydata()[0] for dot in dots])
        np.testing.assert_allclose(drawn, array.positions[:, 1:])
        hollow = [dot.get_markerfacecolor() == "white" for dot in dots]
        assert hollow == (array.positions[:, 0] < 0).tolist()


def test_goals_are_drawn_with_their_intervals(figures):
    ax = figures["goals"].axes[0]
    drawn = [container.lines[0].get_xydata()[0] for container in ax.containers]
    np.testing.assert_allclose(drawn, [[15, 20], [20, 10], [30, 5]])
    (low, high) = ax.containers[0].lines[1]
    assert (low.get_ydata()[0], high.get_ydata()[0]) == (10, 30)


def test_losses_are_drawn_beside_the_whole_at_a_fifth_of_a_second(figures):
    ax = figures["losses"].axes[0]
    np.testing.assert_allclose([line.get_xdata() for line in ax.lines[1::2]], [[2], [4]])
    np.testing.assert_allclose(ax.lines[2].get_xdata(), [8, 8, 8])
