"""States that a ring cannot tell apart: the same Doppler shifts, and where the family ends."""

import numpy as np
import pytest

from dopplerlib import (
    RadarArray,
    doppler_jacobian,
    doppler_shift,
    ring_family,
    ring_family_direction,
    ring_family_limits,
)

RADIUS = 0.2
STATE = np.array([0.833, 0.111, 0.092, -0.75, -0.125, -0.018])


@pytest.fixture
def states():
    """Forty states on both sides of the ring."""
    return np.random.default_rng(50).normal(size=(40, 6))


@pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
@pytest.mark.parametrize("sensors", [1, 6, 13])
def test_every_ring_sees_the_same_shifts_all_along_the_family(states, sensors, share):
    array = RadarArray.ring(sensors, RADIUS, phase=0.3)
    low, high = ring_family_limits(states, RADIUS)
    family = ring_family(states, RADIUS, low ** (1 - share) * high**share)
    # Near the ends v_x grows large and cancels: shifts of hundreds of Hz keep eleven digits.
    np.testing.assert_allclose(
        doppler_shift(family, array), doppler_shift(states, array), rtol=1e-9, atol=1e-8
    )


def test_a_ring_of_another_radius_tells_them_apart():
    family = ring_family(STATE, RADIUS, [1, 1.2])
    shifts = doppler_shift(family, RadarArray.ring(6, 1.1 * RADIUS))
    assert np.abs(shifts[1] - shifts[0]).max() > 0.01


def test_no_ring_sees_the_direction(states):
    direction = ring_family_direction(states, RADIUS)
    H = doppler_jacobian(states, RadarArray.ring(9, RADIUS))
    size = np.abs(H) @ np.abs(direction)[..., None]
    # Each entry is a sum of six terms that cancel to rounding.
    assert (np.abs(H @ direction[..., None]) <= 1e-14 * size).all()


def test_the_direction_is_the_derivative_of_the_family(states):
    x = states[np.abs(states[:, 0]) > 0.3]  # nearer to the plane of the ring it bends sharply
    h = 1e-5
    difference = (ring_family(x, RADIUS, 1 + h) - ring_family(x, RADIUS, 1 - h)) / (2 * h)
    # The error of a central difference is of the order h^2 times a third derivative.
    size = np.linalg.norm(difference, axis=1, keepdims=True)
    assert (np.abs(difference - ring_family_direction(x, RADIUS)) < 1e-5 * size).all()


def test_the_family_ends_in_the_plane_of_the_ring(states):
    low, high = ring_family_limits(states, RADIUS)
    for t in (low * (1 + 1e-12), high * (1 - 1e-12)):
        # x^2 is of the order of the 1e-12 by which t is inside.
        assert (np.abs(ring_family(states, RADIUS, t)[:, 0]) < 1e-5).all()


def test_on_the_axis_the_family_is_endless():
    low, high = ring_family_limits([2.0, 0, 0, -1, 0, 0], RADIUS)
    assert high == np.inf
    assert low == pytest.approx(RADIUS / np.hypot(2.0, RADIUS), rel=1e-15)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x": [0, 1, 0, 0, 0, 1]}, "x must not lie in the plane of the ring"),
        ({"x": [1, 1, 0]}, r"x must have shape \(..., 6\)"),
        ({"radius": 0}, "radius must be positive"),
        ({"t": 0.1}, "t must lie between the limits"),
        ({"t": 50}, "t must lie between the limits"),
        ({"t": -1}, "t must be positive"),
        ({"t": np.nan}, "t must be finite"),
    ],
)
def test_a_wrong_argument_is_named(change, message):
    with pytest.raises(ValueError, match=message):
        ring_family(**{"x": STATE, "radius": RADIUS, "t": 1.0} | change)
