"""What `valid_samples` does, step by step with NumPy: ten times slower, and easier to follow."""

import numpy as np

from dopplerlib.signal import validity as v

AT_ONCE = 2**20  # samples
BLOCK = 32


def valid_samples(x, full_scale=None, longest_run=None, false_alarm=1e-9):
    """Return the mask of complex samples x (S, n)."""
    rows = np.stack([x.real, x.imag], axis=1)[None]
    return _alive(rows, full_scale, longest_run, false_alarm)[0].all(axis=1)


def _alive(rows, full_scale, longest_run, false_alarm):
    good = np.abs(rows) <= v.LARGEST  # not so if NaN
    rows[~good] = 0.0
    # Powers of two change no relation, and keep squares away from overflow.
    exponent = -int(np.frexp(max(rows.max(), -rows.min()))[1])
    np.ldexp(rows, exponent, out=rows)
    unused = (rows == 0).all(axis=-1)
    unused[:, :, 0] = False  # without I, or without I and Q, a module is dead
    if full_scale is not None:
        stops = np.abs(rows) >= np.ldexp(full_scale, exponent)
    else:
        stops = _clipped(rows, good, false_alarm / 4)
    good &= ~stops
    moves = np.diff(rows)
    np.abs(moves, out=moves)
    same = moves == 0
    step = moves.min(axis=-1, initial=np.inf, where=~same)
    del moves
    own = _own_noise(rows, good)
    reach = np.ptp(rows, axis=-1) ** 2
    for place in zip(*np.nonzero((reach > v._LOUD * own) & (own > 0)), strict=True):
        good[place] &= ~_loud(rows[place], own[place])
    for place in zip(*np.nonzero(same.sum(axis=-1) > 1), strict=True):
        change = np.flatnonzero(~same[place]) + 1
        length = np.diff(change, prepend=0, append=rows.shape[-1])
        longest = longest_run
        if longest is None:
            sigma = np.sqrt(own[place]) / step[place]
            longest = _longest_natural(length, sigma, false_alarm / rows.shape[-1])
        good[place] &= ~np.repeat(length > longest, length)
    beside = np.sort(own, axis=1)[:, own.shape[1] // 2]
    for block, share in v._STILL:
        limit = np.maximum(share * own, v._BESIDE * beside[:, None])
        # Where a step is larger than that, whatever stays in one would stand still.
        limit[limit <= step**2] = 0.0
        first = _firsts(rows.shape[-1], block, block // 2)
        still = _variance(rows, good, first, block) < limit[..., None]
        for place in zip(*np.nonzero(still.any(axis=-1)), strict=True):
            good[place] &= ~_grown(rows[place], first[still[place]], block)
    good[unused] = True
    return good


def _clipped(rows, good, chance):
    """Return which samples are at an extreme that repeats too often."""
    at = np.zeros(rows.shape, dtype=bool)
    for sign in (1, -1):
        heights = np.where(good, rows, -sign * np.inf)
        heights *= sign
        top = heights.max(axis=-1, keepdims=True)
        here = good & (heights == top)
        heights[here] = -np.inf
        second = heights.max(axis=-1, keepdims=True)
        a, b = here.sum(axis=-1), (good & (heights == second)).sum(axis=-1)
        total = np.maximum(a + b, 1)
        share = a / total
        rest = np.where(b > 0, 1 - share, 1.0)  # 0 log 0 is 0
        # Chernoff's bound on so many of these at the top by chance.
        excess = share * np.log(np.maximum(share, v._ODDS) / v._ODDS) + np.where(
            b > 0, rest * np.log(rest / (1 - v._ODDS)), 0.0
        )
        many = (b > 0) & (share > v._ODDS) & (total * excess > -np.log(chance))
        at |= here & many[..., None]
        del heights, here  # before the others take as much again
    return at


def _loud(row, noise):
    """Return which samples are further off than any echo beside such neighbors."""
    block = BLOCK
    first = _firsts(len(row), block, block)
    x = row[first[:, None] + np.arange(block)]
    square = (x - np.median(x, axis=-1, keepdims=True)) ** 2
    usual = np.maximum(np.median(square, axis=-1, keepdims=True), noise)
    loud = np.zeros(len(row), dtype=bool)
    loud[(first[:, None] + np.arange(block))[square > v._LOUD * usual]] = True
    return loud


def _longest_natural(length, sigma, chance):
    """Return how long each run (R,) may be, by those around it and noise of `sigma` steps."""
    count = min(len(length), v._NEIGHBORS)
    blocks = -(-len(length) // v._NEIGHBORS)
    first = np.minimum(np.arange(blocks) * v._NEIGHBORS, len(length) - count)
    around = np.ones((blocks, count + v._CHANGES), dtype=int)
    around[:, :count] = length[first[:, None] + np.arange(count)]
    # Nine of ten runs end by `usual`: so p^usual is about a tenth.
    middle = (around.shape[1] - 1) * 9 // 10
    usual = np.partition(around, middle)[:, middle]
    p = ((np.sum(around > usual[:, None], axis=1) + 1) / (around.shape[1] + 1)) ** (1 / usual)
    p = np.maximum(p, np.maximum(np.roll(p, 1), np.roll(p, -1)))
    some = np.append(length, np.ones(v._CHANGES, dtype=int))
    longest = 1 + np.partition(some, -v._LONGEST)[-v._LONGEST]  # one more, for chance
    longest = longest * np.log(chance) / np.log(v._LONGEST / len(some))
    if sigma >= v._COARSE:
        longest = np.minimum(longest, np.log(chance) / np.log(np.maximum(p, 0.4 / sigma)))
    return np.ceil(np.broadcast_to(longest, p.shape))[np.arange(len(length)) // v._NEIGHBORS]


def _firsts(n, block, hop):
    """Return where blocks begin; the last one ends with the record."""
    if n < block:
        return np.empty(0, dtype=int)
    return np.append(np.arange(0, n - block, hop), n - block)


def _blocks(rows, good, first, block):
    """Give blocks about their means, some at a time; NaN where a sample is no measurement."""
    rows = np.where(good, rows, np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(rows, block, axis=-1)
    step = max(1, AT_ONCE // (block * rows[..., 0].size))
    for a in range(0, len(first), step):
        x = windows[..., first[a : a + step], :]
        x = x - x[..., :1]
        yield slice(a, a + step), x - x.mean(axis=-1, keepdims=True)


def _variance(rows, good, first, block):
    """Return the variance in each block, (..., blocks)."""
    variance = np.empty((*rows.shape[:-1], len(first)))
    if len(first):
        for part, x in _blocks(rows, good, first, block):
            variance[..., part] = np.einsum("...i,...i->...", x, x) / (block - 1)
    return variance


def _own_noise(rows, good):
    """Return the variance of the noise of each branch, (...); 0 if nothing shows it."""
    block = BLOCK
    first = _firsts(rows.shape[-1], block, block)
    if not len(first):
        return np.zeros(rows.shape[:-1])
    noise = np.empty((*rows.shape[:-1], len(first)))
    taper = np.hanning(block + 2)[1:-1]
    for part, x in _blocks(rows, good, first, block):
        # Medians of chi-square of one and of two degrees of freedom, over their means.
        jerk = _median(np.diff(x, 4) ** 2) / (70 * 0.4549)
        bins = np.fft.rfft(x * taper)[..., 2:-2]
        floor = _median(bins.real**2 + bins.imag**2) / (np.log(2) * np.sum(taper**2))
        noise[..., part] = np.minimum(jerk, floor)
    known = noise > 0
    count = known.sum(axis=-1, keepdims=True)
    place = (v._ALIVE * np.maximum(count - 1, 0)).astype(int)
    ordered = np.sort(np.where(known, noise, np.inf), axis=-1)
    return np.where(count > 0, np.take_along_axis(ordered, place, axis=-1), 0.0)[..., 0]


def _median(values):
    """Return the middle one of the values, NaN if one is; of an even number the higher one."""
    middle = values.shape[-1] // 2
    # NaN is sorted to the end: it would not show in the middle.
    return np.partition(values, middle)[..., middle] + 0 * values.sum(axis=-1)


def _grown(row, first, block):
    """Return which samples lie in the blocks, or beside them and as near to the same value."""
    still = np.zeros(len(row), dtype=bool)
    still[first[:, None] + np.arange(block)] = True
    edges = np.flatnonzero(np.diff(still, prepend=False, append=False))
    for a, b in edges.reshape(-1, 2):
        level = np.median(row[a:b])
        reach = 7 * np.median(np.abs(row[a:b] - level))  # five standard deviations
        for side, start, way in (
            (row[max(a - block, 0) : a][::-1], a - 1, -1),
            (row[b : b + block], b, 1),
        ):
            away = np.abs(side - level) > reach
            more = int(np.argmax(away)) if away.any() else len(side)
            still[start + way * np.arange(more)] = True
    return still
