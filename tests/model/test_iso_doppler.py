"""A target anywhere on an iso-Doppler cone shows the shift of the one that defines it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from dopplerlib import RadarArray, doppler_shift
from dopplerlib.model.iso_doppler import iso_doppler_directions

RING = RadarArray.ring(6, 0.2)
ANGLES = np.linspace(0, 2 * np.pi, 37)

coordinate = st.floats(-2, 2)
# Neither on a sensor nor at rest: at least 1 cm before the ring, and 1 cm/s fast.
states = st.tuples(st.floats(0.01, 2), coordinate, coordinate, st.floats(0.01, 2), coordinate,
                   coordinate).map(np.array)  # fmt: skip


@given(states, st.floats(0.01, 100))
def test_every_point_of_an_iso_doppler_cone_has_the_shift_of_the_target(x, distance):
    places = RING.positions[:, None] + distance * iso_doppler_directions(x, RING, ANGLES)
    seen = doppler_shift(
        np.concatenate([places, np.broadcast_to(x[3:], places.shape)], axis=-1), RING
    )
    of_its_own_cone = np.diagonal(seen, axis1=0, axis2=2)
    # Shifts stay below 600 Hz, and a place 1 cm from a sensor has lost two of sixteen digits.
    assert_allclose(of_its_own_cone, np.tile(doppler_shift(x, RING), (37, 1)), atol=1e-9)


@given(states)
def test_the_directions_of_a_cone_are_unit_vectors_and_the_first_meets_the_target(x):
    directions = iso_doppler_directions(x, RING, ANGLES)
    to_target = x[:3] - RING.positions
    # Rounding of unit vectors and of distances below 4 m: some units in the 16th digit.
    assert_allclose(np.linalg.norm(directions, axis=-1), 1, atol=1e-12)
    assert_allclose(np.cross(directions[:, 0], to_target), 0, atol=1e-12)
    assert ((directions[:, 0] * to_target).sum(axis=1) > 0).all()


def test_a_target_that_comes_straight_at_the_sensor_makes_the_cone_a_ray():
    sensor = RadarArray([[0, 0, 0]])
    directions = iso_doppler_directions([1, 0, 0, -1, 0, 0], sensor, ANGLES)
    assert_allclose(directions, np.tile([1.0, 0, 0], (1, 37, 1)), atol=1e-15)


def test_states_may_be_stacked():
    x = np.random.default_rng(3).uniform(0.1, 1, (2, 3, 6))
    directions = iso_doppler_directions(x, RING, ANGLES)
    assert directions.shape == (2, 3, 6, 37, 3)
    assert_allclose(directions[1, 2], iso_doppler_directions(x[1, 2], RING, ANGLES), atol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x": [1, 0, 0, 0, 0, 0]}, r"x must have a velocity other than zero, got \[0. 0. 0.\]"),
        ({"x": [0, 0.2, 0, 1, 0, 0]}, "x must not lie on a sensor"),
        ({"angles": 1.0}, r"angles must have shape \(..., any\), got \(\)"),
        ({"angles": [[1.0]]}, r"angles must have shape \(any,\), got \(1, 1\)"),
        ({"array": None}, "array must be a RadarArray, got None"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(change, message):
    good = {"x": [1, 0, 0, 1, 0, 0], "array": RING, "angles": [0.0]}
    with pytest.raises(ValueError, match=message):
        iso_doppler_directions(**good | change)
