"""Modes of the posterior of a target at constant velocity, compiled: start and new start.

A Gaussian sum starts with one member from each window of a grid; and what goes straight can be
fitted again to all that was measured, member by member.
"""

import numpy as np

from .._cholesky import compiled, factor, solve
from ..kernels import doppler as kernel
from ._ring_member import LOST, inline, put, state_at

_STEPS, _HALVINGS, _GAIN = 4, 5, 1e-2  # of a descent
_EQUAL = 0.1  # squared distance of two modes that are one, in deviations

shift_in_space = inline(kernel.doppler_shift_and_gradient)


@inline
def _pulled(G, a0, a1, a2, a3, a4, a5):
    """Return G' a, for the derivatives G of a state by its coordinates."""
    return (
        G[0, 0] * a0 + G[1, 0] * a1 + G[3, 0] * a3,
        G[0, 1] * a0 + G[2, 1] * a2 + G[3, 1] * a3,
        G[3, 2] * a3 + G[4, 2] * a4,
        G[3, 3] * a3 + G[5, 3] * a5,
        G[3, 4] * a3,
        G[0, 5] * a0 + G[1, 5] * a1 + G[2, 5] * a2 + G[3, 5] * a3 + G[4, 5] * a4 + G[5, 5] * a5,
    )


@compiled
def objective(x, scans, variances, middles, now, positions, r, c, mean, information, window, least,
              state, G, g, H, A, B):  # fmt: skip
    """Return minus the log density of scans, prior and window at `x`; g and H of it.

    The scans (S, N) are of the times `middles`, the prior is of the first of them, and `x` of the
    time `now`. `window` has centers and inverse variances of eta and ln rho. H is that of Gauss and
    Newton. A and B (6, 6) are spare.
    """
    state_at(x, r, state, G)
    if not state[0] > least:
        return np.inf
    cost = 2 * np.log(state[0]) - 9 * x[5]
    row, slope = B[0], B[1]
    for i in range(6):
        slope[i] = 0.0
        for j in range(6):
            A[i, j] = 0.0
    for s in range(len(scans)):
        age = now - middles[s]
        for n in range(scans.shape[1]):
            if np.isnan(scans[s, n]):
                continue
            shift, row[0], row[1], row[2], row[3], row[4], row[5] = shift_in_space(
                state[0] - age * state[3], state[1] - age * state[4], state[2] - age * state[5],
                state[3], state[4], state[5],
                positions[n, 0], positions[n, 1], positions[n, 2], c,
            )  # fmt: skip
            residual, w = shift - scans[s, n], 1 / variances[s, n]
            cost += 0.5 * w * residual * residual
            for i in range(3):
                row[3 + i] -= age * row[i]
            for i in range(6):
                scaled = w * row[i]
                slope[i] += scaled * residual
                for j in range(6):
                    A[i, j] += scaled * row[j]
    age = now - middles[0]
    for i in range(3):
        row[i] = state[i] - age * state[3 + i] - mean[i]
        row[3 + i] = state[3 + i] - mean[3 + i]
    for i in range(6):
        s = 0.0
        for j in range(6):
            s += information[i, j] * row[j]
        cost += 0.5 * s * row[i]
        slope[i] += s
        if i < 3:
            slope[3 + i] -= age * s
    for i in range(3):
        for j in range(3):
            near, cross = information[i, j], information[3 + i, j]
            A[i, j] += near
            A[3 + i, j] += cross - age * near
            A[j, 3 + i] += cross - age * near
            A[3 + i, 3 + j] += information[3 + i, 3 + j]
            A[3 + i, 3 + j] += age * (age * near - cross - information[3 + j, i])
    g[0], g[1], g[2], g[3], g[4], g[5] = _pulled(
        G, slope[0], slope[1], slope[2], slope[3], slope[4], slope[5]
    )
    for i in range(6):
        g[i] += 2 * G[0, i] / state[0]
    g[5] -= 9
    for k in range(6):
        B[0, k], B[1, k], B[2, k], B[3, k], B[4, k], B[5, k] = _pulled(
            G, A[k, 0], A[k, 1], A[k, 2], A[k, 3], A[k, 4], A[k, 5]
        )
    for j in range(6):
        H[0, j], H[1, j], H[2, j], H[3, j], H[4, j], H[5, j] = _pulled(
            G, B[j, 0], B[j, 1], B[j, 2], B[j, 3], B[j, 4], B[j, 5]
        )
    for w, i in enumerate((0, 1, 5)):
        d = x[i] - window[w, 0]
        cost += 0.5 * window[w, 1] * d * d
        g[i] += window[w, 1] * d
        H[i, i] += window[w, 1]
    return cost


@compiled
def _downhill(L, g, step):
    """Write the step of Newton, -inv(L L') g, to `step`."""
    for i in range(6):
        step[i] = -g[i]
    solve(L, step)


