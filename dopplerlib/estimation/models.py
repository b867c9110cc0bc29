"""Motion and measurement models as the recursion takes them: linear, or linearized; unchecked.

A motion becomes the function that predicts an estimate, a measurement the one that returns the
innovation and the gain. Nonlinear ones are linearized by their Jacobians (the extended filter) or
by sigma points (the unscented and the cubature filter). What is called `each` here holds one
function or matrix for each sample.
"""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from .._typing import BoolArray, FloatArray
from . import covariances, gaussian, sigma_points
from .extended_update import linearized, wrapped
from .recursion import Correct, Predict

Each = Sequence[Callable[[FloatArray], FloatArray]]


def linear_motion(F: FloatArray, Q: FloatArray) -> Predict:
    """Return the prediction by transition matrices F (K, n, n) and process noise Q (K, n, n)."""
    return lambda k, x, P: gaussian.predict(x, P, F[k], Q[k])


def extended_motion(f: Each, F: Each, Q: FloatArray) -> Predict:
    """Return the prediction by functions f, with the covariance by their Jacobians F."""

    def predict(k, x, P):
        _, P = gaussian.predict(x, P, F[k](x), Q[k])
        return f[k](x), P

    return predict


def sampled_motion(f: Each, Q: FloatArray, scale: tuple[float, float]) -> Predict:
    """Return the prediction by functions f at sigma points, see `sigma_points.scaling`."""

    def predict(k, x, P):
        mean, FL, rest = sigma_points.regression(f[k], x, covariances.square_root(P), scale)
        return mean, covariances.squared(np.concatenate([FL, rest], axis=-1), Q[k])

    return predict


def linear_measurement(
    z: FloatArray, H: FloatArray, R: FloatArray, there: BoolArray | None = None
) -> Correct:
    """Return the correction by measurements z (..., K, m) of H x, with H (K, m, n), R (K, m, m).

    `there` says which components are measured, and may lack the axes of the runs; by default those
    that are not NaN.
    """
    there = ~np.isnan(z) if there is None else there

    def correct(k, x, P):
        innovation = gaussian.innovation(x, z[..., k, :], H[k])
        return innovation, *gaussian.gain(P, H[k], R[k], there[..., k, :])

    return correct


def extended_measurement(
    z: FloatArray, h: Each, H: Each, R: FloatArray, wrap: Iterable[int] = ()
) -> Correct:
    """Return the correction by measurements of functions h with Jacobians H."""

    def correct(k, x, P):
        innovation, J = linearized(x, z[..., k, :], h[k], H[k], wrap)
        return innovation, *gaussian.gain(P, J, R[k], ~np.isnan(innovation))

    return correct


def sampled_measurement(
    z: FloatArray, h: Each, R: FloatArray, scale: tuple[float, float], wrap: Iterable[int] = ()
) -> Correct:
    """Return the correction by measurements of functions h at sigma points."""

    def correct(k, x, P):
        L = covariances.square_root(P)
        mean, HL, rest = sigma_points.regression(h[k], x, L, scale, wrap)
        innovation = wrapped(z[..., k, :] - mean, wrap)
        noise = R[k] + covariances.squared(rest)
        return innovation, *gaussian.gain_of_root(P, L, HL, noise, ~np.isnan(innovation))

    return correct
