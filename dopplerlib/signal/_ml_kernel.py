"""The search for the highest peak of a periodogram, compiled.

The coarse search looks at the bins of the unpadded transform and half way between them. Half way, a
tone shows in both neighbors with opposite signs, so ``|X[k] - X[k + 1]|^2 / 2`` can stand for the
power there: no tone loses more than 1.5 dB on this grid. Only its side lobes are lost, so where a
band may exclude the tone itself, the transform comes padded to twice the length. Every local
maximum of the grid that could still be the highest peak is refined by Newton's method inside its
bracket.

Frequencies are counted in bins of the unpadded transform, u = f n / fs.
"""

import numpy as np

from .._compile import cached_njit, inner_njit

BLOCK = 16  # samples that share a phase; each of their sums is independent of the other five
# 3 dB: how far a peak may rise above its value on the grid. A tone's rises by 1.5 dB; the rest is
# for noise.
SPARE = 10**0.3
# Bins. What is left after a Newton step of this size is its square times the skewness of the peak,
# a millionth of a bin at most; a window must have 100 dB for noise that small.
STOP = 1e-3
STEPS = 60  # by bisection alone the bracket of one bin has shrunk to rounding by then

_inline = inner_njit(forceinline=True)


@_inline
def _power(re, im, first, n, u, wave):
    """Return the power at u, and its first and second derivative with respect to u.

    With omega = 2 pi u / n and X_j = sum_t t^j x_t exp(-i omega t), dX_0/domega = -i X_1 and
    dX_1/domega = -i X_2, so that of the power |X_0|^2

        the first derivative is 2 Im(conj(X_0) X_1),
        the second is 2 (|X_1|^2 - Re(conj(X_0) X_2)).

    Times are counted from the middle of the window, where the derivatives are smallest. A block of
    samples is summed with times a = 0, 1, ... of its own; shifted to its place, t + a, its sums
    y_j become y_1 + t y_0 and y_2 + 2 t y_1 + t^2 y_0.
    """
    omega = 2 * np.pi * u / n
    one, phase = complex(np.cos(omega), -np.sin(omega)), complex(1.0, 0.0)
    for a in range(BLOCK):
        wave[a], wave[BLOCK + a] = phase.real, phase.imag
        phase *= one
    turn, phase = phase, complex(1.0, 0.0)
    x0 = x1 = x2 = complex(0.0, 0.0)
    for start in range(0, n, BLOCK):
        r0 = i0 = r1 = i1 = r2 = i2 = 0.0
        # From the last sample to the first, running sums of running sums: they end as the sums of
        # 1, a and a (a - 1) / 2 times a sample, without a multiplication.
        for a in range(min(BLOCK, n - start) - 1, -1, -1):
            x, y = re[first + start + a], im[first + start + a]
            r2 += r1
            i2 += i1
            r1 += r0
            i1 += i0
            r0 += x * wave[a] - y * wave[BLOCK + a]
            i0 += x * wave[BLOCK + a] + y * wave[a]
        r2, i2 = 2 * r2 + r1, 2 * i2 + i1  # a^2 = 2 a (a - 1) / 2 + a
        t = start - (n - 1) / 2
        y0, y1, y2 = phase * complex(r0, i0), phase * complex(r1, i1), phase * complex(r2, i2)
        x0 += y0
        x1 += y1 + t * y0
        x2 += y2 + 2 * t * y1 + t * t * y0
        phase *= turn
    per_bin = 2 * np.pi / n
    power = x0.real**2 + x0.imag**2
    slope = 2 * (x0.real * x1.imag - x0.imag * x1.real)
    bend = 2 * (x1.real**2 + x1.imag**2 - x0.real * x2.real - x0.imag * x2.imag)
    return power, slope * per_bin, bend * per_bin * per_bin


@_inline
def _refine(re, im, first, n, u, low, high, wave):
    """Return the place of a maximum between `low` and `high`, and the power there."""
    power = 0.0
    for _ in range(STEPS):
        power, slope, bend = _power(re, im, first, n, u, wave)
        # The bracket shrinks to the side on which the power rises; a step must end inside.
        if slope > 0:
            low = u
        else:
            high = u
        step = -slope / bend
        newton = bend < 0 and low <= u + step <= high
        if not newton:
            step = (low + high) / 2 - u
        u += step
        if abs(step) < STOP and newton:
            return u, power + slope * step / 2
        if high - low < 1e-12:
            break
    return u, power


