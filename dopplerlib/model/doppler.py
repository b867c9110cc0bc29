"""Doppler shifts at all sensors of an array, and their Jacobian."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from ..kernels import doppler as kernel
from .radar_array import RadarArray


@checked
def doppler_shift(x: ArrayLike, array: RadarArray) -> FloatArray:
    """Return the Doppler shift at every sensor of an array.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] in m and m/s, not on a sensor.
    array : RadarArray
        The N sensors.

    Returns
    -------
    ndarray, shape (..., N)
        Doppler shifts in Hz, positive when target and sensor approach each other.

    Notes
    -----
    Mittermaier et al. (2016), Eq 6, printed by `dopplerlib.derive`.

    Examples
    --------
    One meter away and approaching at 1 m/s:

    >>> from dopplerlib import RadarArray
    >>> float(doppler_shift([1, 0, 0, -1, 0, 0], RadarArray([[0, 0, 0]]))[0])
    160.0
    """
    shift = kernel.doppler_shift(*_arguments(x, array))
    return _checks.estimates("x, array", shift, what="shifts")


@checked
def doppler_jacobian(x: ArrayLike, array: RadarArray) -> FloatArray:
    """Return the Jacobian of the Doppler shifts with respect to the state.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] in m and m/s, not on a sensor.
    array : RadarArray
        The N sensors.

    Returns
    -------
    ndarray, shape (..., N, 6)
        Columns 0 to 2 in Hz per m, columns 3 to 5 in Hz per m/s.

    Notes
    -----
    Mittermaier et al. (2016), Eq 7, printed by `dopplerlib.derive`.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> doppler_jacobian([1, 0, 0, -1, 0, 0], RadarArray([[0, 0, 0]])).tolist()
    [[0.0, 0.0, 0.0, -160.0, 0.0, 0.0]]
    """
    arguments = _arguments(x, array)
    with np.errstate(all="ignore"):
        _, *gradient = kernel.doppler_shift_and_gradient(*arguments)
    gradient = np.stack(gradient, axis=-1)
    return _checks.estimates("x, array", gradient, what="derivatives")


def check_clear_of_sensors(name: str, x: FloatArray, array: RadarArray) -> None:
    """Raise if a position in `x`, shape (..., 6), is that of a sensor. `x` itself is unchecked."""
    d = x[..., None, :3] - array.positions
    # Not a comparison for equality: the square of less than 1e-162 m is zero as well.
    squared_range = np.einsum("...i,...i->...", d, d)
    if not squared_range.all():
        n = int(np.argwhere(squared_range == 0)[0, -1])
        raise ValueError(
            f"{name} must not lie on a sensor, got a position equal to that of sensor {n}, "
            f"{array.positions[n].tolist()}"
        )


def _arguments(x, array):
    x = _checks.moderate("x", x, (6,))
    check_clear_of_sensors("x", x, array)
    return *np.moveaxis(x[..., None, :], -1, 0), *array.positions.T, array.doppler_per_speed
