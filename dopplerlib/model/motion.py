"""How a target moves between two samples."""

from typing import Literal

import numpy as np

from .. import _checks
from .._typing import ArrayLike, FloatArray

# The axes that each acceleration drives.
_AXES = {"common": np.ones((3, 1)), "independent": np.eye(3)}


@_checks.quiet
def constant_velocity(
    T: ArrayLike, sigma_p: float, noise: Literal["common", "independent"] = "common"
) -> tuple[FloatArray, FloatArray]:
    """Return the transition matrix and process-noise covariance of the constant-velocity model.

    Parameters
    ----------
    T : array_like, shape (...)
        Sampling intervals in s.
    sigma_p : float
        Standard deviation of the acceleration, constant during one interval, in m/s^2.
    noise : {"common", "independent"}
        "common": one scalar acceleration drives all three axes at once, along (1, 1, 1); Q has
        rank one. This is Eq 17 as printed. "independent": each axis has an acceleration of its
        own; Q has rank three.

    Returns
    -------
    F : ndarray, shape (..., 6, 6)
        Transition matrix of each interval, Eq 4.
    Q : ndarray, shape (..., 6, 6)
        Covariance of the process noise of each interval.

    Raises
    ------
    ValueError
        If `T` or `sigma_p` is not finite and positive, or `noise` is not one of the two.

    Notes
    -----
    Mittermaier et al. (2016), Eqs 4, 9 and 17.

    Examples
    --------
    >>> F, Q = constant_velocity(0.001, 0.4)
    >>> _, Q3 = constant_velocity(0.001, 0.4, noise="independent")
    >>> int(np.linalg.matrix_rank(Q)), int(np.linalg.matrix_rank(Q3))
    (1, 3)
    """
    T = _checks.deviation("T", T)
    G, sigma_p = acceleration_gain(T, sigma_p, noise)
    F = np.eye(6) + T[..., None, None] * np.eye(6, k=3)
    return F, sigma_p**2 * (G @ np.swapaxes(G, -1, -2))


def acceleration_gain(
    T: FloatArray, sigma_p: float, noise: Literal["common", "independent"]
) -> tuple[FloatArray, float]:
    """Return G of shape (..., 6, 1) or (..., 6, 3), and sigma_p as a float (Eq 9).

    Raises ValueError unless sigma_p and noise are those of `constant_velocity`, and sigma_p^2 G G',
    which is Q, is finite. `T` itself is unchecked.
    """
    sigma_p = _checks.one_number("sigma_p", sigma_p, _checks.deviation)
    axes = _AXES[_checks.one_of("noise", noise, tuple(_AXES))]
    interval = T[..., None, None]
    G = np.concatenate([interval * interval / 2 * axes, interval * axes], axis=-2)
    largest = float(G.max(initial=0.0))
    if not sigma_p * sigma_p * (largest * largest) < np.inf:
        raise ValueError(f"T must give a finite Q with sigma_p = {sigma_p}, got {T.max()}")
    return G, sigma_p
