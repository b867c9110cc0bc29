"""A grid of positions with the best velocity at each, compiled.

At a given position p the Doppler shift is linear in the velocity v (variable projection):

    w_n h_n = (A v)_n,   row n of A = w_n (c / rho_n) (s_n - p)',   rho_n = |s_n - p|.

With A = Q R, Q of orthonormal columns, and y the weighted measurements,

    |A v - y|^2 = |y|^2 - |Q'y|^2 + |R v - Q'y|^2,

and the last term is zero at the best velocity, unless the box forbids it. Q and R do not depend on
the measurements: `project` makes them once for all runs, and `scan` is left with Q'y at each point.
Arrays have the grid last, so that the inner loops run over neighbors in memory.
"""

import numpy as np

from .._compile import inner_njit
from ._ml_refine import copy

STARTS = 6  # local minima of the grid that are refined; three or four are usual


@inner_njit
def project(grid, w, positions, c, lower, upper, Q, R, bound, order, rate):
    """Prepare the linear problem of the velocity at every grid point.

    The weighted lines of sight A (N, 3) are factored into orthonormal columns Q (3, N, G) and a
    triangle R, of which rows 0 to 5 hold R00, R01, R02, R11, R12, R22 and rows 6 to 8 the inverse
    diagonal. Columns are ordered (`order`) so that the best determined component comes first, and
    one that the box fixes last; `bound` holds their bounds. `rate` (N, G) is 1 / range in Hz per
    (m/s)^2.
    """
    A, U, free = np.empty((len(positions), 3)), np.empty((3, 3)), np.empty(3, np.bool_)
    for p in range(grid.shape[0]):
        for n in range(len(positions)):
            square = 0.0
            for i in range(3):
                A[n, i] = positions[n, i] - grid[p, i]
                square += A[n, i] * A[n, i]
            rate[n, p] = c / np.sqrt(square) if square > 0 else 0.0
            for i in range(3):
                A[n, i] *= w[n] * rate[n, p]
        # Gram-Schmidt with pivoting: of the columns that are left, the longest comes next.
        free[:] = True
        for a in range(3):
            most, column = -1.0, -1
            for i in range(3):
                square = 0.0
                if lower[3 + i] < upper[3 + i]:
                    for n in range(len(positions)):
                        square += A[n, i] * A[n, i]
                if free[i] and square > most:
                    most, column = square, i
            free[column] = False
            order[a, p] = column
            bound[a, 0, p], bound[a, 1, p] = lower[3 + column], upper[3 + column]
            square = 0.0
            for n in range(len(positions)):
                square += A[n, column] * A[n, column]
            U[a, column] = np.sqrt(square)
            # Below this a column is a rounding error: the component does not matter.
            inverse = 1 / np.sqrt(square) if square > 1e-18 * U[0, order[0, p]] ** 2 else 0.0
            R[6 + a, p] = inverse
            for n in range(len(positions)):
                Q[a, n, p] = A[n, column] * inverse
            # What the others have along this column goes into R, and out of them.
            for i in range(3):
                if free[i]:
                    U[a, i] = 0.0
                    for n in range(len(positions)):
                        U[a, i] += Q[a, n, p] * A[n, i]
                    for n in range(len(positions)):
                        A[n, i] -= U[a, i] * Q[a, n, p]
        row = 0
        for a in range(3):
            for b in range(a, 3):
                R[row, p] = U[a, order[b, p]]
                row += 1


@inner_njit
def scan(mean, w, slope, spread, c, Q, R, bound, rate, v, score):
    """Score every grid point by the cost of its best velocity in the box.

    `mean` (N,) are the mean shifts. A velocity outside the box is clipped component by
    component, the least determined first, and what is still free is solved again; this is the
    exact constrained optimum if no component but the last is outside. `slope` (N,) are the
    measured rates of change of the shifts and `spread` their weights, zero if nothing moves.
    """
    y = w * mean
    total = 0.0
    moving = False
    for n in range(y.size):
        total += y[n] * y[n]
        moving |= spread[n] > 0
    a, b, e = v[0], v[1], v[2]  # rows of Q'y first, then of the velocity
    a[:] = 0.0
    b[:] = 0.0
    e[:] = 0.0
    for n in range(y.size):
        for p in range(score.size):
            a[p] += Q[0, n, p] * y[n]
            b[p] += Q[1, n, p] * y[n]
            e[p] += Q[2, n, p] * y[n]
    for p in range(score.size):
        q0, q1, q2 = a[p], b[p], e[p]
        # Back substitution in R v = Q'y, from the component that is determined least.
        v2 = min(max(q2 * R[8, p], bound[2, 0, p]), bound[2, 1, p])
        v1 = (q1 - R[4, p] * v2) * R[7, p]
        v1 = min(max(v1, bound[1, 0, p]), bound[1, 1, p])
        v0 = (q0 - R[1, p] * v1 - R[2, p] * v2) * R[6, p]
        v0 = min(max(v0, bound[0, 0, p]), bound[0, 1, p])
        r0 = R[0, p] * v0 + R[1, p] * v1 + R[2, p] * v2 - q0
        r1 = R[3, p] * v1 + R[4, p] * v2 - q1
        r2 = R[5, p] * v2 - q2
        score[p] = total - q0 * q0 - q1 * q1 - q2 * q2 + r0 * r0 + r1 * r1 + r2 * r2
        a[p], b[p], e[p] = v0, v1, v2
    if not moving:
        return
    for n in range(y.size):
        if w[n] == 0.0:
            continue
        for p in range(score.size):
            v0, v1, v2 = a[p], b[p], e[p]
            u0 = R[0, p] * v0 + R[1, p] * v1 + R[2, p] * v2
            u1 = R[3, p] * v1 + R[4, p] * v2
            radial = (Q[0, n, p] * u0 + Q[1, n, p] * u1 + Q[2, n, p] * R[5, p] * v2) / (c * w[n])
            # The shift of a target at constant velocity falls by speed across, squared, per range:
            # dh/dt = -(c / rho) (|v|^2 - (u'v)^2), with u the line of sight and u'v = `radial`.
            r = slope[n] + rate[n, p] * (v0 * v0 + v1 * v1 + v2 * v2 - radial * radial)
            score[p] += spread[n] * r * r


@inner_njit
def lowest_minima(score, shape, low, spare, chosen):
    """Write the lowest local minima to `chosen`; return their number."""
    copy(score, low)
    inner = score.size
    # `low` becomes the minimum over a point and its 26 neighbors: that of three points along one
    # axis, of these minima along the next, and so on. `inner` is the stride of the axis.
    for n in shape:
        inner //= n
        low, spare = spare, low
        for i in range(score.size // inner):
            here = i * inner
            back = here - inner if i % n > 0 else here
            front = here + inner if i % n < n - 1 else here
            for q in range(inner):
                low[here + q] = min(spare[here + q], min(spare[back + q], spare[front + q]))
    count = 0
    for p in range(score.size):
        if score[p] > low[p] or (count == STARTS and score[p] >= score[chosen[count - 1]]):
            continue
        # Insertion into the sorted list of the lowest so far.
        count = min(count + 1, STARTS)
        place = count - 1
        while place > 0 and score[chosen[place - 1]] > score[p]:
            chosen[place] = chosen[place - 1]
            place -= 1
        chosen[place] = p
    return count
