"""Fewer members of a Gaussian sum, compiled: light ones go, alike ones are united."""

import numpy as np

from .._cholesky import compiled, factor
from ._ring_member import LOST, put, put_square

_HEAVY = 100  # members, at most, of which the nearest is looked for


@compiled
def drop(x, P, weight, count, least):
    """Bring the weights to a sum of one, without those below `least`.

    Return the number left, and the logarithm of the sum before.
    """
    top = LOST
    for m in range(count):
        top = max(top, weight[m])
    if top == LOST:
        return 0, LOST
    total = 0.0
    for m in range(count):
        total += np.exp(weight[m] - top)
    total = top + np.log(total)
    limit, kept = np.log(least), 0
    for m in range(count):
        if weight[m] - total >= limit:
            put(x[kept], x[m])
            put_square(P[kept], P[m])
            weight[kept] = weight[m]
            kept += 1
    left = 0.0
    for m in range(kept):
        left += np.exp(weight[m] - top)
    for m in range(kept):
        weight[m] -= top + np.log(left)
    return kept, total


@compiled
def merge(x, P, weight, count, loss):
    """Unite members that are alike; return the number left.

    From the lightest on, each is united with the nearest of the heavier ones, if Runnalls' (2007)
    bound on the Kullback-Leibler cost of it is below `loss`.
    """
    L, d, both = np.zeros((6, 6)), np.empty(6), np.zeros((6, 6))
    logs, y, v = np.empty(count), np.empty((count, 6)), np.empty((count, 6))
    # Nearness is that along the axes of the members' mean covariance, whitened.
    alive = np.empty(count)
    for m in range(count):
        alive[m] = np.exp(weight[m])
        for a in range(6):
            for b in range(6):
                both[a, b] += alive[m] * P[m, a, b]
    whitener = np.zeros((6, 6))
    factor(both, whitener)
    for m in range(count):
        logs[m] = factor(P[m], L)
        _whitened(x[m], P[m], whitener, both, y[m], v[m])
    # Places by weight, the heaviest first, by insertion: np.argsort takes a second to compile.
    order = np.empty(count, np.int64)
    for m in range(count):
        p = m
        while p > 0 and weight[order[p - 1]] < weight[m]:
            order[p] = order[p - 1]
            p -= 1
        order[p] = m
    for p in range(count - 1, 0, -1):
        i = order[p]
        nearest, least = -1, np.inf
        for q in range(min(p, _HEAVY)):
            j = order[q]
            share = alive[j] / (alive[i] + alive[j])
            limit, distance = least / share, 0.0
            for a in range(6):
                apart = y[j, a] - y[i, a]
                distance += apart * apart / (v[i, a] + share * (v[j, a] - v[i, a]))
                if distance >= limit:
                    break
            if distance < limit:
                nearest, least = j, distance * share
        if nearest < 0:
            break
        j = nearest
        share = alive[i] / (alive[i] + alive[j])
        for a in range(6):
            d[a] = x[j, a] - x[i, a]
        for a in range(6):
            for b in range(6):
                both[a, b] = P[j, a, b] + share * (P[i, a, b] - P[j, a, b])
                both[a, b] += share * (1 - share) * d[a] * d[b]
        log = factor(both, L)
        cost = 0.5 * ((alive[i] + alive[j]) * log - alive[i] * logs[i] - alive[j] * logs[j])
        if cost < loss:
            for a in range(6):
                x[j, a] -= share * d[a]
            put_square(P[j], both)
            alive[j] += alive[i]
            alive[i] = 0.0
            logs[j] = log
            _whitened(x[j], P[j], whitener, both, y[j], v[j])
    kept = 0
    for m in range(count):
        if alive[m] > 0.0:
            put(x[kept], x[m])
            put_square(P[kept], P[m])
            weight[kept] = np.log(alive[m])
            kept += 1
    return kept


@compiled
def _whitened(x, P, L, spare, y, v):
    """Write inv(L) x to `y`, and the diagonal of inv(L) P inv(L)' to `v`."""
    for i in range(6):
        y[i] = x[i]
        for k in range(i):
            y[i] -= L[i, k] * y[k]
        y[i] /= L[i, i]
        for j in range(6):
            s = P[i, j]
            for k in range(i):
                s -= L[i, k] * spare[k, j]
            spare[i, j] = s / L[i, i]
    # The rows of inv(L) P are there; the same from the right, as far as the diagonal.
    for i in range(6):
        for j in range(i + 1):
            s = spare[i, j]
            for k in range(j):
                s -= L[j, k] * spare[i, k]
            spare[i, j] = s / L[j, j]
        v[i] = spare[i, i]
