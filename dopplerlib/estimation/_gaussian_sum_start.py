"""Modes of the posterior of a target at constant velocity, compiled: start and new start.

A Gaussian sum starts with one member from each window of a grid; and what goes straight can be
fitted again to all that was measured, member by member.
"""

import numpy as np

from .._cholesky import compiled, factor, solve
from ..kernels import doppler as kernel
from ._ring_member import LOST, inline, put, put_square, state_at

_STEPS, _FULL, _HALVINGS = 5, 30, 5  # of a descent in a window, of one to a mode
_LEFT = 1e-2  # fall of a cost that is left to the last step
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
                for j in range(i + 1):
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
            A[3 + i, 3 + j] += information[3 + i, 3 + j]
            A[3 + i, 3 + j] += age * (age * near - cross - information[3 + j, i])
    for i in range(6):
        for j in range(i):
            A[j, i] = A[i, j]
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
    """Write the step of Newton, -inv(L L') g, to `step`; return the fall that it promises."""
    left = 0.0
    for i in range(6):
        step[i] = -g[i]
    solve(L, step)
    for i in range(6):
        left -= 0.5 * g[i] * step[i]
    return left


@compiled
def _descend(x, cost, step, steps, scans, variances, middles, now, positions, r, c, mean,
             information, window, least, P, state, G, g, H, A, B, L, new):  # fmt: skip
    """Move `x` to the mode nearby, and write its covariance to `P`.

    `cost` is that of `x`, and `step` the first one to try, of `steps` at most. Return Laplace's log
    weight, the cost there, and what one more step of Newton promises, which says whether it is a
    mode. `L` is the factor of the second derivatives.
    """
    determinant, left = np.nan, np.inf
    for _ in range(steps):
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
        cost = cost_new
        determinant = factor(H, L)
        if np.isnan(determinant):
            break
        left = _downhill(L, g, step)
        if left < _LEFT:  # so small a step keeps what it promises
            for i in range(6):
                x[i] += step[i]
            cost -= left
            break
    if np.isnan(determinant):
        return LOST, cost, np.inf
    for j in range(6):
        for i in range(6):
            step[i] = 1.0 if i == j else 0.0
        solve(L, step)
        put(P[j], step)
    return -cost - 0.5 * determinant, cost, left


@compiled
def start(scans, variances, middles, positions, r, c, mean, information, grid, widths, overlaps,
          least, margin, x, P, weight):  # fmt: skip
    """Fill the bank from one scan: in each window of the grid the mode, and Laplace's weight.

    Windows overlap: of each counts what is left when it is divided by the sum of all, `overlaps`.

    Where there is no state, or none within `margin` of the best in logarithms, the weight is that
    of a member that is lost.
    """
    state, G = np.empty(6), np.zeros((6, 6))
    g, H, L = np.empty(6), np.empty((6, 6)), np.zeros((6, 6))
    A, B = np.empty((6, 6)), np.empty((6, 6))
    step, new, window = np.empty(6), np.empty(6), np.empty((3, 2))
    now, promised = middles[0], np.empty(len(grid))
    m_y = m_z = b = 0.0
    seen = False
    for w in range(len(grid)):
        promised[w], weight[w] = np.inf, LOST
        x[w, 0], x[w, 1], x[w, 5] = grid[w]
        _look(window, grid[w], widths[w])
        # beta and b, in which the shifts are linear, once: the same b and beta - b eta, which are
        # well seen, nearly hold in each window. Then a step in all, not yet taken.
        for linear in range(seen, 2):
            x[w, 2], x[w, 3], x[w, 4] = m_y + b * x[w, 0], m_z + b * x[w, 1], b
            cost = objective(x[w], scans, variances, middles, now, positions, r, c, mean,
                             information, window, least, state, G, g, H, A, B)  # fmt: skip
            if linear == 0:
                for i in (0, 1, 5):
                    for j in range(6):
                        H[i, j] = H[j, i] = 0.0
                    H[i, i] = 1.0
                    g[i] = 0.0
            if not np.isfinite(cost) or np.isnan(factor(H, L)):
                break
            left = _downhill(L, g, step)
            if linear == 0:
                b = step[4]
                m_y, m_z, seen = step[2] - b * x[w, 0], step[3] - b * x[w, 1], True
            else:
                promised[w], P[w, 1, 0] = cost - left, cost
                put(P[w, 0], step)
    # What is likely, only what was reached says; the most promising are asked first, until none
    # that is left promises more.
    best, w, ahead = np.inf, 0, True
    while w < len(grid):
        v = w
        if ahead:
            for other in range(len(grid)):
                if promised[other] < promised[v]:
                    v = other
            ahead = promised[v] < best
        if promised[v] < best + margin:
            promised[v] = np.inf
            _look(window, grid[v], widths[v])
            put(step, P[v, 0])
            weight[v], reached, _ = _descend(
                x[v], P[v, 1, 0], step, _STEPS, scans, variances, middles, now, positions, r, c,
                mean, information, window, least, P[v], state, G, g, H, A, B, L, new,
            )  # fmt: skip
            weight[v] -= overlaps[v]
            best = min(best, reached)
        w += v == w


