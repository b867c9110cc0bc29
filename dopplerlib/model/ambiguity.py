"""The family of states that a ring of sensors cannot distinguish."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray


@checked
def ring_family(x: ArrayLike, radius: float, t: ArrayLike) -> FloatArray:
    """Return states with equal Doppler shifts at every sensor of a ring.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] in m and m/s, with x not zero.
    radius : float
        Radius in m of the ring: a circle about the origin in the plane x = 0.
    t : array_like, shape (...)
        Place in the family, between the limits of `ring_family_limits`; 1 is `x` itself.

    Returns
    -------
    ndarray, shape (..., 6)
        States on the same side of the ring.

    Notes
    -----
    The square of p plus that of the radius, y and z are multiplied by t^2; p.v, v_y and v_z by t.
    `dopplerlib.derive.ring` has the proof.

    Examples
    --------
    >>> from dopplerlib import RadarArray, doppler_shift
    >>> states = ring_family([0.8, 0.1, 0.1, -0.7, 0, 0], 0.2, [0.5, 1, 2])
    >>> doppler_shift(states, RadarArray.ring(4, 0.2)).round(3).tolist()[0::2]
    [[110.29, 110.29, 104.158, 104.158], [110.29, 110.29, 104.158, 104.158]]
    """
    x, radius = _state(x, radius)
    t = _checks.positive("t", t)
    _checks.check_broadcast("t", t.shape, "x", x.shape[:-1])
    low, high = ring_family_limits(x, radius)
    if not ((t > low) & (t < high)).all():
        raise ValueError(f"t must lie between the limits {low} and {high} of the family, got {t}")
    p, v = x[..., :3], x[..., 3:]
    across = t[..., None] ** 2 * p[..., 1:]
    across_v = t[..., None] * v[..., 1:]
    _checks.estimates("x, radius, t", t**4 * np.sum(p * p, axis=-1), what="states")
    square = t**2 * (np.sum(p * p, axis=-1) + radius**2) - radius**2 - np.sum(across**2, axis=-1)
    ahead = np.copysign(np.sqrt(square), p[..., 0])
    ahead_v = (t * np.sum(p * v, axis=-1) - np.sum(across * across_v, axis=-1)) / ahead
    return np.concatenate([ahead[..., None], across, ahead_v[..., None], across_v], axis=-1)


@checked
def ring_family_limits(x: ArrayLike, radius: float) -> tuple[FloatArray, FloatArray]:
    """Return the limits of the parameter of `ring_family`, at which it meets the plane of the ring.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States in m and m/s, with x not zero.
    radius : float
        Radius of the ring in m.

    Returns
    -------
    low, high : ndarray, shape (...)
        Limits of t; `high` is infinite for a target on the axis of the ring.

    Notes
    -----
    With the radius r, the ends are where t^2 (x^2 + y^2 + z^2 + r^2) - r^2 - t^4 (y^2 + z^2), which
    is the square of the first component along the family, is zero.

    Examples
    --------
    >>> low, high = ring_family_limits([0.8, 0.1, 0.1, -0.7, 0, 0], 0.2)
    >>> round(float(low), 3), round(float(high), 3)
    (0.239, 5.911)
    """
    x, radius = _state(x, radius)
    A = np.sum(x[..., :3] ** 2, axis=-1) + radius**2
    across = np.sum(x[..., 1:3] ** 2, axis=-1)
    # Roots of across u^2 - A u + r^2 for u = t^2, in the form that does not cancel.
    larger = A + np.sqrt(np.maximum(A * A - 4 * across * radius**2, 0.0))
    with np.errstate(divide="ignore", over="ignore"):
        return np.sqrt(2 * radius**2 / larger), np.sqrt(larger / (2 * across))


@checked
def ring_family_direction(x: ArrayLike, radius: float) -> FloatArray:
    """Return the unobservable direction of a ring: the derivative of `ring_family` at t = 1.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States in m and m/s, with x not zero.
    radius : float
        Radius of the ring in m.

    Returns
    -------
    ndarray, shape (..., 6)
        In m and m/s; not of unit length.

    Notes
    -----
    The Doppler Jacobian of every ring of this radius times this vector is zero;
    `dopplerlib.derive.ring` has the proof.

    Examples
    --------
    >>> from dopplerlib import RadarArray, doppler_jacobian
    >>> x = [0.8, 0.1, 0.1, -0.7, 0, 0]
    >>> H = doppler_jacobian(x, RadarArray.ring(6, 0.2))
    >>> bool((abs(H @ ring_family_direction(x, 0.2)) < 1e-10).all())
    True
    """
    x, radius = _state(x, radius)
    p, v = x[..., :3], x[..., 3:]
    A = np.sum(p * p, axis=-1) + radius**2
    across = np.sum(p[..., 1:] ** 2, axis=-1)
    # From x v_x = p.v - y v_y - z v_z, whose two parts grow like t and t^3.
    turning = np.sum(p * v, axis=-1) - 3 * np.sum(p[..., 1:] * v[..., 1:], axis=-1)
    with np.errstate(all="ignore"):
        ahead = (A - 2 * across) / p[..., 0]
        ahead_v = (turning - ahead * v[..., 0]) / p[..., 0]
    _checks.estimates("x, radius", ahead, ahead_v, what="direction")
    return np.concatenate(
        [ahead[..., None], 2 * p[..., 1:], ahead_v[..., None], v[..., 1:]], axis=-1
    )


def _state(x, radius):
    x = _checks.moderate("x", x, (6,))
    if not (x[..., 0] != 0).all():
        raise ValueError("x must not lie in the plane of the ring, got x = 0")
    return x, _checks.moderate_number("radius", radius)
