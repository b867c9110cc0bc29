"""The figures of the chapter on real shifts show the numbers that they are given."""

import numpy as np
import pytest

from dopplerlib.figures import real_shifts as draw
from tests.drawn import check_legends, lines

MADE_UP = {"filtered"}

NAMES = ("u-blox", "NovAtel", "Javad")
WAYS = {"all shifts": 4.0, "all counts": 1.0}


def each(value):
    return dict.fromkeys(NAMES, value)


@pytest.fixture(scope="module")
def figures():
    time = np.arange(20.0)
    cloud = np.arange(20.0).reshape(10, 2)
    places = {way: (np.ones(2), scale * np.eye(2)) for way, scale in WAYS.items()}
    return {
        "steps": draw.steps(each(np.outer([1e6, 1e7], 0.1 ** np.arange(7)))),
        "fixes": draw.fixes(each(cloud), each(np.diag([9.0, 1.0])), each(places)),
        "noise": draw.noise(each((np.array([40.0, 50.0]), np.array([0.1, 0.03]))), each(0.05)),
        "filtered": draw.filtered(each(time), each(time + 2), each(time + 1), each(3.0)),
    }


def test_every_start_has_a_line(figures):
    (ax,) = figures["steps"].axes
    values = [line.get_ydata() for line in ax.lines if len(line.get_ydata()) == 7]
    assert len(values) == 2 * len(NAMES)
    assert {value[0] for value in values} == {1e6, 1e7}
    assert set(lines(ax)) == {f"{name}, 2 starts" for name in NAMES}


def test_ellipses_hold_95_percent(figures):
    """Of two normal components: half axes of 2.448 standard deviations."""
    upper, lower = figures["fixes"].axes[0], figures["fixes"].axes[3]
    outline = lines(upper)["claimed, 95 %"].get_xydata()
    np.testing.assert_allclose(outline.max(axis=0), [3 * 2.448, 2.448], rtol=1e-3)
    assert len(lines(upper)["one epoch"].get_xdata()) == 10
    for way, scale in WAYS.items():
        width = np.ptp(lines(lower)[way].get_xdata())
        assert width == pytest.approx(2 * 2.448 * np.sqrt(scale), rel=1e-3)


def test_the_rule_falls_by_ten_for_20_decibels(figures):
    (ax,) = figures["noise"].axes
    rule = next(line for line in ax.lines if line.get_label().startswith("_"))
    x, y = rule.get_xydata().T
    assert np.log10(y[0] / y[1]) == pytest.approx((x[1] - x[0]) / 20)
    assert np.interp(45, x, np.log(y)) == pytest.approx(np.log(0.05))


def test_errors_and_claims_stand_over_time(figures):
    for ax in figures["filtered"].axes:
        drawn = lines(ax)
        assert drawn["error"].get_ydata()[5] == 7
        assert drawn["claimed"].get_ydata()[5] == 6
        assert drawn["all at once"].get_ydata()[0] == 3


@pytest.mark.parametrize("name", ["steps", "fixes", "noise", "filtered"])
def test_legends_name_what_is_drawn(figures, name):
    check_legends(figures[name])
