"""Motion of a target: transition matrices and process noise, in any number of dimensions.

Nearly constant velocity (ncv) and acceleration (nca), driven by discrete white noise acceleration
(dwna: constant during an interval) or by white noise in continuous time (cwna, cwnj).
"""

from math import factorial
from typing import Literal

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray

# The axes that each acceleration drives.
_AXES = {"shared": np.ones((3, 1)), "per_axis": np.eye(3), "horizontal": np.eye(3)[:, :2]}


@checked
@_checks.quiet
def constant_velocity(
    T: ArrayLike, sigma_a: float, noise: Literal["shared", "per_axis", "horizontal"] = "shared"
) -> tuple[FloatArray, FloatArray]:
    """Return the transition matrix and process-noise covariance of the constant-velocity model.

    Parameters
    ----------
    T : array_like, shape (...)
        Sampling intervals in s.
    sigma_a : float
        Standard deviation of the acceleration, constant during one interval, in m/s^2.
    noise : {"shared", "per_axis", "horizontal"}
        "shared": one scalar acceleration drives all three axes at once, along (1, 1, 1); Q has
        rank one. This is Eq 17 as published. "per_axis": each axis has an acceleration of its
        own; Q has rank three. "horizontal": x and y have, and z moves uniformly; rank two.

    Returns
    -------
    F : ndarray, shape (..., 6, 6)
        Transition matrix of each interval, Eq 4.
    Q : ndarray, shape (..., 6, 6)
        Covariance of the process noise of each interval.

    Notes
    -----
    Mittermaier et al. (2016), Eqs 4, 9 and 17.

    Examples
    --------
    >>> F, Q = constant_velocity(0.001, 0.4)
    >>> _, Q3 = constant_velocity(0.001, 0.4, noise="per_axis")
    >>> int(np.linalg.matrix_rank(Q)), int(np.linalg.matrix_rank(Q3))
    (1, 3)
    """
    T = _checks.deviation("T", T)
    G, sigma_a = dwna_gain(T, sigma_a, noise)
    F = np.eye(6) + T[..., None, None] * np.eye(6, k=3)
    return F, sigma_a**2 * (G @ np.swapaxes(G, -1, -2))


def dwna_gain(
    T: FloatArray, sigma_a: float, noise: Literal["shared", "per_axis", "horizontal"]
) -> tuple[FloatArray, float]:
    """Return G of shape (..., 6, 1), (..., 6, 3) or (..., 6, 2), and sigma_a as a float (Eq 9).

    Raises ValueError unless sigma_a and noise are those of `constant_velocity`, and sigma_a^2 G G',
    which is Q, is finite. `T` itself is unchecked.
    """
    sigma_a = _checks.one_number("sigma_a", sigma_a, _checks.deviation)
    axes = _AXES[_checks.one_of("noise", noise, tuple(_AXES))]
    interval = T[..., None, None]
    G = np.concatenate([interval * interval / 2 * axes, interval * axes], axis=-2)
    largest = float(G.max(initial=0.0))
    if not sigma_a * sigma_a * (largest * largest) < np.inf:
        raise ValueError(f"T must give a finite Q with sigma_a = {sigma_a}, got {T.max()}")
    return G, sigma_a


@checked
def ncv_transition(
    T: ArrayLike, dim: int = 2, order: Literal["axis", "derivative"] = "axis"
) -> FloatArray:
    """Return the transition matrix of constant velocity.

    Parameters
    ----------
    T : array_like, shape (...)
        Sampling intervals in s; zero for two measurements at one time, which gives the identity.
    dim : int
        Number of axes.
    order : {"axis", "derivative"}
        Order of the state. "axis": [x, v_x, y, v_y, ...]; "derivative": [x, y, ..., v_x, v_y, ...].

    Returns
    -------
    ndarray, shape (..., 2 dim, 2 dim)

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 6.2.2. "Nearly constant" becomes true with the process
    noise of `cwna_process_noise`.

    Examples
    --------
    >>> ncv_transition(0.5, dim=2)[:2].tolist()
    [[1.0, 0.5, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]
    >>> ncv_transition(0.5, dim=2, order="derivative")[0].tolist()
    [1.0, 0.0, 0.5, 0.0]
    """
    return _all_axes(_integrators(_interval(T), 2), dim, order)


