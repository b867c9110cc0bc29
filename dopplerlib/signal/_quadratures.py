"""Energies of both quadratures of a real tone about the middle of a window.

There cos(w t) and sin(w t) are orthogonal. With C and S the sums of samples times each, and c and s
those of their squares, a tone of angular frequency w explains the energy C^2 / c + S^2 / s. The
line at -f, which every real tone has, is in it: over few cycles c and s differ.
"""

import numpy as np

from ._bins import about_mean, sum_of_ones


def explained(y, f, fs, constant):
    """Return the energy (W,) of a tone of f Hz (W,) in windows (W, n), and its cosine's part.

    `constant`: whether their mean is estimated as well.
    """
    n = y.shape[-1]
    cycles = np.abs(f) * n / fs
    t = np.arange(n) - (n - 1) / 2
    y = about_mean(y) if constant else y
    Y = np.sum(y * np.exp(-2j * np.pi / n * cycles[:, None] * t), axis=-1)
    c, s = energies(cycles, n, constant)[:2]
    even, both = Y.real**2 / c, Y.real**2 / c + Y.imag**2 / s
    return both, np.divide(even, both, out=np.full(both.shape, 0.5), where=both > 0)


def relative_information(share, f, n, fs, constant):
    """Return the information about w of a tone of energy 1, `share` of that in its cosine."""
    c, s, even, odd = energies(np.abs(f) * n / fs, n, constant)
    return share * even / c + (1 - share) * odd / s


def energies(u, n, constant):
    """Return the energies of cos(w t) and sin(w t), and of what they leave of t sin and t cos.

    At u cycles in the window. With `constant`, what that imitates is taken off of the even ones.
    """
    k = 2 * np.pi / n
    D, slope, bend = signed_sum_of_ones(2 * u, n)
    c, s, mixed = (n + D) / 2, (n - D) / 2, -slope / (2 * k)  # mixed: the sum of t sin cos
    square = n * (n**2 - 1) / 12
    t_sin, t_cos = (square + bend / k**2) / 2, (square - bend / k**2) / 2
    odd = t_cos - mixed**2 / s
    if constant:
        one, slope, _ = sum_of_ones(u, n)
        c = c - one**2 / n
        t_sin = t_sin - (slope / k) ** 2 / n
        mixed = mixed + one * slope / k / n
    return c, s, t_sin - mixed**2 / c, odd


def signed_sum_of_ones(v, n):
    """Return the Fourier sum of n ones about their middle and its derivatives, with their sign."""
    sign = np.where((v >= n / 2) & (n % 2 == 0), -1.0, 1.0)
    return tuple(sign * part for part in sum_of_ones(v, n))
