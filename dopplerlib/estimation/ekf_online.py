"""The Doppler filter of `ekf` for samples that come one by one, in microseconds."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import repeat
from typing import Literal

import numpy as np

from .. import _checks
from .._records import filled
from .._typing import ArrayLike
from ..model.doppler import check_clear_of_sensors
from ..model.motion import constant_velocity
from ..model.radar_array import RadarArray
from ._ekf_general import general_rules
from ._ekf_setting import check_not_infinite, noise_columns
from .extended_kalman import _OPTIONAL, gate_bounds
from .online import _online
from .track import Track

_BLOCK = 2048  # numbers for which memory is taken at once, if a sample has not more


@_checks.quiet
def ekf_online(
    array: RadarArray,
    x0: ArrayLike,
    P0: ArrayLike,
    T: float,
    sigma_a: float,
    sigma_f: ArrayLike,
    noise: Literal["shared", "per_axis", "horizontal"] = "shared",
    gate: Literal["upper", "two-sided", "soft"] | None = None,
    *,
    gate_probability: float = 0.95,
    keep: Iterable[str] = _OPTIONAL,
) -> Callable[..., Track]:
    """Prepare the filter of `ekf` for samples that come one by one.

    Parameters
    ----------
    array : RadarArray
        The N sensors.
    x0 : array_like, shape (6,)
        State [x, y, z, v_x, v_y, v_z] in m and m/s one interval before the first sample.
    P0 : array_like, shape (6, 6)
        Its covariance; it may be singular.
    T : float
        Sampling interval in s.
    sigma_a : float
        Standard deviation of the acceleration in m/s^2, see `constant_velocity`.
    sigma_f : array_like, broadcast to (N,)
        Standard deviation of the measurements in Hz.
    noise : {"shared", "per_axis", "horizontal"}
        Process noise, see `constant_velocity`.
    gate : {None, "upper", "two-sided", "soft"}
        Which measurements are used, see `ekf`. "soft" is not compiled, and takes a hundred times
        as long.
    gate_probability : float
        Probability of the gate.
    keep : sequence of {"P", "innovation", "S"}
        Fields of the results that are wanted; the others are None.

    Returns
    -------
    callable
        A function ``update(z, T=None, sigma_f=None)`` that takes the next sample (N,) in Hz, NaN
        for a missing sensor, and returns the estimate after it, a `Track` without the axis of time.
        Another `T` is the interval before this one sample, another `sigma_f` its deviations. The
        function remembers the samples before; each call of `ekf_online` gives another one, for
        another target.

    Raises
    ------
    ValueError
        As `ekf`; the function, if a sample has not N values or an infinite one, or if its interval
        or its deviations are not finite and positive. Such a sample changes nothing.

    Notes
    -----
    Mittermaier et al. (2016), Table 1; see `ekf`. A sample costs two or three microseconds, most of
    it for Python; the first one of all compiles. Arrays of some twenty samples share 16 kB, which
    are there as long as one of them is. As in `ekf`, a prediction that meets a sensor later on, or
    overflows, gives a NIS of NaN, and ``updated`` is False.

    Examples
    --------
    >>> from dopplerlib import RadarArray, doppler_shift
    >>> array, x = RadarArray.ring(6, 0.2), np.array([0.8, 0.1, 0.1, -0.7, 0, 0])
    >>> start = x + [0.05, 0.02, -0.03, 0, 0, 0], 0.01 * np.eye(6)
    >>> update = ekf_online(array, *start, T=0.001, sigma_a=0.4, sigma_f=0.4, gate="upper")
    >>> for _ in range(100):
    ...     x[:3] += 0.001 * x[3:]
    ...     found = update(doppler_shift(x, array))
    >>> found.x.shape, found.P.shape, found.updated
    ((6,), (6, 6), True)
    """
    N = len(_checks.instance("array", array, RadarArray))
    usual = _checks.one_number("T", T, _checks.deviation), _deviations(sigma_f, N).copy()
    columns = noise_columns(np.array([usual[0]]), sigma_a, noise)[0]
    _checks.one_of("gate", gate, (None, "upper", "two-sided", "soft"))
    bounds = gate_bounds("upper" if gate == "soft" else gate, N, gate_probability)
    x0 = _checks.exact_shape("x0", _checks.finite("x0", x0, (6,)), (6,))
    P0 = _checks.one_matrix("P0", _checks.covariance("P0", P0, 6, definite=False))
    keep = _checks.some_of("keep", keep, _OPTIONAL)
    check_clear_of_sensors("F x0", x0[:3] + usual[0] * x0[3:], array)
    if gate == "soft":
        return _soft(array, x0, P0, usual, sigma_a, noise, bounds, keep)

    from ._ekf_loop import INFINITE, NIS, UPDATED, SampleMemory, compiled_step

    wanted = [name in keep for name in _OPTIONAL]
    memory = SampleMemory(array.positions, array.doppler_per_speed, *bounds, len(columns), wanted)
    begin, step = compiled_step()
    begin(memory.all, x0.copy(), P0.flatten())  # copies may be written to: one type for numba
    everything, measured, shape, double = memory.all, memory.z, (N,), memory.z.dtype

    def write(T, sigma_f):
        """Write interval, noise and variances of the next sample to the memory."""
        nonlocal last
        interval, deviations = _chosen(usual, T, sigma_f, N)
        columns = noise_columns(np.array([interval]), sigma_a, noise)
        memory.variance[:] = deviations**2
        memory.noise[: columns.size] = columns.reshape(-1)
        memory.T[0] = interval
        # What may change in its place is written each time.
        last = [v if v is None or type(v) is float else last for v in (T, sigma_f)]

    def results():
        """Yield the x, P, innovation and S that the step writes, in blocks of many samples."""
        nonlocal block
        P, innovation, S = np.cumsum([6, 36 * wanted[0], N * wanted[1]])
        size = S + N * N * wanted[2]
        while True:
            block = np.empty(max(1, _BLOCK // size) * size)
            memory.place[0] = 0
            shown = block.reshape(-1, size)
            shown.setflags(False)
            yield from zip(
                shown[:, :6],
                shown[:, P:innovation].reshape(-1, 6, 6) if wanted[0] else repeat(None),
                shown[:, innovation:S] if wanted[1] else repeat(None),
                shown[:, S:].reshape(-1, N, N) if wanted[2] else repeat(None),
                strict=False,
            )

    block, last, places = None, [None, None], results()
    write(None, None)
    place = next(places)

    def update(z: ArrayLike, T: float | None = None, sigma_f: ArrayLike | None = None) -> Track:
        """Take the next sample (N,) in Hz and return the estimate after it."""
        nonlocal place
        if type(z) is not np.ndarray or z.dtype is not double or z.shape != shape:
            z = _checks.exact_shape("z", _checks.real("z", z), shape)
        if T is not last[0] or sigma_f is not last[1]:
            write(T, sigma_f)
        measured[...] = z
        outcome = step(everything, block)
        if outcome == INFINITE:
            check_not_infinite(z)  # says which one
        x, P, innovation, S = place
        place = next(places)
        nis, updated = everything[NIS], outcome == UPDATED
        fields = {"x": x, "P": P, "innovation": innovation, "S": S, "nis": nis, "updated": updated}
        return filled(Track, fields)

    return update


def _soft(array, x0, P0, usual, sigma_a, noise, bounds, keep):
    """Return the same function for a soft gate, which is not compiled."""
    N = len(array)
    sample, variance = np.full((1, N), np.nan), np.empty((1, N))
    F, Q = np.empty((1, 6, 6)), np.empty((1, 6, 6))
    rules = general_rules(sample, [array], (F, Q), variance)
    step = _online(sample, (x0, P0), *rules, (*bounds, True), "z, array, x0, P0")
    dropped = {name: None for name in _OPTIONAL if name not in keep}

    def update(z: ArrayLike, T: float | None = None, sigma_f: ArrayLike | None = None) -> Track:
        """Take the next sample (N,) in Hz and return the estimate after it."""
        interval, deviations = _chosen(usual, T, sigma_f, N)
        F[:], Q[:] = constant_velocity(np.array([interval]), sigma_a, noise)
        variance[:] = deviations**2
        return replace(step(z), **dropped)

    return update


def _chosen(usual, T, sigma_f, N):
    """Return interval and standard deviations of a sample, checked; None stands for the usual."""
    interval = usual[0] if T is None else _checks.one_number("T", T, _checks.deviation)
    return interval, usual[1] if sigma_f is None else _deviations(sigma_f, N)


def _deviations(sigma_f, N):
    sigma_f = _checks.deviation("sigma_f", sigma_f)
    if sigma_f.shape not in ((), (1,), (N,)):
        raise ValueError(f"sigma_f must broadcast to (N,) = ({N},), got shape {sigma_f.shape}")
    return sigma_f
