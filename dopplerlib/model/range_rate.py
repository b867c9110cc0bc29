"""Range and range rate of a target in a plane, for radars at fixed positions."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray


@checked
def range_rate(x: ArrayLike, sensors: ArrayLike) -> FloatArray:
    """Return the range and the range rate at every radar.

    Parameters
    ----------
    x : array_like, shape (..., 4)
        States [x, y, v_x, v_y] in m and m/s, not on a radar.
    sensors : array_like, shape (N, 2)
        Positions of the radars in m.

    Returns
    -------
    ndarray, shape (..., N, 2)
        Range in m and its rate in m/s, positive when the target recedes.

    Notes
    -----
    Åsheim (2015), Fig 2.1 and Appendix A.3, which takes the rate from differences of the range.

    Examples
    --------
    Five meters away, moving off at 0.2 m/s along x:

    >>> range_rate([3, 4, 0.2, 0], [[0, 0]]).round(3).tolist()
    [[5.0, 0.12]]
    """
    d, u, v = _geometry(x, sensors)
    return np.stack([d, np.einsum("...i,...i->...", u, v)], axis=-1)


@checked
def range_rate_jacobian(x: ArrayLike, sensors: ArrayLike) -> FloatArray:
    """Return the Jacobian of `range_rate` with respect to the state.

    Parameters
    ----------
    x : array_like, shape (..., 4)
        States [x, y, v_x, v_y] in m and m/s, not on a radar.
    sensors : array_like, shape (N, 2)
        Positions of the radars in m.

    Returns
    -------
    ndarray, shape (..., N, 2, 4)
        Row 0 is that of the range, row 1 that of its rate.

    Notes
    -----
    With the unit vector u from radar to target at distance d, the rate u.v changes with the
    position by the part of v across the line of sight, over d.

    Examples
    --------
    >>> range_rate_jacobian([3, 4, 0.2, 0], [[0, 0]]).round(4).tolist()
    [[[0.6, 0.8, 0.0, 0.0], [0.0256, -0.0192, 0.6, 0.8]]]
    """
    d, u, v = _geometry(x, sensors)
    rate = np.einsum("...i,...i->...", u, v)
    H = np.zeros((*d.shape, 2, 4))
    H[..., 0, :2] = u
    with np.errstate(all="ignore"):
        H[..., 1, :2] = (v - rate[..., None] * u) / d[..., None]
    H[..., 1, 2:] = u
    return _checks.estimates("x, sensors", H, what="derivatives")


def _geometry(x, sensors):
    x = _checks.moderate("x", x, (4,))
    sensors = _checks.one_matrix("sensors", _checks.moderate("sensors", sensors, (None, 2)))
    line = x[..., None, :2] - sensors
    d = np.hypot(line[..., 0], line[..., 1])
    if not d.all():
        raise ValueError("x must not lie on a radar, got a position equal to that of one")
    return d, line / d[..., None], x[..., None, 2:]
