"""Densities of Gaussians: quadratic forms such as NIS, likelihoods, mixtures; unchecked.

Of vectors v (..., m) the components count that are not NaN; a quadratic form is NaN where all are.
Covariances are S (..., m, m). ValueError if one is singular to rounding.
"""

import numpy as np

from .. import _checks
from .._typing import FloatArray
from .covariances import cholesky


@_checks.quiet
def quadratic_forms(v: FloatArray, S: FloatArray) -> FloatArray:
    """Return v' S^-1 v (..., D) of many vectors v (..., D, m) with one covariance."""
    there = ~np.isnan(v)
    if there.all():
        white = np.linalg.solve(cholesky(S), v.mT)
        return (white * white).sum(axis=-2)
    return quadratic_form(v, S[..., None, :, :])


@_checks.quiet
def quadratic_form(v: FloatArray, S: FloatArray) -> FloatArray:
    """Return v' S^-1 v (...) of each vector with a covariance of its own, such as NIS."""
    return _form(v, S)[0]


@_checks.quiet
def log_density(v: FloatArray, S: FloatArray) -> FloatArray:
    """Return the log density (...) of zero-mean Gaussians.

    Zero where all components are NaN: a missing measurement favors no model.
    """
    form, L, there = _form(v, S)
    size = there.sum(axis=-1)
    diagonal = np.diagonal(L, axis1=-2, axis2=-1)
    logarithm = size * np.log(2 * np.pi) / 2 + np.log(diagonal).sum(axis=-1)
    return np.where(size > 0, -form / 2 - logarithm, 0.0)


@_checks.quiet
def mixture(x: FloatArray, P: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of mixtures of M parts.

    Means x (..., M, n), covariances P (..., M, n, n) and probabilities `weight` (..., M).
    """
    mean = (weight[..., None] * x).sum(axis=-2)
    off = x - mean[..., None, :]
    spread = P + off[..., :, None] * off[..., None, :]
    return mean, (weight[..., None, None] * spread).sum(axis=-3)


def _form(v, S):
    """Return the quadratic forms, the factors of S for the components there, and which are."""
    there = ~np.isnan(v)
    if there.all():
        L = cholesky(S)
        white = np.linalg.solve(L, v[..., None])[..., 0]
        return (white * white).sum(axis=-1), L, there
    both = there[..., :, None] & there[..., None, :]
    L = cholesky(np.where(both, S, np.eye(v.shape[-1])))
    white = np.linalg.solve(L, np.where(there, v, 0.0)[..., None])[..., 0]
    form = np.where(there.any(axis=-1), (white * white).sum(axis=-1), np.nan)
    return form, L, there
