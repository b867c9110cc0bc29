"""A Gaussian sum along a record, compiled.

Member m has the coordinates ``x[m]`` (6), the covariance ``P[m]`` (6, 6) and the logarithm of its
weight ``weight[m]``. While there are many, samples are taken in blocks, and the state belongs to
the middle of its block: the mean of a few shifts is that of the middle.
"""

import numpy as np

from .. import _cholesky
from .._cholesky import compiled, factor
from .._compile import cached_njit, fingerprint
from ..kernels import doppler, ring_coordinates
from . import _gaussian_sum_gate, _gaussian_sum_merge, _gaussian_sum_start, _ring_member
from ._gaussian_sum_gate import refuse
from ._gaussian_sum_merge import drop, merge
from ._gaussian_sum_start import settle, shift_in_space, start
from ._ring_member import LOST, predict, put, put_square, state_at, update

ALONE = 2  # members with which samples are taken one by one
_BETWEEN = 2  # blocks from one merging to the next
_ITERATIONS = 2  # of an update
_MARGIN = 12.0  # by which a window may be less likely than the best, in logarithms
_FEW = 20  # members, at most, that are fitted again to all scans
_UNLIKE = 0.05  # Kullback-Leibler cost of a new fit, at most: a tenth in the mean squared distance


@compiled
def _cubature(x, P, T, r, mean, covariance, state, at, point, G, L):
    """Write mean and covariance of the state, `T` after one member; False if it has none."""
    state_at(x, r, state, G)
    if not state[0] > 0.0 or np.isnan(factor(P, L)):
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

    Return the number of members that have a state; the others do not count, and if there are none,
    nothing is written. `noise` (C, 6) has the columns of the noise of the state on the way;
    `shares` (M), `means` (M, 6) and `covariances` (M, 6, 6) are those of the M heaviest members,
    as far as there are.
    """
    own, own_P, share = np.empty((count, 6)), np.empty((count, 6, 6)), np.zeros(count)
    at, point, total, there = np.empty(6), np.empty(6), 0.0, 0
    for m in range(count):
        if _cubature(x[m], P[m], T, r, own[m], own_P[m], state, at, point, G, L):
            share[m] = np.exp(weight[m])
            total += share[m]
            there += 1
    if not total > 0.0:
        return 0
    for i in range(6):
        mean[i] = 0.0
        for j in range(6):
            covariance[i, j] = 0.0
    for m in range(count):
        share[m] /= total
        if share[m] > 0.0:
            for column in noise:
                for i in range(6):
                    for j in range(6):
                        own_P[m, i, j] += column[i] * column[j]
            for i in range(6):
                mean[i] += share[m] * own[m, i]
                for j in range(6):
                    covariance[i, j] += share[m] * (own_P[m, i, j] + own[m, i] * own[m, j])
    for i in range(6):
        for j in range(6):
            covariance[i, j] -= mean[i] * mean[j]
    for place in range(min(len(shares), there)):
        heaviest = 0
        for m in range(count):
            if share[m] > share[heaviest]:
                heaviest = m
        shares[place] = share[heaviest]
        put(means[place], own[heaviest])
        put_square(covariances[place], own_P[heaviest])
        share[heaviest] = -1.0
    return there


@compiled
def _slopes(x, weight, count, positions, r, c, T, state, G, slope):
    """Write the change of each shift from sample to sample to `slope`, for the heaviest member."""
    heaviest = 0
    for m in range(count):
        if weight[m] > weight[heaviest]:
            heaviest = m
    if count > 0:
        state_at(x[heaviest], r, state, G)
    for n in range(len(slope)):
        slope[n] = 0.0
        if count > 0:
            _, h_x, h_y, h_z, _, _, _ = shift_in_space(
                state[0], state[1], state[2], state[3], state[4], state[5],
                positions[n, 0], positions[n, 1], positions[n, 2], c,
            )  # fmt: skip
            slope[n] = T * (h_x * state[3] + h_y * state[4] + h_z * state[5])


@compiled
def _scan(z, weights, length, slope, scan, variance):
    """Write the weighted mean of each sensor over `length` samples, and its variance.

    Return the log densities of the means at themselves, and of the samples given the means and
    their `slope`.
    """
    at_mean = inside = 0.0
    for n in range(z.shape[1]):
        total = seen = 0.0
        for k in range(length):
            if not np.isnan(z[k, n]):
                total += weights[k, n] * z[k, n]
                seen += weights[k, n]
        scan[n] = total / seen if seen > 0.0 else np.nan
        variance[n] = 1 / seen if seen > 0.0 else np.inf
        if seen > 0.0:
            at_mean += 0.5 * np.log(seen / (2 * np.pi))
            inside -= 0.5 * np.log(seen / (2 * np.pi))
            for k in range(length):
                if not np.isnan(z[k, n]):
                    apart = z[k, n] - scan[n] - (k - 0.5 * (length - 1)) * slope[n]
                    inside += 0.5 * (
                        np.log(weights[k, n] / (2 * np.pi)) - weights[k, n] * apart * apart
                    )
    return at_mean, inside


@compiled
def _squares(m):
    """Return 1 + 4 + 9 + ... + m^2."""
    return m * (m + 1) * (2 * m + 1) / 6


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
    """Return the filter of one target, compiled once for all processes."""

    @cached_njit
    def track(setting, bank, z, weights, every, out):
        """Take the next samples (K, N) of a target; after each `every` of them, write estimates.

        All that is kept from call to call is in the bank; so samples may come one by one.
        """
        compiled_in  # noqa: B018  (see fingerprint)
        positions, r, c, T = setting.positions, setting.r, setting.c, setting.T
        noise, flat, least = setting.noise, setting.flat, setting.least
        mean, information = setting.mean, setting.information
        x, P, weight = bank.x, bank.P, bank.weight
        held, held_weights = bank.samples, bank.weights
        scans, variances, middles = bank.scans, bank.variances, bank.middles
        state, G, F, spare = np.empty(6), np.zeros((6, 6)), np.empty((6, 6)), np.empty((6, 6))
        at, before, P_before = np.empty(6), np.empty(6), np.empty((6, 6))
        g, b, L, slope = np.empty(6), np.empty(6), np.zeros((6, 6)), np.empty(z.shape[1])
        count, taken, blocks, filled, length, last, settling = bank.numbers
        evidence, constant, rest, known = bank.logs
        exact = len(noise) == 0
        for k in range(len(z)):
            if count == 0 and blocks > 0:
                break  # all members have been lost
            put(held[filled], z[k])
            put(held_weights[filled], weights[k])
            taken += 1
            filled += 1
            if filled == length:
                # Of what goes straight all scans are kept, else the newest only.
                s = blocks if exact and blocks < len(scans) else len(scans) - 1
                scan, variance = scans[s], variances[s]
                if blocks > 0:
                    steps = 0.5 * (last + length)
                    push = _columns(noise, steps, T)
                    for m in range(count):
                        if not predict(x[m], P[m], steps * T, push, r, least, state, G, F, spare):
                            weight[m] = LOST
                if setting.limit < np.inf:
                    lost = refuse(held, held_weights, length, x, P, weight, count, positions, r, c,
                                  flat, setting.limit, state, G, g)  # fmt: skip
                    constant += lost
                    evidence += lost
                _slopes(x, weight, count, positions, r, c, T, state, G, slope)
                at_mean, inside = _scan(held, held_weights, length, slope, scan, variance)
                constant += at_mean
                rest += inside
                middles[s] = (taken - 0.5 * (length + 1)) * T
                if blocks == 0:
                    start(scans[s:s + 1], variances[s:s + 1], middles[s:s + 1], positions, r, c,
                          mean, information, setting.grid, setting.widths, setting.overlaps, least,
                          _MARGIN, x, P, weight)  # fmt: skip
                    count = len(weight)
                    evidence = setting.prior + constant
                else:
                    for m in range(count):
                        if weight[m] > LOST:
                            weight[m] += update(x[m], P[m], scan, variance, positions, r, c, flat,
                                                _ITERATIONS, state, G, at, before, P_before, g,
                                                b)  # fmt: skip
                count, gained = drop(x, P, weight, count, setting.lightest)
                evidence += gained
                if blocks % _BETWEEN == 0:
                    count = merge(x, P, weight, count, setting.loss)
                blocks += 1
                if exact and settling <= blocks < len(scans) and count <= _FEW:
                    modes = settle(scans[:blocks], variances[:blocks], middles[:blocks], middles[s],
                                   positions, r, c, mean, information, least, _UNLIKE, x, P, weight,
                                   count)  # fmt: skip
                    if modes > 0:
                        count, gained = drop(x, P, weight, modes, setting.lightest)
                        evidence = setting.prior + constant + gained
                    settling = blocks + blocks // 4
                last, filled = length, 0
                if blocks > 1 and count <= ALONE and not exact:
                    length = 1
                else:
                    length = setting.block
            if taken % setting.block == 0:
                known = evidence + rest  # of the same samples, whatever the length of blocks now
            if (k + 1) % every == 0 and count > 0:
                # A velocity less the mean of those of its block has this variance, in steps.
                o, apart = k // every, _squares(last - 1) / last**2 + filled
                ahead = (0.5 * (last - 1) + filled) * T
                push = _columns(noise, apart, T)
                out.members[o] = moments(
                    x, P, weight, count, ahead, push, r, out.x[o], out.P[o], out.weights[o],
                    out.means[o], out.covariances[o], state, G, L,
                )  # fmt: skip
                if out.members[o] > 0:
                    out.evidence[o] = known
        for i, value in enumerate((count, taken, blocks, filled, length, last, settling)):
            bank.numbers[i] = value
        for i, value in enumerate((evidence, constant, rest, known)):
            bank.logs[i] = value

    return track


track = _cached(
    fingerprint(
        doppler, ring_coordinates, _cholesky, _ring_member, _gaussian_sum_start,
        _gaussian_sum_merge, _gaussian_sum_gate,
    )
)  # fmt: skip
