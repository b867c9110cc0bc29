"""The extended Kalman filter for Doppler measurements of a target at constant velocity."""

import os
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from math import prod
from typing import Literal

import numpy as np

from .. import _checks
from .._hints import Index, Probability, checked
from .._records import filled
from .._typing import ArrayLike, FloatArray
from ..model.doppler import check_clear_of_sensors
from ..model.links import DopplerLinks, state_size
from ..model.radar_array import RadarArray
from ._ekf_general import filter_general, general_motion
from ._ekf_setting import bounds, check_not_infinite, flat, records, setting
from .track import Track

_OPTIONAL = ("P", "innovation", "S")
_NOTHING = np.empty(0)


@_checks.quiet
def ekf(
    z: ArrayLike,
    array: RadarArray | DopplerLinks,
    x0: ArrayLike,
    P0: ArrayLike,
    T: ArrayLike,
    sigma_a: float,
    sigma_f: ArrayLike,
    noise: Literal["shared", "per_axis", "horizontal"] = "shared",
    gate: Literal["upper", "two-sided", "soft"] | None = None,
    *,
    gate_probability: float = 0.95,
    sigma_clock: float = 0.0,
    sigma_drift: float = 0.0,
    keep: Iterable[str] = _OPTIONAL,
    workers: int | None = None,
) -> Track:
    """Filter whole records of Doppler shifts with an extended Kalman filter, many runs at once.

    Every cycle predicts, then updates. The Jacobian is that of the predicted state.

    Parameters
    ----------
    z : array_like, shape (..., K, N)
        Doppler measurements in Hz; NaN says that this sensor is missing at this sample.
    array : RadarArray or DopplerLinks
        The N sensors or links.
    x0 : array_like, shape (..., 6)
        State [x, y, z, v_x, v_y, v_z] in m and m/s one interval *before* the first sample; of links
        (..., n), with offsets and rates of their clocks.
    P0 : array_like, shape (..., 6, 6)
        Covariance of `x0`; it may be singular: a component can be known exactly. Leading axes of
        `x0` and `P0` broadcast against those of `z`. Of links (..., n, n).
    T : array_like, scalar or shape (K,)
        Sampling interval in s; with uneven times the interval before each sample. Links that go
        straight are at time zero at the first sample. Of links with times only the first interval
        matters, and the others have to be those between the times, if they are given.
    sigma_a : float
        Standard deviation of the acceleration in m/s^2, see `constant_velocity`.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz: one number, one for each sensor, or one for
        each sample and sensor.
    noise : {"shared", "per_axis", "horizontal"}
        Process noise, see `constant_velocity`.
    gate : {None, "upper", "two-sided", "soft"}
        Which measurements are used. None: all. "upper": those whose NIS is below the chi-square
        quantile `gate_probability`. "two-sided": those whose NIS is inside the central interval of
        that probability, which also refuses measurements that fit too well; Fig 6 of the paper
        shows this one. The degrees of freedom are the number of sensors that are there. A
        refused measurement leaves the state predicted. "soft": see `ekf_records`.
    gate_probability : float
        Probability of the gate.
    sigma_clock, sigma_drift : float
        Process noise of the clocks of links, see `DopplerLinks.motion`: Hz and Hz/s after one
        second. For clocks of the model "epoch" `sigma_clock` is the standard deviation of each new
        offset, which is eliminated if that is large against all that the prediction leaves open.
        A million times `sigma_f` costs 1e-4 of a standard deviation in rounding; choose no more.
    keep : sequence of {"P", "innovation", "S"}
        Fields of the result that are wanted; the others are None. Ten thousand runs of a
        thousand samples need 2.9 GB for P alone.
    workers : int, optional
        Threads among which the runs of a RadarArray are shared; one for each processor if None.
        The result does not depend on it.

    Returns
    -------
    Track
        Leading axes are those of `z`; n = 6 or that of the links, m = N.

    Raises
    ------
    ValueError
        If an argument has the wrong shape or is not made of real numbers, a setting is not finite
        and positive, `P0` is not a covariance (it may be singular), a measurement is infinite, or
        the target is predicted onto a sensor at the first sample.

    Notes
    -----
    Mittermaier et al. (2016), Table 1 and Eqs 4 to 9, 14, 16, 17. R is diagonal, so the sensors
    are processed one after the other, without an inverse. P is kept as its factors, U D U' with a
    unit upper triangular U (Bierman 1977; Agee and Turner 1972 for the process noise), and only
    multiplied out for the result: it is symmetric and without a negative variance, however much
    better the measurements are than the start. With P0 / R of 1e24 it still has ten digits.

    Should a prediction meet a sensor later on, or overflow, then NIS is NaN although something
    was measured, and ``updated`` is False.

    Links, and the soft gate, go through the recursion of `ekf_records`: an update by all sensors at
    once, not compiled. There, a prediction that meets a sensor is an error.

    Examples
    --------
    Sixteen records of a tenth of a second, from a start that is about right:

    >>> from dopplerlib import Scenario, simulate
    >>> scenario = Scenario(
    ...     RadarArray.ring(6, 0.2), x0=[0.8, 0.1, 0.1, -0.7, 0, 0],
    ...     T=0.001, samples=100, sigma_f=0.4, sigma_a=0.4, P0=0.01 * np.eye(6),
    ... )
    >>> truth, z = simulate(scenario, 16, rng=np.random.default_rng(1))
    >>> start = scenario.x0 + [0.05, 0.02, -0.03, 0, 0, 0]
    >>> track = ekf(
    ...     z, scenario.array, start, scenario.P0, T=0.001, sigma_a=0.4, sigma_f=0.4
    ... )
    >>> track.x.shape, track.P.shape, track.nis.shape
    ((16, 100, 6), (16, 100, 6, 6), (16, 100))
    """
    n = state_size(_checks.instance("array", array, (RadarArray, DopplerLinks)))
    z = records(z, array)
    batch, (samples, sensors) = z.shape[:-2], z.shape[-2:]
    values = T, sigma_a, sigma_f, noise, gate, gate_probability, sigma_clock, sigma_drift
    given = setting(array, samples, *values)
    x0, P0 = _checks.real("x0", x0), _checks.real("P0", P0)
    _checks.check_shape("x0", x0, (n,))
    _checks.check_shape("P0", P0, (n, n))
    general = gate == "soft" or isinstance(array, DopplerLinks)
    if general or batch:  # runs may share a start, which the compiled loop would see in each
        _check_start(x0, P0, n)
    keep = _checks.some_of("keep", keep, _OPTIONAL)
    if workers is not None:
        workers = _checks.whole_number("workers", workers)

    x0 = _checks.each_run("x0", x0, batch, (n,))
    P0 = _checks.each_run("P0", P0, batch, (n, n))
    if general:
        check_not_infinite(z)
        variance = np.broadcast_to(given.variance, (samples, sensors))
        array, motion = general_motion(array, given.T, samples, sigma_a, noise, *given.clocks)
        limits = (given.lower, given.upper, gate == "soft") if gate else None
        track = filter_general(z, array, x0, P0, motion, variance, limits)
        return replace(track, **{name: None for name in _OPTIONAL if name not in keep})
    lead = *batch, samples
    out = dict.fromkeys(("x", *_OPTIONAL))
    shapes = {"P": (6, 6), "innovation": (sensors,), "S": (sensors, sensors)}
    out["x"], out["nis"] = np.empty((*lead, 6)), np.empty(lead)
    out["updated"] = np.empty(lead, bool)
    for name in keep:
        out[name] = np.empty((*lead, *shapes[name]))
    results = [_NOTHING if value is None else value.reshape(-1) for value in out.values()]
    if not _filtered(prod(batch), array, given, (z, x0, P0), results, workers):
        check_not_infinite(z)
        _check_start(x0, P0, n)
        check_clear_of_sensors("F x0", x0[..., :3] + given.T[0] * x0[..., 3:], array)
    for value in out.values():
        if value is not None:
            value.setflags(False)
    return filled(Track, out)


