"""The search behind `ml_start`, compiled.

One run goes through four steps:

1. `_scan`: at every point of a grid of positions the best velocity is a small linear
   least-squares problem (variable projection), prepared once for all runs by `_project`.
2. `_refine`: Levenberg-Marquardt in the box from the lowest local minima of the grid.
3. `_walk`: a line of sight says little about range, so along one direction the cost may have
   several minima close together; follow that direction both ways and refine what is found.
4. `_settle`: where the likelihood has no unique maximum, take the one nearest to the center of
   the box, so that the answer does not depend on where a search stopped.

Costs are chi-square: sums of squared residuals over their standard deviations.
"""

import hashlib
from pathlib import Path

import numpy as np
from numba import njit

from ..kernels import doppler as kernel

# A Python integer as an argument would make numba compile a function for this very value.
ALL, VELOCITY = np.int64(0), np.int64(3)  # the first component of a step

STARTS = 6  # local minima of the grid that are refined; three or four are usual
ITERATIONS = np.int64(200)  # of one refinement; ten are usual
DAMPING = 1e-6  # of the first step, relative to the diagonal of J'J
TOLERANCE = 1e-12  # stop when a step promises less, relative to the cost
NOISE = 1e-15  # relative rounding error of a predicted measurement
WEAK = 1e-5  # smallest eigenvalue of the scaled information below which `_walk` sets out
STRIDE = 0.15  # of a step of the walk, relative to the distance from the array
STEPS = 25  # of the walk, each way: enough for a range that grows thirtyfold
CORRECTIONS = np.int64(3)  # iterations that bring a state next to the valley floor back to it
PULL = 1e-12  # weight of the box's center in `_settle`, relative to the information
SETTLED = 1e-6  # last step of `_settle`, relative to the box; rounding allows some 1e-9
DISTINCT = 1e-3  # two states differ if a component does by this share of the box
TIE = 1e-9  # relative difference between equal costs

