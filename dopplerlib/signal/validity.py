"""Validity of raw samples: clipped, dead, lost or loud ones are no measurements."""

from typing import overload

import numpy as np

from .. import _checks
from .._hints import AboveZero, Count, Probability, checked
from .._typing import ArrayLike, BoolArray, ComplexArray

# So many samples stand still if they move less than this share of the module's noise.
_STILL = ((16, 0.002), (32, 0.01), (128, 0.1))
_BESIDE = 1e-3  # share for the noise of the other modules, whose gain may differ
_ALIVE = 0.75  # quantile of a module's blocks that is taken for its noise
_COARSE = 0.6  # steps: noise of less than that repeats as long as the signal lets it
_NEIGHBORS = 128  # runs by which it is told how long a run is natural
_CHANGES = (
    32  # short runs that are taken for granted, or a record that never moves would be natural
)
_LONGEST = 10  # how many runs dead stretches cannot be: where many are long, that is natural
_LOUD = 1e4  # of the noise, and of the median in the block: what is louder is no echo
_ODDS = 0.8  # of the two highest codes, the share of the highest: for a pure tone it is 0.71
LARGEST = 1e140  # amplitude, whose square is finite, and that of a sum of many
_AT_ONCE = 2**20  # samples
_BESIDE_LOUD = 32  # samples among which a loud one is told


