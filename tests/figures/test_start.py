"""The figures of the start show the data that they are given, with units on every axis."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dopplerlib.figures import start as draw
from tests.drawn import check_figures

ACROSS, UP = np.linspace(-1, 1, 21), np.linspace(0, 1, 11)
COST = 7 + (10 * (ACROSS - 0.2)) ** 2 + (10 * (UP[:, None] - 0.5)) ** 2
ERRORS = np.random.default_rng(61).uniform(0.1, 1, (2, 300))
SAMPLES = [10, 20, 40]


@pytest.fixture(scope="module")
def figures():
    return {
        "reduced_cost": draw.reduced_cost(
            {"a": (ACROSS, UP, COST)}, [{"truth": (0.2, 0.5)}], [("y (m)", "x (m)")]
        ),
        "error_distributions": draw.error_distributions(
            {"ours": tuple(ERRORS)}, {"printed": (0.2, 0.3)}, (0.5, 0.6)
        ),
        "errors_by_samples": draw.errors_by_samples(
            SAMPLES, [ERRORS[0] / k for k in SAMPLES], np.divide(1, SAMPLES), (10, 0.02)
        ),
    }


NAMES = ["reduced_cost", "error_distributions", "errors_by_samples"]


def test_every_figure_of_the_module_is_here_fits_the_page_and_does_not_stay_with_pyplot(figures):
    check_figures(draw, figures)


@pytest.mark.parametrize("name", NAMES)
def test_every_axis_says_its_unit(figures, name):
    for ax in figures[name].axes:
        labels = [ax.get_xlabel(), ax.get_ylabel()]
        assert any(labels)
        assert all(label.endswith(")") and " (" in label for label in labels if label)


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
