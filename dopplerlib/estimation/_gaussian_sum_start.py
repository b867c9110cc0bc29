"""Start of a Gaussian sum, compiled: one member from each window of a grid."""

import numpy as np

from ._ring_member import LOST, compiled, factor, measure, put, solve, state_at


@compiled
def objective(x, z, variance, positions, r, c, mean, information, window, least,
              state, G, g, H, row):  # fmt: skip
    """Return minus the log density of measurements, prior and window at `x`; g and H of it.

    `window` has centers and inverse variances of eta and ln rho. H is that of Gauss and Newton.
    """
    state_at(x, r, state, G)
    if not state[0] > least:
        return np.inf
    cost, u = 2 * np.log(state[0]) - 9 * x[5], np.exp(-x[5])
    for i in range(6):
        for j in range(6):
            H[i, j] = 0.0
        g[i] = 2 * G[0, i] / state[0]
    g[5] -= 9
    for n in range(len(z)):
        if np.isnan(z[n]):
            continue
        residual = measure(x, u, positions[n], r, c, row) - z[n]
        cost += 0.5 * residual * residual / variance[n]
        for i in range(6):
            g[i] += row[i] * residual / variance[n]
            for j in range(6):
                H[i, j] += row[i] * row[j] / variance[n]
    # prior in the state: G' information (state - mean)
    for k in range(6):
        s = 0.0
        for m in range(6):
            s += information[k, m] * (state[m] - mean[m])
        cost += 0.5 * s * (state[k] - mean[k])
        for i in range(6):
            g[i] += G[k, i] * s
    for k in range(6):
        for m in range(6):
            if information[k, m] != 0.0:
                for i in range(6):
                    for j in range(6):
                        H[i, j] += G[k, i] * information[k, m] * G[m, j]
    for w, i in enumerate((0, 1, 5)):
        d = x[i] - window[w, 0]
        cost += 0.5 * window[w, 1] * d * d
        g[i] += window[w, 1] * d
        H[i, i] += window[w, 1]
    return cost


@compiled
def downhill(L, g, step):
    """Write the step of Newton, -inv(L L') g, to `step`."""
    for i in range(6):
        step[i] = -g[i]
    solve(L, step)


@compiled
def start(z, variance, positions, r, c, mean, information, grid, widths, least, margin, x, P,
          weight):  # fmt: skip
    """Fill the bank from one scan: in each window of the grid the mode, and Laplace's weight.

    Return how many windows have a state. Windows whose predicted weight is `margin` below the best
    are left as they are, with weight `LOST`.
    """
    state, G = np.empty(6), np.zeros((6, 6))
    g, H, L, row = np.empty(6), np.empty((6, 6)), np.zeros((6, 6)), np.empty(6)
    step, new = np.empty(6), np.empty(6)
    window = np.empty((3, 2))
    for i in range(3):
        window[i, 1] = 1 / widths[i] ** 2
    promised, best = np.empty(len(grid)), np.inf
    for w in range(len(grid)):
        weight[w], promised[w] = LOST, np.inf
        x[w, 0], x[w, 1], x[w, 5] = grid[w]
        x[w, 2] = x[w, 3] = x[w, 4] = 0.0
        put(window[:, 0], grid[w])
        cost = objective(x[w], z, variance, positions, r, c, mean, information, window, least,
                         state, G, g, H, row)  # fmt: skip
        if not np.isfinite(cost):
            continue
        # beta and b: linear, given the rest
        for i in (0, 1, 5):
            for j in range(6):
                H[i, j] = H[j, i] = 0.0
            H[i, i] = 1.0
            g[i] = 0.0
        if np.isnan(factor(H, L)):
            continue
        downhill(L, g, step)
        for i in range(2, 5):
            x[w, i] += step[i]
        cost = objective(x[w], z, variance, positions, r, c, mean, information, window, least,
                         state, G, g, H, row)  # fmt: skip
        if not np.isfinite(cost) or np.isnan(factor(H, L)):
            continue
        downhill(L, g, step)
        promised[w] = cost
        for i in range(6):
            promised[w] += 0.5 * g[i] * step[i]
        best = min(best, promised[w])
    count = 0
    for w in range(len(grid)):
        if not promised[w] < best + margin:
            continue
        put(window[:, 0], grid[w])
        cost = objective(x[w], z, variance, positions, r, c, mean, information, window, least,
                         state, G, g, H, row)  # fmt: skip
        determinant = factor(H, L)
        for _ in range(4):
            downhill(L, g, step)
            share, fallen = 1.0, False
            for _ in range(5):
                for i in range(6):
                    new[i] = x[w, i] + share * step[i]
                cost_new = objective(new, z, variance, positions, r, c, mean, information, window,
                                     least, state, G, g, H, row)  # fmt: skip
                if cost_new < cost:
                    fallen = True
                    break
                share *= 0.5
            if not fallen:
                break
            gain = cost - cost_new
            put(x[w], new)
            cost = cost_new
            determinant = factor(H, L)
            if gain < 1e-3:
                break
        cost = objective(x[w], z, variance, positions, r, c, mean, information, window, least,
                         state, G, g, H, row)  # fmt: skip
        determinant = factor(H, L)
        if np.isnan(determinant):
            continue
        for j in range(6):
            for i in range(6):
                step[i] = 1.0 if i == j else 0.0
            solve(L, step)
            put(P[count, j], step)
        put(x[count], x[w])
        weight[count] = -cost - 0.5 * determinant
        count += 1
    return count
