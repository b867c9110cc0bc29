"""Measurement function of a radar in the plane: range, azimuth and range rate."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray


@checked
def polar_radar_h(x: ArrayLike) -> FloatArray:
    """Return range, azimuth and range rate of targets for a radar at the origin.

    Parameters
    ----------
    x : array_like, shape (..., 4)
        States [x, v_x, y, v_y] in m and m/s, not at the origin. The radar looks along +y;
        +x is to its right.

    Returns
    -------
    ndarray, shape (..., 3)
        Range in m; azimuth in rad, zero along +y, positive to the right, in (-pi, pi]; range rate
        in m/s, positive when the target recedes.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 10.3. The component of the velocity across the line of
    sight is not in it.

    Examples
    --------
    A target 3 m to the right and 4 m ahead that moves ahead at 5 m/s:

    >>> polar_radar_h([3.0, 0.0, 4.0, 5.0]).round(3).tolist()
    [5.0, 0.644, 4.0]
    """
    p_x, v_x, p_y, v_y, r = _unpacked(x)
    return np.stack([r, np.arctan2(p_x, p_y), (p_x * v_x + p_y * v_y) / r], axis=-1)


@checked
def polar_radar_jacobian(x: ArrayLike) -> FloatArray:
    """Return the Jacobian of `polar_radar_h`.

    Parameters
    ----------
    x : array_like, shape (..., 4)
        States [x, v_x, y, v_y] in m and m/s, not at the origin.

    Returns
    -------
    ndarray, shape (..., 3, 4)

    Notes
    -----
    The rank is three: a single scan leaves the cross-range velocity open.

    Examples
    --------
    Straight ahead, the range rate is the motion along the line of sight; motion across it will show
    in a while:

    >>> polar_radar_jacobian([0.0, 1.0, 2.0, 0.0])[2].round(1).tolist() == [0.5, 0, 0, 1]
    True
    """
    p_x, v_x, p_y, v_y, r = _unpacked(x)
    u_x, u_y = p_x / r, p_y / r
    with np.errstate(all="ignore"):
        across = (u_y * v_x - u_x * v_y) / r  # velocity across the line of sight, over the range
    _checks.estimates("x", across, what="derivatives")
    H = np.zeros((*r.shape, 3, 4))
    H[..., 0, 0], H[..., 0, 2] = u_x, u_y
    H[..., 1, 0], H[..., 1, 2] = u_y / r, -u_x / r
    H[..., 2, 0], H[..., 2, 2] = u_y * across, -u_x * across
    H[..., 2, 1], H[..., 2, 3] = u_x, u_y
    return H


@checked
def polar_position(z: ArrayLike) -> FloatArray:
    """Return the position at a range and an azimuth.

    Parameters
    ----------
    z : array_like, shape (..., m)
        Measurements; the first two components are range in m and azimuth in rad.

    Returns
    -------
    ndarray, shape (..., 2)
        [x, y] in m.

    Notes
    -----
    The inverse of the first two components of `polar_radar_h`.

    Examples
    --------
    >>> polar_position([2.0, np.pi / 2]).round(3).tolist()
    [2.0, 0.0]
    """
    z = _checks.moderate("z", z, (None,))
    if z.shape[-1] < 2:
        raise ValueError(f"z must have range and azimuth as components, got shape {z.shape}")
    r, azimuth = z[..., 0], z[..., 1]
    return np.stack([r * np.sin(azimuth), r * np.cos(azimuth)], axis=-1)


def _unpacked(x):
    x = _checks.moderate("x", x, (4,))
    r = np.hypot(x[..., 0], x[..., 2])
    if not (r > 0).all():
        raise ValueError("x must not lie on the radar at the origin, got a range of 0")
    return (*np.moveaxis(x, -1, 0), r)
