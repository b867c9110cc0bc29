"""Extended Kalman filters that doubt single measurements: Huber, Student t, a gate, adaptive R."""

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from .. import _checks
from .._typing import ArrayLike, FloatArray
from . import covariances, densities, gaussian, models, recursion
from ._functions import each
from .extended_update import linearized
from .nonlinear_kalman import Function, _arguments
from .track import Track

ROUNDS, SETTLED = 30, 1e-4  # of the weights, and the change with which a run has done


@_checks.quiet
def robust_ekf(
    z: ArrayLike,
    f: Function,
    F: Function,
    Q: ArrayLike,
    h: Function,
    H: Function,
    R: ArrayLike,
    x0: ArrayLike,
    P0: ArrayLike,
    method: Literal["huber", "student-t", "gate", "adaptive"],
    *,
    threshold: float = 1.345,
    degrees: float = 4.0,
    gate_probability: float = 0.999,
    memory: float = 100.0,
) -> Track:
    """Filter whole records with an extended Kalman filter that weighs each measurement.

    The cycle is that of `ekf_records`. A gate there judges all components of a sample as one; here
    each stands for itself, so that one bad sensor does not cost the others.

    Parameters
    ----------
    z : array_like, shape (..., K, m)
        Measurements; NaN says that a component is missing at this sample. The others update alone.
    f, F : callable or sequence of callable
        Motion over one interval and its Jacobian, see `ekf_records`.
    Q : array_like, shape (n, n) or (K, n, n)
        Covariance of the process noise.
    h, H : callable or sequence of callable
        Measurement function and its Jacobian, see `ekf_records`.
    R : array_like, shape (m, m) or (K, m, m)
        Covariance of the measurement noise, diagonal.
    x0 : array_like, shape (..., n)
        State one step before the first measurement; leading axes broadcast against those of `z`.
    P0 : array_like, shape (..., n, n)
        Its covariance; it may be singular.
    method : {"huber", "student-t", "gate", "adaptive"}
        "huber": residuals above `threshold` standard deviations count by their size, not by its
        square. "student-t": noise is Student's t, and the farther off, the less a measurement
        counts. "gate": what is outside the gate counts nothing. "adaptive": all count, with
        variances that are estimated from the residuals.
    threshold : float
        Of "huber"; 1.345 costs 5 % of efficiency with normal errors.
    degrees : float
        Degrees of freedom of "student-t"; R is the square of its scale.
    gate_probability : float
        Probability with which "gate" lets a right measurement pass.
    memory : float
        Samples over which "adaptive" averages squares of residuals, at least one.

    Returns
    -------
    Track
        Leading axes are those of `z`. S and NIS are those of R as it is given, or as it has been
        adapted.

    Raises
    ------
    ValueError
        As `ekf_records`; if `R` is not diagonal, `memory` is below one, or another setting is not
        as described.

    Notes
    -----
    Each update is a linear regression on the prediction. A measurement of weight w has the variance
    R / w. Huber (1981) weighs a residual r, in standard deviations, by min(1, threshold / r); in
    Kalman filters Karlgaard and Schaub (2007). Student's t gives (degrees + 1) / (degrees + E r^2),
    where E r^2 is the square of the residual and the variance of what is predicted there after the
    update (Piché, Särkkä, Hartikainen 2012, there for all components as one). Both are iterated
    from a weight of one.

    The residual of an update that is right has the variance R - H P H' with the updated P, so the
    mean of r^2 + H P H' is R (Mehra 1972; Mohamed and Schwarz 1999): "adaptive" averages it with
    exponential weights. It is never negative.

    Examples
    --------
    A constant that is measured three times, once wrongly:

    >>> model = [lambda x: x, lambda x: [[1.0]], [[0.0]], lambda x: x, lambda x: [[1.0]], [[0.01]]]
    >>> z = [[4.1], [9.0], [4.0]]
    >>> [
    ...     robust_ekf(z, *model, [3.9], [[1.0]], method).x[-1].round(2).tolist()
    ...     for method in ("huber", "student-t", "gate")
    ... ]
    [[4.12], [4.05], [4.05]]
    """
    z, Q, R, x, P, _, _ = _arguments(z, Q, R, x0, P0, (), None, 0.95)
    batch, (K, m), n = z.shape[:-2], z.shape[-2:], x.shape[-1]
    f, F = each("f", f, K, (batch, (n,))), each("F", F, K, (batch, (n, n)))
    h, H = each("h", h, K, (batch, (m,))), each("H", H, K, (batch, (m, n)))
    variance = np.diagonal(R, axis1=-2, axis2=-1)
    if (R != variance[..., None] * np.eye(m)).any():
        raise ValueError(f"R must be diagonal, got {R[0].tolist()}")
    _checks.one_of("method", method, ("huber", "student-t", "gate", "adaptive"))
    threshold = _checks.moderate_number("threshold", threshold)
    degrees = _checks.moderate_number("degrees", degrees)
    gate_probability = _checks.probability("gate_probability", gate_probability)
    memory = _checks.moderate_number("memory", memory)
    if memory < 1:
        raise ValueError(f"memory must be at least one sample, got {memory}")
    predict = models.extended_motion(f, F, Q)
    from scipy.special import chdtri

    limit = float(chdtri(1, 1 - gate_probability))
    weigh = {
        "huber": lambda v, S, R: _iterated(v, S, R, _huber(threshold)),
        "student-t": lambda v, S, R: _iterated(v, S, R, _student_t(degrees)),
        "gate": lambda v, S, R: np.where(_squares(v, S) <= limit, 1.0, 0.0),
        "adaptive": lambda v, S, R: np.ones(v.shape),
    }[method]

    def correct(k, x, P, R):
        innovation, J = linearized(x, z[..., k, :], h[k], H[k])
        L = covariances.square_root(P)
        HL = J @ L
        S = covariances.squared(HL, _diagonal(R))
        w = np.where(np.isnan(innovation), 0.0, weigh(innovation, S, R))
        noise = _diagonal(R / np.where(w > 0, w, 1.0))
        K, P, _ = gaussian.gain_of_root(P, L, HL, noise, w > 0)
        return innovation, K, P, S

    def step(k, state):
        x, P, factor = state
        R = factor * variance[k]
        (x, P), output = recursion.cycle(k, (x, P), predict, lambda k, x, P: correct(k, x, P, R))
        if method == "adaptive":
            residual, J = linearized(x, z[..., k, :], h[k], H[k])
            spread = np.sum((J @ covariances.square_root(P)) ** 2, axis=-1)
            new = (residual**2 + spread) / variance[k]
            factor = factor + np.where(np.isnan(new), 0.0, new - factor) / memory
        return (x, P, factor), output

    factor = np.ones((*batch, m))
    x, P, innovation, S = recursion.scan(step, (x, P, factor), range(K), len(batch))
    count = np.sum(~np.isnan(innovation), axis=-1)
    track = Track(x, P, innovation, S, densities.quadratic_form(innovation, S), count > 0)
    if method == "gate":
        track = replace(track, updated=(_squares(innovation, S) <= limit).any(axis=-1))
    return recursion.finite("z, f, F, Q, h, H, R, x0, P0", track)


