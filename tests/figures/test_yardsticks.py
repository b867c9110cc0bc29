"""The figures of the yardsticks show the data that they are given."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dopplerlib.figures import yardsticks as draw

RNG = np.random.default_rng(1)
CLOUD = RNG.uniform(-0.3, 0.3, (40, 2))
LINE = 0.1 * np.stack([np.cos(np.linspace(0, 6, 100)), np.sin(np.linspace(0, 6, 100))], axis=1)
TIME = np.array([0.02, 0.1, 0.3])
RMS = np.array([[0.1, 0.09, 0.12], [0.05, 0.04, 0.06], [0.02, 0.018, 0.021]])
BOUNDS = {"mean": np.array([0.1, 0.03]), "posterior": np.array([0.001, 0.0003])}
EDGES = np.array([0.1, 0.5, 0.9])
SHELLS = np.array([[0.02, 0.03], [0.001, 0.002]])
PLACES = np.array([[0.1, 0.8], [-0.2, 0.7]])
ELLIPSES = np.array([[[1e-4, 0], [0, 4e-4]], [[1e-4, 0], [0, 1e-4]]])
NEES = RNG.chisquare(6, 200)
Q = np.linspace(0, 30, 31)


@pytest.fixture(scope="module")
def figures():
    curves = {"exact": RMS, "sum": 1.1 * RMS}
    return {
        "posteriors": draw.posteriors(
            {"20 ms": CLOUD, "60 ms": CLOUD / 2}, np.array([[0.1, 0], [0.1, 0.1]]),
            np.array([-0.1, 0]), np.stack([LINE, LINE / 2]),
        ),
        "errors": draw.errors(
            TIME, {"A": curves, "B": curves}, np.array([0.1, 0.3]), {"A": BOUNDS, "B": BOUNDS}
        ),
        "many_bounds": draw.many_bounds(
            PLACES, ELLIPSES, {"arithmetic": np.eye(2), "harmonic": np.eye(2) / 4}, PLACES - 1
        ),
        "shells": draw.shells(EDGES, SHELLS, ("arithmetic", "harmonic")),
        "nees": draw.nees(NEES, Q, np.ones(31) / 30, {"one": (5.8, 6.2), "other": (5.5, 6.1)}),
    }  # fmt: skip


def test_posteriors_are_the_draws_beside_truth_twin_and_bound(figures):
    ax = figures["posteriors"].axes[1]
    cloud, line, truth, twin = (each.get_xydata() for each in ax.lines)
    assert_allclose(cloud, CLOUD / 2)
    assert_allclose(line, LINE / 2)
    assert_allclose(truth, [[0.1, 0.1]])
    assert_allclose(twin, [[-0.1, 0]])


def test_errors_have_their_intervals_and_the_bounds_beside_them(figures):
    for ax in figures["errors"].axes:
        assert_allclose(ax.containers[0][0].get_ydata(), RMS[:, 0])
        for segment, row in zip(ax.containers[0][2][0].get_segments(), RMS, strict=True):
            assert_allclose(segment[:, 1], row[1:])
        drawn = {line.get_label(): line.get_ydata() for line in ax.lines}
        for name, curve in BOUNDS.items():
            assert_allclose(drawn[name], curve)


def test_many_bounds_have_two_deviations_and_both_means(figures):
    left, right = figures["many_bounds"].axes
    first = left.lines[0].get_xydata() - PLACES[0]
    assert_allclose(np.abs(first).max(axis=0), [0.02, 0.04], rtol=1e-2)  # a polygon of 100 points
    drawn = {line.get_label(): np.hypot(*line.get_xydata().T) for line in right.lines}
    assert_allclose(drawn["arithmetic"], 2000)
    assert_allclose(drawn["harmonic"], 1000)


def test_shells_are_steps_in_millimeters(figures):
    (ax,) = figures["shells"].axes
    for step, curve in zip(ax.patches, SHELLS, strict=True):
        assert_allclose(step.get_data().values, 1e3 * curve)


def test_the_histogram_of_nees_is_a_density_and_the_intervals_are_those_given(figures):
    left, right = figures["nees"].axes
    assert_allclose(sum(bar.get_height() * bar.get_width() for bar in left.patches), 1)
    (segments,) = (right.containers[0][2][0].get_segments(),)
    assert_allclose(segments[0][:, 0], [5.8, 6.2])
