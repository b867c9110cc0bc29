"""A Gaussian sum over a record, compiled.

Member m has the coordinates ``x[m]`` (6), the covariance ``P[m]`` (6, 6) and the logarithm of its
weight ``weight[m]``. While there are many, samples are taken in blocks, and the state belongs to
the middle of its block: the mean of a few shifts is that of the middle.
"""

import numpy as np

from .._compile import cached_njit, fingerprint
from ..kernels import ring_coordinates as kernel
from . import _gaussian_sum_merge, _gaussian_sum_start, _ring_member
from ._gaussian_sum_merge import drop, merge
from ._gaussian_sum_start import start
from ._ring_member import LOST, compiled, factor, predict, put, put_square, state_at, update

ALONE = 2  # members with which samples are taken one by one
_BETWEEN = 2  # blocks from one merging to the next
_ITERATIONS = 2  # of an update
_MARGIN = 12.0  # by which a window may be less likely than the best, in logarithms


@compiled
def _cubature(x, P, T, r, mean, covariance, state, at, point, G, L):
    """Write mean and covariance of the state, `T` after one member; False if it has none."""
    if np.isnan(factor(P, L)):
        return False
    for i in range(6):
        mean[i] = 0.0
        for j in range(6):
            covariance[i, j] = 0.0
    for k in range(12):
        sign = np.sqrt(6.0) if k % 2 else -np.sqrt(6.0)
        for i in range(6):
            point[i] = x[i] + sign * L[i, k // 2]
        state_at(point, r, at, G)
        if not at[0] > 0.0:  # a point in or behind the plane of the sensors stays in it
            state_at(x, r, state, G)
            at[0], at[3] = 0.0, state[3]
        for i in range(3):
            at[i] += T * at[3 + i]
        for i in range(6):
            mean[i] += at[i] / 12
            for j in range(i + 1):
                covariance[i, j] += at[i] * at[j] / 12
    for i in range(6):
        for j in range(i + 1):
            covariance[i, j] -= mean[i] * mean[j]
            covariance[j, i] = covariance[i, j]
    return True


@compiled
def moments(x, P, weight, count, T, noise, r, mean, covariance, shares, means, covariances,
            state, G, L):  # fmt: skip
    """Write mean and covariance of the state, `T` after the members, and those of the heaviest.

    `noise` (C, 6) has the columns of the noise of the state on the way; `shares` (M), `means`
    (M, 6) and `covariances` (M, 6, 6) are those of the M heaviest members, as far as there are.
    """
    rank = np.full(count, -1)
    for place in range(min(len(shares), count)):
        heaviest = -1
        for m in range(count):
            if rank[m] < 0 and (heaviest < 0 or weight[m] > weight[heaviest]):
                heaviest = m
        rank[heaviest] = place
    for i in range(6):
        mean[i] = 0.0
        for j in range(6):
            covariance[i, j] = 0.0
    own, own_P, at, point = np.empty(6), np.empty((6, 6)), np.empty(6), np.empty(6)
    total = 0.0
    for m in range(count):
        if not _cubature(x[m], P[m], T, r, own, own_P, state, at, point, G, L):
            continue
        for column in noise:
            for i in range(6):
                for j in range(6):
                    own_P[i, j] += column[i] * column[j]
        w = np.exp(weight[m])
        total += w
        for i in range(6):
            mean[i] += w * own[i]
            for j in range(6):
                covariance[i, j] += w * (own_P[i, j] + own[i] * own[j])
        if rank[m] >= 0:
            shares[rank[m]] = w
            put(means[rank[m]], own)
            put_square(covariances[rank[m]], own_P)
    for place in range(len(shares)):
        shares[place] /= total
    for i in range(6):
        mean[i] /= total
    for i in range(6):
        for j in range(6):
            covariance[i, j] = covariance[i, j] / total - mean[i] * mean[j]


@compiled
def _scan(z, weights, first, length, scan, variance):
    """Write the weighted mean of each sensor over `length` samples, and its variance."""
    for n in range(z.shape[1]):
        total = seen = 0.0
        for k in range(first, first + length):
            if not np.isnan(z[k, n]):
                total += weights[k, n] * z[k, n]
                seen += weights[k, n]
        scan[n] = total / seen if seen > 0.0 else np.nan
        variance[n] = 1 / seen if seen > 0.0 else np.inf


@compiled
def _squares(m):
    """Return 1 + 4 + 9 + ... + m^2."""
    return m * (m + 1) * (2 * m + 1) / 6


@compiled
def _track(z, weights, positions, r, c, T, block, noise, mean, information, grid, widths, least,
           lightest, loss, every, out_x, out_P, out_members, out_weights, out_means,
           out_covariances):  # fmt: skip
    """Filter one record (K, N) of shifts; `noise` (C, 6) has the columns of that of one step."""
    K, N = z.shape
    size = len(grid)
    x, P, weight = np.empty((size, 6)), np.empty((size, 6, 6)), np.empty(size)
    state, G, F, spare = np.empty(6), np.zeros((6, 6)), np.empty((6, 6)), np.empty((6, 6))
    at, before, P_before = np.empty(6), np.empty(6), np.empty((6, 6))
    g, b, L = np.empty(6), np.empty(6), np.zeros((6, 6))
    scan, variance = np.empty(N), np.empty(N)
    count, first, last, cycles = 0, 0, 0.0, 0
    while first < K:
        length = 1 if cycles > 1 and count <= ALONE else block
        length = min(length, K - first)
        _scan(z, weights, first, length, scan, variance)
        middle = first + 0.5 * (length - 1)
        if cycles == 0:
            count = start(scan, variance, positions, r, c, mean, information, grid, widths, least,
                          _MARGIN, x, P, weight)  # fmt: skip
        else:
            steps = middle - last
            push = _columns(noise, steps, T)
            for m in range(count):
                if predict(x[m], P[m], steps * T, push, r, least, state, G, F, spare):
                    weight[m] += update(x[m], P[m], scan, variance, positions, r, c, _ITERATIONS,
                                        at, before, P_before, g, b)  # fmt: skip
                else:
                    weight[m] = LOST
        count = drop(x, P, weight, count, lightest)
        if count == 0:
            break
        if cycles % _BETWEEN == 1:
            count = merge(x, P, weight, count, loss)
        # Outputs at the samples every - 1, 2 every - 1, ... of this block.
        for o in range(first // every, (first + length) // every):
            k = (o + 1) * every - 1
            # A velocity in the block less the mean of its velocities has this variance, in steps.
            i = k - first
            apart = (_squares(i) + _squares(length - 1 - i)) / length**2
            moments(x, P, weight, count, (k - middle) * T, _columns(noise, apart, T), r, out_x[o],
                    out_P[o], out_weights[o], out_means[o], out_covariances[o], state, G,
                    L)  # fmt: skip
            out_members[o] = count
        cycles += 1
        last = middle
        first += length


@compiled
def _columns(noise, steps, T):
    """Return the columns of the noise that gathers over some steps, for columns of one."""
    columns = np.empty(noise.shape)
    for i in range(len(noise)):
        for j in range(3):
            columns[i, 3 + j] = np.sqrt(steps) * noise[i, 3 + j]
            columns[i, j] = 0.5 * steps * T * columns[i, 3 + j]
    return columns


def _cached(compiled_in):
    """Return the filter of many records, compiled once for all processes."""

    @cached_njit
    def filter_records(
        z, weights, positions, r, c, T, block, noise, mean, information, grid, widths, least,
        lightest, loss, every, x, P, members, mixture, means, covariances,
    ):  # fmt: skip
        compiled_in  # noqa: B018  (see fingerprint)
        for run in range(len(z)):
            _track(
                z[run], weights, positions, r, c, T, block, noise, mean, information, grid, widths,
                least, lightest, loss, every, x[run], P[run], members[run],
                mixture[run], means[run], covariances[run],
            )  # fmt: skip

    return filter_records


filter_records = _cached(
    fingerprint(kernel, _ring_member, _gaussian_sum_start, _gaussian_sum_merge)
)
