"""The figures of the chapter on benchmarks show the numbers that they are given."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.figures import benchmarks as draw

TIMES = {
    "one run": {"dopplerlib": [0.4, 0.5, 0.9], "C": [0.3, 0.35, 0.3]},
    "many runs": {"C": [0.1, 0.12, 0.2], "JAX": [3.0, 2.0, 4.0]},
}


ROUNDS = np.array([1.0, 2.0, 4.0])
SIZES = np.array([1, 10, 100])
INTERVAL = ConfidenceInterval(0.9, 0.7, 1.0)


@pytest.fixture(scope="module")
def figures():
    times = {
        kind: {name: np.array(one) for name, one in rows.items()} for kind, rows in TIMES.items()
    }
    methods = ("ml_initialize, all at once", "ml_initialize, one alone", "basinhopping", "DE")
    points = {
        f"case {i}": {name: (10.0**k, INTERVAL) for k, name in enumerate(methods)} for i in range(4)
    }
    curves = {case: (20.0 * SIZES, np.array([0.2, 0.5, 0.8])) for case in points}
    line = SIZES, 1e-3 * SIZES[:, None] ** 0.5 * ROUNDS
    fits = {f"things {i}": (2e-3, ConfidenceInterval(0.5, 0.4, 0.6), SIZES > 1) for i in range(4)}
    return {
        "step_times": draw.step_times(times, "µs a step"),
        "start_success": draw.start_success(points, curves),
        "frequency_error": draw.frequency_error(
            {"FFT": (SIZES, 1 + 1 / SIZES, 0.1 / SIZES)}, allowed=1.01
        ),
        "scan_times": draw.scan_times({"one": line, "other": (SIZES[:2], 9 * line[1][:2])}),
        "memory": draw.memory({"one": 57.0, "other": 680.0}, {"one": 60.0, "other": 700.0}),
        "growth": draw.growth(dict.fromkeys(fits, line), fits),
    }


def test_markers_are_at_medians_lines_reach_least_and_most_and_a_name_has_one_row(figures):
    (ax,) = figures["step_times"].axes
    assert [label.get_text() for label in ax.get_yticklabels()] == ["dopplerlib", "C", "JAX"]
    one, many = ax.containers
    assert_allclose(one[0].get_xydata(), [[0.5, 0], [0.3, 1]])
    assert_allclose(many[0].get_xydata(), [[0.12, 1], [3.0, 2]])
    (line,) = many[2]
    assert_allclose([path[:, 0] for path in line.get_segments()], [[0.1, 0.2], [2.0, 4.0]])


def test_points_have_their_intervals_and_random_starts_a_curve_in_each_panel(figures):
    panels = figures["start_success"].axes
    assert [ax.get_title(loc="left") for ax in panels] == [f"case {i}" for i in range(4)]
    for ax in panels:
        curve = next(line for line in ax.lines if len(line.get_xdata()) == 3)
        assert_allclose(curve.get_xydata(), np.transpose([20.0 * SIZES, [0.2, 0.5, 0.8]]))
        for k, one in enumerate(ax.containers):
            assert_allclose(one[0].get_xydata(), [[10.0**k, 0.9]])
            (bar,) = one[2][0].get_segments()
            assert_allclose(bar[:, 1], [0.7, 1.0])


def test_excess_of_the_error_is_in_percent_and_its_band_two_standard_errors(figures):
    (ax,) = figures["frequency_error"].axes
    limit, curve = ax.lines
    assert_allclose(limit.get_ydata(), 1.0)
    assert_allclose(curve.get_xydata(), np.transpose([SIZES, 100 / SIZES]))
    corners = ax.collections[0].get_paths()[0].vertices
    for size in SIZES:
        assert_allclose(np.ptp(corners[corners[:, 0] == size, 1]), 40 / size)


def test_medians_of_scans_are_labeled_and_a_growth_shows_its_fit(figures):
    (ax,) = figures["scan_times"].axes
    one, other = ax.lines
    assert_allclose(one.get_xydata(), np.transpose([SIZES, 2 * SIZES**0.5]))
    assert_allclose(other.get_xydata()[:, 1], 18 * SIZES[:2] ** 0.5)
    assert [text.get_text() for text in ax.texts] == ["one", "other"]
    for ax in figures["growth"].axes:
        left, fitted, line = (line.get_xydata() for line in ax.lines)
        assert_allclose(np.concatenate([left, fitted]), line)
        assert_allclose(line, np.transpose([SIZES, 2 * SIZES**0.5]))
        assert len(left) == 1 and "0.50" in ax.texts[0].get_text()


def test_memory_of_results_and_call_are_in_the_row_of_their_filter(figures):
    (ax,) = figures["memory"].axes
    results, most = (line.get_xydata() for line in ax.lines)
    assert_allclose(results, [[57, 0], [680, 1]])
    assert_allclose(most, [[60, 0], [700, 1]])
    assert [label.get_text() for label in ax.get_yticklabels()] == ["one", "other"]
