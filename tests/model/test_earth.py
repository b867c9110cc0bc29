"""Latitude, longitude and height lead back to the place; up is the direction of growing height."""

import numpy as np
import pytest

from dopplerlib.model.earth import FLATTENING, RADIUS, east_north_up, geodetic

RNG = np.random.default_rng(5)
LATITUDE = np.r_[RNG.uniform(-np.pi / 2, np.pi / 2, 40), 0, np.pi / 2, -np.pi / 2]
LONGITUDE = RNG.uniform(-np.pi, np.pi, 43)
HEIGHT = np.r_[RNG.uniform(-1e4, 2e7, 40), 0, 100, 100]


def place(latitude, longitude, height):
    """Closed form, the other way round: the normal of the ellipse, lengthened by the height."""
    square = FLATTENING * (2 - FLATTENING)
    normal = RADIUS / np.sqrt(1 - square * np.sin(latitude) ** 2)
    level = (normal + height) * np.cos(latitude)
    z = (normal * (1 - square) + height) * np.sin(latitude)
    return np.stack([level * np.cos(longitude), level * np.sin(longitude), z], axis=-1)


def test_the_way_back_is_closed():
    """Three rounds of Bowring's formula leave less than a micrometer up to 20 000 km."""
    latitude, longitude, height = geodetic(place(LATITUDE, LONGITUDE, HEIGHT))
    np.testing.assert_allclose(latitude, LATITUDE, rtol=0, atol=1e-13)
    np.testing.assert_allclose(longitude[:-2], LONGITUDE[:-2], rtol=0, atol=1e-13)
    np.testing.assert_allclose(height, HEIGHT, rtol=0, atol=1e-6)


def test_the_directions_are_where_the_angles_and_the_height_grow():
    here = place(LATITUDE, LONGITUDE, HEIGHT)[:40]
    axes = east_north_up(here)
    for axis, step in enumerate(1e-6 * np.eye(3)):
        east, north, up = step
        there = place(LATITUDE[:40] + north, LONGITUDE[:40] + east, HEIGHT[:40] + up * 1e7)
        moved = np.einsum("nij,nj->ni", axes, there - here)
        moved /= np.linalg.norm(moved, axis=-1, keepdims=True)
        np.testing.assert_allclose(moved, np.tile(np.eye(3)[axis], (40, 1)), rtol=0, atol=1e-6)


def test_the_center_of_the_earth_has_no_vertical():
    with pytest.raises(ValueError, match="position must be 50 km or more from the earth's center"):
        geodetic([[7e6, 0, 0], [0, 0, 1e4]])
