"""Likelihoods that outliers do not rule, and intervals of parameters that maximize them."""

import numpy as np

_WIDE = 4.0  # scale of the Cauchy density of outliers over the deviation of the rest


def log_density(form, log_det, size, outliers, form_of_outliers=None, log_det_of_outliers=None):
    """Return the log density of vectors that are Gaussian, but for a fraction of outliers.

    form (...): v' S^-1 v of each vector v, and log_det (...), the logarithm of the determinant of
        S; for the outliers the same if not given.
    size (...): Number of its components.
    outliers: Fraction whose density is that of Cauchy with the scatter matrix 16 S. It has no
        moments, so that the largest outlier shifts a scale by no more than others do.
    """
    if form_of_outliers is None:
        form_of_outliers, log_det_of_outliers = form, log_det
    from scipy.special import gammaln  # here: it takes longer to load than all the rest

    half = (size + 1) / 2
    inside = -(size * np.log(2 * np.pi) + log_det + form) / 2
    outside = (
        gammaln(half) - half * np.log(np.pi) - size * np.log(_WIDE) - log_det_of_outliers / 2
        - half * np.log1p(form_of_outliers / _WIDE**2)
    )  # fmt: skip
    with np.errstate(divide="ignore"):  # a fraction of zero
        return np.logaddexp(np.log1p(-outliers) + inside, np.log(outliers) + outside)


def outlier_fraction(terms):
    """Return the fraction of outliers, from 1e-6 to 1/2, for which the likelihood is greatest.

    terms(fraction) (...): Terms of the log likelihood. Its mean is a concave function of it.
    """
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda v: -np.mean(terms(np.exp(v))), bounds=(np.log(1e-6), np.log(0.5)), method="bounded"
    )
    return float(np.exp(found.x))


def scores(terms, theta, step):
    """Return the scores (p, ...) of the terms of a log likelihood by central differences.

    terms(theta) (...): The terms, smooth in parameters theta (p,) of order one, such as logarithms.
    """
    ends = [(terms(theta + h), terms(theta - h)) for h in step * np.eye(len(theta))]
    return np.stack([(up - down) / (2 * step) for up, down in ends])


def information(terms, theta, step):
    """Return minus the Hessian (p, p) of a log likelihood, see `scores`."""
    p = len(theta)
    steps, middle = step * np.eye(p), np.sum(terms(theta))
    hessian = np.empty((p, p))
    for i in range(p):
        ends = (np.sum(terms(theta + sign * steps[i])) for sign in (1, -1))
        hessian[i, i] = sum(ends) - 2 * middle
        for j in range(i):
            both, other = steps[i] + steps[j], steps[i] - steps[j]
            ends = [np.sum(terms(theta + v)) for v in (both, -both, other, -other)]
            hessian[i, j] = hessian[j, i] = (ends[0] + ends[1] - ends[2] - ends[3]) / 4
    return -hessian / step**2


def deviations(score, hessian):
    """Return the standard deviations (p,) of parameters from the scores of independent blocks.

    score (p, B): Sums over each block.
    hessian (p, p): See `information`. If it is not positive definite, the deviations are NaN.
    """
    blocks = score.shape[1]
    off = score - score.mean(axis=1, keepdims=True)
    meat = off @ off.T * blocks / (blocks - 1)
    if not np.isfinite(hessian).all() or np.linalg.eigvalsh(hessian)[0] <= 0:
        return np.full(len(score), np.nan)
    bread = np.linalg.inv(hessian)
    return np.sqrt(np.diagonal(bread @ meat @ bread))
