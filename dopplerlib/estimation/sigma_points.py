"""Sigma points: linear regression of a nonlinear function, without derivatives; unchecked.

The points are x and x +- s L e_i with a square root L of P. Half the difference of a pair is s
times a column of H L, where H is the slope of the regression line; the mean of a pair, less the
value in the middle, is a curvature d_i. The classical weights of mean and covariance then amount to
the mean z_0 + mu with mu = sum w d_i, w = 1 / s^2, and the covariance

    H L (H L)' + sum w d_i d_i' + (w_c - w_m - 1) mu mu'

with the weights w_c and w_m of the middle. That is a sum of squares, of H L and of d_i - t mu with
a number t that is real as long as the weights allow it: no digits are lost where w_m is -1e6.
"""

from collections.abc import Callable, Iterable
from math import sqrt

import numpy as np

from .. import _checks
from .._typing import FloatArray
from . import covariances
from .extended_update import wrapped


def scaling(
    n: int, alpha: float = 1.0, beta: float = 0.0, kappa: float = 0.0
) -> tuple[float, float]:
    """Return the scaling of unscented sigma points; by default that of cubature.

    Raises ValueError unless the settings are numbers which give no negative variance.
    """
    alpha = _checks.moderate_number("alpha", alpha)
    beta, kappa = (
        _checks.one_number(name, value, _checks.moderate)
        for name, value in (("beta", beta), ("kappa", kappa))
    )
    if not n + kappa > 1e-9:
        raise ValueError(f"kappa must be above {-n} for a state of length {n}, got {kappa}")
    least = -(alpha**2) * kappa / n
    if beta < least:
        raise ValueError(
            f"beta must be at least {least:g} with alpha = {alpha} and kappa = {kappa}, got {beta}"
        )
    share = n / (n + kappa) / alpha**2  # of the pairs in the mean
    t = (1 - sqrt(max(1 + share * (beta - alpha**2), 0.0))) / share
    return alpha * sqrt(n + kappa), t


def regression(
    function: Callable[[FloatArray], FloatArray],
    x: FloatArray,
    L: FloatArray,
    scale: tuple[float, float],
    wrap: Iterable[int] = (),
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the linear regression of a function of Gaussians: mean, slope, residual.

    The function takes states (..., 2 n + 1, n) and returns values (..., 2 n + 1, m), of which the
    components `wrap` are angles. Gaussians have means x (..., n) and covariances L L'; `scale` is
    from `scaling`. Mean (..., m), slope H as H L (..., m, n), and a root (..., m, n) of the
    covariance of what the regression line misses.
    """
    s, t = scale
    n = x.shape[-1]
    steps = np.zeros((*L.shape[:-2], 2 * n + 1, n))
    steps[..., 1 : n + 1, :] = s * L.mT
    steps[..., n + 1 :, :] = s * -L.mT
    value = function(x[..., None, :] + steps)
    middle = value[..., 0, :]
    away = wrapped(value[..., 1:, :] - middle[..., None, :], wrap)
    plus, minus = away[..., :n, :], away[..., n:, :]
    d = (plus + minus) / 2
    mu = d.sum(axis=-2) / s**2
    return middle + mu, (plus - minus).mT / (2 * s), (d - t * mu[..., None, :]).mT / s


def moments(
    function: Callable[[FloatArray], FloatArray],
    x: FloatArray,
    P: FloatArray,
    scale: tuple[float, float],
    noise: FloatArray | float = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of a function of Gaussians, plus the covariance of a noise.

    Arguments as in `regression`, with covariances P (..., n, n).
    """
    mean, FL, rest = regression(function, x, covariances.square_root(P), scale)
    return mean, covariances.squared(np.concatenate([FL, rest], axis=-1), noise)