@compiled
def _descend(x, cost, step, scans, variances, middles, now, positions, r, c, mean, information,
             window, least, P, state, G, g, H, A, B, L, new):  # fmt: skip
    """Move `x` to the mode nearby, write its covariance to `P`, and return Laplace's log weight.

    `cost` is that of `x`, and `step` the first one to try; with an infinite cost it has to be zero.
    """
    determinant = np.nan
    for tried in range(_STEPS + 1):
        share = 1.0
        for _ in range(_HALVINGS):
            for i in range(6):
                new[i] = x[i] + share * step[i]
            cost_new = objective(new, scans, variances, middles, now, positions, r, c, mean,
                                 information, window, least, state, G, g, H, A, B)  # fmt: skip
            if cost_new < cost:
                break
            share *= 0.5
        if not cost_new < cost:
            break
        put(x, new)
        gain, cost = cost - cost_new, cost_new
        determinant = factor(H, L)
        if np.isnan(determinant) or gain < _GAIN or tried == _STEPS:
            break
        _downhill(L, g, step)
    if np.isnan(determinant):
        return LOST
    for j in range(6):
        for i in range(6):
            step[i] = 1.0 if i == j else 0.0
        solve(L, step)
        put(P[j], step)
    return -cost - 0.5 * determinant


@compiled
def start(scans, variances, middles, positions, r, c, mean, information, grid, widths, least,
          margin, x, P, weight):  # fmt: skip
    """Fill the bank from one scan: in each window of the grid the mode, and Laplace's weight.

    Return the number of windows that have a state. Those whose predicted weight is `margin` below
    the best are left out.
    """
    state, G = np.empty(6), np.zeros((6, 6))
    g, H, L = np.empty(6), np.empty((6, 6)), np.zeros((6, 6))
    A, B = np.empty((6, 6)), np.empty((6, 6))
    step, new = np.empty(6), np.empty(6)
    window, now = np.empty((3, 2)), middles[0]
    for i in range(3):
        window[i, 1] = 1 / widths[i] ** 2
    promised, best = np.empty(len(grid)), np.inf
    for w in range(len(grid)):
        promised[w] = np.inf
        x[w, 0], x[w, 1], x[w, 5] = grid[w]
        x[w, 2] = x[w, 3] = x[w, 4] = 0.0
        put(window[:, 0], grid[w])
        # First beta and b, in which the shifts are linear; then a step in all, not yet taken.
        for linear in (True, False):
            cost = objective(x[w], scans, variances, middles, now, positions, r, c, mean,
                             information, window, least, state, G, g, H, A, B)  # fmt: skip
            if linear:
                for i in (0, 1, 5):
                    for j in range(6):
                        H[i, j] = H[j, i] = 0.0
                    H[i, i] = 1.0
                    g[i] = 0.0
            if not np.isfinite(cost) or np.isnan(factor(H, L)):
                break
            _downhill(L, g, step)
            if linear:
                for i in range(2, 5):
                    x[w, i] += step[i]
            else:
                promised[w] = weight[w] = cost
                put(P[w, 0], step)
                for i in range(6):
                    promised[w] += 0.5 * g[i] * step[i]
                best = min(best, promised[w])
    count = 0
    for w in range(len(grid)):
        if not promised[w] < best + margin:
            continue
        put(window[:, 0], grid[w])
        put(step, P[w, 0])
        weight[count] = _descend(
            x[w], weight[w], step, scans, variances, middles, now, positions, r, c, mean,
            information, window, least, P[count], state, G, g, H, A, B, L, new,
        )  # fmt: skip
        if weight[count] > LOST:
            put(x[count], x[w])
            count += 1
    return count


@compiled
def settle(scans, variances, middles, now, positions, r, c, mean, information, least, x, P, weight,
           count):  # fmt: skip
    """Move members to the modes of the posterior given all scans; return the number of modes.

    The weight of a mode is Laplace's.
    """
    state, G = np.empty(6), np.zeros((6, 6))
    g, H, L = np.empty(6), np.empty((6, 6)), np.zeros((6, 6))
    A, B = np.empty((6, 6)), np.empty((6, 6))
    step, new, window = np.empty(6), np.empty(6), np.zeros((3, 2))
    kept = 0
    for m in range(count):
        for i in range(6):
            step[i] = 0.0
        weight[kept] = _descend(
            x[m], np.inf, step, scans, variances, middles, now, positions, r, c, mean,
            information, window, least, P[kept], state, G, g, H, A, B, L, new,
        )  # fmt: skip
        alone = weight[kept] > LOST
        for j in range(kept):
            distance = 0.0
            for i in range(6):
                s = 0.0
                for k in range(i, 6):
                    s += L[k, i] * (x[m, k] - x[j, k])
                distance += s * s
            alone = alone and distance > _EQUAL
        if alone:
            put(x[kept], x[m])
            kept += 1
    return kept
