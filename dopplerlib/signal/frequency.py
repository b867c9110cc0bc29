"""Maximum-likelihood frequency of a tone, without or with an unknown DC offset."""

from collections.abc import Sequence

import numpy as np
import scipy.fft

from .._hints import checked
from .._typing import ArrayLike, ComplexArray, FloatArray, IntArray
from ._bins import about_mean, climb, limits, samples, sum_of_ones, unmoving

_CHUNK = 128  # transforms at a time: these stay in the processor's cache
_PAD = 4  # points of the grid in a bin, for the search beside a constant
_FAINT = 1e-15  # of the loudest sample; squares in single precision end at 1e-19
_FIRST = np.zeros(1, dtype=int)
_NEAREST = 1e-3  # bins from the constant: nearer than that a tone cannot be told from it


@checked
def ml_frequency(x: ArrayLike, fs: float, band: Sequence[float] | None = None) -> FloatArray:
    """Return the maximum-likelihood frequency of a tone, the highest peak of the periodogram.

    For one tone in white noise this is the maximum of the likelihood, amplitude and phase
    unknown. It is found to rounding: the unpadded transform is refined by Newton's method, at every
    place that could hold the highest peak.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    fs : float
        Sampling rate in Hz.
    band : tuple of float, optional
        Lowest and highest frequency in Hz, at most fs apart; -fs/2 and fs/2 if None.

    Returns
    -------
    ndarray, shape (...)
        Frequencies in Hz, positive when the target approaches; NaN for samples that are all the
        same: a module that measures has noise.

    Notes
    -----
    Rife and Boorstyn (1974). Mittermaier et al. (2016), Section 3.2, name a Fourier transform and
    a search for its peak.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone([123.4, -50.0], 10e3, 250, 20.0, rng=np.random.default_rng(1))
    >>> ml_frequency(x, 10e3).round(0).tolist()
    [123.0, -50.0]
    """
    x, fs = samples(x, fs)
    rows = x.reshape(-1, x.shape[-1])
    f, _ = peaks(
        rows, np.arange(len(rows)), np.zeros(len(rows), dtype=int), rows.shape[1], fs, band
    )
    return f.reshape(x.shape[:-1])


def peaks(
    x: ComplexArray,
    rows: IntArray,
    firsts: IntArray,
    n: int,
    fs: float,
    band: Sequence[float] | None,
) -> tuple[FloatArray, FloatArray]:
    """Return frequency (W,) and power (W,) of the highest peak in each of many windows; unchecked.

    Windows of n samples lie in `rows` (W,) of records x (R, samples), and begin at the samples
    `firsts` (W,). The frequency is in Hz, NaN for a window that never moves; the power is the
    square of the absolute value of the Fourier sum there, 0 where the frequency is NaN.
    """
    from ._ml_kernel import compiled  # here: numba takes half a second to load

    low, high, circular = limits(band, fs)
    if not len(rows):
        return np.empty(0), np.empty(0)
    # The search for the right peak needs single precision, in the range of 1; the rest is double.
    re, im = x.real.ravel(), x.imag.ravel()
    largest = max(np.abs(re).max(initial=0.0), np.abs(im).max(initial=0.0))
    with np.errstate(under="ignore"):
        coarse = (x / largest if largest > 0 else x).astype(np.complex64)
    starts = rows * x.shape[1] + firsts
    windows = np.lib.stride_tricks.sliding_window_view(coarse.ravel(), n)
    f, power = np.empty(len(starts)), np.empty(len(starts))
    for a in range(0, len(starts), _CHUNK):
        part = slice(a, a + _CHUNK)
        X = scipy.fft.fft(windows[starts[part]], n if circular else 2 * n)
        compiled(
            X, re, im, starts[part], n, low * n / fs, high * n / fs, circular, f[part], power[part]
        )
    f *= fs / n
    still = unmoving(x, rows, firsts, n)
    f[still], power[still] = np.nan, 0.0
    # Beside a moment that is louder by far, single precision has lost a window.
    with np.errstate(under="ignore"):
        lost = np.flatnonzero(~still & ~(power > (_FAINT * largest) ** 2))
    for w in lost:
        window = x[rows[w] : rows[w] + 1, firsts[w] : firsts[w] + n]
        if np.abs(window).max() < _FAINT * largest:
            f[w : w + 1], power[w : w + 1] = peaks(window, _FIRST, _FIRST, n, fs, band)
    return f, power


