"""Cholesky factors of 6 x 6 matrices, compiled, for loops over many of them."""

import numpy as np

from ._compile import inner_njit

compiled = inner_njit


@compiled
def factor(A, L):
    """Write the Cholesky factor of `A` to `L` and return the log of its determinant, or NaN."""
    total = 0.0
    for i in range(6):
        for j in range(i + 1):
            s = A[i, j]
            for k in range(j):
                s -= L[i, k] * L[j, k]
            if i == j:
                if not s > 0.0:
                    return np.nan
                L[i, i] = np.sqrt(s)
                total += np.log(s)
            else:
                L[i, j] = s / L[j, j]
    return total


@compiled
def solve(L, v):
    """Solve L L' v = v in place."""
    for i in range(6):
        for k in range(i):
            v[i] -= L[i, k] * v[k]
        v[i] /= L[i, i]
    for i in range(5, -1, -1):
        for k in range(i + 1, 6):
            v[i] -= L[k, i] * v[k]
        v[i] /= L[i, i]
