"""The twin of a state before a plane array: nearly the same shifts, and back again."""

import numpy as np
import pytest

from dopplerlib import RadarArray, doppler_shift
from dopplerlib.model.twin import planar_twin

STATE = np.array([0.833, 0.111, 0.092, -0.75, -0.125, -0.018])
# Not on a circle, and in the plane x = 0.
PLACES = np.array([[0, 0.1, 0.05], [0, -0.2, 0.1], [0, 0.03, -0.2], [0, 0, 0], [0, 0.15, 0.15]])


def difference(scale):
    array = RadarArray(scale * PLACES)
    return np.abs(doppler_shift(planar_twin(STATE), array) - doppler_shift(STATE, array)).max()


def test_the_shifts_differ_by_the_third_power_of_the_size_of_the_array():
    # Halving the array leaves an eighth, and 10 % are more than the terms of fourth order.
    assert difference(0.05) / difference(0.025) == pytest.approx(8, rel=0.1)


def test_the_twin_of_the_twin_is_the_state():
    # A dozen roundings of numbers near one.
    np.testing.assert_allclose(planar_twin(planar_twin(STATE)), STATE, rtol=0, atol=1e-13)


def test_state_and_twin_have_the_same_distance_and_closing_speed():
    p, q = STATE[:3], planar_twin(STATE)[:3]
    assert np.linalg.norm(q) == pytest.approx(np.linalg.norm(p), rel=1e-14)
    assert q @ planar_twin(STATE)[3:] == pytest.approx(p @ STATE[3:], rel=1e-13)


def test_twins_are_batched():
    states = np.stack([STATE, STATE * [-1, 1, 1, -1, 1, 1]])
    both = planar_twin(states)
    np.testing.assert_array_equal(both[0], planar_twin(STATE))
    # The reflected state has the reflected twin, on its own side.
    np.testing.assert_allclose(both[1], both[0] * [-1, 1, 1, -1, 1, 1], rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("x", "message"),
    [
        ([0, 1, 0, 0, 0, 1], "x must lie off the plane"),
        ([1, 0, 0, 0, 1, 0], "x must lie off the plane"),
        ([1, 0, 0, -0.1, 5, 0], "got a position too far off its axis"),
        ([1, 0, 0], r"x must have shape \(..., 6\)"),
    ],
)
def test_a_wrong_state_is_refused(x, message):
    with pytest.raises(ValueError, match=message):
        planar_twin(x)
