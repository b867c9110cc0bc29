"""The figures of the chapter on adaptive windows show the numbers that they are given."""

import numpy as np
import pytest

from dopplerlib.figures import valarmathi as draw
from dopplerlib.systems import valarmathi as system


@pytest.fixture(scope="module")
def table():
    rng = np.random.default_rng(1)
    return system.window_table([0, 10, 40], [10, 30], rng=rng, runs=2)


@pytest.fixture(scope="module")
def result(table):
    return system.run_algorithms("path 2", 15.0, 2, table, rng=np.random.default_rng(2))


def test_the_best_window_is_marked_on_every_line(table):
    (ax,) = draw.window_error(table, 30.0).axes
    lines, marks = ax.get_lines()[::2], ax.get_lines()[1::2]
    for line, mark, cee, best in zip(lines, marks, table.cee[:, 1], table.best[:, 1], strict=True):
        np.testing.assert_array_equal(line.get_ydata(), cee)
        assert mark.get_xdata() == best


def test_velocities_are_those_of_both_sensors_and_of_their_fusion(result):
    figure = draw.velocities([result], run=1)
    expected = result.velocity(1, 1), result.velocity(1, 2), result.velocity(3)
    for ax, v in zip(figure.axes[:3], expected, strict=True):
        np.testing.assert_array_equal(ax.get_lines()[1].get_ydata(), v[1])
        np.testing.assert_array_equal(ax.get_lines()[0].get_ydata(), result.truth)


def test_a_running_error_is_the_mean_over_the_runs_in_percent(result):
    (ax,) = draw.cumulative_errors([result], [[(2, 2), (4, 1)]], ncols=1).axes
    expected = 100 * result.cee(2, 2).mean(axis=0)
    np.testing.assert_array_equal(ax.get_lines()[0].get_ydata(), expected)
    labels = [line.get_label() for line in ax.get_lines()]
    assert labels == ["algorithm 2, sensor 2", "algorithm 4"]


def test_a_sweep_shows_root_mean_squares_over_the_runs():
    phases = ("maneuver", "constant")
    found = {(1, p): np.array([[3.0, 4.0], [1.0, 1.0]]) for p in phases}
    axes = draw.sweep([0, 10], {"path 1": found}, {1: "one"}, 5.0).axes
    for ax in axes:
        np.testing.assert_allclose(ax.get_lines()[0].get_ydata(), [np.sqrt(12.5), 1.0])


def test_every_path_and_both_correlations_have_their_line():
    several = [system.velocity_path(name) for name in ("path 1", "path 2")]
    (ax,) = draw.paths(several).axes
    np.testing.assert_array_equal(ax.get_lines()[1].get_ydata(), several[1].v)
    (ax,) = draw.correlation(np.array([1.0, 0.1]), np.array([1.0, 0.2])).axes
    np.testing.assert_array_equal(ax.get_lines()[1].get_ydata(), [1.0, 0.2])