# Without wrappers for callers from outside, which take a third of the time to compile.
_compiled = njit(nogil=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
_shift_and_gradient = njit(forceinline=True, error_model="numpy")(kernel.doppler_shift_and_gradient)


@_compiled
def _copy(source, target):
    """Copy an array; written as assignment to a slice it compiles for seconds."""
    for i in range(source.size):
        target[i] = source[i]


@_compiled
def _normal_equations(x, t, z, w, positions, c, H, g):
    """Fill H = J'J and g = J'r of the residuals r = w (h(F(t) x) - z); return the cost r'r."""
    H[:] = 0.0
    g[:] = 0.0
    J = np.empty(6)
    cost = 0.0
    for k in range(z.shape[0]):
        s = t[k]
        p_x, p_y, p_z = x[0] + s * x[3], x[1] + s * x[4], x[2] + s * x[5]
        for n in range(z.shape[1]):
            weight = w[k, n]
            if weight == 0.0:
                continue
            h, J[0], J[1], J[2], J[3], J[4], J[5] = _shift_and_gradient(
                p_x, p_y, p_z, x[3], x[4], x[5],
                positions[n, 0], positions[n, 1], positions[n, 2], c,
            )  # fmt: skip
            r = weight * (h - z[k, n])
            cost += r * r
            # Moving: the gradient of h(F x) is F' times that of h.
            for i in range(3):
                J[3 + i] += s * J[i]
            for i in range(6):
                J[i] *= weight
                g[i] += J[i] * r
                for j in range(i + 1):
                    H[i, j] += J[i] * J[j]
    for i in range(6):
        for j in range(i):
            H[j, i] = H[i, j]
    return cost


@_compiled
def _solve(H, damping, rhs, held, L, d):
    """Solve (H + diag(damping)) d = rhs for the components not held; those of `d` that are stay.

    By L D L' with D kept as its inverse on the diagonal of `L`.
    """
    free = np.empty(6, np.int64)
    m = 0
    for i in range(6):
        if not held[i]:
            free[m] = i
            m += 1
    for a in range(m):
        i = free[a]
        s = rhs[i]
        if m < 6:
            for j in range(6):
                if held[j]:
                    s -= H[i, j] * d[j]
        diagonal = H[i, i] + damping[i]
        pivot = diagonal
        for b in range(a):
            q = H[i, free[b]]
            for e in range(b):
                q -= L[a, e] * L[b, e]
            # L[a, e] holds L D until the row is complete.
            L[a, b] = q
        for b in range(a):
            q = L[a, b]
            L[a, b] = q * L[b, b]
            pivot -= q * L[a, b]
            s -= L[a, b] * d[free[b]]
        # A pivot below rounding would be noise; the step that follows has to prove itself anyway.
        L[a, a] = 1 / max(pivot, 1e-16 * diagonal + 1e-300)
        d[i] = s
    for a in range(m - 1, -1, -1):
        s = d[free[a]] * L[a, a]
        for b in range(a + 1, m):
            s -= L[b, a] * d[free[b]]
        d[free[a]] = s


@_compiled
def _boxed_step(H, g, damping, x, lower, upper, first, held, L, d):
    """Find the step d of components `first` to 5 that lowers d'(H + damping)d/2 + g'd in the box.

    A component that would leave the box is put on its bound and the others are solved again:
    of a convex quadratic whose minimum lies outside, one of the offenders is on its bound.
    """
    rhs = np.empty(6)
    for i in range(6):
        rhs[i] = -g[i]
        d[i] = 0.0
        held[i] = (
            i < first
            or lower[i] == upper[i]
            or (x[i] <= lower[i] and g[i] > 0)
            or (x[i] >= upper[i] and g[i] < 0)
        )
    for _ in range(6):
        _solve(H, damping, rhs, held, L, d)
        share, offender = 1.0, -1
        for i in range(first, 6):
            room = (upper[i] if d[i] > 0 else lower[i]) - x[i]
            if not held[i] and abs(d[i]) > abs(room) and room / d[i] < share:
                share, offender = room / d[i], i
        if offender < 0:
            break
        held[offender] = True
        d[offender] = (upper[offender] if d[offender] > 0 else lower[offender]) - x[offender]


@_compiled
def _move(x, d, lower, upper, moved):
    for i in range(6):
        moved[i] = min(max(x[i] + d[i], lower[i]), upper[i])


@_compiled
def _refine(x, t, z, w, positions, c, lower, upper, size, iterations):
    """Improve x in place by Levenberg-Marquardt in the box; return its cost and convergence.

    After a step that gained less than it promised the velocity is solved for anew at the new
    position. This follows the curved valley of positions whose best velocities differ, and takes
    a third of the iterations.
    `size` is the norm of the weighted measurements.
    """
    H, g, H_new, g_new = np.empty((6, 6)), np.empty(6), np.empty((6, 6)), np.empty(6)
    L, held, d, new = np.empty((6, 6)), np.empty(6, np.bool_), np.empty(6), np.empty(6)
    damping, none = np.empty(6), np.zeros(6)
    factor, growth = DAMPING, 4.0
    cost = _normal_equations(x, t, z, w, positions, c, H, g)
    for _ in range(iterations):
        for i in range(6):
            damping[i] = factor * H[i, i]
        _boxed_step(H, g, damping, x, lower, upper, ALL, held, L, d)
        promise = 0.0
        for i in range(6):
            promise -= 2 * g[i] * d[i]
            for j in range(6):
                promise -= d[i] * H[i, j] * d[j]
        _move(x, d, lower, upper, new)
        cost_new = _normal_equations(new, t, z, w, positions, c, H_new, g_new)
        if cost - cost_new < 0.9 * promise:
            _boxed_step(H_new, g_new, none, new, lower, upper, VELOCITY, held, L, d)
            _move(new, d, lower, upper, new)
            cost_new = _normal_equations(new, t, z, w, positions, c, H_new, g_new)

        rounding = NOISE * size
        enough = TOLERANCE * cost + rounding * (rounding + 2 * np.sqrt(cost))
        gain = cost - cost_new
        if gain > 0:
            _copy(new, x)
            cost = cost_new
            H, H_new, g, g_new = H_new, H, g_new, g
            # Nielsen (1999): damping follows how well the quadratic model foretold the gain.
            factor = max(factor * max(1 / 9, 1 - (2 * gain / promise - 1) ** 3), 1e-14)
            growth = 4.0
        else:
            factor *= growth
            growth *= 2
        if promise <= enough and gain <= enough:
            return cost, factor < 1
        if factor > 1e12:
            break
    return cost, False


@_compiled
def _grow(x, t, z, w, window, positions, c, lower, upper, size):
    """Refine x on the first `window` samples, then on four times as many, up to nearly all.

    Over a long record a small error of the velocity is a large one of the last positions, and the
    cost has many minima; a short record leads towards the right one.
    """
    while window < t.size:
        _refine(x, t[:window], z[:window], w[:window], positions, c, lower, upper, size, ITERATIONS)
        window *= 4


@_compiled
def _weakest(H, lower, upper, start, held, L, e):
    """Find the direction e that H determines least; return its eigenvalue, H scaled to ones.

    Inverse iteration from `start`, in units in which the diagonal of H is one. Directions of
    components that the box fixes do not count.
    """
    C, scale, shift, v = np.empty((6, 6)), np.empty(6), np.full(6, 1e-15), np.empty(6)
    largest = 0.0
    for i in range(6):
        held[i] = lower[i] == upper[i]
        largest = max(largest, H[i, i])
    for i in range(6):
        scale[i] = np.sqrt(H[i, i] + 1e-20 * largest + 1e-300)
        v[i] = 0.0 if held[i] else start[i] * scale[i]
    for i in range(6):
        for j in range(6):
            C[i, j] = H[i, j] / (scale[i] * scale[j])
    for _ in range(4):
        norm = 0.0
        for i in range(6):
            norm += v[i] * v[i]
        for i in range(6):
            v[i] /= np.sqrt(norm)
            e[i] = v[i]
            if held[i]:
                v[i] = 0.0
        _solve(C, shift, e, held, L, v)
    norm = 0.0
    value = 0.0
    for i in range(6):
        norm += v[i] * v[i]
        for j in range(6):
            value += v[i] * C[i, j] * v[j]
    for i in range(6):
        e[i] = v[i] / scale[i]
    return value / norm


@_compiled
def _distance(p, center):
    return np.sqrt((p[0] - center[0]) ** 2 + (p[1] - center[1]) ** 2 + (p[2] - center[2]) ** 2)


@_compiled
def _differ(x, other, lower, upper):
    """Return the first component that differs clearly between two states, or -1."""
    for i in range(6):
        if abs(x[i] - other[i]) > DISTINCT * (upper[i] - lower[i]):
            return i
    return -1


@_compiled
def _lowest(states, costs, taken, lower, upper):
    """Return the number of the best state not taken, or -1.

    Of equally good ones, as before a plane array and behind it, that whose first component that
    differs is larger: rounding errors must not decide.
    """
    best = -1
    for m in range(costs.size):
        # Not a number: a grid point that is a sensor.
        if taken[m] or np.isnan(costs[m]):
            continue
        if best < 0:
            best = m
        elif abs(costs[m] - costs[best]) <= TIE * costs[best]:
            component = _differ(states[m], states[best], lower, upper)
            if component < 0:
                best = m if costs[m] < costs[best] else best
            elif states[m, component] > states[best, component]:
                best = m
        elif costs[m] < costs[best]:
            best = m
    return best


@_compiled
def _walk(x, t, z, w, still_t, still_z, still_w, positions, c, lower, upper, center, radius,
          path, cost):  # fmt: skip
    """Follow the weakest direction of x both ways; return the range of `path` that was filled.

    The walk stays where the mean Doppler shifts (`still_t`, `still_z`, `still_w`: one sample in
    the middle) are explained best. `cost` is that of all measurements along the path.
    """
    H, g, L = np.empty((6, 6)), np.empty(6), np.empty((6, 6))
    held, e, before, new = np.empty(6, np.bool_), np.empty(6), np.empty(6), np.empty(6)
    _copy(x, path[STEPS])
    cost[STEPS] = _normal_equations(x, t, z, w, positions, c, H, g)
    first, last = STEPS, STEPS
    for way in (-1, 1):
        for i in range(6):
            before[i] = way * (x[i] - center[i]) if i < 3 else 0.0
        here = STEPS
        for _ in range(STEPS):
            y = path[here]
            _normal_equations(y, still_t, still_z, still_w, positions, c, H, g)
            if not _weakest(H, lower, upper, before, held, L, e) <= WEAK:
                break
            reach = _distance(y, center) + radius
            along = 0.0
            length = 0.0
            for i in range(3):
                along += e[i] * before[i]
                length += e[i] * e[i]
            if length == 0.0:
                break
            stretch = np.sign(along) * STRIDE * reach / np.sqrt(length)
            for i in range(6):
                e[i] *= stretch
                before[i] = e[i]
            _move(y, e, lower, upper, new)
            _refine(new, still_t, still_z, still_w, positions, c, lower, upper, 0.0, CORRECTIONS)
            if _distance(new, y) < 0.2 * STRIDE * reach:  # at the end of the box
                break
            here += way
            _copy(new, path[here])
            cost[here] = _normal_equations(new, t, z, w, positions, c, H, g)
        first, last = min(first, here), max(last, here)
    return first, last


@_compiled
def _settle(x, t, z, w, positions, c, lower, upper):
    """Move x among equally likely states to the one nearest to the center of the box.

    Newton's method with a vanishing prior: it pulls only where the data say nothing. Short steps
    are for those few sets of equal states that bend sharply. If the cost would rise x stays: then
    the box leaves one best state only.
    """
    H, g, L = np.empty((6, 6)), np.empty(6), np.empty((6, 6))
    held, d = np.empty(6, np.bool_), np.empty(6)
    towards, last, pull, prior = np.empty(6), np.empty(6), np.empty(6), np.zeros(6)
    enough = _normal_equations(x, t, z, w, positions, c, H, g) * (1 + TIE) + TIE
    most = 0.0
    for i in range(6):
        most = max(most, H[i, i] * (upper[i] - lower[i]) ** 2)
    for i in range(6):
        if upper[i] > lower[i]:
            prior[i] = PULL * most / (upper[i] - lower[i]) ** 2
    for longest_step in (0.1, 0.02):  # of the box
        new = x.copy()
        last[:] = 0.0
        share = 1.0
        for _ in range(int(5 / longest_step)):
            _normal_equations(new, t, z, w, positions, c, H, g)
            for i in range(6):
                pull[i] = prior[i] * ((lower[i] + upper[i]) / 2 - new[i])
                g[i] -= pull[i]
                towards[i] = 0.0
            _boxed_step(H, g, prior, new, lower, upper, ALL, held, L, d)
            _solve(H, prior, pull, held, L, towards)
            length, along, square = 0.0, 0.0, 0.0
            for i in range(6):
                length = max(length, np.sqrt(prior[i] / (PULL * most)) * abs(d[i]))
                along += prior[i] * towards[i] * last[i]
                square += prior[i] * last[i] ** 2
            # Where the set bends, a full step is too long or too short: secant.
            if square > 0:
                share = min(max(share / max(1 - along / square, 0.1), 0.05), 2.0)
            share = min(share, longest_step / length)
            for i in range(6):
                last[i] = towards[i]
                d[i] += (share - 1) * towards[i]
            _move(new, d, lower, upper, new)
            if length < SETTLED:
                # What the prior has cost in the directions that the data do determine is regained.
                cost, _ = _refine(new, t, z, w, positions, c, lower, upper, 0.0, CORRECTIONS)
                if cost <= enough:
                    _copy(new, x)
                    return
                break


@_compiled
def _project(grid, w, positions, c, lower, upper, Q, R, bound, order, rate):
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


@_compiled
def _scan(mean, w, slope, spread, c, Q, R, bound, rate, v, score):
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
    a, b, e = v[0], v[1], v[2]
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
            # The shift of a target at constant velocity falls by speed across, squared, per range.
            r = slope[n] + rate[n, p] * (v0 * v0 + v1 * v1 + v2 * v2 - radial * radial)
            score[p] += spread[n] * r * r


@_compiled
def _lowest_minima(score, shape, low, spare, chosen):
    """Write the lowest points that no neighbor is below to `chosen`; return how many."""
    _copy(score, low)
    inner = score.size
    for n in shape:  # the minimum of three neighbors along one axis after the other
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
        count = min(count + 1, STARTS)
        place = count - 1
        while place > 0 and score[chosen[place - 1]] > score[p]:
            chosen[place] = chosen[place - 1]
            place -= 1
        chosen[place] = p
    return count


@_compiled
def _summarize(times, z, w, window, mean_t, mean_z, mean_w, slope, spread):
    """Reduce every sensor to the mean and the slope of its first samples.

    Return how many values determine the state: all that are there, or one a sensor if there is
    one time only. If a sensor is missing in the first samples, all samples are taken.
    """
    samples, sensors = z.shape
    seen = 0
    for n in range(sensors):
        total, early = 0, 0
        for k in range(samples):
            total += w[k, n] > 0
            early += k < window and w[k, n] > 0
        seen += total if times.size > 1 else total > 0
        if total > 0 and early == 0:
            window = samples
    all_weights, all_times = 0.0, 0.0
    for n in range(sensors):
        weight, time, mean = 0.0, 0.0, 0.0
        for k in range(window):
            square = w[k, n] ** 2
            weight += square
            mean += square * z[k, n]
            if times.size > 1:
                time += square * times[k]
        all_weights += weight
        all_times += time
        mean_w[0, n] = np.sqrt(weight)
        mean_z[0, n] = slope[n] = spread[n] = 0.0
        if weight == 0.0:
            continue
        mean_z[0, n] = mean / weight
        if times.size > 1:
            for k in range(window):
                square = w[k, n] ** 2
                since = times[k] - time / weight
                spread[n] += square * since**2
                slope[n] += square * since * z[k, n]
            if spread[n] > 0:
                slope[n] /= spread[n]
    mean_t[0] = all_times / all_weights if all_weights > 0 else 0.0
    return seen


@_compiled
def _search(z, deviations, times, window, positions, c, lower, upper, grid, shape, center, radius,
           singular, needed, x, information, cost, converged, second_x, second_cost):  # fmt: skip
    """Fill the outputs, one row a run.

    With one entry in `times` the state is constant, and one weighted mean of every sensor stands
    for all samples. The first `window` samples are those of the grid and of the walk.
    A run in which fewer than `needed` values (after the mean) are there is left NaN.
    """
    runs, samples, sensors = z.shape
    moving = times.size > 1
    points = len(grid)
    Q, R, bound = np.empty((3, sensors, points)), np.empty((9, points)), np.empty((3, 2, points))
    order, rate = np.empty((3, points), np.int64), np.empty((sensors, points))
    v, score = np.empty((3, points)), np.empty(points)
    low, spare = np.empty(points), np.empty(points)
    prepared = np.full(sensors, np.nan)
    slope, spread = np.empty(sensors), np.empty(sensors)
    data, w = np.empty((samples, sensors)), np.empty((samples, sensors))
    mean_t, mean_z, mean_w = np.zeros(1), np.empty((1, sensors)), np.empty((1, sensors))
    chosen = np.empty(STARTS, np.int64)
    path, path_cost = np.empty((2 * STEPS + 1, 6)), np.empty(2 * STEPS + 1)
    states, costs = np.empty((2 * STARTS + 2 * STEPS + 1, 6)), np.empty(2 * STARTS + 2 * STEPS + 1)
    arrived, taken = np.empty(costs.size, np.bool_), np.empty(costs.size, np.bool_)
    H, g, L = np.empty((6, 6)), np.empty(6), np.empty((6, 6))
    held, e, ones = np.empty(6, np.bool_), np.empty(6), np.ones(6)
    for run in range(runs):
        x[run] = second_x[run] = np.nan
        information[run] = np.nan
        cost[run] = second_cost[run] = np.nan
        converged[run] = False
        size = 0.0
        for k in range(samples):
            for n in range(sensors):
                here = not np.isnan(z[run, k, n])
                data[k, n] = z[run, k, n] if here else 0.0
                w[k, n] = 1 / deviations[k, n] if here else 0.0
                size += (w[k, n] * data[k, n]) ** 2
        size = np.sqrt(size)
        seen = _summarize(times, data, w, window if moving else samples, mean_t, mean_z, mean_w,
                          slope, spread)  # fmt: skip
        scatter = 0.0
        if moving:
            t_fit, z_fit, w_fit = times, data, w
        else:
            t_fit, z_fit, w_fit = mean_t, mean_z, mean_w
            for k in range(samples):
                for n in range(sensors):
                    scatter += (w[k, n] * (data[k, n] - mean_z[0, n])) ** 2
        if seen < needed:
            continue

        for n in range(sensors):
            if mean_w[0, n] != prepared[n]:
                _copy(mean_w[0], prepared)
                _project(grid, prepared, positions, c, lower, upper, Q, R, bound, order, rate)
                break
        _scan(mean_z[0], prepared, slope, spread, c, Q, R, bound, rate, v, score)
        count = _lowest_minima(score, shape, low, spare, chosen)
        for m in range(count):
            p = chosen[m]
            for a in range(3):
                states[m, 3 + order[a, p]] = v[a, p]
            for i in range(3):
                e[i] = grid[p, i] - mean_t[0] * states[m, 3 + i]
            e[3:] = 0.0
            states[m, :3] = 0.0
            _move(states[m], e, lower, upper, states[m])
        if window < t_fit.size:
            for m in range(count):
                _copy(states[m], states[count + m])
                _grow(
                    states[count + m], t_fit, z_fit, w_fit, window, positions, c, lower, upper,
                    size,
                )  # fmt: skip
            count *= 2
        for m in range(count):
            costs[m], arrived[m] = _refine(
                states[m], t_fit, z_fit, w_fit, positions, c, lower, upper, size, ITERATIONS
            )
        taken[:] = False
        best = _lowest(states[:count], costs[:count], taken, lower, upper)
        if best < 0:
            continue
        if moving:
            first, last = _walk(
                states[best], times, data, w, mean_t, mean_z, mean_w, positions, c, lower, upper,
                center, radius, path, path_cost,
            )  # fmt: skip
            for m in range(first, last + 1):
                if (
                    m != STEPS
                    and (m == first or path_cost[m] < path_cost[m - 1])
                    and (m == last or path_cost[m] <= path_cost[m + 1])
                ):
                    _copy(path[m], states[count])
                    costs[count], arrived[count] = _refine(
                        states[count], times, data, w, positions, c, lower, upper, size, ITERATIONS
                    )
                    count += 1
            best = _lowest(states[:count], costs[:count], taken, lower, upper)

        _normal_equations(states[best], t_fit, z_fit, w_fit, positions, c, H, g)
        flat = _weakest(H, lower, upper, ones, held, L, e) < singular
        if flat:
            _settle(states[best], t_fit, z_fit, w_fit, positions, c, lower, upper)
        _copy(states[best], x[run])
        converged[run] = arrived[best]
        cost[run] = scatter + _normal_equations(
            x[run], t_fit, z_fit, w_fit, positions, c, information[run], g
        )
        taken[best] = True
        while True:
            m = _lowest(states[:count], costs[:count], taken, lower, upper)
            if m < 0:
                break
            taken[m] = True
            if flat:
                _settle(states[m], t_fit, z_fit, w_fit, positions, c, lower, upper)
            if _differ(states[m], x[run], lower, upper) >= 0:
                _copy(states[m], second_x[run])
                second_cost[run] = scatter + costs[m]
                break


def _cached(fingerprint):
    """Return `_search`, compiled once for all processes.

    numba's cache watches this file only, and the variables of an enclosing function: as one of
    them, the fingerprint of the kernels makes a new kernel a new function.
    """

    @njit(nogil=True, error_model="numpy", cache=True)
    def search(*arguments):
        fingerprint  # noqa: B018
        _search(*arguments)

    return search


search = _cached(hashlib.sha256(Path(kernel.__file__).read_bytes()).hexdigest())
