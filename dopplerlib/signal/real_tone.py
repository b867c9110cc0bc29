"""Frequency of a tone in real samples, those of a module without Q, and its bound."""

from collections.abc import Sequence

import numpy as np
import scipy.fft

from .. import _checks
from .._hints import AboveZero, checked
from .._typing import ArrayLike, FloatArray
from ._bins import about_mean, climb, samples, still_windows, sum_of_ones
from ._quadratures import energies, signed_sum_of_ones

_CHUNK = 256  # windows at a time
_PAD = 4  # points of the grid in a bin
# Cycles in a window. A tone of fewer is a constant with a slope, or half a swing; as far from half
# the sampling rate it alternates like one.
FEWEST = 0.05


@checked
def ml_frequency_real(x: ArrayLike, fs: float, band: Sequence[float] | None = None) -> FloatArray:
    """Return the maximum-likelihood frequency of a tone in real samples, of a module without Q.

    Parameters
    ----------
    x : array_like, shape (..., n)
        Real samples, at least 5, with mean zero. Of complex ones the real part: it is what the
        module gave if they are its analytic signal, as ``layout="real"`` makes it.
    fs : float
        Sampling rate in Hz.
    band : tuple of float, optional
        Lowest and highest frequency in Hz, of one sign; 0 and fs/2 if None. Real samples do not
        tell the sign of a Doppler shift: say by the band which one it has.

    Returns
    -------
    ndarray, shape (...)
        Frequencies in Hz with the sign of the band; NaN for samples that are all the same. The
        smallest that is looked at is that of a twentieth of a cycle in the window.

    Raises
    ------
    ValueError
        If a sample is not finite, there are fewer than 5, or `band` holds both signs or more than
        fs/2.

    Notes
    -----
    Nonlinear least squares, amplitude and phase unknown (Kay 1993, example 7.16, without the
    approximation for many cycles).

    The analytic signal and `ml_frequency` do the same over many cycles. Over few, the line at the
    negative frequency, which leaks into that at the positive one, and the ends of the record, where
    nothing tells the analytic signal, give a bias that no noise explains.

    Examples
    --------
    A cycle and a half:

    >>> t = np.arange(250) / 10e3
    >>> x = np.cos(2 * np.pi * 60 * t + 0.3)
    >>> round(float(ml_frequency_real(x, 10e3)), 3)
    60.0
    >>> round(float(ml_frequency_real(x, 10e3, band=(-400, -20))), 3)
    -60.0
    """
    return _estimate(x, fs, band, constant=False)


@checked
def ml_frequency_real_dc(
    x: ArrayLike, fs: float, band: Sequence[float] | None = None
) -> FloatArray:
    """Return the maximum-likelihood frequency of a tone in real samples with a constant.

    Parameters
    ----------
    x : array_like, shape (..., n)
        Real samples, at least 5, with any mean; see `ml_frequency_real`.
    fs : float
        Sampling rate in Hz.
    band : tuple of float, optional
        Lowest and highest frequency in Hz, of one sign; 0 and fs/2 if None.

    Returns
    -------
    ndarray, shape (...)
        See `ml_frequency_real`; NaN for samples that are all the same.

    Raises
    ------
    ValueError
        See `ml_frequency_real`.

    Examples
    --------
    >>> t = np.arange(250) / 10e3
    >>> round(float(ml_frequency_real_dc(7 + np.cos(2 * np.pi * 60 * t + 0.3), 10e3)), 3)
    60.0
    """
    return _estimate(x, fs, band, constant=True)


@checked
@_checks.quiet
def crlb_frequency_std_real(
    f: ArrayLike, phase: ArrayLike, snr: ArrayLike, n: int, fs: AboveZero, dc: bool = False
) -> FloatArray:
    """Return the Cramér-Rao bound on the frequency of a tone in real samples.

    Parameters
    ----------
    f : array_like, shape (...)
        Frequency in Hz, at most fs/2 in absolute value.
    phase : array_like, broadcast to (...)
        Phase of the cosine at the middle of the window in rad: over few cycles much depends on it.
    snr : array_like, broadcast to (...)
        Power of the tone, half the square of its amplitude, over the variance of a real sample of
        noise, not in dB.
    n : int
        Number of samples, at least 5.
    fs : float
        Sampling rate in Hz.
    dc : bool
        Whether there is an unknown constant.

    Returns
    -------
    ndarray, shape (...)
        Cramér-Rao lower bound in Hz, amplitude and phase unknown; infinite where nothing tells a
        change of the frequency from one of amplitude, phase or the constant. Over many cycles it is
        that of `crlb_frequency_std` at half this ratio.

    Notes
    -----
    The derivative of ``a cos(w t) + b sin(w t)`` with respect to w is ``t (b cos(w t) - a sin(w
    t))``. Its even part can be imitated by the cosine, and by the constant; its odd part by the
    sine. The information is the energy of what is left of each.

    Examples
    --------
    One cycle in 25 ms, with an extreme and with a zero in the middle, and ten and a half:

    >>> phase = [0, np.pi / 2, 0]
    >>> crlb_frequency_std_real([40, 40, 420], phase, 10.0, 250, 10e3).round(2).tolist()
    [0.5, 0.43, 0.44]
    """
    f, phase = _checks.finite("f", f), _checks.finite("phase", phase)
    snr, n = _checks.positive("snr", snr), _checks.whole_number("n", n, least=5)
    _checks.check_leading(f=(f, 0), phase=(phase, 0), snr=(snr, 0))
    cycles = np.abs(f) * n / fs
    if not (cycles <= n / 2).all():
        raise ValueError(f"f must be at most fs / 2 = {fs / 2:g}, got {np.abs(f).max():g}")
    *_, even, odd = energies(cycles, n, dc)
    # snr is 1/2 of the squared amplitude over the variance.
    information = 2 * snr * (even * np.cos(phase) ** 2 + odd * np.sin(phase) ** 2)
    return np.where(information > 0, fs / (2 * np.pi * np.sqrt(information)), np.inf)


