"""Coordinates of a state in which a ring of sensors sees five numbers, and no scale."""

import numpy as np

from .. import _checks
from .._hints import Positive, checked
from .._typing import ArrayLike, FloatArray
from ..kernels import ring_coordinates as kernel


@checked
def to_ring_coordinates(x: ArrayLike, radius: Positive) -> FloatArray:
    """Return states in ring coordinates: five numbers that a ring sees, and the scale.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] in m and m/s.
    radius : float
        Radius r in m of the ring: a circle about the origin in the plane x = 0.

    Returns
    -------
    ndarray, shape (..., 6)
        With rho^2 = p.p + r^2: (y, z) / rho^2 in 1/m, (v_y, v_z) / rho in 1/s, p.v / rho in m/s,
        and ln rho, of rho in m. A state and its mirror image at the plane x = 0 have the same.

    Notes
    -----
    Doppler shifts at the ring are functions of the first five; `dopplerlib.derive.ring_coordinates`
    has the proof. They are to a ring what modified polar coordinates are to bearings (Aidala and
    Hammel 1983).

    Examples
    --------
    The states of a family that looks alike differ in the last coordinate only:

    >>> from dopplerlib import ring_family
    >>> states = ring_family([0.8, 0.1, 0.1, -0.7, 0, 0], 0.2, [1, 1.5])
    >>> to_ring_coordinates(states, 0.2).round(2)[:, [0, 1, 4, 5]].tolist()
    [[0.14, 0.14, -0.67, -0.18], [0.14, 0.14, -0.67, 0.23]]
    """
    x = _checks.moderate("x", x, (6,))
    *seen, rho = kernel.to_coordinates(*np.moveaxis(x, -1, 0), r=radius)
    return _checks.estimates("x, radius", np.stack([*seen, np.log(rho)], axis=-1))


@checked
@_checks.quiet
def from_ring_coordinates(xi: ArrayLike, radius: Positive) -> FloatArray:
    """Return states, with x >= 0, from ring coordinates.

    Parameters
    ----------
    xi : array_like, shape (..., 6)
        Ring coordinates, see `to_ring_coordinates`.
    radius : float
        Radius of the ring in m.

    Returns
    -------
    ndarray, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] in m and m/s.

    Raises
    ------
    ValueError
        If no state in front of the ring has such coordinates: rho is too small or too large for
        the first two.

    Examples
    --------
    >>> x = [0.8, 0.1, 0.1, -0.7, 0, 0]
    >>> from_ring_coordinates(to_ring_coordinates(x, 0.2), 0.2).round(12).tolist()
    [0.8, 0.1, 0.1, -0.7, 0.0, 0.0]
    """
    xi = _checks.moderate("xi", xi, (6,))
    *seen, scale = np.moveaxis(xi, -1, 0)
    state = np.stack(kernel.to_state(*seen, rho=np.exp(scale), r=radius)[:6], axis=-1)
    if not np.isfinite(state).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(state))[0][:-1])
        raise ValueError(
            "xi must belong to a state in front of the ring, x^2 = rho^2 - r^2 - y^2 - z^2 > 0, "
            f"got {xi[place].tolist()} with radius {radius}"
        )
    return state
