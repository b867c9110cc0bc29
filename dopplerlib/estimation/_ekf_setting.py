"""Settings of the Doppler filter: checked, in the form of the compiled loop, and remembered.

A call for one sample would spend most of its time with checks of the numbers that it was called
with before.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .. import _checks
from .._hints import between
from .._typing import FloatArray
from ..model.links import DopplerLinks
from ..model.motion import dwna_gain
from ..model.radar_array import RadarArray

_FEW = 64  # sensors of which settings are remembered: a key holds their positions
# Types of interval, deviations, noise, gate, its probability and deviations of clocks, of which
# equal values are the same settings.
_PLAIN = {(float, float, float, str, gate, float, float, float) for gate in (str, type(None))}


class Setting(NamedTuple):
    """Settings of `ekf`, beside measurements and start; a first axis of one is for all."""

    T: FloatArray  # (K or 1,)
    columns: FloatArray  # (K or 1, C, 6): those of sigma_a G
    variance: FloatArray  # (K or 1, N)
    lower: FloatArray
    upper: FloatArray
    clocks: tuple[float, float]
    inputs: tuple[FloatArray, ...]  # T, columns and variance with one axis, read-only
    memories: dict[int, FloatArray]


def setting(array: RadarArray | DopplerLinks, samples: int, *values) -> Setting:
    """Return the setting of an array and of what `ekf` takes from `T` to `sigma_drift`.

    In this order: T, sigma_a, sigma_f, noise, gate, gate_probability, sigma_clock, sigma_drift.
    """
    if type(array) is RadarArray and tuple(map(type, values)) in _PLAIN and len(array) <= _FEW:
        return _remembered(array.positions.tobytes(), array.wavelength, *values)
    clocks = isinstance(array, DopplerLinks) and array.n > 6
    return _setting(len(array), samples, clocks, *values)


@lru_cache
def _remembered(positions, wavelength, *values):
    return _setting(len(positions) // 24, 1, False, *values)


def _setting(
    sensors, samples, there, T, sigma_a, sigma_f, noise, gate, probability, sigma_clock, sigma_drift
):
    T = _intervals(T, samples)
    columns = noise_columns(T, sigma_a, noise)
    rows = 1 if type(sigma_f) is float else samples
    variance = variances(sigma_f, (rows, sensors))
    _checks.one_of("gate", gate, (None, "upper", "two-sided", "soft"))
    probability = _checks.probability("gate_probability", probability)
    lower, upper = bounds("upper" if gate == "soft" else gate, sensors, probability)
    # Without clocks they have no noise.
    noise_of_clock = between(0, 1e60 if there else 0)
    clocks = noise_of_clock("sigma_clock", sigma_clock), noise_of_clock("sigma_drift", sigma_drift)
    # Whether an array may be written to is part of its type: numba would compile the loop again
    # for every mixture, 2 s each.
    inputs = tuple(flat(value) for value in (T, columns, variance))
    return Setting(T, columns, variance, lower, upper, clocks, inputs, {})


def flat(value: FloatArray) -> FloatArray:
    """Return an array with one axis, read-only, as the compiled loop takes all inputs."""
    value = np.ascontiguousarray(value).reshape(-1)
    value.setflags(False)
    return value


@lru_cache
def bounds(
    gate: str | None, sensors: int, gate_probability: float
) -> tuple[FloatArray, FloatArray]:
    """Return the bounds of `gate_bounds`, remembered: not to be written to."""
    if sensors > 10**6:  # 8 MB
        raise ValueError(f"sensors must be at most a million, got {sensors}")
    lower = np.full(sensors + 1, -np.inf)
    upper = np.full(sensors + 1, np.inf)
    if gate is not None:
        from scipy.special import chdtri  # upper-tail quantile of chi-square

        dof = np.arange(1, sensors + 1)
        tail = (1 - gate_probability) / (1 if gate == "upper" else 2)
        upper[1:] = chdtri(dof, tail)
        if gate == "two-sided":
            lower[1:] = chdtri(dof, 1 - tail)
    return lower, upper


def noise_columns(T: FloatArray, sigma_a: float, noise: str) -> FloatArray:
    """Return the columns of sigma_a G, (K or 1, C, 6), for the noise of each interval."""
    G, sigma_a = dwna_gain(T, sigma_a, noise)
    return np.ascontiguousarray(sigma_a * np.swapaxes(G, -1, -2))


def _intervals(T, samples):
    """Return the intervals before the samples, (samples,), or (1,) if all are the same."""
    T = _checks.deviation("T", T)
    if T.shape not in ((), (samples,)):
        raise ValueError(
            f"T must be one number or have shape (K,) = ({samples},), got shape {T.shape}"
        )
    return T.reshape(-1).copy()


def variances(sigma_f, shape: tuple[int, int]) -> FloatArray:
    """Return the variances of measurements, broadcast to (K or 1, N), or raise."""
    sigma_f = _checks.deviation("sigma_f", sigma_f)
    try:
        return np.ascontiguousarray(np.broadcast_to(sigma_f**2, shape))
    except ValueError:
        raise ValueError(
            f"sigma_f must broadcast to (K, N) = {shape}, got shape {sigma_f.shape}"
        ) from None


def measurements(z, array: RadarArray | DopplerLinks) -> FloatArray:
    """Return measurements (..., K, N), NaN for a missing one, or raise."""
    z = records(z, array)
    check_not_infinite(z)
    return z


def records(z, array: RadarArray | DopplerLinks) -> FloatArray:
    """Return numbers (..., K, N), or raise; they may be infinite."""
    z = _checks.real("z", z)
    _checks.check_shape("z", z, (None, len(array)))
    if not z.size:
        raise ValueError(f"z must hold at least one run and one sample, got shape {z.shape}")
    return z


def check_not_infinite(z: FloatArray) -> None:
    """Raise if a measurement is infinite; NaN is a missing one."""
    if not _checks.all_finite(z) and np.isinf(z).any():
        place = tuple(int(i) for i in np.argwhere(np.isinf(z))[0])
        raise ValueError(
            f"z must be finite, or NaN where a sensor is missing, got {z[place]} at index {place}"
        )
