"""Filters that take one sample at a time: arguments are checked once, each sample costs little.

Every function here prepares the filter that its namesake applies to whole records, and returns a
function that takes the next sample and returns the estimate after it: to the last bit what the
other returns for the same record.
"""

from collections.abc import Callable, Iterable
from typing import Any, Literal

import numpy as np

from .. import _checks
from .._records import filled
from .._typing import ArrayLike
from ..model.doppler import check_clear_of_sensors
from ..model.motion import dwna_gain
from ..model.radar_array import RadarArray
from . import models, recursion
from ._functions import each
from .extended_kalman import _OPTIONAL, _measurements, _noise_columns, gate_bounds
from .nonlinear_kalman import _arguments, _sampled
from .track import Track

Function = Callable[..., Any]


@_checks.quiet
def ekf_online(
    array: RadarArray,
    x0: ArrayLike,
    P0: ArrayLike,
    T: float,
    sigma_a: float,
    sigma_f: ArrayLike,
    noise: Literal["shared", "per_axis", "horizontal"] = "shared",
    gate: Literal["upper", "two-sided"] | None = None,
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
    gate : {None, "upper", "two-sided"}
        Which measurements are used, see `ekf`.
    gate_probability : float
        Probability of the gate.
    keep : sequence of {"P", "innovation", "S"}
        Fields of the results that are wanted; the others are None.

    Returns
    -------
    callable
        A function ``update(z, T=None)`` that takes the next sample (N,) in Hz, NaN for a missing
        sensor, and returns the estimate after it, a `Track` without the axis of time. Another `T`
        is the interval before this one sample. The function remembers the samples before; each
        call of `ekf_online` gives another one, for another target.

    Raises
    ------
    ValueError
        As `ekf`; the function, if a sample has not N values or an infinite one, or if its interval
        is not finite and positive. Such a sample changes nothing.

    Notes
    -----
    Mittermaier et al. (2016), Table 1; see `ekf`. A sample costs a few microseconds, most of it for
    Python; the first one of all compiles. As in `ekf`, a prediction that meets a sensor later on,
    or overflows, gives a NIS of NaN, and ``updated`` is False.

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
    T = _checks.one_number("T", T, _checks.deviation)
    columns = _noise_columns(np.array([T]), sigma_a, noise)[0]
    sigma_f = _checks.deviation("sigma_f", sigma_f)
    if sigma_f.shape not in ((), (1,), (N,)):
        raise ValueError(f"sigma_f must broadcast to (N,) = ({N},), got shape {sigma_f.shape}")
    _checks.one_of("gate", gate, (None, "upper", "two-sided"))
    bounds = gate_bounds(gate, N, gate_probability)
    x0 = _checks.exact_shape("x0", _checks.finite("x0", x0, (6,)), (6,))
    P0 = _checks.one_matrix("P0", _checks.covariance("P0", P0, 6, definite=False))
    keep = _checks.some_of("keep", keep, _OPTIONAL)
    check_clear_of_sensors("F x0", x0[:3] + T * x0[3:], array)

    from ._ekf_loop import INFINITE, NIS, UPDATED, SampleMemory, compiled_step

    count = len(columns)
    memory = SampleMemory(array.positions, array.doppler_per_speed, *bounds, count)
    begin, step = compiled_step()
    begin(memory.all, x0.copy(), P0.flatten())  # copies may be written to: one type for numba
    memory.variance[:] = sigma_f**2
    everything, measured, last = memory.all, memory.z, None
    copy_x = memory.x.copy
    copies = [(name, getattr(memory, name).copy) for name in _OPTIONAL if name in keep]
    missing = dict.fromkeys(_OPTIONAL)
    shape, double = (N,), measured.dtype

    def interval(given):
        """Write an interval and its noise to the memory."""
        rows = columns
        if given is not None:
            given = _checks.one_number("T", given, _checks.deviation)
            G, sigma = dwna_gain(np.array([given]), sigma_a, noise)
            rows = (sigma * np.swapaxes(G, -1, -2))[0]
        memory.T[0] = T if given is None else given
        memory.noise[: rows.size] = rows.reshape(-1)

    interval(None)

    def update(z: ArrayLike, T: float | None = None) -> Track:
        """Take the next sample (N,) in Hz and return the estimate after it."""
        nonlocal last
        if type(z) is not np.ndarray or z.dtype is not double or z.shape != shape:
            z = _checks.exact_shape("z", _checks.real("z", z), shape)
        if T is not last:
            interval(T)
            last = T
        measured[...] = z
        outcome = step(everything)
        if outcome == INFINITE:
            _measurements(z[None], array)  # says which one
        x = copy_x()
        x.setflags(False)
        fields = {"x": x, **missing, "nis": everything[NIS], "updated": outcome == UPDATED}
        for name, copy in copies:
            fields[name] = value = copy()
            value.setflags(False)
        return filled(Track, fields)

    return update


@_checks.quiet
def ekf_records_online(
    f: Function,
    F: Function,
    Q: ArrayLike | Function,
    h: Function,
    H: Function,
    R: ArrayLike,
    x0: ArrayLike,
    P0: ArrayLike,
    *,
    wrap: Iterable[int] = (),
    gate: Literal["upper", "two-sided", "soft"] | None = None,
    gate_probability: float = 0.95,
    iterations: int = 1,
) -> Callable[[ArrayLike], Track]:
    """Prepare the filter of `ekf_records` for samples that come one by one.

    Parameters
    ----------
    f : callable
        Motion over one interval: takes states (n,), returns (n,).
    F : callable
        Its Jacobian: takes states (n,), returns (n, n).
    Q : array_like, shape (n, n), or callable
        Covariance of the process noise; or a function that takes the state before the interval.
    h : callable
        Measurement function: takes states (n,), returns (m,).
    H : callable
        Its Jacobian: takes states (n,), returns (m, n).
    R : array_like, shape (m, m)
        Covariance of the measurement noise.
    x0 : array_like, shape (n,)
        State one step before the first measurement.
    P0 : array_like, shape (n, n)
        Its covariance; it may be singular.
    wrap : iterable of int
        Components of the measurement that are angles in rad.
    gate : {None, "upper", "two-sided", "soft"}
        Which measurements are used, see `ekf_records`.
    gate_probability : float
        Probability of the gate.
    iterations : int
        Linearizations of each measurement, see `ekf_records`.

    Returns
    -------
    callable
        A function that takes the next measurement (m,), NaN for a missing component, and returns
        the estimate after it, a `Track` without the axis of time. It remembers the samples before.
        For uneven times let `f` and `F` know the interval.

    Raises
    ------
    ValueError
        As `ekf_records`; the function too. Such a sample changes nothing.

    Notes
    -----
    See `ekf_records` for the sources. The cycle is the same code as for whole records.

    Examples
    --------
    >>> update = ekf_records_online(
    ...     lambda x: x, lambda x: [[1.0]], [[0.0]],
    ...     lambda x: x**2, lambda x: 2 * x[..., None], [[0.01]], [3.0], [[1.0]],
    ... )
    >>> [round(float(update([z]).x[0]), 2) for z in (4.1, 3.9, 4.0)]
    [2.18, 2.11, 2.09]
    """
    R, z = _buffer(R)
    z, Q, R, x, P, wrap, bounds = _arguments(z, Q, R, x0, P0, wrap, gate, gate_probability)
    iterations = _checks.count("iterations", iterations, 100)
    m, n = z.shape[-1], x.shape[-1]
    f, F = each("f", _one("f", f), 1, ((), (n,))), each("F", _one("F", F), 1, ((), (n, n)))
    h, H = each("h", _one("h", h), 1, ((), (m,))), each("H", _one("H", H), 1, ((), (m, n)))
    predict = models.extended_motion(f, F, Q)
    correct = models.extended_measurement(z, h, H, R, wrap, iterations)
    return _online(z, (x, P), predict, correct, bounds, "z, f, F, Q, h, H, R, x0, P0")


@_checks.quiet
def ukf_online(
    f: Function,
    Q: ArrayLike | Function,
    h: Function,
    R: ArrayLike,
    x0: ArrayLike,
    P0: ArrayLike,
    *,
    points: Literal["cubature", "unscented"] = "cubature",
    alpha: float = 1e-3,
    beta: float = 2.0,
    kappa: float = 0.0,
    wrap: Iterable[int] = (),
    gate: Literal["upper", "two-sided", "soft"] | None = None,
    gate_probability: float = 0.95,
    iterations: int = 1,
) -> Callable[[ArrayLike], Track]:
    """Prepare the filter of `ukf` for samples that come one by one.

    Parameters
    ----------
    f : callable
        Motion over one interval: takes states (..., n), returns (..., n).
    Q : array_like, shape (n, n), or callable
        Covariance of the process noise; or a function that takes the state before the interval.
    h : callable
        Measurement function: takes states (..., n), returns (..., m).
    R : array_like, shape (m, m)
        Covariance of the measurement noise.
    x0 : array_like, shape (n,)
        State one step before the first measurement.
    P0 : array_like, shape (n, n)
        Its covariance; it may be singular.
    points : {"cubature", "unscented"}
        Sigma points, see `ukf`.
    alpha, beta, kappa : float
        Spread and weights of "unscented" points, see `ukf`.
    wrap : iterable of int
        Components of the measurement that are angles in rad.
    gate : {None, "upper", "two-sided", "soft"}
        Which measurements are used, see `ekf_records`.
    gate_probability : float
        Probability of the gate.
    iterations : int
        Regressions of each measurement, see `ukf`.

    Returns
    -------
    callable
        A function that takes the next measurement (m,), NaN for a missing component, and returns
        the estimate after it, a `Track` without the axis of time. It remembers the samples before.

    Raises
    ------
    ValueError
        As `ukf`; the function too. Such a sample changes nothing.

    Notes
    -----
    See `ukf` for the sources. The cycle is the same code as for whole records.

    Examples
    --------
    >>> update = ukf_online(
    ...     lambda x: x, [[0.0]], lambda x: x**2, [[0.01]], [3.0], [[1.0]],
    ...     points="unscented", kappa=2.0,
    ... )
    >>> [round(float(update([z]).x[0]), 2) for z in (4.1, 3.9, 4.0)]
    [2.07, 1.97, 1.99]
    """
    R, z = _buffer(R)
    z, Q, R, x, P, wrap, bounds = _arguments(z, Q, R, x0, P0, wrap, gate, gate_probability)
    functions = _one("f", f), _one("h", h)
    shape = points, alpha, beta, kappa
    predict, correct = _sampled(z, *functions, Q, R, x, shape, wrap, iterations)
    return _online(z, (x, P), predict, correct, bounds, "z, f, Q, h, R, x0, P0")


def _buffer(R):
    """Return R, and a record of one sample that waits for a measurement."""
    R = _checks.matrix("R", R, (None, None))
    return R, np.full((1, len(R)), np.nan)


def _one(name, function):
    return _checks.function(name, function)


def _online(buffer, state, predict, correct, bounds, names):
    """Return the function that takes the next sample; the models read it from the buffer."""

    @_checks.quiet
    def update(z: ArrayLike) -> Track:
        """Take the next measurement (m,) and return the estimate after it."""
        nonlocal state
        buffer[0] = _checks.exact_shape("z", _checks.measured("z", z, None), buffer.shape[1:])
        after, track = recursion.filter_sample(state, predict, correct, bounds)
        track = recursion.finite(names, track)
        state = after
        return track

    return update
