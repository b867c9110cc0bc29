"""Filters that take one sample at a time: arguments are checked once, each sample costs little.

Every function here prepares the filter that its namesake applies to whole records, and returns a
function that takes the next sample and returns the estimate after it: to the last bit what the
other returns for the same record.
"""

from collections.abc import Callable, Iterable
from typing import Any, Literal

import numpy as np

from .. import _checks
from .._typing import ArrayLike
from . import models, recursion
from ._functions import each
from .nonlinear_kalman import _arguments, _sampled
from .track import Track

Function = Callable[..., Any]


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
