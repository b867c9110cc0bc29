"""How a target moves between two samples."""

import numpy as np

from .. import _checks


def constant_velocity(T, sigma_p, noise="common"):
    """Return the transition matrix and process-noise covariance of the constant-velocity model.

    Parameters
    ----------
    T : float
        Sampling interval in s.
    sigma_p : float
        Standard deviation of the acceleration, constant during one interval, in m/s^2.
    noise : {"common", "independent"}
        "common": one scalar acceleration drives all three axes at once, along (1, 1, 1); Q has
        rank one. This is Eq 17 as printed. "independent": each axis has an acceleration of its
        own; Q has rank three.

    Returns
    -------
    F : ndarray, shape (6, 6)
        Transition matrix, Eq 4.
    Q : ndarray, shape (6, 6)
        Covariance of the process noise of one interval.

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
    T = _checks.one_number("T", T, _checks.deviation)
    sigma_p = _checks.one_number("sigma_p", sigma_p, _checks.deviation)
    _checks.one_of("noise", noise, ("common", "independent"))
    eye = np.eye(3)
    F = np.eye(6)
    F[:3, 3:] = T * eye
    axes = np.ones((3, 1)) if noise == "common" else eye
    G = np.vstack([T**2 / 2 * axes, T * axes])
    with np.errstate(over="ignore", invalid="ignore"):
        Q = sigma_p**2 * (G @ G.T)
    if not np.isfinite(Q).all():
        raise ValueError(f"T must give a finite Q with sigma_p = {sigma_p}, got {T}")
    return F, Q
