"""The figures of the chapter on benchmarks show the numbers that they are given."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dopplerlib.figures import benchmarks as draw
from tests.drawn import check_figures

TIMES = {
    "one run": {"dopplerlib": [0.4, 0.5, 0.9], "C": [0.3, 0.35, 0.3]},
    "many runs": {"C": [0.1, 0.12, 0.2], "JAX": [3.0, 2.0, 4.0]},
}


@pytest.fixture(scope="module")
def figures():
    times = {
        kind: {name: np.array(one) for name, one in rows.items()} for kind, rows in TIMES.items()
    }
    return {"step_times": draw.step_times(times, "µs a step")}


def test_every_figure_of_the_module_is_here_fits_the_page_and_does_not_stay_with_pyplot(figures):
    check_figures(draw, figures)


def test_markers_are_at_medians_lines_reach_least_and_most_and_a_name_has_one_row(figures):
    (ax,) = figures["step_times"].axes
    assert [label.get_text() for label in ax.get_yticklabels()] == ["dopplerlib", "C", "JAX"]
    one, many = ax.containers
    assert_allclose(one[0].get_xydata(), [[0.5, 0], [0.3, 1]])
    assert_allclose(many[0].get_xydata(), [[0.12, 1], [3.0, 2]])
    (line,) = many[2]
    assert_allclose([path[:, 0] for path in line.get_segments()], [[0.1, 0.2], [2.0, 4.0]])
