"""Directions and heights on the ellipsoid of the earth."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray

# WGS 84: half the axis in the equator's plane, and the flattening.
RADIUS = 6378137.0  # m
FLATTENING = 1 / 298.257223563
_SQUARE = FLATTENING * (2 - FLATTENING)  # the eccentricity's


@checked
def geodetic(position: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return latitude, longitude and height above the ellipsoid of WGS 84.

    Parameters
    ----------
    position : array_like, shape (..., 3)
        Places in m, in the frame that turns with the earth: x and y in the equator's plane, z
        along the axis. Not within 50 km of the earth's center.

    Returns
    -------
    latitude, longitude : ndarray, shape (...)
        Angles in rad, of the vertical against the equator's plane, and around the axis.
    height : ndarray, shape (...)
        Height in m.

    Notes
    -----
    Bowring's formula of 1976, iterated three times: it is exact near the ground after one.

    Examples
    --------
    >>> latitude, longitude, height = geodetic([6378137.0 + 100.0, 0.0, 0.0])
    >>> float(latitude), float(longitude), round(float(height), 6)
    (0.0, 0.0, 100.0)
    """
    position = _checks.moderate("position", position, (3,))
    if (np.linalg.norm(position, axis=-1) < 5e4).any():
        raise ValueError("position must be 50 km or more from the earth's center, got one nearer")
    x, y, z = np.moveaxis(position, -1, 0)
    axis = np.hypot(x, y)
    semi = RADIUS * (1 - FLATTENING)
    reduced = np.arctan2(z, (1 - FLATTENING) * axis)
    for _ in range(3):
        latitude = np.arctan2(
            z + _SQUARE / (1 - _SQUARE) * semi * np.sin(reduced) ** 3,
            axis - _SQUARE * RADIUS * np.cos(reduced) ** 3,
        )
        reduced = np.arctan2((1 - FLATTENING) * np.sin(latitude), np.cos(latitude))
    sine = np.sin(latitude)
    normal = RADIUS / np.sqrt(1 - _SQUARE * sine**2)
    height = axis * np.cos(latitude) + (z + _SQUARE * normal * sine) * sine - normal
    return latitude, np.arctan2(y, x), height


@checked
def east_north_up(position: ArrayLike) -> FloatArray:
    """Return the directions east, north and up at a place on the earth.

    Parameters
    ----------
    position : array_like, shape (..., 3)
        Places in m as in `geodetic`.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Unit vectors, one a row: the product with a difference of places is that difference in
        meters to the east, to the north, and upwards.

    Examples
    --------
    >>> east_north_up([6378137.0, 0.0, 0.0]).tolist()
    [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    """
    latitude, longitude, _ = geodetic(position)
    s, c = np.sin(longitude), np.cos(longitude)
    rise, level = np.sin(latitude), np.cos(latitude)
    zero = np.zeros_like(s)
    rows = [(-s, c, zero), (-rise * c, -rise * s, level), (level * c, level * s, rise)]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2) + 0.0
