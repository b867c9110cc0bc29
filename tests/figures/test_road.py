"""The figures of the road show the data that they are given, with units on every axis."""

import numpy as np
import pytest

from dopplerlib.chain.ridges import Ridge
from dopplerlib.figures import road as draw
from dopplerlib.signal.spectrogram import spectrogram

TIME = np.linspace(0.1, 0.9, 30)
RIDGE = Ridge(TIME, -200 - 10 * TIME, 2 + TIME, np.full(30, 0.3), 100, 25, "hann")


@pytest.fixture(scope="module")
def figures():
    x = np.random.default_rng(1).standard_normal(2000)
    seen = spectrogram(x, 2000.0, 100)
    return {
        "ridges": draw.ridges(seen, [RIDGE, RIDGE]),
        "deviations": draw.deviations(RIDGE, -200 - 9 * TIME),
    }


def test_ridges_are_drawn_over_positive_frequencies(figures):
    left, right = figures["ridges"].axes[:2]
    assert [len(left.lines), len(right.lines)] == [0, 2]
    np.testing.assert_array_equal(right.lines[0].get_ydata(), -RIDGE.frequency)
    assert left.get_ylim()[0] >= 0


def test_errors_and_both_claims_are_drawn(figures):
    error, std, bound = figures["deviations"].axes[0].lines[:3]
    np.testing.assert_allclose(error.get_ydata(), TIME)
    np.testing.assert_array_equal(std.get_ydata(), RIDGE.std)
    np.testing.assert_array_equal(bound.get_ydata(), RIDGE.bound)
