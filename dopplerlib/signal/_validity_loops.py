"""The passes over every raw sample behind `valid_samples`, compiled.

A recording of minutes does not fit into a cache, and NumPy would fetch it anew for each operation.
Rows (rows, n) are branches, I or Q of one module; `good` (rows, n) is False where a sample has been
found to be no measurement.
"""

import numpy as np

from .._compile import cached_njit, inner_njit

BLOCK = 32  # samples that show a branch's noise
LANES = 64  # blocks that are worked on at a time
_BINS = np.arange(2, BLOCK // 2 - 1)  # those that do: away from 0 Hz and from half the rate
_TAPER = np.hanning(BLOCK + 2)[1:-1]
_PHASE = 2 * np.pi * np.outer(np.arange(BLOCK // 2 + 1), _BINS) / BLOCK
_COS, _SIN = np.cos(_PHASE), np.sin(_PHASE)
# What the fourth differences of white noise, and the power of a bin, are in the median: chi-square
# of one degree of freedom and of two.
_JERK = 70 * 0.4549
_FLOOR = np.log(2) * np.sum(_TAPER**2)


def middle_network(n):
    """Return the pairs (i, j) to be put in order, so that place n // 2 of n values is the middle.

    Batcher's network of odd-even merges (Knuth, vol. 3, algorithm 5.3.4M), of which only what leads
    to that place is kept. It does the same whatever the values are, so that many rows of them can
    go through it at once.
    """
    pairs, top = [], 1 << (n - 1).bit_length() - 1
    p = top
    while p > 0:
        q, r, d = top, 0, p
        while d > 0:
            pairs += [(i, i + d) for i in range(n - d) if i & p == r]
            d, q, r = q - p, q >> 1, p
        p >>= 1
    needed, kept = {n // 2}, []
    for pair in reversed(pairs):
        if needed & set(pair):
            needed |= set(pair)
            kept.append(pair)
    return np.array(kept[::-1])


_JERKS, _POWERS = middle_network(BLOCK - 4), middle_network(len(_BINS))


@cached_njit
def survey(rows, good, ends, counts, step, same, longest):
    """Describe the values of each row, and how they change.

    `ends` (rows, 2, 2) are the highest and the second highest value of the row and of its negative,
    `counts` (rows, 2, 2) how many samples have them, of those that are good. `step` (rows,) is the
    smallest change from a sample to the next that is not zero, `same` (rows,) how many do not
    change, and `longest` (rows, L) the lengths of the L longest runs of equal samples, 1 at least.
    """
    for r in range(len(rows)):
        top, second, bottom, last = -np.inf, -np.inf, np.inf, np.inf
        tops = seconds = bottoms = lasts = equal = 0
        least, run, before = np.inf, 1, np.nan
        longest[r] = 1
        for k in range(rows.shape[1]):
            x = rows[r, k]
            move = abs(x - before)
            if move == 0.0:
                equal += 1
                run += 1
            else:
                if run > longest[r, 0]:
                    _put(run, longest[r])
                run = 1
                if move < least:
                    least = move
            before = x
            if not good[r, k]:
                continue
            if x >= second:
                if x > top:
                    second, seconds, top, tops = top, tops, x, 1
                elif x == top:
                    tops += 1
                elif x > second:
                    second, seconds = x, 1
                else:
                    seconds += 1
            if x <= last:
                if x < bottom:
                    last, lasts, bottom, bottoms = bottom, bottoms, x, 1
                elif x == bottom:
                    bottoms += 1
                elif x < last:
                    last, lasts = x, 1
                else:
                    lasts += 1
        ends[r, 0, 0], ends[r, 0, 1], ends[r, 1, 0], ends[r, 1, 1] = top, second, -bottom, -last
        counts[r, 0, 0], counts[r, 0, 1], counts[r, 1, 0], counts[r, 1, 1] = (
            tops, seconds, bottoms, lasts,
        )  # fmt: skip
        step[r], same[r] = least, equal
        if run > longest[r, 0]:
            _put(run, longest[r])


@inner_njit
def _put(value, ascending):
    """Let a value that is larger than the first one take its place among them."""
    place = 0
    while place + 1 < len(ascending) and ascending[place + 1] < value:
        ascending[place] = ascending[place + 1]
        place += 1
    ascending[place] = value


@cached_njit
def noise(rows, good, first, variance):
    """Write the variance of the noise in each block that begins at `first` (blocks,).

    It is what the neighboring frequencies or the fourth differences show, whichever is less, in the
    median; `variance` (rows, blocks) is NaN for a block that is not good throughout.
    """
    half, last = BLOCK // 2, len(first) - 1
    # Some blocks at a time, so that the processor does with all of them what it does with one.
    x, y = np.empty((BLOCK, LANES)), np.empty((BLOCK, LANES))
    jerk = y[: BLOCK - 4]
    power, re, im = np.empty((len(_BINS), LANES)), np.empty(LANES), np.empty(LANES)
    for r in range(len(rows)):
        for b in range(0, len(first), LANES):
            for m in range(LANES):
                a = first[min(b + m, last)]
                for k in range(BLOCK):
                    x[k, m] = rows[r, a + k] - rows[r, a]
            re[:] = 0.0
            for k in range(BLOCK):
                for m in range(LANES):
                    re[m] += x[k, m] / BLOCK
            for k in range(BLOCK):
                for m in range(LANES):
                    x[k, m] -= re[m]
                    y[k, m] = x[k, m]
                    x[k, m] *= _TAPER[k]
            for order in range(1, 5):  # one after the other: those of equal values are zero
                for k in range(BLOCK - order):
                    for m in range(LANES):
                        y[k, m] = y[k + 1, m] - y[k, m]
            for k in range(BLOCK - 4):
                for m in range(LANES):
                    jerk[k, m] *= jerk[k, m]
            # A transform is one of sums and of differences of what lies as far from either end.
            for k in range(1, half):
                for m in range(LANES):
                    even, odd = x[k, m] + x[BLOCK - k, m], x[k, m] - x[BLOCK - k, m]
                    x[k, m], x[BLOCK - k, m] = even, odd
            for i in range(len(_BINS)):
                for m in range(LANES):
                    re[m], im[m] = x[0, m] + x[half, m] * _COS[half, i], 0.0
                for k in range(1, half):
                    c, s = _COS[k, i], _SIN[k, i]
                    for m in range(LANES):
                        re[m] += x[k, m] * c
                        im[m] += x[BLOCK - k, m] * s
                for m in range(LANES):
                    power[i, m] = re[m] * re[m] + im[m] * im[m]
            _sort(jerk, _JERKS)
            _sort(power, _POWERS)
            for m in range(min(LANES, len(first) - b)):
                whole = True
                for k in range(first[b + m], first[b + m] + BLOCK):
                    whole &= good[r, k]
                by_jerk = jerk[(BLOCK - 4) // 2, m] / _JERK
                by_floor = power[len(_BINS) // 2, m] / _FLOOR
                variance[r, b + m] = min(by_jerk, by_floor) if whole else np.nan


@inner_njit
def _sort(values, pairs):
    """Exchange values (n, LANES) where the first of a pair of them is larger, pair by pair."""
    for p in range(len(pairs)):
        i, j = pairs[p]
        for m in range(LANES):
            a, b = values[i, m], values[j, m]
            values[i, m], values[j, m] = min(a, b), max(a, b)


@cached_njit
def standing(rows, good, first, size, limit, still):
    """Write in `still` (rows, blocks) which blocks have less than a variance of `limit` (rows,).

    A block has `size` samples, all of them good, and begins at one of `first` (blocks,).
    """
    for r in range(len(rows)):
        if not limit[r] > 0:
            still[r] = False
            continue
        enough = limit[r] * (size - 1)
        for b in range(len(first)):
            a = first[b]
            # Two values add half the square of their distance, wherever the mean is: a few pairs
            # show of nearly every block that it moves.
            total = 0.0
            for k in range(a, a + size - 1, 2):
                total += 0.5 * (rows[r, k] - rows[r, k + 1]) ** 2
                if total > 1.001 * enough:
                    break
            still[r, b] = total <= 1.001 * enough and _stands(rows[r], good[r], a, size, enough)


@inner_njit
def _stands(row, good, a, size, enough):
    """Return whether the squares about the mean of a block are less than `enough` in sum."""
    mean = 0.0
    for k in range(a, a + size):
        if not good[k]:
            return False
        mean += row[k] - row[a]
    mean /= size
    total = 0.0
    for k in range(a, a + size):
        total += (row[k] - row[a] - mean) ** 2
    return total < enough
