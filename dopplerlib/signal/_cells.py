"""Reference cells of a detector, and the level of their powers."""

import numpy as np

_CELLS = 24  # reference cells
_AT_ONCE = 2**20  # cells at a time


def reference(B, circular, guard, apart):
    """Return the reference cells (B, N) of each bin, the nearest on both sides."""
    half = min(_CELLS // 2, (B - 2 * guard) // (2 * apart))
    beside = guard + apart * np.arange(half)
    if circular:
        return (np.arange(B)[:, None] + np.concatenate([-beside, beside])) % B
    # At an end of the band, the other side has more.
    beside = guard + apart * np.arange(2 * half)
    places = np.arange(B)[:, None] + np.concatenate([-beside, beside])
    outside = (places < 0) | (places >= B)
    nearest = np.argsort(
        np.where(outside, B, np.abs(places - np.arange(B)[:, None])), axis=-1, kind="stable"
    )[:, : 2 * half]
    return np.take_along_axis(places, nearest, axis=-1)


def levels(power, cells, rank):
    """Return the level of the reference cells of each bin, shape (K, B)."""
    level = np.empty_like(power)
    step = max(1, _AT_ONCE // cells.size)
    for a in range(0, len(power), step):
        some = power[a : a + step][:, cells]
        if rank is None:
            level[a : a + step] = some.mean(axis=-1)
        else:
            level[a : a + step] = np.partition(some, rank - 1, axis=-1)[..., rank - 1]
    return level
