"""The figures of ring coordinates show the data that they are given, with units on every axis."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dopplerlib.figures import coordinates as draw
from tests.drawn import check_legends, lines

CLAIMS = {"one": np.geomspace(0.2, 0.02, 8), "two": np.full(8, 0.2)}
ERRORS = {"one": np.full(8, 0.3), "two": np.geomspace(0.2, 0.25, 8)}
Y, Z = np.linspace(-0.4, 0.4, 9), np.linspace(-0.5, 0.5, 11)
BOWL = 40 * (Y**2 + Z[:, None] ** 2)
STATES = {"a": np.array([[0.1, 0.2], [-0.1, -0.2]]), "b": np.array([[0.1, 0.2]])}
ACROSS, AHEAD = np.linspace(-1, 1, 21), np.linspace(0.2, 1.5, 31)
DENSITY = np.exp(-8 * ACROSS**2 - 30 * (AHEAD[:, None] - 0.8) ** 2)
DRAWS = {f"filter {n}": np.random.default_rng(n).normal(0.5, 0.1, (50, 2)) for n in range(6)}


@pytest.fixture(scope="module")
def figures():
    return {
        "knowledge": draw.knowledge(CLAIMS, ERRORS, 0.18),
        "valleys": draw.valleys(Y, Z, {"a": BOWL, "b": 2 * BOWL}, STATES),
        "three_steps": draw.three_steps(ACROSS, AHEAD, DENSITY, DRAWS, np.array([0.1, 0.8])),
    }


def test_claims_and_errors_have_a_panel_each(figures):
    for ax, values in zip(figures["knowledge"].axes, (CLAIMS, ERRORS), strict=True):
        drawn = lines(ax)
        assert drawn.keys() == values.keys()
        for label, value in values.items():
            assert_array_equal(drawn[label].get_xydata().T, [range(8), value])
        assert 0.18 in [line.get_ydata()[0] for line in ax.lines]
    check_legends(figures["knowledge"])


def test_the_contours_are_at_one_two_and_three_deviations(figures):
    for ax, scale in zip(figures["valleys"].axes, (1, 2), strict=True):
        (filled,) = ax.collections
        for level, path in zip((1, 2, 3), filled.get_paths(), strict=True):
            reached = np.sqrt(40 * scale * np.sum(path.vertices**2, axis=-1))
            # Straight lines between grid points cut a circle short by up to a tenth.
            assert reached.max() < level * 1.15


def test_target_and_twin_are_where_they_are(figures):
    for ax, places in zip(figures["valleys"].axes, STATES.values(), strict=True):
        assert_array_equal([line.get_xydata()[0] for line in ax.lines], places)
        assert [text.get_text() for text in ax.texts] == ["target", "twin"][: len(places)]


def test_the_shades_hold_a_half_nine_tenths_and_all_but_a_hundredth(figures):
    total = DENSITY.sum()
    for ax, (label, draws) in zip(figures["three_steps"].axes, DRAWS.items(), strict=True):
        (shades,) = ax.collections
        for level, share in zip(shades.levels, (0.99, 0.9, 0.5), strict=False):
            inside = DENSITY[DENSITY >= level].sum() / total
            assert share <= inside < share + 0.02  # one cell of the grid
        dots, truth = ax.lines
        assert ax.get_title("left") == label
        assert_array_equal(dots.get_xydata(), draws)
        assert_allclose(truth.get_xydata(), [[0.1, 0.8]])
