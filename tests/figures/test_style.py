"""What figures share: a view of space, labels that do not touch, colors of sensors."""

import inspect
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

from dopplerlib.figures import style


def test_the_view_has_z_upwards_and_hides_the_direction_to_the_viewer():
    assert_allclose(style.project([0, 0, 1], 30, 0), [0, 1], atol=1e-15)
    assert_allclose(style.project([0, 1, 0], 0, 20), [1, 0], atol=1e-15)
    to_viewer = [np.cos(1.1) * np.cos(0.5), np.cos(1.1) * np.sin(0.5), np.sin(1.1)]
    assert_allclose(style.project(to_viewer, *np.rad2deg([0.5, 1.1])), [0, 0], atol=1e-15)


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=8), st.floats(0.01, 1))
def test_labels_are_spread_until_none_is_closer_than_the_gap(values, gap):
    moved = style.spread(values, gap)
    assert (np.diff(np.sort(moved)) >= gap * (1 - 1e-6)).all()
    assert (np.diff(moved[np.argsort(values, kind="stable")]) >= 0).all()
    assert_allclose(np.mean(moved), np.mean(values), atol=1e-9)


def test_labels_that_are_far_apart_stay():
    assert style.spread([3, 1, 2], 0.5).tolist() == [3, 1, 2]


@pytest.mark.parametrize("n", [1, 2, 5, 6])
def test_sensors_have_colors_of_their_own(n):
    assert len(set(style.sensor_colors(n))) == n


def test_a_drawing_gets_a_figure_and_returns_it():
    got = []

    @style.drawing(7.0, 2.0)
    def draw(figure: Figure, number: float, *, label: str = "") -> None:
        """Draw nothing."""
        got.append((figure, number, label))
        figure.text(0, 0, "-4 dB, x-1")

    figure = draw(1, label="one")
    assert got == [(figure, 1.0, "one")] and figure.get_size_inches().tolist() == [7.0, 2.0]
    assert list(inspect.signature(draw).parameters) == ["number", "label"]
    assert [text.get_text() for text in figure.texts] == ["\N{MINUS SIGN}4 dB, x-1"]
    with pytest.raises(ValueError, match=r"^number must be an array of real numbers, got 'x'"):
        draw("x")


def test_a_color_with_a_name_is_called_by_it():
    named = {c for c in vars(style).values() if isinstance(c, str) and c.startswith("#")}
    assert style.SKY in named
    modules = [path for path in Path(style.__file__).parent.glob("*.py") if path.stem != "style"]
    texts = {path.stem: path.read_text(encoding="utf8").upper() for path in modules}
    assert [
        name for name, text in texts.items() if any(f'"{c.upper()}"' in text for c in named)
    ] == []
