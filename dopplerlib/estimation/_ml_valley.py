"""Nearly flat likelihoods, compiled: follow the valley, choose one of its states.

A line of sight says little about range, so along one direction the cost may have several minima
close together, or none at all.
"""

import numpy as np

from .._compile import inner_njit
from ._ml_refine import (
    ALL,
    _boxed_step,
    _solve,
    copy,
    move,
    normal_equations,
    refine,
)

WEAK = 1e-5  # smallest eigenvalue of the scaled information below which `walk` sets out

STRIDE = 0.15  # of a step of the walk, relative to the distance from the array

STEPS = 25  # of the walk, each way: enough for a range that grows thirtyfold

CORRECTIONS = np.int64(3)  # iterations that bring a state next to the valley floor back to it

PULL = 1e-12  # weight of the box's center in `settle`, relative to the information

SETTLED = 1e-6  # last step of `settle`, relative to the box; rounding allows some 1e-9

DISTINCT = 1e-3  # two states differ if a component does by this share of the box

TIE = 1e-9  # relative difference between equal costs


@inner_njit
def weakest(H, lower, upper, start, held, L, e):
    """Find the direction e that H determines least; return its eigenvalue, H scaled to ones.

    Inverse iteration from `start`, in units in which the diagonal of H is one: with D = diag H,
    C = D^-1/2 H D^-1/2 and v <- C^-1 v / |v|, which grows along the smallest eigenvalue of C. So an
    eigenvalue is a share of what single components are known by, whatever their units. Directions
    of components that the box fixes do not count.
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
    for _ in range(4):  # plenty where it matters: where one eigenvalue is by far the smallest
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
        e[i] = v[i] / scale[i]  # in the units of the state again
    return value / norm  # Rayleigh quotient v'C v / v'v


@inner_njit
def _distance(p, center):
    return np.sqrt((p[0] - center[0]) ** 2 + (p[1] - center[1]) ** 2 + (p[2] - center[2]) ** 2)


@inner_njit
def differ(x, other, lower, upper):
    """Return the first component that differs clearly between two states, or -1."""
    for i in range(6):
        if abs(x[i] - other[i]) > DISTINCT * (upper[i] - lower[i]):
            return i
    return -1


@inner_njit
def lowest(states, costs, taken, lower, upper):
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
            component = differ(states[m], states[best], lower, upper)
            if component < 0:
                best = m if costs[m] < costs[best] else best
            elif states[m, component] > states[best, component]:
                best = m
        elif costs[m] < costs[best]:
            best = m
    return best


@inner_njit
def walk(x, t, z, w, still_t, still_z, still_w, positions, c, lower, upper, center, radius,
          path, cost):  # fmt: skip
    """Follow the weakest direction of x both ways; return the range of `path` that was filled.

    The walk stays where the mean Doppler shifts (`still_t`, `still_z`, `still_w`: one sample in
    the middle) are explained best. `cost` is that of all measurements along the path.
    """
    H, g, L = np.empty((6, 6)), np.empty(6), np.empty((6, 6))
    held, e, before, new = np.empty(6, np.bool_), np.empty(6), np.empty(6), np.empty(6)
    copy(x, path[STEPS])
    cost[STEPS] = normal_equations(x, t, z, w, positions, c, H, g)
    first, last = STEPS, STEPS
    for way in (-1, 1):
        for i in range(6):
            before[i] = way * (x[i] - center[i]) if i < 3 else 0.0
        here = STEPS
        for _ in range(STEPS):
            y = path[here]
            normal_equations(y, still_t, still_z, still_w, positions, c, H, g)
            if not weakest(H, lower, upper, before, held, L, e) <= WEAK:
                break
            # An eigenvector has no sign: go on in the direction of the step before, at first away
            # from the array or towards it. Steps grow with the distance, as the valley does.
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
            move(y, e, lower, upper, new)
            refine(new, still_t, still_z, still_w, positions, c, lower, upper, 0.0, CORRECTIONS)
            if _distance(new, y) < 0.2 * STRIDE * reach:  # at the end of the box
                break
            here += way
            copy(new, path[here])
            cost[here] = normal_equations(new, t, z, w, positions, c, H, g)
        first, last = min(first, here), max(last, here)
    return first, last


@inner_njit
def settle(x, t, z, w, positions, c, lower, upper):
    """Move x among equally likely states to the one nearest to the center of the box.

    Newton's method with a vanishing prior: with M its weights and m the center of the box, it
    minimizes cost + (x - m)'M (x - m), so it pulls only where the data say nothing. Short steps are
    for those few sets of equal states that bend sharply. If the cost would rise x stays: then the
    box leaves one best state only.
    """
    H, g, L = np.empty((6, 6)), np.empty(6), np.empty((6, 6))
    held, d = np.empty(6, np.bool_), np.empty(6)
    towards, last, pull, prior = np.empty(6), np.empty(6), np.empty(6), np.zeros(6)
    enough = normal_equations(x, t, z, w, positions, c, H, g) * (1 + TIE) + TIE
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
            normal_equations(new, t, z, w, positions, c, H, g)
            # d is the Newton step of both, `towards` the part of it that the pull alone makes.
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
            # Where the set bends, a full step is too long or too short. After `share` of the pull's
            # step its next one was `towards` instead of `last`; the secant through both says which
            # share would have left nothing: share / (1 - along / square).
            if square > 0:
                share = min(max(share / max(1 - along / square, 0.1), 0.05), 2.0)
            share = min(share, longest_step / length)
            for i in range(6):
                last[i] = towards[i]
                d[i] += (share - 1) * towards[i]  # only the pull's part is stretched
            move(new, d, lower, upper, new)
            if length < SETTLED:
                # What the prior has cost in the directions that the data do determine is regained.
                cost, _ = refine(new, t, z, w, positions, c, lower, upper, 0.0, CORRECTIONS)
                if cost <= enough:
                    copy(new, x)
                    return
                break