@checked
def nca_transition(
    T: ArrayLike, dim: int = 2, order: Literal["axis", "derivative"] = "axis"
) -> FloatArray:
    """Return the transition matrix of constant acceleration.

    Parameters
    ----------
    T : array_like, shape (...)
        Sampling intervals in s; zero for two measurements at one time, which gives the identity.
    dim : int
        Number of axes.
    order : {"axis", "derivative"}
        Order of the state. "axis": [x, v_x, a_x, y, ...]; "derivative": [x, y, ..., a_x, a_y, ...].

    Returns
    -------
    ndarray, shape (..., 3 dim, 3 dim)

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 6.2.3.

    Examples
    --------
    >>> nca_transition(2.0, dim=1).tolist()
    [[1.0, 2.0, 2.0], [0.0, 1.0, 2.0], [0.0, 0.0, 1.0]]
    """
    return _all_axes(_integrators(_interval(T), 3), dim, order)


@checked
def cwna_process_noise(
    T: ArrayLike, q: float, dim: int = 2, order: Literal["axis", "derivative"] = "axis"
) -> FloatArray:
    """Return the process noise of white-noise acceleration over one interval.

    Parameters
    ----------
    T : array_like, shape (...)
        Sampling intervals in s; over none there is no noise.
    q : float
        Spectral density of the acceleration in m^2/s^3: over a second the velocity wanders by
        sqrt(q) m/s, whatever the sampling interval.
    dim, order
        See `ncv_transition`.

    Returns
    -------
    ndarray, shape (..., 2 dim, 2 dim)

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Eq 6.2.2-12.

    Examples
    --------
    >>> cwna_process_noise(3.0, 2.0, dim=1).tolist()
    [[18.0, 9.0], [9.0, 6.0]]
    """
    return _white_noise(T, q, 2, dim, order)


@checked
def cwnj_process_noise(
    T: ArrayLike, q: float, dim: int = 2, order: Literal["axis", "derivative"] = "axis"
) -> FloatArray:
    """Return the process noise of white-noise jerk over one interval.

    Parameters
    ----------
    T : array_like, shape (...)
        Sampling intervals in s; over none there is no noise.
    q : float
        Spectral density of the jerk in m^2/s^5.
    dim, order
        See `nca_transition`.

    Returns
    -------
    ndarray, shape (..., 3 dim, 3 dim)

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Eq 6.2.3-9.

    Examples
    --------
    >>> cwnj_process_noise(1.0, 60.0, dim=1).tolist()
    [[3.0, 7.5, 10.0], [7.5, 20.0, 30.0], [10.0, 30.0, 60.0]]
    """
    return _white_noise(T, q, 3, dim, order)


def _interval(T):
    """Return an interval as a float, or intervals (...) as an array."""
    T = _checks.moderate("T", T)
    if not (T >= 0).all():
        raise ValueError(f"T must not be negative, got {T.min()}")
    return T if T.ndim else float(T)


def _integrators(T, n):
    """Return the transition of `n` integrators in a row: T^(j - i) / (j - i)!."""
    F = np.broadcast_to(np.eye(n), (*np.shape(T), n, n)).copy()
    for i in range(n):
        for j in range(i + 1, n):
            F[..., i, j] = T ** (j - i) / factorial(j - i)
    return F


def _white_noise(T, q, n, dim, order):
    """Return the covariance that white noise of density `q` leaves behind `n` integrators."""
    T = _interval(T)
    q = _checks.positive_number("q", q)
    Q = np.empty((*np.shape(T), n, n))
    for i in range(n):
        for j in range(n):
            # The product of T^a / a! and T^b / b!, integrated over the interval.
            a, b = n - 1 - i, n - 1 - j
            Q[..., i, j] = q * T ** (a + b + 1) / ((a + b + 1) * factorial(a) * factorial(b))
    _checks.estimates("T, q", Q, what="process noise")
    return _all_axes(Q, dim, order)


def _all_axes(block, dim, order):
    dim = _checks.count("dim", dim, 1000)
    axes = np.eye(dim)
    subscripts = "ij,...ab->...iajb" if order == "axis" else "ij,...ab->...aibj"
    size = dim * block.shape[-1]
    return np.einsum(subscripts, axes, block).reshape(*block.shape[:-2], size, size)
