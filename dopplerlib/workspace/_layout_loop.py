"""Bounds and second valleys of many targets in uniform motion, compiled.

`seen` has the times at which the mean of a block of samples stands for the block, `weights`
(times, N) the samples of that block over the variance of one.
"""

from math import erfc, sqrt

import numpy as np

from .. import _cholesky
from .._cholesky import compiled, factor, solve
from .._compile import cached_njit, fingerprint, inner_njit
from ..kernels import doppler as kernel

_inline = inner_njit(forceinline=True)
_shift = _inline(kernel.doppler_shift_and_gradient)

_STEPS = 200  # of a search for a valley, at most
_SETTLED = 1e-5  # nats: so little a step promises where the search ends
_SAME = 0.1  # squared standard deviations from a valley that is known: its search ends there
_SEPARATE = 1.0  # standard deviation: nearer to each other two valleys are one


@compiled
def _put(target, source):
    """Copy a state; numba takes seconds to compile what NumPy writes in one line."""
    for i in range(6):
        target[i] = source[i]


@compiled
def _normal(x, true, positions, c, seen, weights, mean, prior, A, g):
    """Return half of chi-square of the state `x` where the shifts are those of `true`.

    Write its gradient to `g` and the information at `x`, with that of the prior, to `A`.
    """
    cost = 0.0
    for i in range(6):
        s = 0.0
        for j in range(6):
            A[i, j] = prior[i, j]
            s += prior[i, j] * (x[j] - mean[j])
        g[i] = s
        cost += 0.5 * s * (x[i] - mean[i])
    row = np.empty(6)
    for k in range(len(seen)):
        t = seen[k]
        for n in range(len(positions)):
            w = weights[k, n]
            if w == 0.0:
                continue
            h, row[0], row[1], row[2], row[3], row[4], row[5] = _shift(
                x[0] + t * x[3], x[1] + t * x[4], x[2] + t * x[5], x[3], x[4], x[5],
                positions[n, 0], positions[n, 1], positions[n, 2], c,
            )  # fmt: skip
            row[3] += t * row[0]
            row[4] += t * row[1]
            row[5] += t * row[2]
            off = h - true[k, n]
            cost += 0.5 * w * off * off
            for i in range(6):
                g[i] += w * off * row[i]
                for j in range(i + 1):
                    A[i, j] += w * row[i] * row[j]
    for i in range(6):
        for j in range(i):
            A[j, i] = A[i, j]
    return cost


@compiled
def _shifts(x, positions, c, seen, out):
    """Write the shifts of a target at the times `seen`."""
    for k in range(len(seen)):
        t = seen[k]
        for n in range(len(positions)):
            out[k, n] = _shift(
                x[0] + t * x[3], x[1] + t * x[4], x[2] + t * x[5], x[3], x[4], x[5],
                positions[n, 0], positions[n, 1], positions[n, 2], c,
            )[0]  # fmt: skip


@compiled
def _apart(x, other, A):
    """Return the squared distance of two states for an information A."""
    apart = 0.0
    for i in range(6):
        for j in range(6):
            apart += A[i, j] * (x[i] - other[i]) * (x[j] - other[j])
    return apart


@compiled
def _descend(x, true, positions, c, seen, weights, mean, prior, least, A, g, L, known, A_known):
    """Move `x` to the bottom of its valley, by Levenberg and Marquardt; return the cost there.

    A and its factor L are those of the bottom. Infinite if the valley leads into the plane, or is
    that of the state `known`, with the information `A_known`.
    """
    new, step, damped, spare = np.empty(6), np.empty(6), np.empty((6, 6)), np.empty((6, 6))
    g_new = np.empty(6)
    cost = _normal(x, true, positions, c, seen, weights, mean, prior, A, g)
    damping = 1e-3
    for _ in range(_STEPS):
        for i in range(6):
            step[i] = -g[i]
            for j in range(6):
                damped[i, j] = A[i, j]
            damped[i, i] *= 1 + damping
        if np.isnan(factor(damped, L)):
            return np.inf
        solve(L, step)
        promised = 0.0
        for i in range(6):
            promised -= 0.5 * g[i] * step[i]
            new[i] = x[i] + step[i]
        cost_new = np.inf
        if new[0] > least and new[0] + seen[-1] * new[3] > least:
            cost_new = _normal(new, true, positions, c, seen, weights, mean, prior, spare, g_new)
        if cost_new < cost:
            cost = cost_new
            for i in range(6):
                x[i], g[i] = new[i], g_new[i]
                for j in range(6):
                    A[i, j] = spare[i, j]
            damping *= 0.2
            if promised < _SETTLED:
                return cost
            if _apart(x, known, A_known) < _SAME:
                return np.inf
        else:
            if promised < _SETTLED:
                return cost
            damping = max(10 * damping, 1e-3)
    return np.inf


