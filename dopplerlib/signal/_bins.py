"""What the estimators share that look at the bins of a discrete Fourier transform."""

import numpy as np
import scipy.fft

from .. import _checks


def samples(x, fs, least=2):
    """Return checked IQ samples and their sampling rate."""
    x = _checks.finite_complex("x", x, (None,))
    if x.shape[-1] < least:
        raise ValueError(f"x must have at least {least} samples, got {x.shape[-1]}")
    return x, _checks.positive_number("fs", fs)


def limits(band, fs):
    """Return the ends of the band in Hz, and whether it is all that the sampling rate tells apart.

    None is the band around zero.
    """
    if band is None:
        return -fs / 2, fs / 2, True
    low, high = _checks.increasing_pair("band", band)
    if high - low > fs * (1 + 1e-12):
        raise ValueError(f"band must not be wider than fs = {fs:g}, got {band}")
    return low, high, high - low >= fs * (1 - 1e-12)


class Bins:
    """The transforms of windows, and which of their bins lie in the band."""

    def __init__(self, x, fs, band, nfft=None, least=2):
        x, self.fs = samples(x, fs, least)
        self.n = x.shape[-1]
        self.nfft = self.n if nfft is None else _checks.whole_number("nfft", nfft, self.n)
        self.low, self.high, self.circular = limits(band, self.fs)
        first = int(np.ceil(self.low * self.nfft / self.fs - 1e-9))
        last = int(np.floor(self.high * self.nfft / self.fs + 1e-9))
        if self.circular:
            last = min(last, first + self.nfft - 1)
        if last < first:
            raise ValueError(
                f"band must hold a bin, a multiple of {self.fs / self.nfft:g} Hz, got {band}"
            )
        self.X = scipy.fft.fft(x, self.nfft)
        self.inside = np.arange(first, last + 1)

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
        """Return the frequency of bin k, which may be a fraction; around the end of a full band."""
        f = k * self.fs / self.nfft
        return self.low + (f - self.low) % self.fs if self.circular else f
