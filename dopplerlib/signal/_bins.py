"""Common parts of the estimators that use the bins of a discrete Fourier transform."""

import numpy as np
import scipy.fft

from .. import _checks
from .._records import record

TAGS = {"start": 0.0, "center": 0.5, "end": 1.0}  # place of a timestamp in its window
_STEPS = 60  # of a search inside a bracket
_LARGE = 1e140  # energies; squares of what is beyond leave the range of double precision


def samples(x, fs, least=2):
    """Return checked IQ samples and their sampling rate."""
    x = _checks.finite_complex("x", x, (None,))
    if x.shape[-1] < least:
        raise ValueError(f"x must have at least {least} samples, got {x.shape[-1]}")
    return in_range(x), _checks.moderate_number("fs", fs)


def in_range(x):
    """Return windows (..., n), each scaled by a power of two if its squares could leave the range.

    The frequency of a tone does not depend on its amplitude. Other windows stay as they are.
    """
    if not x.size:
        return x
    parts = np.ascontiguousarray(x).view(float)
    with np.errstate(over="ignore", under="ignore"):
        energy = np.einsum("...i,...i->...", parts, parts)
    far = ~((energy > 1 / _LARGE) & (energy < _LARGE))
    if not far.any():
        return x
    exponent = np.where(far, -np.frexp(np.abs(parts).max(axis=-1))[1], 0)
    return np.ldexp(parts, exponent[..., None]).view(complex)


def unmoving(x, rows, firsts, n):
    """Return which windows of n samples, beginning at (row, first) of x (R, samples), never move.

    Noise moves every sample of a module that measures: the same value n times tells no frequency,
    be it zero or not.
    """
    start = x[rows, firsts]
    same = (start == x[rows, firsts + 1]) & (start == x[rows, firsts + n - 1])
    for w in np.flatnonzero(same):
        same[w] = (x[rows[w], firsts[w] : firsts[w] + n] == start[w]).all()
    return same


def still_windows(x):
    """Return which windows (..., n) never move, shape (...)."""
    rows = x.reshape(-1, x.shape[-1])
    place = np.arange(len(rows))
    return unmoving(rows, place, np.zeros_like(place), rows.shape[1]).reshape(x.shape[:-1])


def touched(bad, n, firsts):
    """Return which windows of n samples, from `firsts` on, hold a sample that is bad (R, K)."""
    count = np.zeros((len(bad), bad.shape[1] + 1), dtype=int)
    np.cumsum(bad, axis=-1, out=count[:, 1:])
    return count[:, firsts + n] > count[:, firsts]


def ratio(a, b):
    """Return a / b, and NaN where b is zero or NaN."""
    some = (b != 0) & (b == b)
    return np.divide(a, b, out=np.full(np.shape(b), np.nan, dtype=b.dtype), where=some)


def limits(band, fs):
    """Return the ends of the band in Hz, and whether it is as wide as the sampling rate.

    None is the band around zero.
    """
    if band is None:
        return -fs / 2, fs / 2, True
    low, high = _checks.increasing_pair("band", band)
    if high - low > fs * (1 + 1e-12):
        raise ValueError(f"band must not be wider than fs = {fs:g}, got {band}")
    return low, high, high - low >= fs * (1 - 1e-12)


@record
class Bins:
    """The transforms of windows, and which of their bins lie in the band."""

    X: np.ndarray  # (..., nfft)
    still: np.ndarray  # (...), whether the window never moves
    inside: np.ndarray  # (bins,)
    n: int
    nfft: int
    fs: float
    low: float
    circular: bool

    def power(self):
        """Return the power of each bin in the band, shape (..., bins)."""
        X = self.X[..., self.inside % self.nfft]
        return X.real**2 + X.imag**2

    def peak(self):
        """Return the number of the highest bin in the band, shape (...)."""
        return self.inside[np.argmax(self.power(), axis=-1)]

    def at(self, k):
        """Return the value of bin k (...) in each transform."""
        k = np.asarray(k) % self.nfft
        return np.take_along_axis(self.X, k[..., None], axis=-1)[..., 0]

    def hertz(self, k):
        """Return the frequency of bin k, which may be a fraction; around the end of a full band.

        NaN for a window that never moves.
        """
        f = np.where(self.still, np.nan, k) * self.fs / self.nfft
        return self.low + (f - self.low) % self.fs if self.circular else f


def transform(x, fs, band, nfft=None, least=2):
    """Return the `Bins` of checked IQ samples."""
    x, fs = samples(x, fs, least)
    n = x.shape[-1]
    nfft = n if nfft is None else _checks.whole_number("nfft", nfft, n)
    low, high, circular = limits(band, fs)
    first = int(np.ceil(low * nfft / fs - 1e-9))
    last = int(np.floor(high * nfft / fs + 1e-9))
    if circular:
        last = min(last, first + nfft - 1)
    if last < first:
        raise ValueError(f"band must hold a bin, a multiple of {fs / nfft:g} Hz, got {band}")
    inside = np.arange(first, last + 1)
    return Bins(scipy.fft.fft(x, nfft), still_windows(x), inside, n, nfft, fs, low, circular)


def about_mean(x):
    """Return samples less their mean over the last axis: zeros, to the last bit, for a constant."""
    x = x - x[..., :1]  # else a constant would leave the rounding of its mean
    return x - x.mean(axis=-1, keepdims=True)


def sum_of_ones(u, n):
    """Return the Fourier sum of n ones about their middle, and its derivatives, at u bins.

    Its sign is that of the multiple of n nearest to u: only products of two are of use.
    """
    a = np.pi * ((u + n / 2) % n - n / 2)
    b = a / n
    s, c = np.sin(b), np.cos(b)
    D0 = np.sin(a) / s
    D1 = np.pi * (np.cos(a) - D0 * c / n) / s
    D2 = np.pi**2 * ((1 + c**2) * D0 / n**2 - 2 * np.cos(a) * c / n - D0 * s**2) / s**2
    return D0, D1, D2


def climb(slopes, y, start, low, high, apart=0.0):
    """Return where the likelihood of windows y (W, n) is highest from `low` to `high`, in bins.

    Newton's method inside a bracket that shrinks, for all windows that are not there yet. `slopes`
    takes places (W,), and the Fourier sum about the middle of the window and its two derivatives
    there (3, W), and returns those of the likelihood. No place is nearer to zero than `apart`.
    """
    n = y.shape[-1]
    t = -2j * np.pi / n * (np.arange(n) - (n - 1) / 2)
    powers = np.stack([np.ones(n), t, t**2], axis=-1)
    found, busy, u = start.copy(), np.arange(len(start)), start
    for _ in range(_STEPS):
        u = np.where(np.abs(u) < apart, np.where(u < 0, -apart, apart), u)
        slope, bend = slopes(u, np.moveaxis((y * np.exp(t * u[:, None])) @ powers, -1, 0))
        low, high = np.where(slope > 0, u, low), np.where(slope > 0, high, u)
        with np.errstate(invalid="ignore", divide="ignore"):
            step = -slope / bend
        newton = (bend < 0) & (u + step >= low) & (u + step <= high)
        step = np.where(newton, step, (low + high) / 2 - u)
        u = u + step
        found[busy] = u
        left = (~newton | (np.abs(step) > 1e-5)) & (high - low > 1e-9)
        if not left.any():
            break
        y, u, low, high, busy = y[left], u[left], low[left], high[left], busy[left]
    return found
