"""Low-pass filter and decimation."""

from functools import lru_cache
from typing import overload

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, BoolArray, ComplexArray
from .validity import known_samples


@overload
def lowpass(
    x: ArrayLike, fs: float, cutoff: float, taps: int, valid: None = None
) -> tuple[ComplexArray, float]: ...
@overload
def lowpass(
    x: ArrayLike, fs: float, cutoff: float, taps: int, valid: ArrayLike
) -> tuple[ComplexArray, float, BoolArray]: ...
@checked
def lowpass(x, fs, cutoff, taps, valid=None):
    """Return low-pass filtered IQ samples, and the delay of the linear-phase filter.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    fs : float
        Sampling rate in Hz.
    cutoff : float
        Frequency in Hz at which the filter lets half of the amplitude through; less than fs / 2.
    taps : int
        Length of the filter, odd.
    valid : array_like of bool, broadcast to (..., n), optional
        Which samples are measurements, see `valid_samples`.

    Returns
    -------
    y : ndarray of complex, shape (..., n)
        The first ``taps - 1`` samples come from a filter that is still filling.
    delay : float
        Group delay in s: y at a time t shows the signal at t - delay.
    valid : ndarray of bool, shape (..., n)
        Only if `valid` was given: which of y are made of valid samples alone. False for the length
        of the filter after each one that is not, and while it is filling.

    Notes
    -----
    `scipy.signal.firwin` with a Hamming window.

    Examples
    --------
    >>> import numpy as np
    >>> y, delay = lowpass(np.ones(50), 1000.0, 100.0, 21)
    >>> y.shape, delay, bool(np.allclose(y[20:], 1))
    ((50,), 0.01, True)
    """
    from scipy.signal import oaconvolve  # here: it takes long to load

    x, valid = known_samples("x", x, valid, (None,))
    b, delay = _impulse_response(fs, cutoff, taps)
    with np.errstate(all="ignore"):
        y = oaconvolve(x, b.reshape((1,) * (x.ndim - 1) + (-1,)), axes=-1)
    _checks.estimates("x", y, what="filtered samples")
    y = y[..., : x.shape[-1]]
    return (y, delay) if valid is None else (y, delay, _filtered(valid, len(b)))


@overload
def lowpass_decimate(
    x: ArrayLike, fs: float, factor: int, taps: int | None = None, valid: None = None
) -> tuple[ComplexArray, float, float]: ...
@overload
def lowpass_decimate(
    x: ArrayLike, fs: float, factor: int, taps: int | None = None, *, valid: ArrayLike
) -> tuple[ComplexArray, float, float, BoolArray]: ...
@checked
def lowpass_decimate(x, fs, factor, taps=None, valid=None):
    """Return low-pass filtered and decimated IQ samples, and their delay.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    fs : float
        Their sampling rate in Hz.
    factor : int
        Every how many samples one is kept.
    taps : int, optional
        Length of the filter, odd; 20 for each of the `factor` and one more if None.
    valid : array_like of bool, broadcast to (..., n), optional
        Which samples are measurements, see `valid_samples`.

    Returns
    -------
    y : ndarray of complex, shape (..., ceil(n / factor))
        Samples 0, factor, 2 factor, ... of the filter's output. Until ``2 * delay`` the filter
        is still filling.
    fs_out : float
        New sampling rate in Hz.
    delay : float
        Group delay in s: y[m] shows the signal at m / fs_out - delay.
    valid : ndarray of bool, shape (..., ceil(n / factor))
        Only if `valid` was given: which of y are made of valid samples alone.

    Notes
    -----
    `scipy.signal.upfirdn` with the filter of `lowpass`, whose outputs it gives, but computes only
    those that are kept. The filter lets half of the amplitude through at half the new rate. Near
    there, what lies beyond is folded back; up to 80 % of half the new rate the passband is flat to
    1 %.

    Examples
    --------
    >>> import numpy as np
    >>> y, fs_out, delay = lowpass_decimate(np.ones(1000), 50e3, 5)
    >>> y.shape, fs_out, delay
    ((200,), 10000.0, 0.001)
    """
    factor = _checks.whole_number("factor", factor)
    fs = _checks.moderate_number("fs", fs)
    taps = 20 * factor + 1 if taps is None else _checks.whole_number("taps", taps)
    x, valid = known_samples("x", x, valid, (None,))
    if factor == 1:
        return (x, fs, 0.0) if valid is None else (x, fs, 0.0, valid)
    from scipy.signal import upfirdn

    b, delay = _impulse_response(fs, fs / (2 * factor), taps)
    y = np.empty((*x.shape[:-1], -(-x.shape[-1] // factor)), complex)
    if x.size:
        with np.errstate(all="ignore"):
            # I and Q apart: SciPy would multiply complex samples by a complex filter.
            y.real = upfirdn(b, x.real, down=factor)[..., : y.shape[-1]]
            y.imag = upfirdn(b, x.imag, down=factor)[..., : y.shape[-1]]
    _checks.estimates("x", y, what="filtered samples")
    kept = () if valid is None else (_filtered(valid, taps)[..., ::factor],)
    return y, fs / factor, delay, *kept


def _impulse_response(fs, cutoff, taps):
    """Return a linear-phase low-pass filter (taps,), and its delay in s."""
    fs = _checks.moderate_number("fs", fs)
    taps = _checks.whole_number("taps", taps)
    if taps % 2 == 0:
        raise ValueError(f"taps must be odd, or the delay is half a sample off, got {taps}")
    cutoff = _checks.positive_number("cutoff", cutoff)
    if not cutoff < fs / 2:
        raise ValueError(f"cutoff must be less than fs / 2 = {fs / 2:g}, got {cutoff:g}")
    return _designed(taps, cutoff, fs), (taps - 1) / 2 / fs


@lru_cache
def _designed(taps, cutoff, fs):
    """Return the filter, read-only: records that are made one by one have the same."""
    from scipy.signal import firwin

    b = firwin(taps, cutoff, fs=fs)
    b.setflags(write=False)
    return b


def _filtered(valid, taps):
    """Return which outputs of a filter of so many taps are made of valid samples alone."""
    whole = np.zeros(valid.shape, dtype=bool)
    count = np.cumsum(valid, axis=-1)
    if valid.shape[-1] >= taps:
        before = np.concatenate(
            [np.zeros((*valid.shape[:-1], 1), int), count[..., :-taps]], axis=-1
        )
        whole[..., taps - 1 :] = count[..., taps - 1 :] - before == taps
    return whole
