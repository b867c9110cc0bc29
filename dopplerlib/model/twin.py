"""The twin: a second state that a plane array can hardly distinguish from a given one."""

import numpy as np

from .. import _checks
from .._typing import ArrayLike, FloatArray


def planar_twin(x: ArrayLike, radius: float = 0.0) -> FloatArray:
    """Return the twin of a state: nearly equal Doppler shifts at any array in the plane x = 0.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] in m and m/s, with x and p.v not zero.
    radius : float
        Radius in m of the circle on which the sensors stand, or the root of their mean squared
        distance from the origin. Zero stands for an array that is small beside its distance.

    Returns
    -------
    ndarray, shape (..., 6)
        States on the same side of the array. The twin of the twin is the state itself.

    Raises
    ------
    ValueError
        If `x` has the wrong shape, is not finite or beyond 1e60, x or p.v is zero, or the twin
        would have to be farther to the side than it is from the origin.

    Notes
    -----
    State and twin have the same p.p and p.v. With kappa = p.v / (p.p + r^2) of the radius r, the
    components in the plane are p' = 2 v / kappa - 3 p and v' = v + kappa (p' - p). The shifts of
    sensors in the plane x = 0 near the origin differ by terms of third order in the size of the
    array over the distance only; `dopplerlib.derive.ring_coordinates` has the proof.

    Examples
    --------
    Differences of the shifts at the paper's ring in Hz, without and with its radius:

    >>> from dopplerlib import RadarArray, doppler_shift
    >>> x = np.array([0.833, 0.111, 0.092, -0.75, -0.125, -0.018])
    >>> ring = RadarArray.ring(6, 0.2)
    >>> shift = doppler_shift(x, ring)
    >>> for radius in (0, 0.2):
    ...     apart = doppler_shift(planar_twin(x, radius), ring) - shift
    ...     print(round(float(np.abs(apart).max()), 2))
    0.64
    0.03
    """
    x = _checks.moderate("x", x, (6,))
    radius = _checks.one_number("radius", radius, _checks.moderate)
    p, v = x[..., :3], x[..., 3:]
    square, w = np.sum(p * p, axis=-1), np.sum(p * v, axis=-1)
    if not ((p[..., 0] != 0) & (w != 0)).all():
        raise ValueError("x must lie off the plane of the array and have p.v other than zero")
    with np.errstate(all="ignore"):
        kappa = (w / (square + radius**2))[..., None]
        across = 2 * v[..., 1:] / kappa - 3 * p[..., 1:]
        across_v = v[..., 1:] + kappa * (across - p[..., 1:])
        left = square - np.sum(across * across, axis=-1)
    _checks.estimates("x", left, across_v, what="twin")
    if not (left > 0).all():
        raise ValueError(
            "x must have a twin in front of the array, got a position too far off its axis"
        )
    ahead = np.copysign(np.sqrt(left), p[..., 0])
    ahead_v = (w - np.sum(across * across_v, axis=-1)) / ahead
    return np.concatenate([ahead[..., None], across, ahead_v[..., None], across_v], axis=-1)
