"""Doppler shifts at all sensors of an array, and their Jacobian."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from ..kernels import doppler as kernel
from ..kernels import links as moving
from .links import DopplerLinks, state_size
from .radar_array import RadarArray


@checked
def doppler_shift(x: ArrayLike, array: RadarArray | DopplerLinks) -> FloatArray:
    """Return the Doppler shift at every sensor of an array, or of every link.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] in m and m/s, not on a sensor. For links shape (..., n),
        with the offsets of their clocks; for links with times (..., K, n), a state for each.
    array : RadarArray or DopplerLinks
        The N sensors or links.

    Returns
    -------
    ndarray, shape (..., N)
        Doppler shifts in Hz, positive when target and sensor approach each other; for links the
        frequencies measured, with bias and offsets.

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
    x = _state(x, array)
    if isinstance(array, RadarArray):
        shift = kernel.doppler_shift(*_arguments(x, array)[0])
    else:
        shift = sum(moving.leg_shift(*leg) for leg in _arguments(x, array))
        offsets = x[..., 6 : 6 + array.clocks.shape[1]]
        shift = shift + array.bias + offsets @ array.clocks.T
    return _checks.estimates("x, array", shift, what="shifts")


@checked
def doppler_jacobian(x: ArrayLike, array: RadarArray | DopplerLinks) -> FloatArray:
    """Return the Jacobian of the Doppler shifts with respect to the state.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States, see `doppler_shift`.
    array : RadarArray or DopplerLinks
        The N sensors or links.

    Returns
    -------
    ndarray, shape (..., N, 6)
        Columns 0 to 2 in Hz per m, columns 3 to 5 in Hz per m/s. For links (..., N, n), and the
        columns of their clocks are numbers; rates of clocks act through the transition only.

    Notes
    -----
    Mittermaier et al. (2016), Eq 7, printed by `dopplerlib.derive`.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> doppler_jacobian([1, 0, 0, -1, 0, 0], RadarArray([[0, 0, 0]])).tolist()
    [[0.0, 0.0, 0.0, -160.0, 0.0, 0.0]]
    """
    x = _state(x, array)
    with np.errstate(all="ignore"):
        if isinstance(array, RadarArray):
            _, *gradient = kernel.doppler_shift_and_gradient(*_arguments(x, array)[0])
            H = _stacked(gradient)
        else:
            legs = (moving.leg_shift_and_gradient(*leg) for leg in _arguments(x, array))
            target = sum(_stacked(gradient) for _, *gradient in legs)
            H = np.zeros((*target.shape[:-1], array.n))
            H[..., :6] = target
            H[..., 6 : 6 + array.clocks.shape[1]] = array.clocks
    return _checks.estimates("x, array", H, what="derivatives")


def check_clear_of_sensors(name: str, x: FloatArray, array: RadarArray | DopplerLinks) -> None:
    """Raise if a position in `x`, shape (..., 6), is that of a sensor. `x` itself is unchecked."""
    ends = [array.positions] if isinstance(array, RadarArray) else [end for end, _ in array.legs]
    for end in ends:
        d = x[..., None, :3] - end[..., :3]
        # Not a comparison for equality: the square of less than 1e-162 m is zero as well.
        squared_range = np.einsum("...i,...i->...", d, d)
        if not squared_range.all():
            place = tuple(np.argwhere(squared_range == 0)[0])
            raise ValueError(
                f"{name} must not lie on a sensor, got a position equal to that of sensor "
                f"{place[-1]}, {np.broadcast_to(end[..., :3], d.shape)[place].tolist()}"
            )


def _state(x, array):
    n = state_size(array)
    x = _checks.moderate("x", x, (n,))
    if isinstance(array, DopplerLinks) and array.times is not None:
        K = len(array.times)
        if x.ndim < 2 or x.shape[-2] not in (1, K):
            raise ValueError(
                f"x must have shape (..., {K}, {n}), a state for each of the times, got {x.shape}"
            )
    check_clear_of_sensors("x", x, array)
    return x


def _stacked(columns):
    """Return columns (...) as rows (..., 6); `np.stack` takes five times as long for a few."""
    rows = np.empty((*columns[0].shape, len(columns)))
    for i, column in enumerate(columns):
        rows[..., i] = column
    return rows


def _arguments(x, array):
    """Return the arguments of the kernels, for each leg."""
    columns = [x[..., i, None] for i in range(6)]
    if isinstance(array, RadarArray):
        return [(*columns, *array.positions.T, array.doppler_per_speed)]
    return [(*columns, *np.moveaxis(end, -1, 0), per_speed) for end, per_speed in array.legs]
