"""Ring coordinates, compiled: state, shift, motion and the algebra of 6 x 6 matrices."""

import numpy as np

from .._cholesky import compiled
from .._compile import inner_njit
from ..kernels import ring_coordinates as kernel

LOST = -np.inf  # logarithm of the weight of a member that is none

inline = inner_njit(forceinline=True)
_shift = inline(kernel.shift_and_gradient)
_to_state = inline(kernel.to_state)
_moved = inline(kernel.moved)
_pushed = inline(kernel.pushed)


@compiled
def put(target, source):
    """Copy a vector; numba takes seconds to compile what NumPy writes in one line."""
    for i in range(source.size):
        target[i] = source[i]


@compiled
def put_square(target, source):
    """Copy a matrix."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@compiled
def state_at(x, r, state, G):
    """Write the state at coordinates `x`, and its derivatives, to `state` and `G`."""
    (
        state[0], state[1], state[2], state[3], state[4], state[5],
        G[0, 0], G[0, 1], G[0, 5], G[1, 0], G[1, 5], G[2, 1], G[2, 5],
        G[3, 0], G[3, 1], G[3, 2], G[3, 3], G[3, 4], G[3, 5],
        G[4, 2], G[4, 5], G[5, 3], G[5, 5],
    ) = _to_state(x[0], x[1], x[2], x[3], x[4], np.exp(x[5]), r)  # fmt: skip


@compiled
def predict(x, P, T, noise, r, least, state, G, F, spare):
    """Move one member by `T`, with noise of columns (C, 6) in the state; False if it is lost."""
    state_at(x, r, state, G)
    if not state[0] > least:
        return False
    V = state[3] ** 2 + state[4] ** 2 + state[5] ** 2
    slope = spare[0]
    for j in range(6):
        slope[j] = 2 * (state[3] * G[3, j] + state[4] * G[4, j] + state[5] * G[5, j])
    (
        x[0], x[1], x[2], x[3], x[4], growth,
        F[0, 0], F[0, 1], F[0, 2], F[0, 3], F[0, 4], F[0, 5],
        F[1, 0], F[1, 1], F[1, 2], F[1, 3], F[1, 4], F[1, 5],
        F[2, 0], F[2, 1], F[2, 2], F[2, 3], F[2, 4], F[2, 5],
        F[3, 0], F[3, 1], F[3, 2], F[3, 3], F[3, 4], F[3, 5],
        F[4, 0], F[4, 1], F[4, 2], F[4, 3], F[4, 4], F[4, 5],
        F[5, 0], F[5, 1], F[5, 2], F[5, 3], F[5, 4], F[5, 5],
    ) = _moved(
        x[0], x[1], x[2], x[3], x[4], np.exp(-x[5]), V,
        slope[0], slope[1], slope[2], slope[3], slope[4], slope[5], T,
    )  # fmt: skip
    x[5] += np.log(growth)
    for i in range(3):
        state[i] += T * state[3 + i]
    if not state[0] > least:
        return False
    for i in range(6):
        for j in range(6):
            s = 0.0
            for k in range(6):
                s += F[i, k] * P[k, j]
            spare[i, j] = s
    for i in range(6):
        for j in range(i + 1):
            s = 0.0
            for k in range(6):
                s += spare[i, k] * F[j, k]
            P[i, j] = P[j, i] = s
    rho = np.exp(x[5])
    for c in noise:
        d = _pushed(
            state[0], state[1], state[2], state[3], state[4], state[5], rho,
            c[0], c[1], c[2], c[3], c[4], c[5],
        )  # fmt: skip
        for i in range(6):
            for j in range(6):
                P[i, j] += d[i] * d[j]
    return True


@inline
def measure(x, u, state, G, position, r, c, g):
    """Return the shift at one sensor, and write its gradient by the coordinates to `g`.

    `state` and its derivatives `G` count only if the sensor is off the plane.
    """
    shift, g[0], g[1], g[2], g[3], g[4], g[5], by_x, by_v = _shift(
        x[0], x[1], x[2], x[3], x[4], u, state[0], state[3], position[0], position[1], position[2],
        r, c,
    )  # fmt: skip
    if position[0] != 0.0:
        for i in range(6):
            g[i] += by_x * G[0, i] + by_v * G[3, i]
    return shift


@compiled
def update(x, P, z, variance, positions, r, c, flat, iterations, state, G, at, before, P_before, g,
           b):  # fmt: skip
    """Update one member, sensor by sensor, and return the log likelihood of the scan.

    Every iteration linearizes at the estimate of the one before. `flat` says that all sensors are
    in their plane.
    """
    put(before, x)
    put_square(P_before, P)
    put(at, x)
    likelihood = 0.0
    state[0] = state[3] = 0.0
    for iteration in range(iterations):
        last = iteration + 1 == iterations
        if iteration:
            put(at, x)
            put(x, before)
            put_square(P, P_before)
        u = np.exp(-at[5])
        if not flat:
            state_at(at, r, state, G)
        for n in range(len(z)):
            if np.isnan(z[n]):
                continue
            innovation = z[n] - measure(at, u, state, G, positions[n], r, c, g)
            S = variance[n]
            for i in range(6):
                innovation -= g[i] * (x[i] - at[i])
                s = 0.0
                for j in range(6):
                    s += P[i, j] * g[j]
                b[i] = s
                S += s * g[i]
            gain = 1 / S
            if last:
                likelihood -= 0.5 * (innovation * innovation * gain + np.log(2 * np.pi * S))
            for i in range(6):
                k = b[i] * gain
                x[i] += k * innovation
                for j in range(6):
                    P[i, j] -= k * b[j]
    if not np.isfinite(likelihood):
        return LOST
    return likelihood
