"""Densities of Gaussians: quadratic forms such as NIS, likelihoods, mixtures; unchecked."""

import numpy as np

from .. import _checks
from .._typing import FloatArray
from .covariances import cholesky


@_checks.quiet
def quadratic_forms(v: FloatArray, S: FloatArray) -> FloatArray:
    """Return v' S^-1 v of many vectors with one covariance, such as the NIS of all detections.

    Parameters
    ----------
    v : ndarray, shape (..., D, m)
        Vectors; the form is that of the components which are not NaN.
    S : ndarray, shape (..., m, m)
        Covariances.

    Returns
    -------
    ndarray, shape (..., D)
        Not negative; NaN where all components are.

    Raises
    ------
    ValueError
        If a covariance is singular to rounding.
    """
    there = ~np.isnan(v)
    if there.all():
        white = np.linalg.solve(cholesky(S), v.mT)
        return np.sum(white * white, axis=-2)
    return quadratic_form(v, S[..., None, :, :])


@_checks.quiet
def quadratic_form(v: FloatArray, S: FloatArray) -> FloatArray:
    """Return v' S^-1 v of each vector with a covariance of its own, such as NIS.

    Parameters
    ----------
    v : ndarray, shape (..., m)
        Vectors; the form is that of the components which are not NaN.
    S : ndarray, shape (..., m, m)
        Covariances.

    Returns
    -------
    ndarray, shape (...)
        Not negative; NaN where all components are.

    Raises
    ------
    ValueError
        If a covariance is singular to rounding.
    """
    return _form(v, S)[0]


@_checks.quiet
def log_density(v: FloatArray, S: FloatArray) -> FloatArray:
    """Return the log density of zero-mean Gaussians.

    Parameters
    ----------
    v : ndarray, shape (..., m)
        Vectors; the density is that of the components which are not NaN.
    S : ndarray, shape (..., m, m)
        Covariances.

    Returns
    -------
    ndarray, shape (...)
        Zero where all components are NaN: a missing measurement favors no model.

    Raises
    ------
    ValueError
        If a covariance is singular to rounding.
    """
    form, L, there = _form(v, S)
    size = np.sum(there, axis=-1)
    diagonal = np.diagonal(L, axis1=-2, axis2=-1)
    logarithm = size * np.log(2 * np.pi) / 2 + np.sum(np.log(diagonal), axis=-1)
    return np.where(size > 0, -form / 2 - logarithm, 0.0)


@_checks.quiet
def mixture(x: FloatArray, P: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of mixtures.

    Parameters
    ----------
    x : ndarray, shape (..., M, n)
        Means of the M parts.
    P : ndarray, shape (..., M, n, n)
        Their covariances.
    weight : ndarray, shape (..., M)
        Their probabilities.

    Returns
    -------
    x : ndarray, shape (..., n)
    P : ndarray, shape (..., n, n)
    """
    mean = np.sum(weight[..., None] * x, axis=-2)
    off = x - mean[..., None, :]
    spread = P + off[..., :, None] * off[..., None, :]
    return mean, np.sum(weight[..., None, None] * spread, axis=-3)


def _form(v, S):
    """Return the quadratic forms, the factors of S for the components there, and which are."""
    there = ~np.isnan(v)
    if there.all():
        L = cholesky(S)
        white = np.linalg.solve(L, v[..., None])[..., 0]
        return np.sum(white * white, axis=-1), L, there
    both = there[..., :, None] & there[..., None, :]
    L = cholesky(np.where(both, S, np.eye(v.shape[-1])))
    white = np.linalg.solve(L, np.where(there, v, 0.0)[..., None])[..., 0]
    form = np.where(there.any(axis=-1), np.sum(white * white, axis=-1), np.nan)
    return form, L, there
