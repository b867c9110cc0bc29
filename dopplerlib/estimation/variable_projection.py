"""Variable projection: the velocity given the position is a linear least-squares problem."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from ..model.doppler import doppler_jacobian
from ..model.radar_array import RadarArray


@checked
@_checks.quiet
def velocity_given_position(
    z: ArrayLike, array: RadarArray, sigma_f: ArrayLike, p: ArrayLike, in_plane: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return the weighted least-squares velocity from Doppler shifts at a known position.

    Parameters
    ----------
    z : array_like, shape (N,)
        Doppler shifts in Hz, one sample or the mean of several.
    array : RadarArray
        The N sensors.
    sigma_f : array_like, broadcast to (N,)
        Standard deviation of the shifts in Hz.
    p : array_like, shape (..., 3)
        Positions in m.
    in_plane : bool
        Whether v_z is known to be zero.

    Returns
    -------
    v : ndarray, shape (..., 3)
        Velocities in m/s; the shortest one where several are equally good.
    cost : ndarray, shape (...)
        Remaining misfit: the sum of the squared residuals over their variances.

    Notes
    -----
    The Doppler shift is linear in the velocity, h = A(p) v, where the rows of A are the unit
    vectors towards the sensors times 2 / wavelength. So v is a linear least-squares estimate, and
    the cost a function of position only: variable projection, Golub and Pereyra (1973).

    Examples
    --------
    >>> from dopplerlib import doppler_shift
    >>> array = RadarArray.ring(6, 0.2)
    >>> z = doppler_shift([0.8, 0.1, 0.1, -0.7, 0, 0.2], array)
    >>> v, cost = velocity_given_position(z, array, 0.4, [0.8, 0.1, 0.1])
    >>> (v.round(6) + 0.0).tolist(), bool(cost < 1e-9)
    ([-0.7, 0.0, 0.2], True)
    """
    z = _checks.finite("z", z, (len(array),))
    if z.ndim != 1:
        raise ValueError(f"z must be one sample, got an array of shape {z.shape}")
    sigma_f = _checks.each_run("sigma_f", _checks.deviation("sigma_f", sigma_f), (len(array),), ())
    p = _checks.moderate("p", p, (3,))
    A = doppler_jacobian(np.concatenate([p, 0 * p], axis=-1), array)[..., 3:] / sigma_f[:, None]
    A[..., 2] *= not _checks.one_boolean("in_plane", in_plane)
    y = z / sigma_f
    # A direction that no sensor sees leaves a singular value of 1e-16.
    v = np.linalg.pinv(A, rcond=1e-12) @ y
    cost = np.sum((y - np.einsum("...ni,...i->...n", A, v)) ** 2, axis=-1)
    return _checks.estimates("z, sigma_f, p", v, cost)
