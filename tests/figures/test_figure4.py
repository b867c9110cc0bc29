"""The figures of the noise study show the data that they are given, with units on every axis."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dopplerlib.figures import figure4 as draw
from dopplerlib.systems.mittermaier2016 import NoiseSweep, PublishedFigure4, noise_levels

NOISE_LEVELS = noise_levels()
ERROR = 0.2 * np.sqrt(NOISE_LEVELS)[:, None] * np.linspace(0.8, 1.2, 5)
OURS = NoiseSweep(NOISE_LEVELS, ERROR, 2 * ERROR, ERROR / 2, ERROR, 0.9 * ERROR, 1.8 * ERROR)
DOTS = PublishedFigure4(NOISE_LEVELS, 0.9 * ERROR, 1.9 * ERROR)


@pytest.fixture(scope="module")
def figures():
    return {
        "errors": draw.errors_by_noise(OURS, DOTS),
        "median": draw.mean_and_median({"a": (ERROR, ERROR / 2)}, 0.9 * ERROR[:, 2], NOISE_LEVELS),
        "sequences": draw.sequences({"published": ERROR[:2], "b": 2 * ERROR[:2]}),
    }


def line(ax, label):
    return next(line for line in ax.lines if line.get_label() == label)


def test_the_dots_and_the_mean_are_those_given(figures):
    left, right = figures["errors"].axes
    assert_allclose(line(left, "published").get_ydata(), DOTS.position.ravel())
    assert_allclose(line(right, "published").get_ydata(), DOTS.velocity.ravel())
    assert_allclose(line(right, "ours, mean").get_ydata(), OURS.velocity.mean(axis=1))
    assert_allclose(line(left, "at the CRLB").get_ydata(), OURS.bound_position.mean(axis=1))


def test_mean_and_median_are_divided_by_the_noise(figures):
    (ax,) = figures["median"].axes
    assert_allclose(line(ax, "a: mean").get_ydata(), 0.2)
    assert_allclose(line(ax, "a: median").get_ydata(), 0.1)


def test_every_sequence_is_shown(figures):
    (ax,) = figures["sequences"].axes
    assert_allclose(line(ax, "b").get_xydata(), 2 * ERROR[:2].T)
