"""Motion and measurement models as the recursion takes them: linear, or linearized; unchecked.

A motion becomes the function that predicts an estimate, a measurement the one that returns the
innovation and the gain. Nonlinear ones are linearized by their Jacobians (the extended filter) or
by sigma points (the unscented and the cubature filter), once or again where the update has led to.
What is called `each` here holds one function or matrix for each sample.
"""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from .._typing import BoolArray, FloatArray
from . import covariances, gaussian, sigma_points
from .extended_update import wrapped
from .recursion import Correct, Predict

Each = Sequence[Callable[[FloatArray], FloatArray]]


def linear_motion(F: FloatArray, Q: FloatArray) -> Predict:
    """Return the prediction by transition matrices F (K, n, n) and process noise Q (K, n, n)."""
    return lambda k, x, P: gaussian.predict(x, P, F[k], Q[k])


def extended_motion(f: Each, F: Each, Q: FloatArray | Each) -> Predict:
    """Return the prediction by functions f, with the covariance by their Jacobians F.

    The process noise Q may be functions of the state before the step.
    """

    def predict(k, x, P):
        P = covariances.squared(F[k](x) @ covariances.square_root(P), _noise(Q[k], x))
        return f[k](x), P

    return predict


def sampled_motion(f: Each, Q: FloatArray | Each, scale: tuple[float, float]) -> Predict:
    """Return the prediction by functions f at sigma points, see `sigma_points.scaling`.

    The process noise Q may be functions of the mean before the step.
    """

    def predict(k, x, P):
        return sigma_points.moments(f[k], x, P, scale, _noise(Q[k], x))

    return predict


def _noise(Q, x):
    return Q(x) if callable(Q) else Q


def _root(R):
    """Return the square root of covariances R (K, m, m) that are all one, or None."""
    return covariances.square_root(R[0]) if len(R) == 1 or not R.strides[0] else None


def linear_measurement(
    z: FloatArray, H: FloatArray, R: FloatArray, there: BoolArray | None = None
) -> Correct:
    """Return the correction by measurements z (..., K, m) of H x, with H (K, m, n), R (K, m, m).

    `there` says which components are measured, and may lack the axes of the runs; by default those
    that are not NaN.
    """
    root = _root(R)

    def correct(k, x, P):
        innovation = gaussian.innovation(x, z[..., k, :], H[k])
        known = ~np.isnan(z[..., k, :]) if there is None else there[..., k, :]
        return innovation, *gaussian.gain(P, H[k], R[k], known, root)

    return correct


def extended_measurement(
    z: FloatArray, h: Each, H: Each, R: FloatArray, wrap: Iterable[int] = (), iterations: int = 1
) -> Correct:
    """Return the correction by measurements of functions h with Jacobians H, see `_iterated`."""
    root = _root(R)

    def correct(k, x, P, at=None, _=None):
        point = x if at is None else at
        innovation, J = wrapped(z[..., k, :] - h[k](point), wrap), H[k](point)
        if at is not None:
            innovation = gaussian.innovation(x - at, innovation, J)
        return innovation, *gaussian.gain(P, J, R[k], ~np.isnan(innovation), root)

    return _iterated(correct, iterations)


def sampled_measurement(
    z: FloatArray,
    h: Each,
    R: FloatArray,
    scale: tuple[float, float],
    wrap: Iterable[int] = (),
    iterations: int = 1,
) -> Correct:
    """Return the correction by measurements of functions h at sigma points, see `_iterated`.

    The first points are those of the prediction, the next ones those of the estimate after it.
    """

    def correct(k, x, P, at=None, P_at=None):
        again = at is not None
        at, P_at = (at, P_at) if again else (x, P)
        L = covariances.square_root(P_at)
        mean, HL, rest = sigma_points.regression(h[k], at, L, scale, wrap)
        innovation = wrapped(z[..., k, :] - mean, wrap)
        there, noise = ~np.isnan(innovation), R[k] + covariances.squared(rest)
        if not again:
            return innovation, *gaussian.gain_of_root(P, L, HL, noise, there)
        # The slope itself: it is that of another density than the one it is used with.
        H = covariances.solve(P_at, L @ HL.mT).mT
        return gaussian.innovation(x - at, innovation, H), *gaussian.gain(P, H, noise, there)

    return _iterated(correct, iterations)


def _iterated(correct, iterations):
    """Return a correction that is linearized anew, every time where the one before has led to.

    `correct` takes also the estimate and the covariance at which it is to linearize.
    """
    if iterations == 1:
        return correct
    before = _iterated(correct, iterations - 1)

    def again(k, x, P):
        innovation, K, P_after, _ = before(k, x, P)
        return correct(k, x, P, gaussian.moved(x, K, innovation), P_after)

    return again