@compiled
def _look(window, center, widths):
    """Write center and inverse variance of a window (3, 2)."""
    for i in range(3):
        window[i, 0], window[i, 1] = center[i], 1 / widths[i] ** 2


@compiled
def settle(scans, variances, middles, now, positions, r, c, mean, information, least, unlike, x, P,
           weight, count):  # fmt: skip
    """Move members to the modes of the posterior given all scans; return the number of modes.

    The weight of a mode is Laplace's. Where the members are, the Gaussians at the modes must have
    the density of the posterior: if in the mean over the members its logarithm is more than
    `unlike` too low, all stays as it is, and the return value is 0. In this mean a member counts
    by that density and its own volume, not by the weight that it came with.
    """
    state, G = np.empty(6), np.zeros((6, 6))
    g, H, L = np.empty(6), np.empty((6, 6)), np.zeros((6, 6))
    A, B = np.empty((6, 6)), np.empty((6, 6))
    step, new, window = np.empty(6), np.empty(6), np.zeros((3, 2))
    own, costs, logs = np.empty(count), np.empty(count), np.empty(count)
    modes, shapes = np.empty((count, 6)), np.empty((count, 6, 6))
    factors = np.zeros((count, 6, 6))
    kept = 0
    for m in range(count):
        own[m] = objective(x[m], scans, variances, middles, now, positions, r, c, mean,
                           information, window, least, state, G, g, H, A, B)  # fmt: skip
        if not np.isfinite(own[m]) or np.isnan(factor(H, L)):
            continue
        _downhill(L, g, step)
        put(modes[kept], x[m])
        logs[kept], costs[kept], left = _descend(
            modes[kept], own[m], step, _FULL, scans, variances, middles, now, positions, r, c, mean,
            information, window, least, shapes[kept], state, G, g, H, A, B, L, new,
        )  # fmt: skip
        alone = left < _LEFT
        for j in range(kept):
            alone = alone and _apart(L, modes[kept], modes[j]) > _EQUAL
        if alone:
            put_square(factors[kept], L)
            kept += 1
    if kept == 0:
        return 0
    top = logs[:kept].max()
    whole = found = apart = 0.0
    for j in range(kept):
        whole += np.exp(logs[j] - top)
    for m in range(count):
        log = factor(P[m], L)
        if not np.isfinite(own[m]) or np.isnan(log):
            continue
        nearest = np.inf
        for j in range(kept):
            nearest = min(nearest, costs[j] + 0.5 * _apart(factors[j], x[m], modes[j]))
        share = np.exp(0.5 * log - own[m] - top)
        found += share
        apart += share * max(nearest - own[m], 0.0)
    if not apart <= unlike * max(whole, found):
        return 0
    for j in range(kept):
        put(x[j], modes[j])
        put_square(P[j], shapes[j])
        weight[j] = logs[j]
    return kept


@compiled
def _apart(L, x, y):
    """Return d' L L' d, for the difference d of two points."""
    distance = 0.0
    for i in range(6):
        s = 0.0
        for k in range(i, 6):
            s += L[k, i] * (x[k] - y[k])
        distance += s * s
    return distance
