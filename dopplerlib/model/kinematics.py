"""Targets that nearly keep a velocity or an acceleration, in any number of dimensions."""

from math import factorial
from typing import Literal

import numpy as np

from .. import _checks
from .._typing import FloatArray

ORDERS = ("axis", "derivative")


def ncv_transition(
    T: float, dim: int = 2, order: Literal["axis", "derivative"] = "axis"
) -> FloatArray:
    """Return the transition matrix of constant velocity.

    Parameters
    ----------
    T : float
        Sampling interval in s; zero for two measurements at one time, which gives the identity.
    dim : int
        Number of axes.
    order : {"axis", "derivative"}
        Order of the state. "axis": [x, v_x, y, v_y, ...]; "derivative": [x, y, ..., v_x, v_y, ...].

    Returns
    -------
    ndarray, shape (2 dim, 2 dim)

    Raises
    ------
    ValueError
        If `T` is negative or beyond 1e60, `dim` is not positive, or `order` is not one of the two.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 6.2.2. "Nearly constant" becomes true with the process
    noise of `wna_process_noise`.

    Examples
    --------
    >>> ncv_transition(0.5, dim=2)[:2].tolist()
    [[1.0, 0.5, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]
    >>> ncv_transition(0.5, dim=2, order="derivative")[0].tolist()
    [1.0, 0.0, 0.5, 0.0]
    """
    return _all_axes(_integrators(_interval(T), 2), dim, order)


def nca_transition(
    T: float, dim: int = 2, order: Literal["axis", "derivative"] = "axis"
) -> FloatArray:
    """Return the transition matrix of constant acceleration.

    Parameters
    ----------
    T : float
        Sampling interval in s; zero for two measurements at one time, which gives the identity.
    dim : int
        Number of axes.
    order : {"axis", "derivative"}
        Order of the state. "axis": [x, v_x, a_x, y, ...]; "derivative": [x, y, ..., a_x, a_y, ...].

    Returns
    -------
    ndarray, shape (3 dim, 3 dim)

    Raises
    ------
    ValueError
        If `T` is negative or beyond 1e60, `dim` is not positive, or `order` is not one of the two.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 6.2.3.

    Examples
    --------
    >>> nca_transition(2.0, dim=1).tolist()
    [[1.0, 2.0, 2.0], [0.0, 1.0, 2.0], [0.0, 0.0, 1.0]]
    """
    return _all_axes(_integrators(_interval(T), 3), dim, order)


def wna_process_noise(
    T: float, q: float, dim: int = 2, order: Literal["axis", "derivative"] = "axis"
) -> FloatArray:
    """Return the process noise of white-noise acceleration over one interval.

    Parameters
    ----------
    T : float
        Sampling interval in s; over none there is no noise.
    q : float
        Spectral density of the acceleration in m^2/s^3: over a second the velocity wanders by
        sqrt(q) m/s, whatever the sampling interval.
    dim, order
        See `ncv_transition`.

    Returns
    -------
    ndarray, shape (2 dim, 2 dim)

    Raises
    ------
    ValueError
        If `T` is negative or beyond 1e60, `q` or `dim` is not positive, or `order` is not one of
        the two.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Eq 6.2.2-12.

    Examples
    --------
    >>> wna_process_noise(3.0, 2.0, dim=1).tolist()
    [[18.0, 9.0], [9.0, 6.0]]
    """
    return _white_noise(T, q, 2, dim, order)


def wnj_process_noise(
    T: float, q: float, dim: int = 2, order: Literal["axis", "derivative"] = "axis"
) -> FloatArray:
    """Return the process noise of white-noise jerk over one interval.

    Parameters
    ----------
    T : float
        Sampling interval in s; over none there is no noise.
    q : float
        Spectral density of the jerk in m^2/s^5.
    dim, order
        See `nca_transition`.

    Returns
    -------
    ndarray, shape (3 dim, 3 dim)

    Raises
    ------
    ValueError
        If `T` is negative or beyond 1e60, `q` or `dim` is not positive, or `order` is not one of
        the two.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Eq 6.2.3-9.

    Examples
    --------
    >>> wnj_process_noise(1.0, 60.0, dim=1).tolist()
    [[3.0, 7.5, 10.0], [7.5, 20.0, 30.0], [10.0, 30.0, 60.0]]
    """
    return _white_noise(T, q, 3, dim, order)


def velocity_step_noise(
    w: float, dim: int = 2, order: Literal["axis", "derivative"] = "axis"
) -> FloatArray:
    """Return a process noise that acts on the velocities alone, once a step.

    Parameters
    ----------
    w : float
        Standard deviation of the velocity step in m/s.
    dim, order
        See `ncv_transition`.

    Returns
    -------
    ndarray, shape (2 dim, 2 dim)
        Diagonal, of rank `dim`.

    Raises
    ------
    ValueError
        If `w` or `dim` is not positive, or `order` is not one of the two.

    Notes
    -----
    Macaveiu et al. (2013), Eq 3. It belongs to one sampling interval: with another one, the same
    `w` stands for another target.

    Examples
    --------
    >>> np.diag(velocity_step_noise(0.5, dim=2)).tolist()
    [0.0, 0.25, 0.0, 0.25]
    """
    w = _checks.one_number("w", w, _checks.deviation)
    return _all_axes(np.diag([0.0, w * w]), dim, order)


def _interval(T):
    T = _checks.one_number("T", T, _checks.moderate)
    if T < 0:
        raise ValueError(f"T must not be negative, got {T}")
    return T


def _integrators(T, n):
    """Return the transition of `n` integrators in a row: T^(j - i) / (j - i)!."""
    F = np.eye(n)
    for i in range(n):
        for j in range(i + 1, n):
            F[i, j] = T ** (j - i) / factorial(j - i)
    return F


def _white_noise(T, q, n, dim, order):
    """Return the covariance that white noise of density `q` leaves behind `n` integrators."""
    T = _interval(T)
    q = _checks.positive_number("q", q)
    Q = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            # The product of T^a / a! and T^b / b!, integrated over the interval.
            a, b = n - 1 - i, n - 1 - j
            Q[i, j] = q * T ** (a + b + 1) / ((a + b + 1) * factorial(a) * factorial(b))
    _checks.estimates("T, q", Q, what="process noise")
    return _all_axes(Q, dim, order)


def _all_axes(block, dim, order):
    dim = _checks.count("dim", dim, 1000)
    if _checks.one_of("order", order, ORDERS) == "axis":
        return np.kron(np.eye(dim), block)
    return np.kron(block, np.eye(dim))