@checked
def ml_frequency_dc(x: ArrayLike, fs: float, band: Sequence[float] | None = None) -> FloatArray:
    """Return the maximum-likelihood frequency of a tone with an unknown DC offset.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    fs : float
        Sampling rate in Hz.
    band : tuple of float, optional
        Lowest and highest frequency in Hz; -fs/2 and fs/2 if None.

    Returns
    -------
    ndarray, shape (...)
        Frequencies in Hz; NaN for samples that are all the same. Nothing tells a tone of less than
        a thousandth of a cycle in the window from the constant: that is the smallest that is looked
        at.

    Notes
    -----
    With y the samples less their mean, Y their Fourier sum at f and D that of n ones, the
    likelihood grows with ``|Y|^2 / (n - |D|^2 / n)``: the mean takes away from a slow tone too, and
    the denominator gives it back.

    Examples
    --------
    One cycle and a half beside a constant ten times as strong:

    >>> from dopplerlib.signal.synthesis import tone
    >>> x = 10 + tone(60.0, 10e3, 250, 40.0, rng=np.random.default_rng(1))
    >>> round(float(ml_frequency_dc(x, 10e3)))
    60
    """
    x, fs = samples(x, fs, least=3)
    low, high, circular = limits(band, fs)
    n = x.shape[-1]
    rows = x.reshape(-1, n)
    u = np.empty(len(rows))
    for a in range(0, len(rows), 2 * _CHUNK):
        part = slice(a, a + 2 * _CHUNK)
        u[part] = _beside_constant(rows[part], low * n / fs, high * n / fs, circular)
    return (u * (fs / n)).reshape(x.shape[:-1])


def _beside_constant(x, low, high, circular):
    """Return the likeliest frequencies beside a constant, between `low` and `high`, in bins."""
    n = x.shape[-1]
    y = about_mean(x)
    first, last = np.ceil(low * _PAD), np.floor(high * _PAD)
    if last > first:
        grid = np.arange(first, last + 1)[: _PAD * n]
        Y = scipy.fft.fft(y, _PAD * n)[:, grid.astype(int) % (_PAD * n)]
    else:
        grid = _PAD * np.array([low, high])
        Y = y @ np.exp(-2j * np.pi * np.outer(np.arange(n), grid) / (_PAD * n))
    u = grid / _PAD
    # 0 itself is no candidate: its neighbors stand for the range up to it.
    near = np.abs((u + n / 2) % n - n / 2) < 0.1
    weight = n - sum_of_ones(np.where(near, 1.0, u), n)[0] ** 2 / n
    fit = np.where(near, 0.0, (Y.real**2 + Y.imag**2) / weight)
    top = u[np.argmax(fit, axis=-1)]
    left, right = top - 1 / _PAD, top + 1 / _PAD
    if circular:
        found = low + (_climb(y, top, left, right) - low) % n
    else:
        found = _climb(y, top, np.maximum(left, low), np.minimum(right, high))
    return np.where((y != 0).any(axis=-1), found, np.nan)


def _climb(y, start, left, right):
    """Return where the likelihood beside a constant is highest between `left` and `right`."""
    n = y.shape[-1]

    def slopes(u, Y):
        Y0, Y1, Y2 = Y
        P0, P1 = np.abs(Y0) ** 2, 2 * (Y0.conj() * Y1).real
        P2 = 2 * (np.abs(Y1) ** 2 + (Y0.conj() * Y2).real)
        D0, D1, D2 = sum_of_ones(u, n)
        W0, W1, W2 = n - D0**2 / n, -2 * D0 * D1 / n, -2 * (D1**2 + D0 * D2) / n
        slope = P1 * W0 - P0 * W1
        return slope, P2 * W0 - P0 * W2 - 2 * W1 / W0 * slope

    return climb(slopes, y, start, left, right, _NEAREST)
