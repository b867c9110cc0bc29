"""The figures of observability show the data that they are given, with units on every axis."""

import numpy as np
import pytest
from matplotlib.patches import Ellipse
from numpy.testing import assert_allclose

from dopplerlib import RadarArray, ring_family
from dopplerlib.figures import observability as draw
from dopplerlib.figures.style import project
from tests.drawn import lines

RING, LINE = RadarArray.ring(6, 0.2), RadarArray.linear(5, 0.4)
STATE = np.array([0.833, 0.111, 0.092, -0.75, -0.125, -0.018])
FAMILY = ring_family(STATE, 0.2, np.linspace(0.6, 1.4, 30))
DISTANCE, SPEED = np.linspace(0.5, 1, 21), np.linspace(0.7, 0.8, 11)
MISFIT = ((DISTANCE - 0.8) / 0.05) ** 2 + ((SPEED[:, None] - 0.75) / 0.01) ** 2
COVARIANCE = np.array([[0.04, 0.01], [0.01, 0.09]])
SIZE = np.geomspace(0.001, 0.1, 8)
DOTS = np.random.default_rng(70).normal(STATE, 0.1, (50, 6))
P = np.diag([0.01, 0.04, 0.01, 1, 1, 1.0])
AWAY, ASIDE = np.linspace(0.1, 1, 9), np.linspace(-0.5, 0.5, 11)
MAP = AWAY[:, None] ** 2 + 0 * ASIDE
TIME = np.geomspace(1e-3, 1, 6)


@pytest.fixture(scope="module")
def figures():
    return {
        "likelihood_ridges": draw.likelihood_ridges(
            DISTANCE, SPEED, {"a": MISFIT, "b": 4 * MISFIT}, (0.8, 0.75), {"b": COVARIANCE}
        ),
        "blind_family": draw.blind_family(RING, STATE, FAMILY),
        "bounds_by_change": draw.bounds_by_change(
            SIZE, {"lifted": 1 / SIZE, "moved": 2 / SIZE}, {"plain": 50.0}
        ),
        "bounds_by_motion": draw.bounds_by_motion(
            SIZE, {"about": SIZE, "across": 2 * SIZE}, {"ahead": 3 * SIZE}
        ),
        "estimates": draw.estimates(
            {"few": DOTS, "many": STATE + 0.1 * (DOTS - STATE)},
            STATE,
            {"family": FAMILY, "second": FAMILY[:1]},
            {"few": P, "many": P / 100},
            [(0, 1), (1, 2)],
        ),
        "bound_maps": draw.bound_maps(AWAY, ASIDE, {"m": MAP, "n": 2 * MAP}, [RING, LINE]),
        "bounds_over_time": draw.bounds_over_time(
            TIME, {"ring": TIME**-1.5, "more": TIME**-0.5}, 2 * TIME**-1.5, {"Table 2": (0.01, 0.1)}
        ),
    }


def test_the_contours_are_at_one_two_and_three_deviations(figures):
    for ax, scale in zip(figures["likelihood_ridges"].axes, (1, 2), strict=True):
        (filled,) = ax.collections
        assert filled.levels.tolist() == [0, 1, 2, 3]
        edge = np.vstack([path.vertices for path in filled.get_paths()[:1]])
        off = scale * np.hypot((edge[:, 0] - 0.8) / 0.05, (edge[:, 1] - 0.75) / 0.01)
        # Between grid points half a deviation apart the contour is a chord.
        assert off.max() == pytest.approx(1, abs=0.15)


@pytest.mark.parametrize(
    ("name", "panel", "pair", "P"),
    [
        ("likelihood_ridges", 1, None, COVARIANCE),
        ("estimates", 0, (0, 1), P[:2, :2]),
        ("estimates", 1, (1, 2), P[1:3, 1:3] / 100),
    ],
)
def test_the_ellipses_are_two_deviations_of_the_covariance(figures, name, panel, pair, P):
    center = (0.8, 0.75) if pair is None else STATE[list(pair)]
    (ellipse,) = [p for p in figures[name].axes[panel].patches if isinstance(p, Ellipse)]
    unit = ellipse.get_path().vertices
    rim = ellipse.get_patch_transform().transform(unit) - np.asarray(center)
    rim = rim[np.linalg.norm(unit, axis=1) < 1.0001]
    # A point of the rim is two deviations away; Bézier curves miss a circle by 3e-4.
    assert_allclose(np.einsum("ni,ij,nj->n", rim, np.linalg.inv(P), rim), 4, rtol=2e-3)