@checked
def valid_samples(
    x: ArrayLike,
    *,
    full_scale: AboveZero | None = None,
    longest_run: Count | None = None,
    false_alarm: Probability = 1e-9,
) -> BoolArray:
    """Return the mask of valid samples.

    A module that is dead, stuck, cut off or driven into its stops gives samples too, and after a
    mean is taken off or a filter has run they look like a perfect tone at 0 Hz. So this is to be
    decided first, and the result goes along with the samples.

    Parameters
    ----------
    x : array_like of complex, shape (..., S, n) or (n,)
        Raw IQ samples of S modules of one array. They may hold NaN and infinities.
    full_scale : float, optional
        Amplitude of I and of Q at which the converter is at its stop, its highest code. If None, a
        branch is clipped at an extreme that repeats far more often than the next value.
    longest_run : int, optional
        How many equal samples in a row a live branch may give. If None, it follows from how often
        the samples of this branch repeat, see the notes.
    false_alarm : float
        Chance that a live branch of independent samples loses a run to chance.

    Returns
    -------
    ndarray of bool, shape of x
        False where there is no measurement:

        - a value is not finite, or its square is not;
        - I or Q of single samples is a hundred times as far off as the noise and their neighbors;
        - I or Q stays the same for longer than quantized noise does;
        - I or Q hardly moves: echo included, less than 0.002 of the power of the module's own noise
          in 16 samples, 0.01 in 32 or 0.1 in 128, or 0.001 of that of the other modules;
        - I or Q is clipped.

    Notes
    -----
    If a sample repeats the one before with probability p, a run of L equal samples begins somewhere
    in n with a chance of less than ``n p^(L-1)``; the longest that is natural follows. Noise of
    sigma steps repeats with 0.4 / sigma at most, and p is not less than what the runs around
    show. A fine converter repeats hardly ever: 8 equal samples of 10 000 are too many. Where noise
    is less than a step, a slow signal repeats as long as it stays in one; there a run has to be so
    much longer than the ten longest that their law gives it less than that chance.

    The noise of a module is what its neighboring frequencies or its fourth differences show,
    whichever is less, in the median of a block: neither an echo that grows nor single loud samples
    move it. White noise of a branch falls below a hundredth of its power in 32 samples with a
    chance of less than 1e-24; in 16 and 128 those are 1e-17 and 1e-38. What a stuck module adds
    itself is told if it lies 10 dB below the module's noise for 192 samples, 20 dB for 64, or 28 dB
    for 32. A module that hardly moves for three quarters of its record or more is told by the
    others only.

    Samples with an imaginary part of zero throughout are those of a module without Q: I decides.

    Examples
    --------
    A module that sticks from sample 60 on:

    >>> x = np.random.default_rng(1).standard_normal(100) + 0j
    >>> x[60:] = x[60]
    >>> np.flatnonzero(~valid_samples(x)).tolist() == list(range(60, 100))
    True
    """
    x = _checks.numbers("x", x, (None,))
    shape = x.shape
    if not x.size:
        return np.ones(shape, dtype=bool)
    x = x.reshape(-1, shape[-2] if x.ndim > 1 else 1, shape[-1])
    valid = np.empty(x.shape, dtype=bool)
    step = max(1, _AT_ONCE // (2 * x[0].size))
    for a in range(0, len(x), step):
        part = x[a : a + step]
        parts = [part.real, part.imag] if np.iscomplexobj(part) else [part]
        rows = np.stack(parts, axis=2)  # (runs, S, branches, n)
        valid[a : a + step] = _alive(rows, full_scale, longest_run, false_alarm).all(axis=2)
    return valid.reshape(shape)


@overload
def known_samples(
    name: str, x: ArrayLike, valid: None, shape: tuple[int | None, ...]
) -> tuple[ComplexArray, None]: ...
@overload
def known_samples(
    name: str, x: ArrayLike, valid: ArrayLike, shape: tuple[int | None, ...]
) -> tuple[ComplexArray, BoolArray]: ...
@checked
def known_samples(name, x, valid, shape):
    """Return samples with zeros in place of invalid ones, and the mask of valid samples.

    `name` and `shape` come from a function that calls it, and are unchecked.

    Parameters
    ----------
    name : str
        Name of the samples in an error.
    x : array_like of complex, shape (...)
        Samples; where `valid` is False they may be anything.
    valid : array_like of bool, broadcast to (...), or None
        Which of them are measurements; None for all.
    shape : tuple of int or None
        Last axes that `x` must have; None stands for any length.

    Returns
    -------
    x : ndarray of complex, shape (...)
    valid : ndarray of bool, shape (...), or None
        None if None was given.

    Examples
    --------
    >>> known_samples("x", [1, np.nan], [True, False], (None,))[0].tolist()
    [(1+0j), 0j]
    """
    if valid is None:
        return _checks.finite_complex(name, x, shape), None
    x = _checks.numbers(name, x, shape)
    valid = _checks.booleans("valid", valid)
    try:
        valid = np.broadcast_to(valid, x.shape)
    except ValueError:
        raise ValueError(
            f"valid must have a shape that broadcasts to {x.shape} of {name}, got {valid.shape}"
        ) from None
    return _checks.finite_complex(name, np.where(valid, x, 0.0)), valid


def _alive(rows, full_scale, longest_run, false_alarm):
    """Return the same for each branch of the modules, shape of `rows` (runs, S, branches, n).

    The values in `rows` are lost: of a long recording there should not be many copies.
    """
    from ._validity_loops import standing, survey  # here: numba takes longer to load than the rest

    shape, n = rows.shape, rows.shape[-1]
    good = rows <= LARGEST  # not so if NaN
    good &= rows >= -LARGEST
    if not good.all():
        rows[~good] = 0.0
    # Powers of two change no relation, and keep squares away from overflow.
    exponent = -int(np.frexp(max(rows.max(), -rows.min()))[1])
    np.ldexp(rows, exponent, out=rows)
    rows, good = rows.reshape(-1, n), good.reshape(-1, n)
    ends, counts = np.empty((len(rows), 2, 2)), np.empty((len(rows), 2, 2))
    step, same, longest = np.empty(len(rows)), np.empty(len(rows)), np.empty((len(rows), _LONGEST))
    survey(rows, good, ends, counts, step, same, longest)
    if full_scale is not None:
        stop = np.ldexp(full_scale, exponent)
        for row in np.flatnonzero((np.abs(ends[:, :, 0]) >= stop).any(axis=1)):
            good[row] &= np.abs(rows[row]) < stop
    else:
        for row, side in np.argwhere(_clipped(counts, false_alarm / 4)):
            good[row] &= rows[row] != (1 - 2 * side) * ends[row, side, 0]
    own = _own_noise(rows, good)
    reach = (ends[:, 0, 0] + ends[:, 1, 0]) ** 2
    for row in np.flatnonzero((reach > _LOUD * own) & (own > 0)):
        good[row] &= ~_loud(rows[row], own[row])
    least = longest_run or _least_natural(n - same, longest[:, 0], own, step, false_alarm / n)
    for row in np.flatnonzero((same > 1) & (longest[:, -1] > least)):
        change = np.flatnonzero(np.diff(rows[row])) + 1
        length = np.diff(change, prepend=0, append=n)
        natural = longest_run or _longest_natural(
            length, longest[row, 0], own[row], step[row], false_alarm / n
        )
        good[row] &= ~np.repeat(length > natural, length)
    by_module = own.reshape(shape[:-1])
    beside = np.sort(by_module, axis=1)[:, shape[1] // 2]
    beside = np.broadcast_to(beside[:, None], by_module.shape).ravel()
    for size, share in _STILL:
        limit = np.maximum(share * own, _BESIDE * beside)
        # Where a step is larger than that, whatever stays in one would stand still.
        limit[limit <= step**2] = 0.0
        first = _firsts(n, size, size // 2)
        still = np.empty((len(rows), len(first)), dtype=bool)
        standing(rows, good, first, size, limit, still)
        for row in np.flatnonzero(still.any(axis=-1)):
            good[row] &= ~_grown(rows[row], first[still[row]], size)
    # Without I, or without I and Q, a module is dead; without Q it is none that needs it.
    unused = (ends[:, :, 0] == 0).all(axis=-1).reshape(shape[:-1])
    unused[:, :, 0] = False
    good[unused.ravel()] = True
    return good.reshape(shape)


def _clipped(counts, chance):
    """Return which extremes repeat too often, by the counts of each and of its neighbor."""
    a, b = counts[..., 0], counts[..., 1]
    total = np.maximum(a + b, 1)
    share = a / total
    rest = np.where(b > 0, 1 - share, 1.0)  # 0 log 0 is 0
    # Chernoff's bound on so many of these at the top by chance.
    excess = share * np.log(np.maximum(share, _ODDS) / _ODDS) + np.where(
        b > 0, rest * np.log(rest / (1 - _ODDS)), 0.0
    )
    return (b > 0) & (share > _ODDS) & (total * excess > -np.log(chance))


def _loud(row, noise):
    """Return which samples are further off than any echo beside such neighbors."""
    first = _firsts(len(row), _BESIDE_LOUD, _BESIDE_LOUD)
    places = first[:, None] + np.arange(_BESIDE_LOUD)
    x = row[places]
    square = (x - np.median(x, axis=-1, keepdims=True)) ** 2
    usual = np.maximum(np.median(square, axis=-1, keepdims=True), noise)
    loud = np.zeros(len(row), dtype=bool)
    loud[places[square > _LOUD * usual]] = True
    return loud


def _longest_natural(length, tenth, noise, step, chance):
    """Return the longest natural length of each run (R,), by those around it and the noise.

    `tenth` is the length of the tenth longest of all.
    """
    count = min(len(length), _NEIGHBORS)
    blocks = -(-len(length) // _NEIGHBORS)
    first = np.minimum(np.arange(blocks) * _NEIGHBORS, len(length) - count)
    around = np.ones((blocks, count + _CHANGES), dtype=int)
    around[:, :count] = length[first[:, None] + np.arange(count)]
    # Nine of ten runs end by `usual`: so p^usual is about a tenth.
    middle = (around.shape[1] - 1) * 9 // 10
    usual = np.partition(around, middle)[:, middle]
    p = ((np.sum(around > usual[:, None], axis=1) + 1) / (around.shape[1] + 1)) ** (1 / usual)
    p = np.maximum(p, np.maximum(np.roll(p, 1), np.roll(p, -1)))
    longest = _by_odds(p, len(length), tenth, noise, step, chance)
    return np.ceil(longest)[np.arange(len(length)) // _NEIGHBORS]


def _least_natural(runs, tenth, noise, step, chance):
    """Return a lower limit of `_longest_natural` for a number of runs in any order."""
    rarest = 1 / (np.minimum(runs, _NEIGHBORS) + _CHANGES + 1)
    return _by_odds(rarest, runs, tenth, noise, step, chance)


def _by_odds(p, runs, tenth, noise, step, chance):
    """Return the longest natural run: samples repeat with probability p, or as in the longest."""
    by_rank = (1 + tenth) * np.log(chance) / np.log(_LONGEST / (runs + _CHANGES))  # 1 for chance
    sigma = np.sqrt(noise) / step
    by_odds = np.log(chance) / np.log(np.maximum(p, 0.4 / np.maximum(sigma, _COARSE)))
    return np.where(sigma >= _COARSE, np.minimum(by_rank, by_odds), by_rank)


def _firsts(n, block, hop):
    """Return where blocks begin; the last one ends with the record."""
    if n < block:
        return np.empty(0, dtype=int)
    return np.append(np.arange(0, n - block, hop), n - block)


def _own_noise(rows, good):
    """Return the variance of the noise of each row; 0 if nothing shows it."""
    from ._validity_loops import BLOCK, noise

    first = _firsts(rows.shape[-1], BLOCK, BLOCK)
    blocks = np.empty((len(rows), len(first)))
    noise(rows, good, first, blocks)
    own = np.zeros(len(rows))
    for row, one in enumerate(blocks):
        known = one[one > 0]
        if len(known):
            place = int(_ALIVE * (len(known) - 1))
            own[row] = np.partition(known, place)[place]
    return own


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
