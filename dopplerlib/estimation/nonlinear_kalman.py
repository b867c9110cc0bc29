"""Nonlinear Kalman filters: extended, unscented and cubature."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal

from .. import _checks
from .._typing import ArrayLike
from . import models, recursion, sigma_points
from ._functions import each
from .extended_kalman import gate_bounds
from .track import Track

Function = Callable[..., Any] | Sequence[Callable[..., Any]]  # for all samples, or each


@_checks.quiet
def ekf_records(
    z: ArrayLike,
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
) -> Track:
    """Filter whole records with an extended Kalman filter, for any motion and measurement.

    Every cycle predicts, then updates, like `kf`. `ekf` is the same for Doppler shifts, compiled.

    Parameters
    ----------
    z : array_like, shape (..., K, m)
        Measurements; NaN says that a component is missing at this sample. The others update alone.
    f : callable or sequence of callable
        Motion over one interval: takes states (..., n), returns (..., n). At uneven times one for
        each sample, that of the step which leads to it.
    F : callable or sequence of callable
        Its Jacobian: takes states (..., n), returns (..., n, n).
    Q : array_like, shape (n, n) or (K, n, n), or callable, or sequence of callable
        Covariance of the process noise; or a function that takes states (..., n) before the
        interval and returns it, (..., n, n).
    h : callable or sequence of callable
        Measurement function: takes states (..., n), returns (..., m).
    H : callable or sequence of callable
        Its Jacobian: takes states (..., n), returns (..., m, n).
    R : array_like, shape (m, m) or (K, m, m)
        Covariance of the measurement noise.
    x0 : array_like, shape (..., n)
        State one step before the first measurement; leading axes broadcast against those of `z`.
    P0 : array_like, shape (..., n, n)
        Its covariance; it may be singular: a component can be known exactly.
    wrap : iterable of int
        Components of the measurement that are angles in rad: their innovations are brought into
        [-pi, pi).
    gate : {None, "upper", "two-sided", "soft"}
        Which measurements are used, see `ekf`. A refused one leaves the state predicted. "soft"
        refuses none: above the quantile of "upper", S is taken for larger by so much that NIS is at
        that quantile. The farther off a measurement is, the less it counts, but never nothing: a
        filter that is off by twenty deviations comes back. Every gate judges all components of a
        sample as one; those that come as samples of their own, a millisecond apart, are judged one
        by one.
    gate_probability : float
        Probability of the gate.
    iterations : int
        Linearizations of each measurement, from 1 to 100: the first at the prediction, each other
        one at the estimate that the one before gave.

    Returns
    -------
    Track
        Leading axes are those of `z`. The last x and P are `x0` and `P0` of what is measured next:
        a record may come sample by sample.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite (but for a NaN in `z`), also of what functions
        return and of what comes out, a matrix is not a covariance (`P0` and `Q` may be singular),
        `R` is so small that the covariance of an innovation is singular to rounding, `wrap` names a
        component that the measurement does not have, or `gate`, `gate_probability` or `iterations`
        is not as described.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 10.3, and Sec 10.5.2 for the iterated filter, whose
    update is Gauss and Newton's method for the mode (Bell and Cathey 1993), without step control;
    covariances are sums of squares. Innovation and S are those of the last linearization, so that
    NIS is twice the least cost, of measurement and prediction together, if it has converged. Chang
    (2014) for the soft gate.

    Examples
    --------
    A constant of which the square is measured, from a start that is off by one:

    >>> track = ekf_records(
    ...     [[4.1], [3.9], [4.0]], lambda x: x, lambda x: [[1.0]], [[0.0]],
    ...     lambda x: x**2, lambda x: 2 * x[..., None], [[0.01]], [3.0], [[1.0]],
    ... )
    >>> track.x[:, 0].round(2).tolist()
    [2.18, 2.11, 2.09]
    """
    z, Q, R, x, P, wrap, bounds = _arguments(z, Q, R, x0, P0, wrap, gate, gate_probability)
    iterations = _checks.count("iterations", iterations, 100)
    batch, (K, m), n = z.shape[:-2], z.shape[-2:], x.shape[-1]
    f, F = each("f", f, K, (batch, (n,))), each("F", F, K, (batch, (n, n)))
    h, H = each("h", h, K, (batch, (m,))), each("H", H, K, (batch, (m, n)))

    motion = models.extended_motion(f, F, Q)
    measurement = models.extended_measurement(z, h, H, R, wrap, iterations)
    track = recursion.filter_records(x, P, motion, measurement, range(K), len(batch), bounds)
    return recursion.finite("z, f, F, Q, h, H, R, x0, P0", track)


@_checks.quiet
def ukf(
    z: ArrayLike,
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
) -> Track:
    """Filter whole records with an unscented or cubature Kalman filter, without Jacobians.

    Every cycle predicts, then updates, each with sigma points drawn anew.

    Parameters
    ----------
    z : array_like, shape (..., K, m)
        Measurements; NaN says that a component is missing at this sample. The others update alone.
    f : callable or sequence of callable
        Motion over one interval: takes states (..., n), returns (..., n). The points of all runs
        come at once, along the axis before the last. At uneven times one for each sample.
    Q : array_like, shape (n, n) or (K, n, n), or callable, or sequence of callable
        Covariance of the process noise; or a function that takes states (..., n) before the
        interval and returns it, (..., n, n).
    h : callable or sequence of callable
        Measurement function: takes states (..., n), returns (..., m).
    R : array_like, shape (m, m) or (K, m, m)
        Covariance of the measurement noise.
    x0 : array_like, shape (..., n)
        State one step before the first measurement; leading axes broadcast against those of `z`.
    P0 : array_like, shape (..., n, n)
        Its covariance; it may be singular: a component can be known exactly.
    points : {"cubature", "unscented"}
        Sigma points: 2 n of equal weight, or the scaled ones with the mean as one more.
    alpha : float
        Spread: "unscented" points stand alpha sqrt(n + kappa) standard deviations away.
    beta : float
        Weight of the middle point in covariances; 2 is best for Gaussians.
    kappa : float
        Second spread, usually 0 or 3 - n.
    wrap : iterable of int
        Components of the measurement that are angles in rad.
    gate : {None, "upper", "two-sided", "soft"}
        Which measurements are used, see `ekf`. A refused one leaves the state predicted. "soft"
        refuses none: above the quantile of "upper", S is taken for larger by so much that NIS is at
        that quantile. The farther off a measurement is, the less it counts, but never nothing: a
        filter that is off by twenty deviations comes back. Every gate judges all components of a
        sample as one; those that come as samples of their own, a millisecond apart, are judged one
        by one.
    gate_probability : float
        Probability of the gate.
    iterations : int
        Regressions of each measurement, from 1 to 100: the first over the prediction, each other
        one over the estimate that the one before gave (posterior linearization).

    Returns
    -------
    Track

    Raises
    ------
    ValueError
        As `ekf_records`; if `alpha` is not positive, `kappa` not above -n, or `beta` is so small
        that these weights could give a negative variance.

    Notes
    -----
    Julier and Uhlmann (2004); Wan and van der Merwe (2000) for alpha, beta, kappa; Arasaratnam and
    Haykin (2009) for cubature. The points are taken as a linear regression, z = H x + e, of which
    they give H L with a square root L of P, and the covariance of e, which adds to R (Lefebvre,
    Bruyninckx, De Schutter 2002; Särkkä 2013, Sec 5.5). The gain is the classical one, but the
    covariance is a sum of squares, also where the middle point has a negative weight. García-
    Fernández, Svensson, Morelande, Särkkä (2015) for more than one regression.

    Angles are averaged as differences from that of the middle, which is their mean on the circle as
    long as they spread less than half of it. Functions are called at the middle with "cubature",
    too.

    Examples
    --------
    A constant of which the square is measured, from a start that is off by one:

    >>> track = ukf(
    ...     [[4.1], [3.9], [4.0]], lambda x: x, [[0.0]],
    ...     lambda x: x**2, [[0.01]], [3.0], [[1.0]], points="unscented", kappa=2.0,
    ... )
    >>> track.x[:, 0].round(2).tolist()
    [2.07, 1.97, 1.99]
    """
    z, Q, R, x, P, wrap, bounds = _arguments(z, Q, R, x0, P0, wrap, gate, gate_probability)
    shape = points, alpha, beta, kappa
    motion, measurement = _sampled(z, f, h, Q, R, x, shape, wrap, iterations)
    times, axis = range(z.shape[-2]), z.ndim - 2
    track = recursion.filter_records(x, P, motion, measurement, times, axis, bounds)
    return recursion.finite("z, f, Q, h, R, x0, P0", track)


def _sampled(z, f, h, Q, R, x, shape, wrap, iterations):
    """Return prediction and correction by sigma points of a shape, which is checked."""
    iterations = _checks.count("iterations", iterations, 100)
    batch, (K, m), n = z.shape[:-2], z.shape[-2:], x.shape[-1]
    points, *spread = shape
    _checks.one_of("points", points, ("cubature", "unscented"))
    scale = sigma_points.scaling(n, *spread)
    if points == "cubature":
        scale = sigma_points.scaling(n)
    many = (*batch, 2 * n + 1)
    f, h = each("f", f, K, (many, (n,))), each("h", h, K, (many, (m,)))
    motion = models.sampled_motion(f, Q, scale)
    return motion, models.sampled_measurement(z, h, R, scale, wrap, iterations)


def _arguments(z, Q, R, x0, P0, wrap, gate, gate_probability):
    """Return the checked arguments of both filters."""
    x0 = _checks.finite("x0", x0, (None,))
    n = x0.shape[-1]
    P0 = _checks.covariance("P0", P0, n, definite=False)
    z = _checks.bounded("z", z, (None, None))
    if not z.size or not n:
        name, value = ("z", z) if n else ("x0", x0)
        raise ValueError(f"{name} must not be empty, got shape {value.shape}")
    batch, (K, m) = z.shape[:-2], z.shape[-2:]
    if callable(Q) or (isinstance(Q, (list, tuple)) and any(map(callable, Q))):
        Q = each("Q", Q, K, (batch, (n, n)))
    else:
        Q = _checks.each_sample("Q", _checks.covariance("Q", Q, n, definite=False), K, (n, n))
    R = _checks.each_sample("R", _checks.covariance("R", R, m), K, (m, m))
    x0 = _checks.each_run("x0", x0, batch, (n,))
    P0 = _checks.each_run("P0", P0, batch, (n, n))
    _checks.one_of("gate", gate, (None, "upper", "two-sided", "soft"))
    soft = gate == "soft"
    bounds = *gate_bounds("upper" if soft else gate, m, gate_probability), soft
    wrap = _checks.components("wrap", wrap, m)
    return z, Q, R, x0, P0, wrap, bounds if gate else None
