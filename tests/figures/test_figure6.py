"""The figures of Fig 6 show the data that they are given, with a name and a unit on everything."""

import numpy as np
import pytest

from dopplerlib import chi2_interval
from dopplerlib.figures import figure6 as draw
from dopplerlib.systems import mittermaier2016 as paper
from tests.drawn import check_legends, lines

RUNS, RUN = 20, 3
INTERVAL = (1.2, 14.4)


@pytest.fixture(scope="module")
def published():
    return paper.reported().figure6


@pytest.fixture(scope="module")
def result():
    return paper.run_example(RUNS, rng=np.random.default_rng(31), keep=())


@pytest.fixture(scope="module")
def gated():
    return paper.run_example(RUNS, rng=np.random.default_rng(31), gate="two-sided", keep=())


@pytest.fixture(scope="module")
def array():
    return paper.reported().scenario.array


@pytest.fixture(scope="module")
def figures(result, gated, published, array):
    return {
        "scene": draw.scene(result, published, array, RUN),
        "errors": draw.errors(result, published, RUN),
        "error_bands": draw.error_bands(result, published),
        "nis": draw.nis(gated, published, INTERVAL, RUN),
        "nis_averages": draw.nis_averages(
            {"no gate": result, "gate": gated}, {"drawn": 5.9, "quoted": 5.82}, INTERVAL
        ),
        "skipped_counts": draw.skipped_counts(gated, published),
    }


def axes(figures, name):
    """Return the axes of a figure; a figure of one has it alone."""
    found = figures[name].axes
    return found[0] if len(found) == 1 else found


def assert_shows(line, x, y):
    np.testing.assert_array_equal(line.get_xdata(), x)
    np.testing.assert_array_equal(line.get_ydata(), y)


NAMES = ["scene", "errors", "error_bands", "nis", "nis_averages", "skipped_counts"]


@pytest.mark.parametrize("name", NAMES)
def test_every_curve_is_in_a_legend(figures, name):
    check_legends(figures[name])


def test_the_scene_shows_sensors_path_and_both_estimates_from_above_and_from_the_side(
    figures, result, published, array
):
    for ax, shown in zip(axes(figures, "scene"), ([0, 1], [0, 2]), strict=True):
        found = {label: line.get_xydata() for label, line in lines(ax).items()}
        np.testing.assert_array_equal(found["true path"], result.truth[:, shown])
        np.testing.assert_array_equal(found["published estimates"], published.path[:, shown])
        np.testing.assert_array_equal(found["our estimates"], result.track.x[RUN, ::20, shown].T)
        np.testing.assert_array_equal(found["sensors"], array.positions[:, shown])


def test_the_errors_are_those_of_one_run_in_centimeters(figures, result, published):
    for i, ax in enumerate(axes(figures, "errors")):
        shown = lines(ax)
        assert_shows(shown["published"], published.time, 100 * published.error[:, i])
        assert_shows(shown["ours, one run"], result.time, 100 * result.error[RUN, :, i])
        assert ax.get_ylabel() == f"error of {'xyz'[i]} (cm)"


def test_the_bands_hold_the_runs_that_they_promise(figures, result, published):
    for i, ax in enumerate(axes(figures, "error_bands")):
        shown = lines(ax)
        assert_shows(shown["published run"], published.time, 1000 * published.error[:, i])
        np.testing.assert_allclose(
            shown["median"].get_ydata(), 1000 * np.median(result.error[:, :, i], axis=0), rtol=1e-12
        )
        outer, inner = (band.get_paths()[0].vertices for band in ax.collections)
        assert ax.collections[0].get_label() == f"central 95 % of {RUNS} runs"
        last = 1000 * result.error[:, -1, i]
        for band, share in [(outer, 0.95), (inner, 0.5)]:
            bounds = band[band[:, 0] == result.time[-1], 1]
            expected = np.quantile(last, [(1 - share) / 2, (1 + share) / 2])
            np.testing.assert_allclose([bounds.min(), bounds.max()], expected, rtol=1e-12)


def test_the_nis_figure_shows_both_runs_and_marks_what_each_left_out(figures, gated, published):
    ours, theirs = axes(figures, "nis")
    skipped = ~gated.track.updated[RUN]
    for ax, values, out, label in [
        (ours, gated.track.nis[RUN], skipped, "ours, one run"),
        (theirs, published.nis, published.skipped, "published"),
    ]:
        curve, marks, *bounds = ax.lines
        assert_shows(curve, gated.time, values)
        assert_shows(marks, gated.time[out], values[out])
        assert marks.get_label() == f"{label}: {out.sum()} samples not used"
        assert [set(bound.get_ydata()) for bound in bounds] == [{INTERVAL[0]}, {INTERVAL[1]}]


def test_the_averages_are_shown_as_their_distribution(figures, result, gated):
    ax = axes(figures, "nis_averages")
    shown = lines(ax)
    for label, runs in [("no gate", result), ("gate", gated)]:
        average = runs.track.nis.mean(axis=1)
        for x, share in zip(shown[label].get_xdata(), shown[label].get_ydata(), strict=True):
            assert share == pytest.approx(np.mean(average <= x), abs=1e-12)
    assert set(shown["drawn"].get_xdata()) == {5.9}
    assert set(shown["quoted"].get_xdata()) == {5.82}
    (span,) = ax.patches
    assert (span.get_x(), span.get_x() + span.get_width()) == pytest.approx(INTERVAL)


def test_the_counts_are_of_what_each_run_left_out_below_and_above(figures, gated, published):
    shown = lines(axes(figures, "skipped_counts"))
    lower, upper = chi2_interval(6)
    value = gated.track.nis
    assert_shows(shown["our runs"], (value < lower).sum(axis=1), (value > upper).sum(axis=1))
    theirs = published.nis[published.skipped]
    assert_shows(shown["published run"], [np.sum(theirs < 6)], [np.sum(theirs > 6)])
