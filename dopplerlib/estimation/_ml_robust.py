"""A fit that survives wrong measurements: high breakdown first, then efficient.

1. Small random subsets of the measurements are solved as if they were all. One of them is free of
   wrong ones, but for a probability of `MISSED`.
2. From each, a few concentration steps of least trimmed squares (Rousseeuw and Van Driessen 2006):
   refine on the better half of the residuals. The best ends are refined to the end, and the one
   with the least trimmed sum is the beginning. It breaks down with half of the measurements, and
   not before, wherever the wrong ones lie.
3. From there an M-estimate with Tukey's bisquare (Yohai 1987), whose scale is given, or that of the
   residuals. With the weights that it leaves the box is searched again, until that finds nothing
   better.
"""

from itertools import combinations, islice
from typing import NamedTuple

import numpy as np

from ._ml_polish import Data, Refined, bisquare, refine, trimmed

SHARE, MISSED = 0.3, 1e-3  # of wrong measurements, and the probability not to draw a clean subset

FEW, BEST = 3, 8  # concentration steps of all subsets, and subsets that are refined to the end

ROUNDS = 20  # of scale and weights; three are usual

_TRIED = 500  # sets of links that give the clocks of a sample; of 9 links and 2 clocks there are 36

TIE = 1e-9  # relative difference between equal costs

DISTINCT = 1e-3  # two states differ if a component does by this share of the box


class RobustFit(NamedTuple):
    """The best fit and the second-best, one row each if there are any; and weights and scale."""

    best: Refined
    second: Refined
    weights: np.ndarray
    scale: float


def robust_fit(problem, z, deviations, estimate_scale, rng):
    """Return the fit of one run (K, N) with enough measurements; None if no subset is solved."""
    data = problem.data(z, deviations)
    there, box = data.there, (problem.lower, problem.upper)
    M, unknowns = np.sum(there), problem.unknowns(there)
    found = problem.begin(z, deviations, _subsets(problem, there.reshape(z.shape), rng), rng)
    if not len(found.x):
        return None
    half = trimmed((M + unknowns + 1) // 2)
    found = refine(data, found.x, box, half, clocks=found.clocks, iterations=FEW)
    found = found.of(np.argsort(found.cost, kind="stable")[:BEST])
    found = refine(data, found.x, box, half, clocks=found.clocks)
    found, scale = found.of(np.argsort(found.cost, kind="stable")), 1.0
    if estimate_scale:
        # The median of the absolute value of a normal error is 0.6745 of its deviation.
        r = residuals(data, found.of([0]))[there]
        scale = np.median(np.abs(r)) / 0.6745 * np.sqrt(M / (M - unknowns))
    for _ in range(ROUNDS):
        scale = max(scale, 1e-150)
        data = problem.data(z, scale * deviations)
        if problem.epoch:
            clocks = np.stack([_epoch_clocks(data, x) for x in found.x])
        else:
            clocks = found.clocks
        found = refine(data, found.x, box, bisquare, clocks=clocks)
        found = found.of([np.argmin(found.cost)])
        w = bisquare(residuals(data, found), data.there)[1].reshape(z.shape)
        # A measurement of weight w is one whose variance is 1 / w times as large.
        with np.errstate(divide="ignore"):
            again = problem.search(
                np.where(w > 0, z, np.nan)[None],
                np.where(w > 0, scale * deviations / np.sqrt(w), 1.0),
            )
        x = np.concatenate([again.x, again.second_x])
        x = x[np.isfinite(x).all(axis=1)]
        if not len(x):
            return None
        others = refine(data, x, box, bisquare, clocks=np.repeat(found.clocks, len(x), axis=0))
        # The search has rules for states that are equally good: what it found goes before.
        better = others.cost[0] < found.cost[0] * (1 - TIE) - TIE
        if others.cost[0] <= found.cost[0] * (1 + TIE) + TIE:
            found = others.of([0])
        r = residuals(data, found)
        w, used = bisquare(r, there)[1], scale
        if estimate_scale:
            kept = w > 0
            scale *= np.sqrt(np.sum(r[kept] ** 2) / max(np.sum(kept) - problem.unknowns(kept), 1))
        if not better and abs(scale - used) <= 1e-9 * used:
            break
    apart = (np.abs(others.x - found.x) > DISTINCT * (box[1] - box[0])).any(axis=1)
    second = others.of(np.flatnonzero(apart)[np.argsort(others.cost[apart])[:1]])
    return RobustFit(found, second, w.reshape(z.shape), used)


def residuals(data: Data, found: Refined):
    """Return standardized residuals (K N,) of one fit; zero where a measurement is missing."""
    r = data.residuals(found.x)[0]
    return (r + (data.columns @ found.clocks[..., None]).reshape(r.shape))[0]


def _epoch_clocks(data, x):
    """Return clocks (K, C) of each sample at a state: of those by few links the likeliest.

    A sample whose clocks are far off has no weights that could lead back.
    """
    D = data.columns
    groups, each, count = D.shape
    r = data.residuals(x[None])[0].reshape(groups, each)
    there = data.there.reshape(groups, each)
    best, clocks = np.full(groups, np.inf), np.zeros((groups, count))
    for few in islice(combinations(range(each), count), _TRIED):
        few = list(few)
        c = -(np.linalg.pinv(D[:, few], rcond=1e-9) @ r[:, few, None])
        cost = bisquare(r + (D @ c)[..., 0], there)[0].sum(axis=1)
        better = cost < best
        best[better], clocks[better] = cost[better], c[better, :, 0]
    return clocks


def _subsets(problem, there, rng):
    """Return which measurements (subsets, K, N) determine a state, and little more.

    Half of them are simple random samples: then a sensor that is wrong throughout is left out by
    many. The others have as many measurements of each sensor as can be, which determines more.
    Clocks that are others at each sample need some samples with several measurements each.
    """
    places, (samples, sensors) = np.argwhere(there), there.shape
    clocks = problem.design.shape[-1]
    size = problem.free + 1 + (0 if problem.epoch else clocks)
    epochs = samples
    if problem.epoch:
        epochs = min(samples, max(2, -(-size // max(sensors - clocks, 1))))
        size += epochs * clocks
    draws = int(np.ceil(np.log(MISSED) / np.log1p(-((1 - SHARE) ** size))))
    subsets = np.zeros((draws * (1 + (sensors > 1)), samples, sensors), bool)
    for i, subset in enumerate(subsets):
        order = rng.permutation(len(places))
        if problem.epoch:
            chosen = rng.permutation(np.unique(places[:, 0]))[:epochs]
            order = order[np.isin(places[order, 0], chosen)]
            order = order[np.argsort(_rank(places[order, 0]), kind="stable")]
        elif i >= draws:
            order = order[np.argsort(_rank(places[order, 1]), kind="stable")]
        subset[tuple(places[order[:size]].T)] = True
    return subsets


def _rank(labels):
    """Return for each entry the number of equal ones before it."""
    order = np.argsort(labels, kind="stable")
    rank = np.empty(len(labels), int)
    ordered = labels[order]
    rank[order] = np.arange(len(labels)) - np.searchsorted(ordered, ordered)
    return rank
