"""Frequency of a tone by interpolation between bins of a Fourier transform.

All take IQ samples ``x (..., n)`` and give frequencies ``(...)`` in Hz, positive when the target
approaches. They look for the highest bin in the ``band``, (lowest, highest) in Hz; None is from
-fs/2 to fs/2. A band from 0 to fs is as good, for targets that only approach. A window whose
samples are all the same, be they zero or not, has no frequency: a module that measures has noise.
It gives NaN, and so does one whose bins leave the form undecided.
"""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from .._hints import Count, checked
from .._typing import ArrayLike, FloatArray
from ._bins import ratio, samples, transform

_LEAST = 1e-300  # stands for an empty bin, which has no logarithm


@checked
def peak_bin(
    x: ArrayLike, fs: float, band: Sequence[float] | None = None, nfft: int | None = None
) -> FloatArray:
    """Return the frequency of the highest bin.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    fs : float
        Sampling rate in Hz.
    band : tuple of float, optional
        Lowest and highest frequency in Hz; -fs/2 and fs/2 if None.
    nfft : int, optional
        Length of the transform, padded with zeros; n if None.

    Returns
    -------
    ndarray, shape (...)
        Frequencies in Hz, multiples of fs / nfft; NaN for samples that are all the same.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(120.0, 1000.0, 100, None, rng=np.random.default_rng(1))
    >>> float(peak_bin(x, 1000.0))
    120.0
    """
    bins = transform(x, fs, band, nfft)
    return bins.hertz(bins.peak())


@checked
def parabolic(
    x: ArrayLike,
    fs: float,
    band: Sequence[float] | None = None,
    nfft: int | None = None,
    scale: Literal["magnitude", "log"] = "magnitude",
) -> FloatArray:
    """Return the vertex of the parabola through the highest bin and its neighbors.

    Parameters
    ----------
    x, fs, band, nfft
        See `peak_bin`.
    scale : {"magnitude", "log"}
        Whether the parabola goes through magnitudes or through their logarithms.

    Returns
    -------
    ndarray, shape (...)
        Frequencies in Hz; NaN for a window that tells none.

    Examples
    --------
    The shape of a peak is no parabola; padding brings the three points to its top:

    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(123.0, 1000.0, 100, None, rng=np.random.default_rng(1))
    >>> [round(float(parabolic(x, 1000.0, nfft=nfft)), 2) for nfft in (100, 400)]
    [120.74, 122.99]
    """
    bins = transform(x, fs, band, nfft, least=3)
    k = bins.peak()
    y = [np.abs(bins.at(k + step)) for step in (-1, 0, 1)]
    if scale == "log":
        y = [np.log(np.maximum(value, _LEAST)) for value in y]
    return bins.hertz(k + ratio(y[0] - y[2], 2 * (y[0] - 2 * y[1] + y[2])))


@checked
def parabolic_three_highest(
    x: ArrayLike, fs: float, band: Sequence[float] | None = None, nfft: int | None = None
) -> FloatArray:
    """Return the vertex of the parabola through the three highest bins, adjacent or not.

    For comparison only: without padding the third highest bin is often no neighbor of the
    highest, and noise decides where it is.

    Parameters
    ----------
    x, fs, band, nfft
        See `peak_bin`.

    Returns
    -------
    ndarray, shape (...)
        Frequencies in Hz, anywhere: a flat parabola has its vertex far away. NaN for a window that
        tells none.

    Notes
    -----
    Valarmathi et al., Eqs 1 to 3, as published.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(123.0, 1000.0, 100, None, rng=np.random.default_rng(1))
    >>> round(float(parabolic_three_highest(x, 1000.0, nfft=400)), 2)
    122.99
    """
    bins = transform(x, fs, band, nfft, least=3)
    if len(bins.inside) < 3:
        raise ValueError(f"band must hold three bins, got {len(bins.inside)} in {band}")
    magnitude = np.sqrt(bins.power())
    order = np.argsort(magnitude, axis=-1)[..., -3:]
    k = bins.inside[order].astype(float)
    y = np.take_along_axis(magnitude, order, axis=-1)
    # From the highest on, in Newton's divided differences: the vertex is where the slope is zero.
    (k2, k1, k0), (y2, y1, y0) = np.moveaxis(k, -1, 0), np.moveaxis(y, -1, 0)
    first = (y1 - y0) / (k1 - k0)
    second = ((y2 - y1) / (k2 - k1) - first) / (k2 - k0)
    vertex = k0 + (k1 - k0) / 2 - ratio(first, 2 * second)
    return np.where(bins.still, np.nan, vertex) * bins.fs / bins.nfft


