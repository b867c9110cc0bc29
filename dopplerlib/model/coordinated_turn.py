"""Coordinated turn in the plane, at a nearly constant turn rate, and its Jacobian."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray


@checked
@_checks.quiet
def coordinated_turn(x: ArrayLike, T: float) -> FloatArray:
    """Return states after an interval of constant speed and turn rate.

    Parameters
    ----------
    x : array_like, shape (..., 5)
        States [x, y, v_x, v_y, omega] in m, m/s and rad/s; a positive rate turns from x to y.
    T : float
        Interval in s, zero or more.

    Returns
    -------
    ndarray, shape (..., 5)

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 11.7.1. The motion `f` of `ukf` and `ekf_records`, with
    `coordinated_turn_jacobian` as `F`. It holds at a rate of zero as well: a straight line.

    Examples
    --------
    A quarter of a circle of radius 1 m in one second:

    >>> rate = np.pi / 2
    >>> coordinated_turn([1.0, 0.0, 0.0, rate, rate], 1.0).round(12).tolist()[:2]
    [0.0, 1.0]
    """
    x, T, a, b, c, s = _turned(x, T)
    px, py, vx, vy, rate = np.moveaxis(x, -1, 0)
    after = px + a * vx - b * vy, py + b * vx + a * vy, c * vx - s * vy, s * vx + c * vy, rate
    return np.stack(after, axis=-1)


@checked
@_checks.quiet
def coordinated_turn_jacobian(x: ArrayLike, T: float) -> FloatArray:
    """Return the Jacobian of `coordinated_turn` with respect to the state.

    Parameters
    ----------
    x : array_like, shape (..., 5)
        States before the interval.
    T : float
        Interval in s, zero or more.

    Returns
    -------
    ndarray, shape (..., 5, 5)

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 11.7.2. At small rates the derivative of
    sin(omega T) / omega is a series, where its closed form would lose digits.

    Examples
    --------
    On a straight line, a turn rate moves the target sideways by v T^2 / 2:

    >>> coordinated_turn_jacobian([0.0, 0.0, 3.0, 0.0, 0.0], 2.0)[1, 4].item()
    6.0
    """
    x, T, a, b, c, s = _turned(x, T)
    vx, vy, angle = x[..., 2], x[..., 3], x[..., 4] * T
    da = T**2 * _sinc_slope(angle)
    db = T**2 * (np.sinc(angle / np.pi) - np.sinc(angle / (2 * np.pi)) ** 2 / 2)
    F = np.zeros((*x.shape, 5))
    F[..., range(5), range(5)] = 1.0
    F[..., 0, 2], F[..., 0, 3], F[..., 1, 2], F[..., 1, 3] = a, -b, b, a
    F[..., 2, 2], F[..., 2, 3], F[..., 3, 2], F[..., 3, 3] = c, -s, s, c
    F[..., 0, 4], F[..., 1, 4] = da * vx - db * vy, db * vx + da * vy
    F[..., 2, 4], F[..., 3, 4] = -T * (s * vx + c * vy), T * (c * vx - s * vy)
    return F


def _turned(x, T):
    """Return x, T, sin(w T) / w, (1 - cos(w T)) / w, cos(w T) and sin(w T) of checked arguments."""
    x = _checks.moderate("x", x, (5,))
    T = _checks.one_number("T", T, _checks.moderate)
    if T < 0:
        raise ValueError(f"T must not be negative, got {T}")
    angle = x[..., 4] * T
    half = np.sinc(angle / (2 * np.pi))  # NumPy's sinc is sin(pi u) / (pi u)
    a, b = T * np.sinc(angle / np.pi), T * np.sin(angle / 2) * half
    return x, T, a, b, np.cos(angle), np.sin(angle)


def _sinc_slope(u):
    """Return the derivative of sin(u) / u."""
    series = 1.0
    for factor in (88, 54, 28, 10):  # 2 k (2 k + 3); the next term is below rounding
        series = 1 - u**2 / factor * series
    small = np.abs(u) < 0.2
    far = np.where(small, 1.0, u)
    return np.where(small, -u / 3 * series, (np.cos(far) - np.sin(far) / far) / far)
