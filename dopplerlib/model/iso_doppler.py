"""Iso-Doppler cones: where a target of a given velocity shows a given Doppler shift."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from .doppler import check_clear_of_sensors
from .radar_array import RadarArray


@checked
def iso_doppler_directions(x: ArrayLike, array: RadarArray, angles: ArrayLike) -> FloatArray:
    """Return directions from each sensor in which a target shows the same Doppler shift.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] in m and m/s, moving and not on a sensor.
    array : RadarArray
        The N sensors.
    angles : array_like, shape (M,)
        Angles around the axis of each cone in rad; 0 is the direction of the target itself.

    Returns
    -------
    ndarray, shape (..., N, M, 3)
        Unit vectors. A target at ``sensor + distance * direction`` with the velocity of `x` has
        the Doppler shift of `x`, for any positive distance.

    Notes
    -----
    At a fixed velocity the shift depends only on the angle between the line of sight and the
    velocity. So the positions with the same shift form a cone: apex at the sensor, axis along the
    velocity, the target on it.

    Examples
    --------
    A target beside the sensor has no shift; nor has it opposite, or above:

    >>> sensor = RadarArray([[0, 0, 0]])
    >>> directions = iso_doppler_directions([0, 1, 0, 1, 0, 0], sensor, [0, np.pi / 2, np.pi])
    >>> (directions.round(3) + 0.0).tolist()
    [[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]]
    """
    x = _checks.moderate("x", x, (6,))
    check_clear_of_sensors("x", x, array)
    angles = _checks.finite("angles", angles, (None,))
    if angles.ndim != 1:
        raise ValueError(f"angles must have shape (any,), got {angles.shape}")
    angles = angles[:, None]
    velocity = x[..., None, 3:]
    speed = np.linalg.norm(velocity, axis=-1, keepdims=True)
    if not (speed > 0).all():
        raise ValueError(f"x must have a velocity other than zero, got {x[..., 3:]}")
    axis = velocity / speed
    to_target = x[..., None, :3] - array.positions
    to_target = to_target / np.linalg.norm(to_target, axis=-1, keepdims=True)
    along = np.sum(to_target * axis, axis=-1, keepdims=True) * axis
    across = (to_target - along)[..., None, :]
    turned = np.cos(angles) * across + np.sin(angles) * np.cross(axis[..., None, :], across)
    return along[..., None, :] + turned