@checked
def jacobsen(x: ArrayLike, fs: float, band: Sequence[float] | None = None) -> FloatArray:
    """Return the frequency by Jacobsen and Kootsookos, from three complex bins.

    Arguments and result are those of `peak_bin`; NaN for a window that tells no frequency.

    Notes
    -----
    Jacobsen and Kootsookos (2007), Eq 3.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(123.0, 1000.0, 100, None, rng=np.random.default_rng(1))
    >>> round(float(jacobsen(x, 1000.0)), 2)
    123.0
    """
    bins = transform(x, fs, band, least=3)
    k = bins.peak()
    return bins.hertz(k + _jacobsen(bins, k))


@checked
def candan(x: ArrayLike, fs: float, band: Sequence[float] | None = None) -> FloatArray:
    """Return the frequency by Candan: `jacobsen` with a correction of its bias.

    Arguments and result are those of `peak_bin`; NaN for a window that tells no frequency.

    Notes
    -----
    Candan (2011): the offset times tan(pi / n) / (pi / n).

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(330.0, 1000.0, 10, None, rng=np.random.default_rng(1))
    >>> round(float(jacobsen(x, 1000.0)), 1), round(float(candan(x, 1000.0)), 1)
    (329.1, 330.1)
    """
    bins = transform(x, fs, band, least=3)
    k = bins.peak()
    return bins.hertz(k + _jacobsen(bins, k) * np.tan(np.pi / bins.n) * bins.n / np.pi)


@checked
def quinn1(x: ArrayLike, fs: float, band: Sequence[float] | None = None) -> FloatArray:
    """Return Quinn's first estimate, from the highest bin and the neighbor on the tone's side.

    Arguments and result are those of `peak_bin`; NaN for a window that tells no frequency.

    Notes
    -----
    Quinn (1994).

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(123.0, 1000.0, 100, None, rng=np.random.default_rng(1))
    >>> round(float(quinn1(x, 1000.0)), 2)
    123.0
    """
    bins = transform(x, fs, band, least=3)
    k = bins.peak()
    left, right = _quinn(bins, k)
    return bins.hertz(k + np.where((left > 0) & (right > 0), right, left))


@checked
def quinn2(x: ArrayLike, fs: float, band: Sequence[float] | None = None) -> FloatArray:
    """Return Quinn's second estimate, which weights both neighbors.

    Arguments and result are those of `peak_bin`; NaN for a window that tells no frequency.

    Notes
    -----
    Quinn (1997).

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(123.0, 1000.0, 100, None, rng=np.random.default_rng(1))
    >>> round(float(quinn2(x, 1000.0)), 2)
    123.0
    """
    bins = transform(x, fs, band, least=3)
    k = bins.peak()
    left, right = _quinn(bins, k)
    return bins.hertz(k + (left + right) / 2 + _kappa(right**2) - _kappa(left**2))


@checked
def aboutanios_mulgrew(
    x: ArrayLike, fs: float, band: Sequence[float] | None = None, iterations: Count = 2
) -> FloatArray:
    """Return the frequency by Aboutanios and Mulgrew, from Fourier sums half a bin off the peak.

    Parameters
    ----------
    x, fs, band
        See `peak_bin`.
    iterations : int
        How often the comparison is repeated at the place it has led to.

    Returns
    -------
    ndarray, shape (...)
        Frequencies in Hz; NaN for a window that tells none.

    Notes
    -----
    Aboutanios and Mulgrew (2005), their first algorithm: after two iterations the variance is
    1.015 times the bound.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(123.0, 1000.0, 100, None, rng=np.random.default_rng(1))
    >>> round(float(aboutanios_mulgrew(x, 1000.0)), 2)
    123.0
    """
    x, fs = samples(x, fs)
    bins = transform(x, fs, band)
    k = bins.peak()
    t = np.arange(bins.n) / bins.n
    offset = np.zeros(k.shape)
    for _ in range(iterations):
        turned = x * np.exp(-2j * np.pi * t * (k + offset)[..., None])
        left, right = turned @ np.exp(1j * np.pi * t), turned @ np.exp(-1j * np.pi * t)
        offset = offset + ratio(right + left, right - left).real / 2
    return bins.hertz(k + offset)


def _jacobsen(bins, k):
    left, here, right = (bins.at(k + step) for step in (-1, 0, 1))
    return ratio(left - right, 2 * here - left - right).real


def _quinn(bins, k):
    """Return where the tone lies after each neighbor, in bins."""
    here = bins.at(k)
    left, right = (ratio(bins.at(k + step), here).real for step in (-1, 1))
    return ratio(left, 1 - left), ratio(-right, 1 - right)


def _kappa(x):
    root = np.sqrt(2 / 3)
    ratio = (x + 1 - root) / (x + 1 + root)
    return np.log(3 * x**2 + 6 * x + 1) / 4 - np.sqrt(6) / 24 * np.log(ratio)