def test_the_family_is_drawn_in_space_and_by_its_speeds(figures):
    space, speeds = figures["blind_family"].axes
    view = project(FAMILY[:, :3], -68.0, 22.0)
    assert any(np.array_equal(line.get_xydata(), view) for line in space.lines)
    shown = lines(speeds)
    assert list(shown) == ["$v_x$", "$v_y$", "$v_z$"]
    for i, line in enumerate(shown.values()):
        assert_allclose(line.get_xydata(), FAMILY[:, [0, 3 + i]])


def test_arrows_point_along_the_velocities(figures):
    space = figures["blind_family"].axes[0]
    arrows = [text for text in space.texts if not text.get_text() and text.arrowprops]
    steps = [np.subtract(text.xy, text.xyann) for text in arrows]
    states = [*FAMILY[::4], STATE]
    assert len(steps) == len(states)
    assert_allclose(steps, 0.1 * project([state[3:] for state in states], -68.0, 22.0))


def test_bounds_are_over_centimeters_of_change(figures):
    (ax,) = figures["bounds_by_change"].axes
    shown = lines(ax)
    assert_allclose(shown["lifted"].get_xdata(), 100 * SIZE)
    assert_allclose(shown["moved"].get_ydata(), 2 / SIZE)
    assert [text.get_text() for text in ax.texts] == ["plain"]


def test_bounds_by_motion_have_a_panel_for_turns_and_one_for_accelerations(figures):
    turning, accelerating = map(lines, figures["bounds_by_motion"].axes)
    assert_allclose(turning["across"].get_xydata(), np.transpose([SIZE, 2 * SIZE]))
    assert_allclose(accelerating["ahead"].get_xydata(), np.transpose([SIZE, 3 * SIZE]))


def test_estimates_are_dots_families_are_curves_and_the_truth_a_square(figures):
    for ax, pair, scale in zip(figures["estimates"].axes, ([0, 1], [1, 2]), (1, 0.1), strict=True):
        assert_allclose(ax.lines[0].get_xydata(), (STATE + scale * (DOTS - STATE))[:, pair])
        shown = lines(ax)
        assert_allclose(shown["family"].get_xydata(), FAMILY[:, pair])
        assert shown["second"].get_marker() == "X"
        assert_allclose(shown["truth"].get_xydata(), STATE[None, pair])


def test_maps_have_distance_upwards_and_lines_at_a_centimeter_a_decimeter_a_meter(figures):
    first, second, key = figures["bound_maps"].axes
    assert [ax.get_title(loc="left") for ax in (first, second)] == ["m", "n"]
    line = first.collections[1]
    assert line.levels.tolist() == [0.01, 0.1, 1]
    (path,) = [p for p in line.get_paths()[1:2]]
    # Where the distance squared is 0.1; the grid is linear between its points.
    assert_allclose(path.vertices[:, 1], np.sqrt(0.1), atol=0.01)
    assert first.get_xlabel() == "y (m)" and first.get_ylabel() == "x (m)"
    assert key.get_xlabel() == "bound on position error (m)"


def test_bounds_over_time_have_the_law_and_the_marks(figures):
    (ax,) = figures["bounds_over_time"].axes
    shown = lines(ax)
    assert_allclose(shown["ring"].get_xydata(), np.transpose([TIME, TIME**-1.5]))
    assert_allclose(shown["law of short records, ring"].get_ydata(), 2 * TIME**-1.5)
    assert_allclose(shown["Table 2"].get_xydata(), [[0.01, 0.1]])
