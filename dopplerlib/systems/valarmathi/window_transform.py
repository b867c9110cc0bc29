"""The Doppler filter of the document: a velocity from every window, at every sample."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import pairwise
from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Index, checked
from ..._records import record
from ..._typing import ComplexArray, FloatArray
from ...signal.laws import crlb_frequency_std
from .published import reported
from .window_choice import Lengths

_LOUD = 1e4  # of the median sample: beyond, sums in single precision keep too much of it


@checked
@record
class FilteredDoppler:
    """Velocities from windows of several lengths, which all end with the same sample.

    windows (W,): Lengths in samples.
    first: Sample with which the first windows end.
    v (W, ..., K): Measured velocities in m/s, one per sample; NaN where all samples of the window
        are the same, or one is so loud that it hides the others.
    snr_db (W, ..., K): Signal-to-noise ratios that the spectra show, in dB; -30, the least, where
        `v` is NaN.

    Examples
    --------
    >>> measured = FilteredDoppler([8], 0, np.full((1, 1, 1, 20), 250.0), np.zeros((1, 1, 1, 20)))
    >>> measured.delays.tolist()
    [0.0105]
    """

    windows: Lengths
    first: Index
    v: Annotated[FloatArray, partial(_checks.measured, shape=())]
    snr_db: Annotated[FloatArray, _checks.decibels]

    def __post_init__(self):
        """Check that the fields belong together."""
        for name in ("v", "snr_db"):
            shape = getattr(self, name).shape
            if shape[:1] != self.windows.shape or shape != self.v.shape or len(shape) < 2:
                raise ValueError(
                    f"{name} must have shape ({len(self.windows)}, ..., K) as windows and v, "
                    f"got {shape}"
                )

    @property
    def delays(self) -> FloatArray:
        """Time from the middle of each window to its last sample, in s, shape (W,)."""
        return (self.windows - 1) / 2 * reported().stated.T

    @checked
    def part(self, windows: Lengths, sensors: Sequence[Index] = (0,)) -> "FilteredDoppler":
        """Return the measurements of some windows and sensors, `v` of shape (W, runs, S, K)."""
        if not np.isin(windows, self.windows).all() or self.v.ndim != 4:
            raise ValueError(f"windows must be some of {self.windows.tolist()}, got {windows}")
        if not len(sensors) or max(sensors) >= self.v.shape[2]:
            raise ValueError(f"sensors must be below {self.v.shape[2]}, got {sensors}")
        rows = np.searchsorted(self.windows, windows)
        v, snr_db = (one[rows][:, :, list(sensors)] for one in (self.v, self.snr_db))
        return FilteredDoppler(windows, self.first, v, snr_db)


@checked
def doppler_filter(
    x: Annotated[ComplexArray, _checks.finite_complex],
    windows: Lengths | None = None,
    first: Index | None = None,
) -> FilteredDoppler:
    """Return the velocities that the document's Doppler filter finds in IQ samples.

    A transform of the last samples, padded with zeros, at every sample; its highest bin from zero
    to the sampling rate, for targets that approach; the vertex of the parabola through the
    magnitudes of this bin and its neighbors; and the velocity that this frequency belongs to.

    x (..., n): IQ samples at the interval T of the document.
    windows (W,): Lengths in samples; all of `chosen` if None.
    first: Sample with which the first windows end; that of `chosen` if None.
    Returns: NaN where a window holds the same sample only, or one that hides the others.
    Raises ValueError if an argument is not of the kind described, or a window is longer than the
        transform or reaches back beyond the first sample.

    Notes
    -----
    Eqs 1 to 6 of the document, read as `dopplerlib.signal.interpolation.parabolic`: with bins
    this close, its three highest are neighbors, and the frequency is the vertex and no root. The
    signal-to-noise ratio is the power of the peak, less what the noise adds to it, over that of the
    residual. On average it is too large by (n - 1.5) / (n - 2.5) in a window of n samples: a
    quarter of a decibel in one of 20, where a choice among windows does not feel it.

    Examples
    --------
    A tone of 50 Hz, at a wavelength of 4 m:

    >>> x = np.exp(2j * np.pi * 50 * 0.003 * np.arange(80))
    >>> doppler_filter(x, [64], 64).v[0, 0].round().item()
    100.0
    """
    own, T = reported().chosen, reported().stated.T
    _checks.check_shape("x", x, (None,))
    windows = own.windows if windows is None else windows
    first = int(own.first) if first is None else first
    n = x.shape[-1]
    if not (3 <= windows.min() and windows.max() <= min(first + 1, own.nfft) and first < n):
        raise ValueError(
            f"windows must be from 3 to min(first + 1, {own.nfft}) samples long and first one of "
            f"the {n} samples, got {windows.tolist()} and {first}"
        )
    rows = x.reshape(-1, n)
    size = np.maximum(np.abs(rows.real), np.abs(rows.imag))
    usual = np.median(size, axis=-1, keepdims=True)
    loud = (size > _LOUD * usual) & (usual > 0)
    rows = np.where(loud, 0.0, rows)
    place, power = _peaks(rows, loud, windows, first, own.nfft)
    energy = np.zeros((len(rows), n + 1))
    np.cumsum(rows.real**2 + rows.imag**2, axis=-1, out=energy[:, 1:])
    moves = np.zeros((len(rows), n), dtype=int)
    np.cumsum(rows[:, 1:] != rows[:, :-1], axis=-1, out=moves[:, 1:])
    last = np.arange(first + 1, n + 1)
    snr = power  # to save memory, in place
    for w, window in enumerate(windows):
        place[w][moves[:, last - 1] == moves[:, last - window]] = np.nan
        amp2 = np.where(np.isnan(place[w]), 0.0, power[w] / window**2)
        mean = (energy[:, last] - energy[:, last - window]) / window
        # A noise of a billionth is less than single precision can tell from none.
        noise = np.maximum(mean - amp2, 1e-9 * mean) * (window / (window - 1.5))
        ratio = np.divide(amp2, noise, out=np.zeros_like(amp2), where=noise > 0)
        snr[w] = np.maximum(ratio - 1.5 / window, 1e-3)
    shape = (len(windows), *x.shape[:-1], n - first)
    v = place * (own.wavelength / (2 * own.nfft * T))
    return FilteredDoppler(windows, first, v.reshape(shape), 10 * np.log10(snr).reshape(shape))


@checked
def measurement_variance(
    windows: Annotated[FloatArray, _checks.positive],
    snr_db: Annotated[FloatArray, _checks.decibels],
) -> FloatArray:
    """Return the variance of a measured velocity if it reaches the Cramér-Rao bound.

    windows (...): Lengths in samples, at least 2.
    snr_db: Signal-to-noise ratio of a sample in dB.
    Returns (...): In (m/s)^2.

    Examples
    --------
    >>> measurement_variance(64, 15.0).round(4).item()
    0.0082
    """
    std = crlb_frequency_std(10 ** (snr_db / 10), windows, 1 / reported().stated.T)
    return (reported().chosen.wavelength / 2 * std) ** 2


def _peaks(rows, loud, windows, first, nfft):
    """Return places in bins and powers (W, R, K), the records shared among the processors."""
    from ._sliding_kernel import compiled  # here: numba takes half a second to load

    turn = np.outer(np.arange(nfft), np.arange(nfft)) % nfft
    wave = np.exp(-2j * np.pi * np.arange(nfft) / nfft)[turn]
    wave_re, wave_im = wave.real.astype(np.float32), wave.imag.astype(np.float32)
    re, im = rows.real.astype(np.float32), rows.imag.astype(np.float32)
    # Numba compiles for each layout and for arrays that must not be written to: records come first,
    # as a part of them has the layout of all, and the windows are copied.
    windows = windows.copy()
    place = np.empty((len(rows), len(windows), rows.shape[1] - first))
    power = np.empty_like(place)

    def work(part):
        compiled(
            re[part], im[part], loud[part], wave_re, wave_im, windows, first,
            place[part], power[part],
        )  # fmt: skip

    _share(work, len(rows))
    return tuple(np.ascontiguousarray(np.moveaxis(one, 1, 0)) for one in (place, power))


def _share(work, count):
    """Call a function of a slice of `count` records or runs, some at a time."""
    parts = min(os.cpu_count() or 1, 4)
    edges = np.linspace(0, count, parts + 1).astype(int)
    slices = [slice(a, b) for a, b in pairwise(edges) if b > a]
    with ThreadPoolExecutor(parts) as pool:
        list(pool.map(work, slices))
