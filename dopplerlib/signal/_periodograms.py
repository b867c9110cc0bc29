"""Periodograms of sliding windows, tapered, of real or complex samples."""

from collections.abc import Iterator

import numpy as np
import scipy.fft

from .. import _checks
from .._records import record
from .._typing import FloatArray
from ._bins import touched
from ._tapers import APART, weights
from .validity import LARGEST, known_samples

_AT_ONCE = 2**18  # samples in the windows of one transform


@record
class Windows:
    """Sliding windows of records, and the bins of their transforms.

    Records x (R, n), first samples of windows (K,), which of them are known (R, K), weights
    (window,), and numbers of bins (B,) in order of frequency. Those of real samples end where their
    negative frequencies begin to reach: in between, noise is as in complex ones.
    """

    x: np.ndarray
    fs: float
    firsts: np.ndarray
    known: np.ndarray
    w: np.ndarray
    bins: np.ndarray

    @property
    def frequency(self) -> FloatArray:
        """Frequencies of the bins in Hz, shape (B,)."""
        return self.bins * self.fs / len(self.w)

    def powers(self) -> Iterator[tuple[int, slice, FloatArray]]:
        """Yield the number of a record, a slice of its windows, and their powers (K, B).

        A power is the variance of a complex sample of white noise that has as much there.
        """
        n = len(self.w)
        step, scale = max(1, _AT_ONCE // n), 1 / np.sum(self.w**2)
        for row, x in enumerate(self.x):
            windows = np.lib.stride_tricks.sliding_window_view(x, n)
            for a in range(0, len(self.firsts), step):
                part = slice(a, a + step)
                X = scipy.fft.fft(windows[self.firsts[part]] * self.w)[:, self.bins]
                yield row, part, (X.real**2 + X.imag**2) * scale


def sliding_windows(x, fs, window, hop, taper, valid):
    """Return the `Windows` of samples (..., n), and the leading axes of these; checked."""
    is_real = _checks.numbers("x", x, (None,)).dtype.kind == "f"
    x, valid = known_samples("x", x, valid, (None,))
    largest = np.abs(x).max(initial=0.0)
    if largest > LARGEST:
        raise ValueError(f"x must not exceed {LARGEST:g}, or its square is lost, got {largest:g}")
    n, apart = x.shape[-1], APART[taper]
    if not 6 * apart <= window <= n:
        raise ValueError(
            f"window must be from {6 * apart} to the {n} samples of the record, got {window}"
        )
    rows, firsts = x.reshape(-1, n), np.arange(0, n - window + 1, hop)
    known = np.ones((len(rows), len(firsts)), dtype=bool)
    if valid is not None:
        known = ~touched(~valid.reshape(-1, n), window, firsts)
    if is_real:
        rows, bins = rows.real, np.arange(apart, (window + 1) // 2 - apart + 1)
    else:
        bins = np.arange(window) - window // 2
    return Windows(rows, fs, firsts, known, weights(taper, window), bins), x.shape[:-1]