@compiled
def _covariances(x, positions, c, seen, weights, prior, end, out):
    """Write the bounds (R, 6, 6) of states `end` seconds after `x`."""
    A, L, g, column = np.empty((6, 6)), np.zeros((6, 6)), np.empty(6), np.empty(6)
    true = np.zeros((len(seen), len(positions)))
    for r in range(len(x)):
        _normal(x[r], true, positions, c, seen, weights, x[r], prior, A, g)
        if np.isnan(factor(A, L)):
            out[r, 0, 0] = np.nan
            continue
        for j in range(6):
            for i in range(6):
                column[i] = 1.0 if i == j else 0.0
            # a column of the transition, from the right: P F' with F = [1, end; 0, 1]
            if j < 3:
                column[j + 3] = end
            solve(L, column)
            for i in range(3):
                column[i] += end * column[i + 3]
            for i in range(6):
                out[r, i, j] = column[i]


@compiled
def _chances(x, starts, positions, c, seen, weights, mean, prior, least, chance, twin):
    """Write the probabilities that a second valley weighs more than the true one.

    Searches for it begin at `starts` (R, S, 6). `twin` gets the bottom of the likeliest, and
    the state itself where there is none.
    """
    A, L, g = np.empty((6, 6)), np.zeros((6, 6)), np.empty(6)
    A_twin, L_twin = np.empty((6, 6)), np.zeros((6, 6))
    here, there = np.empty(6), np.empty(6)
    true = np.empty((len(seen), len(positions)))
    unknown = np.full((6, 6), np.inf)
    at_here, at_there = np.empty_like(true), np.empty_like(true)
    for r in range(len(x)):
        chance[r] = 0.0
        _put(twin[r], x[r])
        _shifts(x[r], positions, c, seen, true)
        _put(here, x[r])
        cost = _descend(here, true, positions, c, seen, weights, mean, prior, least, A, g, L,
                        here, unknown)  # fmt: skip
        volume = factor(A, L)
        _shifts(here, positions, c, seen, at_here)
        for s in range(starts.shape[1]):
            _put(there, starts[r, s])
            if not there[0] > least:
                continue
            cost_twin = _descend(there, true, positions, c, seen, weights, mean, prior, least,
                                 A_twin, g, L_twin, here, A)  # fmt: skip
            if not np.isfinite(cost_twin) or (
                min(_apart(there, here, A), _apart(there, here, A_twin)) < _SEPARATE**2
            ):
                continue
            volume_twin = factor(A_twin, L_twin)
            _shifts(there, positions, c, seen, at_there)
            square = 0.0
            for k in range(len(seen)):
                for n in range(len(positions)):
                    square += weights[k, n] * (at_there[k, n] - at_here[k, n]) ** 2
            ahead = cost - cost_twin + 0.5 * (volume - volume_twin)
            found = 0.5 * erfc((0.5 * square - ahead) / sqrt(2 * square))
            if found > chance[r]:
                chance[r] = found
                _put(twin[r], there)


def _cached(compiled_in):
    """Return both loops, compiled once for all processes."""

    @cached_njit
    def covariances(*arguments):
        compiled_in  # noqa: B018  (see fingerprint)
        _covariances(*arguments)

    @cached_njit
    def chances(*arguments):
        compiled_in  # noqa: B018
        _chances(*arguments)

    return covariances, chances


covariances, chances = _cached(fingerprint(_cholesky, kernel))