@_inline
def _coarse(X, n, bins, halves):
    """Write the power at every bin k, and half way from it to the next."""
    if len(X) == 2 * n:
        for k in range(n):
            bins[k] = X[2 * k].real ** 2 + X[2 * k].imag ** 2
            halves[k] = X[2 * k + 1].real ** 2 + X[2 * k + 1].imag ** 2
        return
    for k in range(n - 1):
        here, after = X[k], X[k + 1]
        bins[k] = here.real * here.real + here.imag * here.imag
        real, imag = here.real - after.real, here.imag - after.imag
        halves[k] = (real * real + imag * imag) * 0.5
    here, after = X[n - 1], X[0]
    bins[n - 1] = here.real * here.real + here.imag * here.imag
    real, imag = here.real - after.real, here.imag - after.imag
    halves[n - 1] = (real * real + imag * imag) * 0.5


@_inline
def _real_ratio(a, b):
    """Return the real part of a / b; NaN for b = 0, for which numba's own division stops."""
    return (a.real * b.real + a.imag * b.imag) / (b.real * b.real + b.imag * b.imag)


@_inline
def _guess(X, n, k, half):
    """Return where a tone would lie, from bin k, that explains the bins around it.

    A tone at k + d has X[k + m] in proportion to 1 / (d - m), but for small terms. From two bins
    d = X[k + 1] / (X[k + 1] - X[k]) follows, and from three (Jacobsen)
    d = (X[k - 1] - X[k + 1]) / (2 X[k] - X[k - 1] - X[k + 1]).
    """
    each = len(X) // n
    here, after = X[each * k], X[each * (k + 1 if k < n - 1 else 0)]
    if half:
        return _real_ratio(after, after - here)
    before = X[each * (k - 1 if k > 0 else n - 1)]
    return _real_ratio(before - after, 2 * here - before - after)


@_inline
def _largest(values, begin, end):
    """Return the largest of values[begin:end], in four parts side by side."""
    a = b = c = d = 0.0
    end = max(begin, end)
    stop = begin + (end - begin) // 4 * 4
    for j in range(begin, stop, 4):
        a, b = max(a, values[j]), max(b, values[j + 1])
        c, d = max(c, values[j + 2]), max(d, values[j + 3])
    for j in range(stop, end):
        a = max(a, values[j])
    return max(max(a, b), max(c, d))


def search(X, re, im, firsts, n, low, high, circular, u, power):
    """Write the place `u` in bins and the `power` of the highest peak of each window.

    `X` (W, n) or (W, 2 n) are the transforms of the windows, to any scale; `re`, `im` (samples,)
    hold all samples, and window w begins at ``firsts[w]``. The peak lies between `low` and `high`;
    if `circular`, they are the same frequency, one sampling rate apart. A window of zeros has none.
    """
    wave = np.empty(2 * BLOCK)
    grid = np.empty((2, n))  # the bins, and the places half way after them
    # From first to last half bin; a bin is an even one.
    begin = int(np.ceil(2 * low))
    end = begin + 2 * n - 1 if circular else int(np.floor(2 * high))
    starts = ((begin + 1) // 2, begin // 2)
    counts = (end // 2 - starts[0] + 1, (end - 1) // 2 - starts[1] + 1)
    for w in range(len(firsts)):
        first = firsts[w]
        if end < begin:  # a narrow band between two points of the grid
            u[w], power[w] = _refine(re, im, first, n, (low + high) / 2, low, high, wave)
            continue
        _coarse(X[w], n, grid[0], grid[1])
        best = 0.0  # in the band
        for half in range(2):
            j = starts[half] % n
            best = max(best, _largest(grid[half], j, min(j + counts[half], n)))
            best = max(best, _largest(grid[half], 0, j + counts[half] - n))
        u[w], power[w] = np.nan, 0.0
        if not best > 0:
            continue
        limit = best / SPARE
        for half in range(2):
            for j in range(n):
                value = grid[half, j]
                if value < limit:
                    continue
                k = starts[half] + (j - starts[half]) % n
                place = 2 * k + half
                before = grid[0, j] if half else grid[1, j - 1 if j > 0 else n - 1]
                after = grid[0, j + 1 if j < n - 1 else 0] if half else grid[1, j]
                if (
                    k - starts[half] >= counts[half]
                    or (value < before and (place > begin or circular))
                    or (value < after and (place < end or circular))
                ):
                    continue
                a, b = (place - 1) / 2, (place + 1) / 2
                if not circular:
                    a, b = max(a, low), min(b, high)
                guess = k + _guess(X[w], n, j, half)
                if not a <= guess <= b:
                    guess = (a + b) / 2
                peak, height = _refine(re, im, first, n, guess, a, b, wave)
                if height > power[w]:
                    u[w], power[w] = peak, height
        if circular:
            u[w] = low + (u[w] - low) % n
            continue
        for edge in (low, high):  # what lies outside of the band may be highest at its edge
            place = int(np.rint(2 * edge))
            if grid[place % 2, (place // 2) % n] >= limit:
                a, b = max(edge - 0.5, low), min(edge + 0.5, high)
                peak, height = _refine(re, im, first, n, edge, a, b, wave)
                if height > power[w]:
                    u[w], power[w] = peak, height


compiled = cached_njit(search)
