"""The likelihood of a record given the state at its first sample, compiled.

Accelerations are integrated out: given that state, all that is left of the motion is a path a few
millimeters wide, along which an EKF of zero start covariance is exact enough.
"""

import numpy as np

from .._compile import cached_njit, fingerprint, inner_njit
from ..kernels import doppler as kernel

_inline = inner_njit(forceinline=True)
_shift = _inline(kernel.doppler_shift)
_gradient = _inline(kernel.doppler_shift_and_gradient)


@inner_njit
def _straight(z, weights, x, positions, c, T):
    """Return the log likelihood, but for a constant, of a straight path; move `x` to its end."""
    total = 0.0
    for k in range(len(z)):
        if k:
            for i in range(3):
                x[i] += T * x[3 + i]
        for n in range(len(positions)):
            if weights[k, n] > 0.0:
                s = positions[n]
                r = z[k, n] - _shift(x[0], x[1], x[2], x[3], x[4], x[5], s[0], s[1], s[2], c)
                total -= 0.5 * weights[k, n] * r * r
    return total


@inner_njit
def _crooked(z, weights, x, positions, c, T, Q, P, H, b, d):
    """Return the same of all paths from `x` on; write the estimate at their end to `x` and `P`."""
    total = 0.0
    for i in range(6):
        for j in range(6):
            P[i, j] = 0.0
    for k in range(len(z)):
        if k:
            for i in range(3):
                x[i] += T * x[3 + i]
                for j in range(6):
                    P[i, j] += T * P[3 + i, j]
            for i in range(6):
                for j in range(3):
                    P[i, j] += T * P[i, 3 + j]
                for j in range(6):
                    P[i, j] += Q[i, j]
        for n in range(len(positions)):
            s = positions[n]
            H[n, 6], H[n, 0], H[n, 1], H[n, 2], H[n, 3], H[n, 4], H[n, 5] = _gradient(
                x[0], x[1], x[2], x[3], x[4], x[5], s[0], s[1], s[2], c
            )
        for i in range(6):
            d[i] = 0.0
        volume = 1.0
        for n in range(len(positions)):
            if weights[k, n] > 0.0:
                innovation, growth = z[k, n] - H[n, 6], 1.0
                for i in range(6):
                    innovation -= H[n, i] * d[i]
                    s = 0.0
                    for j in range(6):
                        s += P[i, j] * H[n, j]
                    b[i] = s
                    growth += weights[k, n] * H[n, i] * s
                inverse = weights[k, n] / growth
                total -= 0.5 * innovation * innovation * inverse
                volume *= growth
                for i in range(6):
                    gain = b[i] * inverse
                    d[i] += gain * innovation
                    for j in range(6):
                        P[i, j] -= gain * b[j]
        total -= 0.5 * np.log(volume)
        for i in range(6):
            x[i] += d[i]
    return total


def _cached(compiled_in):
    """Return the likelihood of many states, compiled once for all processes."""

    @cached_njit
    def record_likelihood(z, weights, x, positions, c, T, Q, likelihood, P):
        """Write the log likelihood of a record (K, N) given each state of `x` (S, 6).

        `x` and `P` (S, 6, 6) become mean and covariance of the state at the last sample.
        """
        compiled_in  # noqa: B018  (see fingerprint)
        H, b, d = np.empty((len(positions), 7)), np.empty(6), np.empty(6)
        for i in range(len(x)):
            if Q.any():
                likelihood[i] = _crooked(z, weights, x[i], positions, c, T, Q, P[i], H, b, d)
            else:
                likelihood[i] = _straight(z, weights, x[i], positions, c, T)
                P[i] = 0.0

    return record_likelihood


record_likelihood = _cached(fingerprint(kernel))
