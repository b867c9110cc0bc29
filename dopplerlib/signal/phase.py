"""Frequency of a tone from phase differences between samples."""

from collections.abc import Sequence

import numpy as np

from .._hints import Count, checked
from .._typing import ArrayLike, FloatArray
from ._bins import limits, samples, still_windows


@checked
def kay(x: ArrayLike, fs: float, band: Sequence[float] | None = None) -> FloatArray:
    """Return Kay's weighted mean of phase differences, as a frequency.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    fs : float
        Sampling rate in Hz.
    band : tuple of float, optional
        Steps are understood as frequencies within fs / 2 of the middle of this band; of 0 if None.

    Returns
    -------
    ndarray, shape (...)
        Frequencies in Hz; NaN for samples that are all the same, and where no product of two
        samples tells a phase.

    Notes
    -----
    Kay (1989). The weights are those of the best linear fit to the phase, so the bound is
    reached while every single sample is well above the noise.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(123.0, 1000.0, 100, None, rng=np.random.default_rng(1))
    >>> round(float(kay(x, 1000.0)), 2)
    123.0
    """
    x, fs = samples(x, fs)
    n = x.shape[-1]
    low, high, _ = limits(band, fs)
    middle = (low + high) / 2
    steps = x[..., 1:] * x[..., :-1].conj() * np.exp(-2j * np.pi * middle / fs)
    i = np.arange(1, n)
    weights = 6 * i * (n - i) / (n * (n**2 - 1))
    f = middle + np.angle(steps) @ weights * fs / (2 * np.pi)
    return np.where(still_windows(x) | ~steps.any(axis=-1), np.nan, f)


@checked
def pulse_pair(
    x: ArrayLike, fs: float, band: Sequence[float] | None = None, lag: Count = 1
) -> FloatArray:
    """Return the pulse-pair frequency: the phase of the autocorrelation at one lag.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    fs : float
        Sampling rate in Hz.
    band : tuple of float, optional
        The phase is understood as a frequency within fs / (2 lag) of the middle of this band;
        of 0 if None.
    lag : int
        Distance in samples, less than n.

    Returns
    -------
    ndarray, shape (...)
        Frequencies in Hz; NaN for samples that are all the same, and where no product of two
        samples tells a phase.

    Notes
    -----
    The pulse-pair processor of weather radars; Lank, Reed and Pollon (1973) give its variance.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(123.0, 1000.0, 100, None, rng=np.random.default_rng(1))
    >>> round(float(pulse_pair(x, 1000.0)), 2)
    123.0
    """
    x, fs = samples(x, fs)
    if lag >= x.shape[-1]:
        raise ValueError(f"lag must be less than the {x.shape[-1]} samples, got {lag}")
    low, high, _ = limits(band, fs)
    middle = (low + high) / 2
    pair = np.sum(x[..., lag:] * x[..., :-lag].conj(), axis=-1)
    pair = pair * np.exp(-2j * np.pi * middle * lag / fs)
    f = middle + np.angle(pair) * fs / (2 * np.pi * lag)
    return np.where(still_windows(x) | (pair == 0), np.nan, f)
