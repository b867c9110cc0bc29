"""The figures of consistency show the data that they are given, with units on every axis."""

import numpy as np
import pytest
from matplotlib.patches import Ellipse
from numpy.testing import assert_allclose
from scipy.stats import chi2

from dopplerlib.figures import consistency as draw
from dopplerlib.systems.mittermaier2016 import Consistency
from tests.drawn import check_legends, lines

MADE_UP = {"clouds", "claims"}

INTERVAL = (1.237, 14.449)
RNG = np.random.default_rng(81)
ETA = np.linspace(0, 20, 401)
DENSITIES = {n: (ETA, chi2.pdf(ETA, n)) for n in (2, 6)}
SUMS = {n: chi2.rvs(n, size=1000, random_state=RNG) for n in (2, 6)}
ERRORS = {"a": RNG.normal(size=(50, 2)), "b": RNG.normal(size=(50, 2))}
COVARIANCES = {"a": np.diag([0.01, 0.04]), "b": np.array([[0.05, 0.03], [0.03, 0.05]])}
TIME = np.array([0.0, 0.001, 0.01, 0.1])
VALUES = {"NIS": RNG.random(4), "NEES": RNG.random(4)}
AVERAGES = {"NIS": 6 + RNG.normal(size=80) / 10, "NEES": 6 + RNG.normal(size=80)}
INTERVALS = {"NIS": {"one": (5.8, 6.2)}, "NEES": {"one": (5.8, 6.2), "two": (4.0, 8.4)}}
NEES, NIS = RNG.uniform(1, 100, (9, 4)), RNG.uniform(1, 10, (9, 4))
STATES = np.zeros((9, 4, 6)), np.zeros((1, 4, 6, 6))
RESULTS = {
    label: Consistency(TIME, np.zeros((4, 6)), *STATES, factor * NEES, NIS, np.zeros(9))
    for label, factor in (("printed", 1), ("repaired", 0.1))
}
CURVES = {"white": np.array([0.7, 0.5, 0.3]), "colored": np.array([0.02, -0.01, 0.0])}
SPREAD, CLAIMED = np.array([3.0, 2, 1, 1]), {"x": np.ones(4), "y": np.full(4, 0.5)}


@pytest.fixture(scope="module")
def figures():
    return {
        "chi_square": draw.chi_square(DENSITIES, INTERVAL, SUMS, filled=6),
        "clouds": draw.clouds(ERRORS, COVARIANCES, ("x", "y")),
        "one_run": draw.one_run(TIME, VALUES, INTERVAL),
        "averages_spread": draw.averages_spread(AVERAGES, INTERVALS),
        "autocorrelations": draw.autocorrelations(CURVES, 0.1),
        "causes": draw.causes(RESULTS, INTERVAL, 5.35),
        "claims": draw.claims(TIME + 0.001, SPREAD, CLAIMED),
    }


NAMES = [
    "chi_square", "clouds", "one_run", "averages_spread", "autocorrelations", "causes", "claims",
]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_every_curve_is_in_a_legend(figures, name):
    check_legends(figures[name])


def test_the_densities_are_drawn_over_histograms_of_area_one_and_the_interval_is_filled(figures):
    (ax,) = figures["chi_square"].axes
    shown = lines(ax)
    for n in (2, 6):
        assert_allclose(shown[f"{n} degrees of freedom"].get_xydata().T, DENSITIES[n])
    (filled,) = ax.collections
    x = filled.get_paths()[0].vertices[:, 0]
    assert INTERVAL[0] <= x.min() < INTERVAL[0] + 0.1
    assert INTERVAL[1] - 0.1 < x.max() <= INTERVAL[1]
    for patch, n in zip(ax.patches, (2, 6), strict=True):
        height, edges, _ = patch.get_data()
        assert_allclose(np.sum(height * np.diff(edges)), np.mean(SUMS[n] <= 20))


def test_the_ellipse_holds_95_percent_of_a_normal_cloud(figures):
    """Its points are at the distance, in deviations, at which chi-square of two dof has 0.95."""
    for ax, label in zip(figures["clouds"].axes, ERRORS, strict=True):
        assert_allclose(ax.lines[0].get_xydata(), ERRORS[label])
        (ellipse,) = (patch for patch in ax.patches if isinstance(patch, Ellipse))
        points = ellipse.get_patch_transform().transform(
            [[np.cos(a), np.sin(a)] for a in np.linspace(0, 6, 20)]
        )
        distance = np.sum(points * np.linalg.solve(COVARIANCES[label], points.T).T, axis=1)
        assert_allclose(distance, chi2.isf(0.05, 2), rtol=1e-9)


def test_the_two_statistics_of_a_run_are_shown_with_the_interval(figures):
    for ax, (name, value) in zip(figures["one_run"].axes, VALUES.items(), strict=True):
        assert ax.get_ylabel() == name
        assert_allclose(lines(ax)["one run"].get_xydata().T, [TIME, value])
        (span,) = ax.patches
        assert_allclose((span.get_y(), span.get_y() + span.get_height()), INTERVAL)


def test_every_average_is_counted_and_every_bound_drawn(figures):
    for ax, name in zip(figures["averages_spread"].axes, AVERAGES, strict=True):
        assert sum(patch.get_height() for patch in ax.patches) == len(AVERAGES[name])
        bounds = sorted(line.get_xdata()[0] for line in ax.lines)
        assert bounds == sorted(b for pair in INTERVALS[name].values() for b in pair)


def test_the_medians_of_both_statistics_are_drawn_one_interval_after_the_start(figures):
    for ax, factor, values in zip(figures["causes"].axes, (0.1, 1), (NEES, NIS), strict=True):
        shown = lines(ax)
        assert_allclose(shown["printed"].get_xydata().T, [TIME + 0.001, np.median(values, axis=0)])
        assert_allclose(shown["repaired"].get_ydata(), factor * np.median(values, axis=0))
        assert set(shown["their median"].get_ydata()) == {5.35}


def test_the_autocorrelations_are_drawn_from_lag_one_over_the_band(figures):
    (ax,) = figures["autocorrelations"].axes
    for label, curve in CURVES.items():
        assert_allclose(lines(ax)[label].get_xydata().T, [[1, 2, 3], curve])
    (span,) = ax.patches
    assert_allclose((span.get_y(), span.get_y() + span.get_height()), (-0.1, 0.1))


def test_the_claims_are_drawn_beside_the_error(figures):
    (ax,) = figures["claims"].axes
    shown = lines(ax)
    assert_allclose(shown["actual error of the EKF"].get_ydata(), SPREAD)
    for label, value in CLAIMED.items():
        assert_allclose(shown[label].get_xydata().T, [TIME + 0.001, value])