def _check_start(x0, P0, n):
    _checks.finite("x0", x0)
    _checks.covariance("P0", P0, n, definite=False)


def _filtered(runs, array, given, inputs, results, workers):
    """Write the results of the compiled loop; return whether no input needs a longer look."""
    LANES, compiled, new_memory = _loop()
    lanes = LANES if runs >= LANES else 1
    sizes = *inputs[0].shape[:-3:-1], given.columns.shape[-2]
    z, x0, P0 = map(flat, inputs)

    def run(z, x0, P0, *results):
        memory = given.memories.get(lanes)
        if memory is None:
            setup = array.positions, array.doppler_per_speed, given.lower, given.upper
            memory = given.memories[lanes] = new_memory(lanes, *setup)
        return compiled(lanes)(memory.copy(), *sizes, z, *given.inputs, x0, P0, *results)

    workers = workers or os.cpu_count() or 1
    if runs <= lanes or workers == 1:
        return run(z, x0, P0, *results)

    def part(first, last):
        def own(values):
            return values[first * (len(values) // runs) : last * (len(values) // runs)]

        return run(*map(own, (z, x0, P0, *results)))

    with ThreadPoolExecutor(workers) as pool:
        # A list: `all` stops at the first False, and what has not begun by then never would.
        return all([*pool.map(part, *_parts(runs, lanes, workers))])


@cache
def _loop():
    # Here, and not above, so that importing the library does not load numba.
    from ._ekf_loop import LANES, compiled, new_memory

    return LANES, compiled, new_memory


@checked
@_checks.quiet
def gate_bounds(
    gate: Literal["upper", "two-sided"] | None, sensors: Index, gate_probability: Probability = 0.95
) -> tuple[FloatArray, FloatArray]:
    """Return the bounds of the gate on NIS for 0, 1, ..., `sensors` measurements.

    Parameters
    ----------
    gate : {None, "upper", "two-sided"}
        See `ekf`.
    sensors : int
        Largest number of measurements N.
    gate_probability : float
        Probability that a measurement of a consistent filter passes.

    Returns
    -------
    lower, upper : ndarray, shape (N + 1,)
        A NIS passes if it is neither below `lower` nor above `upper`.

    Notes
    -----
    Mittermaier et al. (2016), Section 3.5: outlier detection and gating by NIS, Eq 14.

    Examples
    --------
    >>> lower, upper = gate_bounds("two-sided", 6)
    >>> round(float(lower[6]), 3), round(float(upper[6]), 3)
    (1.237, 14.449)
    """
    lower, upper = bounds(gate, sensors, gate_probability)
    return lower.copy(), upper.copy()


def _parts(runs, lanes, workers):
    """Return where at most `workers` parts begin and where they end, in whole groups of lanes."""
    groups = -(-runs // lanes)
    size = lanes * -(-groups // workers)
    return range(0, runs, size), [min(first + size, runs) for first in range(0, runs, size)]