def _estimate(x, fs, band, constant):
    x, fs = samples(x, fs, least=5)
    n = x.shape[-1]
    sign, low, high = _one_sign(band, fs)
    ends = np.clip(np.array([low, high]) * n / fs, FEWEST, n / 2 - FEWEST)
    y = x.real.reshape(-1, n)
    u = np.empty(len(y))
    for a in range(0, len(y), _CHUNK):
        part = slice(a, a + _CHUNK)
        u[part] = _highest(about_mean(y[part]) if constant else y[part], *ends, constant)
    u[still_windows(y)] = np.nan
    return (sign * u * fs / n).reshape(x.shape[:-1])


def _one_sign(band, fs):
    """Return the sign of a band, and the ends of the range of absolute frequencies."""
    if band is None:
        return 1.0, 0.0, fs / 2
    low, high = _checks.increasing_pair("band", band)
    if low < 0 < high:
        raise ValueError(
            "band must be of one sign, since real samples do not tell an approaching target from "
            f"one that recedes, got {band}"
        )
    if max(-low, high) > fs / 2 * (1 + 1e-12):
        raise ValueError(f"band must not exceed fs / 2 = {fs / 2:g}, got {band}")
    return (1.0, low, high) if low >= 0 else (-1.0, -high, -low)


def _highest(y, low, high, constant):
    """Return the likeliest frequencies between `low` and `high`, in cycles in the window."""
    n = y.shape[-1]
    grid = np.arange(np.ceil(low * _PAD), np.floor(high * _PAD) + 1)
    u = np.unique(np.concatenate([grid / _PAD, [low, high]]))
    places = np.round(u * _PAD).astype(int)
    Y = scipy.fft.rfft(y, _PAD * n)[:, places] * np.exp(1j * np.pi * places / _PAD * (n - 1) / n)
    for i in (0, -1):  # the ends lie beside the grid
        Y[:, i] = y @ np.exp(-2j * np.pi * u[i] / n * (np.arange(n) - (n - 1) / 2))
    c, s = energies(u, n, constant)[:2]
    top = u[np.argmax(Y.real**2 / c + Y.imag**2 / s, axis=-1)]
    return _climb(
        y, top, np.maximum(top - 1 / _PAD, low), np.minimum(top + 1 / _PAD, high), constant
    )


def _climb(y, start, low, high, constant):
    """Return where the energy explained is highest between `low` and `high`, in cycles."""
    n = y.shape[-1]

    def slopes(u, Y):
        D = signed_sum_of_ones(2 * u, n)
        even, odd = (n + D[0]) / 2, (n - D[0]) / 2
        c, s = [even, D[1], 2 * D[2]], [odd, -D[1], -2 * D[2]]
        if constant:
            one = sum_of_ones(u, n)
            c[0] = c[0] - one[0] ** 2 / n
            c[1] = c[1] - 2 * one[0] * one[1] / n
            c[2] = c[2] - 2 * (one[1] ** 2 + one[0] * one[2]) / n
        return np.add(_ratio(Y.real, c), _ratio(Y.imag, s))

    return climb(slopes, y, start, low, high)


def _ratio(Y, W):
    """Return first and second derivative of Y^2 / W by those of Y and W."""
    N0, N1, N2 = Y[0] ** 2, 2 * Y[0] * Y[1], 2 * (Y[1] ** 2 + Y[0] * Y[2])
    W0, W1, W2 = W
    slope = (N1 - N0 * W1 / W0) / W0
    return slope, (N2 - N0 * W2 / W0 - 2 * W1 * slope) / W0
