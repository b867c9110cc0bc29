"""Samples that the members of a Gaussian sum do not expect, compiled."""

import numpy as np

from .._cholesky import compiled
from ._ring_member import LOST, measure, state_at


@compiled
def refuse(held, weights, length, x, P, weight, count, positions, r, c, flat, limit, state, G,
           g):  # fmt: skip
    """Set samples of a block (length, N) to NaN, each sensor on its own; return their evidence.

    Those are refused whose square, as a deviation from the mean that the members predict for the
    middle of the block, is more than `limit` times its variance. `weights` (length, N) are inverse
    variances of the noise. Without members it is the deviation from the median of the block. As
    evidence they count as if they were at the edge of the gate, so that a filter gains nothing from
    what it refuses.
    """
    own, evidence = np.empty(length), 0.0
    for n in range(held.shape[1]):
        mean = spread = total = 0.0
        for m in range(count):
            if weight[m] == LOST:
                continue
            if not flat:
                state_at(x[m], r, state, G)
            h = measure(x[m], np.exp(-x[m, 5]), state, G, positions[n], r, c, g)
            variance = h * h
            for i in range(6):
                for j in range(6):
                    variance += g[i] * P[m, i, j] * g[j]
            w = np.exp(weight[m])
            total += w
            mean += w * h
            spread += w * variance
        if total > 0.0:
            mean /= total  # weights add up to one only while no member is lost
            spread = max(spread / total - mean * mean, 0.0)
        else:
            seen = 0
            # In order, by insertion: np.median takes seconds to compile.
            for k in range(length):
                if not np.isnan(held[k, n]):
                    p = seen
                    while p > 0 and own[p - 1] > held[k, n]:
                        own[p] = own[p - 1]
                        p -= 1
                    own[p] = held[k, n]
                    seen += 1
            if seen == 0:
                continue
            mean = (own[(seen - 1) // 2] + own[seen // 2]) / 2
        for k in range(length):
            off, S = held[k, n] - mean, spread + 1 / weights[k, n]
            if off * off > limit * S:
                held[k, n] = np.nan
                evidence -= 0.5 * (limit + np.log(2 * np.pi * S))
    return evidence
