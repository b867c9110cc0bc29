"""Refine a state: Levenberg-Marquardt in a box, compiled.

The cost is chi-square: the sum of squared residuals over their standard deviations. With residuals
r and their Jacobian J, H = J'J and g = J'r, the cost after a step d is about

    r'r + 2 g'd + d'H d,

whose damped minimum in the box is the step: (H + factor diag H) d = -g where the box is far.
"""

import numpy as np

from .._compile import inner_njit
from ..kernels import doppler as kernel

# A Python integer as an argument would make numba compile a function for this very value.
ALL, VELOCITY = np.int64(0), np.int64(3)  # the first component of a step

ITERATIONS = np.int64(200)  # of one refinement; ten are usual

DAMPING = 1e-6  # of the first step, relative to the diagonal of J'J

TOLERANCE = 1e-12  # stop when a step promises less, relative to the cost

NOISE = 1e-15  # relative rounding error of a predicted measurement

_shift_and_gradient = inner_njit(forceinline=True)(kernel.doppler_shift_and_gradient)


@inner_njit
def copy(source, target):
    """Copy an array; written as assignment to a slice it compiles for seconds."""
    for i in range(source.size):
        target[i] = source[i]


@inner_njit
def normal_equations(x, t, z, w, positions, c, H, g):
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


@inner_njit
def _solve(H, damping, rhs, held, L, d):
    """Solve (H + diag(damping)) d = rhs for the components not held; those of `d` that are stay.

    By L D L' with D kept as its inverse on the diagonal of `L`. What is held moves to the
    right-hand side: H_ff d_f = rhs_f - H_fh d_h.
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


@inner_njit
def _boxed_step(H, g, damping, x, lower, upper, first, held, L, d):
    """Find the step d of components `first` to 5 that lowers d'(H + damping)d/2 + g'd in the box.

    A component that would leave the box is put on its bound and the others are solved again:
    of a convex quadratic whose minimum lies outside, one of the offenders is on its bound.
    """
    rhs = np.empty(6)
    for i in range(6):
        rhs[i] = -g[i]
        d[i] = 0.0
        # Held from the beginning: what is on a bound and would be pushed out of the box.
        held[i] = (
            i < first
            or lower[i] == upper[i]
            or (x[i] <= lower[i] and g[i] > 0)
            or (x[i] >= upper[i] and g[i] < 0)
        )
    for _ in range(6):  # each time one more component is held
        _solve(H, damping, rhs, held, L, d)
        # The offender is the component that meets its bound after the smallest share of the step.
        share, offender = 1.0, -1
        for i in range(first, 6):
            room = (upper[i] if d[i] > 0 else lower[i]) - x[i]
            if not held[i] and abs(d[i]) > abs(room) and room / d[i] < share:
                share, offender = room / d[i], i
        if offender < 0:
            break
        held[offender] = True
        d[offender] = (upper[offender] if d[offender] > 0 else lower[offender]) - x[offender]


@inner_njit
def move(x, d, lower, upper, moved):
    for i in range(6):
        moved[i] = min(max(x[i] + d[i], lower[i]), upper[i])


@inner_njit
def refine(x, t, z, w, positions, c, lower, upper, size, iterations):
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
    cost = normal_equations(x, t, z, w, positions, c, H, g)
    for _ in range(iterations):
        for i in range(6):
            damping[i] = factor * H[i, i]
        _boxed_step(H, g, damping, x, lower, upper, ALL, held, L, d)
        promise = 0.0  # by how much the quadratic model says that the cost falls: -2 g'd - d'H d
        for i in range(6):
            promise -= 2 * g[i] * d[i]
            for j in range(6):
                promise -= d[i] * H[i, j] * d[j]
        move(x, d, lower, upper, new)
        cost_new = normal_equations(new, t, z, w, positions, c, H_new, g_new)
        if cost - cost_new < 0.9 * promise:
            # For the velocity alone the problem is nearly linear: one undamped step will do.
            _boxed_step(H_new, g_new, none, new, lower, upper, VELOCITY, held, L, d)
            move(new, d, lower, upper, new)
            cost_new = normal_equations(new, t, z, w, positions, c, H_new, g_new)

        # Rounding errors e of the predictions change the cost by |r + e|^2 - |r|^2, at most
        # |e|^2 + 2 |r| |e|: a smaller gain is none.
        rounding = NOISE * size
        enough = TOLERANCE * cost + rounding * (rounding + 2 * np.sqrt(cost))
        gain = cost - cost_new
        if gain > 0:
            copy(new, x)
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


@inner_njit
def grow(x, t, z, w, window, positions, c, lower, upper, size):
    """Refine x on the first `window` samples, then on four times as many, up to nearly all.

    Over a long record a small error of the velocity is a large one of the last positions, and the
    cost has many minima; a short record leads towards the right one.
    """
    while window < t.size:
        refine(x, t[:window], z[:window], w[:window], positions, c, lower, upper, size, ITERATIONS)
        window *= 4