def _huber(threshold: float) -> Callable[..., FloatArray]:
    """Return Huber's weights of residuals and their variances after the update, over R."""
    return lambda r, spread: threshold / np.maximum(np.abs(r), threshold)


def _student_t(degrees: float) -> Callable[..., FloatArray]:
    """Return weights of Student's t: the posterior means of the precisions, over 1 / R."""
    return lambda r, spread: (degrees + 1) / (degrees + r**2 + spread)


def _iterated(innovation, S, R, rule):
    """Return weights (..., m) that agree with the residuals of the update they lead to.

    With P H' = M, the update moves the prediction by M S^-1 v, so the residual is R / w S^-1 v.
    """
    covariances.cholesky(S)  # blames R if it is singular
    m = innovation.shape[-1]
    v, S, R = innovation.reshape(-1, m), S.reshape(-1, m, m), R.reshape(-1, m)
    there = ~np.isnan(v)
    both = there[..., :, None] & there[..., None, :]
    HPH = np.where(both, S - _diagonal(R), 0.0)
    known = np.concatenate([np.where(there, v, 0.0)[..., None], HPH], axis=-1)
    w, left = np.ones(v.shape), np.arange(len(v))
    for _ in range(ROUNDS):
        before, r, H = w[left], R[left], HPH[left]
        solved = np.linalg.solve(H + _diagonal(r / before), known[left])
        spread = np.diagonal(H - H @ solved[..., 1:], axis1=-2, axis2=-1)
        w[left] = rule(np.sqrt(r) / before * solved[..., 0], spread / r)
        left = left[np.abs(w[left] - before).max(axis=-1) > SETTLED]
        if not len(left):
            break
    return w.reshape(innovation.shape)


def _squares(innovation, S):
    return innovation**2 / np.diagonal(S, axis1=-2, axis2=-1)


def _diagonal(variance):
    return variance[..., None] * np.eye(variance.shape[-1])
