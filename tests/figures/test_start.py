"""The figures of the start show the data that they are given, with units on every axis."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dopplerlib import RadarArray
from dopplerlib.figures import start as draw

ACROSS, UP = np.linspace(-1, 1, 21), np.linspace(0, 1, 11)
COST = 7 + (10 * (ACROSS - 0.2)) ** 2 + (10 * (UP[:, None] - 0.5)) ** 2
ERRORS = np.random.default_rng(61).uniform(0.1, 1, (2, 300))
SAMPLES = [10, 20, 40]
AXIS = np.linspace(-0.9, 0.9, 7)
MAP = np.abs(AXIS)[:, None] + 0.01 * (AXIS + 1)
LINE = RadarArray.linear(5, 0.4)
LIMITS = np.array([0.05, 0.1, 0.2])
# Fraction, ratio, ends of the interval; for a robust start and a plain one.
WRONG = np.array([[[0, 1, 0.9, 1.2], [0.1, 1.1, 1, 1.3]], [[0, 1, 0.9, 1.2], [0.1, 50, 40, 70]]])
DRAWS = np.random.default_rng(60).uniform(0.1, 0.4, (3, 20)) / [[1], [2], [4]]


@pytest.fixture(scope="module")
def figures():
    return {
        "reduced_cost": draw.reduced_cost(
            {"a": (ACROSS, UP, COST)}, [{"truth": (0.2, 0.5)}], [("y (m)", "x (m)")]
        ),
        "error_distributions": draw.error_distributions(
            {"ours": tuple(ERRORS)}, {"Table 2": (0.2, 0.3)}, (0.5, 0.6)
        ),
        "errors_by_samples": draw.errors_by_samples(
            SAMPLES, [ERRORS[0] / k for k in SAMPLES], np.divide(1, SAMPLES), (10, 0.02)
        ),
        "error_maps": draw.error_maps(
            AXIS, AXIS, {"a": MAP, "b": 2 * MAP, "c": MAP.T, "d": MAP}, [LINE] * 4, [[1, 2, 0]] * 4
        ),
        "area_fractions": draw.area_fractions(
            LIMITS, {"left": {"ours": DRAWS, "published": LIMITS}}
        ),
        "line_profiles": draw.line_profiles(
            AXIS, {"published": AXIS**2, "off": 9 * AXIS**2}, MAP[0], 0.1
        ),
        "wrong_windows": draw.wrong_windows({"road": {"line": WRONG}, "ring": {"line": 2 * WRONG}}),
    }


def test_the_white_line_is_three_deviations_from_the_best(figures):
    ax, _ = figures["reduced_cost"].axes
    filled, line = ax.collections
    assert filled.levels.tolist()[:4] == [0, 1, 2, 3]
    assert line.levels.tolist() == [3]
    rim = np.vstack([path.vertices for path in line.get_paths()])
    off = np.hypot(10 * (rim[:, 0] - 0.2), 10 * (rim[:, 1] - 0.5))
    # Between grid points a deviation apart the contour is a chord.
    assert_allclose(off, 3, atol=0.15)
    assert_allclose(ax.lines[0].get_xydata(), [[0.2, 0.5]])


def test_a_distribution_rises_to_one_at_the_largest_error(figures):
    for ax, errors, mark, bound in zip(
        figures["error_distributions"].axes, ERRORS, (0.2, 0.3), (0.5, 0.6), strict=True
    ):
        ours, printed, limit = ax.lines
        x, share = ours.get_xydata().T
        assert_allclose(share, [(errors <= value).mean() for value in x])
        assert set(printed.get_xdata()) == {mark}
        assert set(limit.get_xdata()) == {bound}


def test_bands_hold_the_central_shares(figures):
    (ax,) = figures["errors_by_samples"].axes
    median, bound, printed = ax.lines
    assert_allclose(median.get_ydata(), np.median(ERRORS[0]) / SAMPLES)
    assert_allclose(bound.get_ydata(), np.divide(1, SAMPLES))
    assert_allclose(printed.get_xydata(), [[10, 0.02]])
    for band, (low, high) in zip(ax.collections, ((5, 95), (25, 75)), strict=True):
        heights = band.get_paths()[0].vertices[:, 1]
        ends = np.percentile(ERRORS[0], low) / 40, np.percentile(ERRORS[0], high) / 10
        assert_allclose([heights.min(), heights.max()], ends)


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
    (ax,) = figures["area_fractions"].axes
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


def test_errors_are_drawn_against_percent_with_their_intervals(figures):
    for ax, factor in zip(figures["wrong_windows"].axes, (1, 2), strict=True):
        for bars, found in zip(ax.containers, factor * WRONG, strict=True):
            line, _, (segments,) = bars.lines
            assert_allclose(line.get_ydata(), found[:, 1])
            assert_allclose(line.get_xdata() - line.get_xdata()[0], 100 * found[:, 0])
            ends = [segment[:, 1] for segment in segments.get_segments()]
            assert_allclose(ends, found[:, 2:])
