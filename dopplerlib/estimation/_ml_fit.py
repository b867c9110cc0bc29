"""The fit of one run with a loss, correlated errors, clocks, and a covariance of one's choice."""

from typing import NamedTuple

import numpy as np

from ._ml_covariance import bootstrap, information, sandwich, slopes
from ._ml_polish import Refined, least_squares, refine
from ._ml_robust import TIE, residuals, robust_fit
from .initial_estimate import FALSE_ALARM
from .whitening import whitening_matrices


class Options(NamedTuple):
    """Arguments of `ml_initialize`; `sample` is that of the offsets of an "epoch" clock."""

    robust: bool
    estimate_scale: bool
    correlation: np.ndarray | None
    covariance: str
    lags: int | None
    resamples: int
    sample: int


class Fit(NamedTuple):
    """Results of one run, with n = 6 + C components and N measurements a sample."""

    x: np.ndarray
    information: np.ndarray
    P: np.ndarray | None
    cost: float
    arrived: bool
    second_x: np.ndarray
    second_cost: float
    weights: np.ndarray
    scale: float


def fit_run(problem, z, deviations, options, rng):
    """Return the `Fit` of one run (K, N), or None if it is too incomplete."""
    box, robust, there = (problem.lower, problem.upper), options.robust, ~np.isnan(z)
    needed = problem.unknowns(there.ravel())
    if np.sum(there) < needed or (robust and np.sum(there) <= 2 * needed):
        return None
    if robust:
        fit = robust_fit(problem, z, deviations, options.estimate_scale, rng)
        if fit is None:
            return None
        found, second, weights, scale = fit
        data = problem.data(z, scale * deviations)
    else:
        begun = problem.search(z[None], deviations)
        x = np.concatenate([begun.x, begun.second_x])
        x = x[np.isfinite(x).all(axis=1)]
        if not len(x):
            return None
        data, weights, scale = problem.data(z, deviations), np.where(there, 1.0, 0.0), 1.0
        found, second = _best(refine(data, x, box))
    kept, agrees = weights > 0, True
    if options.correlation is not None:
        # Errors of wrong windows belong to no law: those windows are missing, all others count.
        weights, robust = np.where(kept, 1.0, 0.0), False
        roots = whitening_matrices(options.correlation, kept)
        data = problem.data(np.where(kept, z, np.nan), scale * deviations, roots)
        x = np.concatenate([found.x, second.x])
        clocks = np.concatenate([found.clocks, second.clocks])
        found, second = _best(refine(data, x, box, least_squares, None, clocks))
        agrees = _agrees(len(options.correlation), kept, found, data)
    kept = kept.ravel()
    group = options.sample if problem.epoch else 0
    r, A = slopes(data, found, kept, group)
    cost, P = np.sum(r[kept] ** 2), None
    free = np.append(box[0] < box[1], np.ones(A.shape[1] - 6, bool))
    if options.covariance == "sandwich":
        P = sandwich(r, A, kept, robust, len(z), options.lags, free)
    elif options.covariance == "bootstrap":
        P = bootstrap(
            data, found, box, robust, kept, options.lags, options.resamples, group, rng
        )  # fmt: skip
    second_x, second_cost = np.full(A.shape[1], np.nan), np.nan
    if len(second.x):
        second_x = np.append(second.x[0], second.clocks[0, group])
        second_cost = cost + second.cost[0] - found.cost[0]
    return Fit(
        np.append(found.x[0], found.clocks[0, group]), information(A, kept, robust), P, cost,
        found.arrived[0] and agrees, second_x, second_cost, np.where(there, weights, np.nan), scale,
    )  # fmt: skip


def _agrees(lags, kept, found, data):
    """Return whether residuals that were made white are so, by Ljung and Box (1978).

    Of white ones each product over a lag is about normal, with a variance of the pairs there are
    times the squared variance, so that the sum over `lags` is chi-square: beyond its quantile with
    about the probability `FALSE_ALARM`.
    """
    from scipy.special import chdtri

    r = residuals(data, found).reshape(kept.shape)
    variance = np.sum(r**2) / np.sum(kept)
    total = 0.0
    for lag in range(1, min(lags, len(r) - 1) + 1):
        pairs = np.sum(kept[lag:] & kept[:-lag])
        total += np.sum(r[lag:] * r[:-lag]) ** 2 / max(pairs, 1)
    return total <= chdtri(lags, FALSE_ALARM) * variance**2


def _best(found: Refined):
    """Return the best fit, the first of equal ones, and the second-best if there is one."""
    first = 0 if found.cost[0] <= found.cost.min() * (1 + TIE) + TIE else np.argmin(found.cost)
    return found.of([first]), found.of(np.arange(len(found.cost)) != first)
