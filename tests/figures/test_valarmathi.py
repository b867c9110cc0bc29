"""The figures of the chapter on adaptive windows show the numbers that they are given."""

import numpy as np
import pytest

from dopplerlib.figures import valarmathi as draw
from dopplerlib.systems import valarmathi as system
from tests.drawn import check_legends

NUMBERED = {11: "sensor 1", 12: "sensor 2", 13: "fused"}


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
    figure = draw.velocities([result], run=1, numbers=[(11, 12, 13)])
    check_legends(figure)
    titles = [ax.get_title("left") for ax in figure.axes[:3]]
    assert titles == [f"{name} (their Fig {n})" for n, name in NUMBERED.items()]
    expected = result.velocity(1, 1), result.velocity(1, 2), result.velocity(3)
    for ax, v in zip(figure.axes[:3], expected, strict=True):
        np.testing.assert_array_equal(ax.get_lines()[1].get_ydata(), v[1])
        np.testing.assert_array_equal(ax.get_lines()[0].get_ydata(), result.truth)


def test_a_running_error_is_the_mean_over_the_runs_in_percent(result):
    figure = draw.cumulative_errors([result], [[(2, 2), (4, 1)]], ["Fig 15"], ncols=1)
    check_legends(figure)
    (ax,) = figure.axes
    assert ax.get_title("left") == "Fig 15"
    expected = 100 * result.cee(2, 2).mean(axis=0)
    np.testing.assert_array_equal(ax.get_lines()[0].get_ydata(), expected)
    labels = [line.get_label() for line in ax.get_lines()]
    assert labels == ["2 adaptive window, sensor 2", "4 two adaptive, fused"]


def test_a_sweep_shows_medians_with_their_intervals_and_the_limits():
    study = system.saved_study()
    figure = draw.sweep(study, 5.0, (15.0, 35.0))
    check_legends(figure)
    shown = [(path, "maneuver") for path in study.paths] + [("path 2", "constant")]
    for ax, (path, phase) in zip(figure.axes, shown, strict=True):
        for algorithm, line, band in zip(
            system.ALGORITHMS, ax.get_lines(), ax.collections, strict=False
        ):
            runs = study.of(phase, path, algorithm)
            np.testing.assert_array_equal(line.get_ydata(), np.median(runs, axis=-1))
            ends = band.get_paths()[0].vertices[:, 1]
            # Of 100 runs, the 40th and the 61st.
            assert ends.min() == np.sort(runs)[:, 39].min()
            assert ends.max() == np.sort(runs)[:, 60].max()
        assert [line.get_xdata()[0] for line in ax.get_lines()[-2:]] == [15, 35]


def test_failures_are_drawn_in_percent_with_their_intervals():
    shares = system.saved_failures()
    figure = draw.failures(shares, 0.05)
    check_legends(figure)
    assert [ax.get_title("left") for ax in figure.axes] == ["path 1", "path 2", "fighter"]
    for ax in figure.axes:
        for algorithm, line, band in zip(
            system.ALGORITHMS, ax.get_lines(), ax.collections, strict=False
        ):
            snrs_db, found = shares[ax.get_title("left"), algorithm]
            np.testing.assert_array_equal(line.get_xdata(), snrs_db)
            np.testing.assert_allclose(line.get_ydata(), [100 * one.value for one in found])
            ends = band.get_paths()[0].vertices[:, 1]
            assert ends.max() == pytest.approx(100 * max(one.high for one in found))


def test_every_path_and_both_correlations_have_their_line():
    several = [system.velocity_path(name) for name in ("path 1", "path 2")]
    both = draw.correlation(np.array([1.0, 0.1]), np.array([1.0, 0.2]))
    for figure, second in ((draw.paths(several), several[1].v), (both, [1.0, 0.2])):
        check_legends(figure)
        np.testing.assert_array_equal(figure.axes[0].get_lines()[1].get_ydata(), second)
