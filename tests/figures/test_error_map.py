"""The figures of the error maps show the data that they are given, with units on every axis."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dopplerlib import RadarArray
from dopplerlib.figures import error_map as draw
from tests.drawn import check_figures

AXIS = np.linspace(-0.9, 0.9, 7)
MAP = np.abs(AXIS)[:, None] + 0.01 * (AXIS + 1)
LINE = RadarArray.linear(5, 0.4)
LIMITS = np.array([0.05, 0.1, 0.2])
DRAWS = np.random.default_rng(60).uniform(0.1, 0.4, (3, 20)) / [[1], [2], [4]]


@pytest.fixture(scope="module")
def figures():
    return {
        "error_maps": draw.error_maps(
            AXIS, AXIS, {"a": MAP, "b": 2 * MAP, "c": MAP.T, "d": MAP}, [LINE] * 4, [[1, 2, 0]] * 4
        ),
        "shares": draw.shares(LIMITS, {"left": {"ours": DRAWS, "published": LIMITS}}),
        "line_profiles": draw.line_profiles(AXIS, {"on": AXIS**2, "off": 9 * AXIS**2}, MAP[0], 0.1),
    }


NAMES = ["error_maps", "shares", "line_profiles"]


def test_every_figure_of_the_module_is_here_fits_the_page_and_does_not_stay_with_pyplot(figures):
    check_figures(draw, figures)


@pytest.mark.parametrize("name", NAMES)
def test_every_axis_says_its_unit(figures, name):
    for ax in figures[name].axes:
        labels = [ax.get_xlabel(), ax.get_ylabel()]
        assert all(label.endswith(")") and " (" in label for label in labels if label)


def test_a_map_has_x_upwards_and_values_within_the_scale(figures):
    first, second, third, _, *_, key = figures["error_maps"].axes
    for ax, expected in (first, MAP), (second, 2 * MAP), (third, MAP.T):
        (mesh,) = ax.collections
        # pcolormesh takes (vertical, horizontal), and x is vertical.
        assert_allclose(mesh.get_array().reshape(7, 7), np.clip(expected, 0.025, 1))
        assert ax.get_xlabel() in ("y (m)", "")
    assert first.get_ylabel() == "x (m)"
    assert key.get_xlabel() == "error (m)"


def test_sensors_and_velocity_are_drawn_in_the_same_axes(figures):
    ax = figures["error_maps"].axes[0]
    assert_allclose(ax.lines[0].get_xydata(), LINE.positions[:, [1, 0]])
    (arrow,) = [text for text in ax.texts if text.arrowprops]
    step = np.subtract(arrow.xy, arrow.xyann)
    assert_allclose(step / np.linalg.norm(step), np.array([2, 1]) / np.sqrt(5))  # (y, x)


def test_a_panel_too_many_is_not_shown(figures):
    shown = [ax.get_visible() for ax in figures["error_maps"].axes[:6]]
    assert shown == [True] * 4 + [False] * 2


def test_draws_become_a_band_and_a_median_and_what_is_published_points(figures):
    (ax,) = figures["shares"].axes
    ours, published = ax.lines
    assert_allclose(ours.get_ydata(), np.median(DRAWS, axis=1))
    assert_allclose(published.get_xydata(), np.transpose([LIMITS, LIMITS]))
    (band,) = ax.collections
    heights = band.get_paths()[0].vertices[:, 1]
    assert_allclose([heights.min(), heights.max()], [np.percentile(DRAWS[2], 2.5),
                                                     np.percentile(DRAWS[0], 97.5)])  # fmt: skip


def test_both_lines_through_the_map_and_the_bound_are_shown(figures):
    (ax,) = figures["line_profiles"].axes
    on, off, bound, *_ = ax.lines
    assert_allclose(on.get_ydata(), AXIS**2)
    assert_allclose(off.get_ydata(), 9 * AXIS**2)
    assert_allclose(bound.get_ydata(), MAP[0])
