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

from functools import partial

import numpy as np

from ._ml_polish import bisquare, refine, trimmed

SHARE, MISSED = 0.3, 1e-3  # of wrong measurements, and the probability not to draw a clean subset

FEW, BEST = 3, 8  # concentration steps of all subsets, and subsets that are refined to the end

ROUNDS = 20  # of scale and weights; three are usual

TIE = 1e-9  # relative difference between equal costs

DISTINCT = 1e-3  # two states differ if a component does by this share of the box


def robust_fit(problem, z, deviations, estimate_scale, rng):
    """Return state, whether it is an optimum, weights (K, N), scale, and the second-best state.

    `z` (K, N) is one run with more than twice as many measurements as unknowns. The second-best
    state comes with the cost that it has more; it is NaN if there is none. None if no subset can
    be solved.
    """
    there = ~np.isnan(z)
    values, sigma = z[there], deviations[there]
    M, unknowns, box = values.size, problem.unknowns, (problem.lower, problem.upper)

    def residuals(x, scale=1.0):
        h, J = problem.predict(x)
        return (h[:, there] - values) / (scale * sigma), J[:, there] / (scale * sigma)[:, None]

    x = _beginnings(problem, z, deviations, there, rng)
    if not len(x):
        return None
    half = trimmed((M + unknowns + 1) // 2)
    x, cost, _ = refine(residuals, x, *box, half, FEW)
    x, cost, _ = refine(residuals, x[np.argsort(cost, kind="stable")[:BEST]], *box, half)
    x, scale = x[np.argsort(cost, kind="stable")], 1.0
    if estimate_scale:
        # The median of the absolute value of a normal error is 0.6745 of its deviation.
        scale = np.median(np.abs(residuals(x[:1])[0])) / 0.6745 * np.sqrt(M / (M - unknowns))
    for _ in range(ROUNDS):
        scale = max(scale, 1e-150)
        scaled = partial(residuals, scale=scale)
        x, cost, arrived = refine(scaled, x, *box, bisquare)
        best = [np.argmin(cost)]
        x, cost, arrived = x[best], cost[best], arrived[best]
        w = np.full(z.shape, np.nan)
        w[there] = bisquare(scaled(x)[0])[1][0]
        # A measurement of weight w is one whose variance is 1 / w times as large.
        with np.errstate(divide="ignore"):
            found = problem.search(
                np.where(w > 0, z, np.nan)[None],
                np.where(w > 0, scale * deviations / np.sqrt(w), 1.0),
            )
        others = np.concatenate([found.x, found.second_x])
        others = others[np.isfinite(others).all(axis=1)]
        if not len(others):
            return None
        others, other_cost, other_arrived = refine(scaled, others, *box, bisquare)
        # The search has rules for states that are equally good: what it found goes before.
        better = other_cost[0] < cost[0] * (1 - TIE) - TIE
        if other_cost[0] <= cost[0] * (1 + TIE) + TIE:
            x, cost, arrived = others[:1], other_cost[:1], other_arrived[:1]
        apart = (np.abs(others - x) > DISTINCT * (problem.upper - problem.lower)).any(axis=1)
        r = scaled(x)[0][0]
        w[there] = bisquare(r[None])[1][0]
        before, kept = scale, w[there] > 0
        if estimate_scale:
            scale *= np.sqrt(np.sum(r[kept] ** 2) / max(kept.sum() - unknowns, 1))
        if not better and abs(scale - before) <= 1e-9 * before:
            break
    second = np.full(x.shape[1], np.nan), np.nan
    if apart.any():
        best = np.argmin(np.where(apart, other_cost, np.inf))
        second = others[best], other_cost[best] - cost[0]
    return x[0], arrived[0], w, before, *second


def _beginnings(problem, z, deviations, there, rng):
    """Return states (subsets, n) that solve small random subsets of the measurements.

    Half of them are simple random samples: then a sensor that is wrong throughout is left out by
    many. The others have as many measurements of each sensor as can be, which determines more.
    """
    size = problem.unknowns + 1
    draws = int(np.ceil(np.log(MISSED) / np.log1p(-((1 - SHARE) ** size))))
    places, sensors = np.argwhere(there), z.shape[1]
    x = []
    for draw in range(draws * (1 + (sensors > 1))):
        order = rng.permutation(len(places))
        if draw >= draws:
            # The first of every sensor in this order, then the second of each, and so on.
            by_sensor = np.argsort(places[order, 1], kind="stable")
            ordered = places[order[by_sensor], 1]
            place = np.arange(len(places)) - np.searchsorted(ordered, ordered)
            order = order[by_sensor[np.argsort(place, kind="stable")]]
        k, n = places[order[:size]].T
        rows, row = np.unique(k, return_inverse=True)
        subset = np.full((1, len(rows), sensors), np.nan)
        subset[0, row, n] = z[k, n]
        x.append(problem.search(subset, deviations[rows], rows).x[0])
    x = np.array(x)
    return x[np.isfinite(x).all(axis=1)]
