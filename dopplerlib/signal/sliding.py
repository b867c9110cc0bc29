"""From a record of IQ samples to a record of Doppler shifts, each with the time it belongs to."""

from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np

from .. import _checks
from .._records import record
from .._typing import ArrayLike, FloatArray
from ._bins import about_mean, sum_of_ones
from .frequency import ml_frequency, ml_frequency_dc, peaks
from .laws import crlb_frequency_std, crlb_frequency_std_dc

_TAGS = {"start": 0.0, "center": 0.5, "end": 1.0}
_AT_ONCE = 2**14  # samples in the windows of one call of an estimator: a quarter of a megabyte


@record
class DopplerRecord:
    """Doppler shifts from windows of IQ samples.

    A window may be weak, or come from a module that is dead: then `frequency` says little or
    nothing, and the others are to go on. For a filter, take `measurements()`.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time of each window in s, counted from the first sample, as tagged.
    frequency : ndarray, shape (..., K, S)
        Doppler shifts in Hz, however weak the signal is; NaN where there is none: the samples are
        all zero (all the same, if a constant is estimated too), or the estimator finds none.
    amp2 : ndarray, shape (..., K, S)
        Squares of the amplitudes at these frequencies; 0 where `frequency` is NaN.
    noise_variance : ndarray, shape (..., K, S)
        Estimated variances of a complex noise sample.
    window : int
        Samples of a window.
    hop : int
        Samples from one window to the next.
    fs : float
        Sampling rate in Hz.
    beside_constant : bool
        Whether the windows hold a constant that was estimated together with the tone.
    """

    time: np.ndarray
    frequency: np.ndarray
    amp2: np.ndarray
    noise_variance: np.ndarray
    window: int
    hop: int
    fs: float
    beside_constant: bool = False

    @property
    def snr(self) -> FloatArray:
        """Measured signal-to-noise ratio of a sample, not in dB, shape (..., K, S).

        Without bias for a tone well above the noise: the power that noise adds at the peak is taken
        off, and so is what the mean of 1 / noise_variance is too large. Noise alone may leave it
        negative. It is 0 where `frequency` is NaN, and infinite where there is no noise.
        """
        n, unknowns = self.window, 5 if self.beside_constant else 3
        # The noise variance is chi-square distributed, with 2 n - unknowns degrees of freedom.
        dof = n - unknowns / 2
        size = np.where(np.isnan(self.frequency), 1.0, self._size())
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = self.amp2 / self.noise_variance * ((dof - 1) / dof) - 1.5 / size
        return np.where(self.amp2 > 0, ratio, 0.0)

    @property
    def frequency_std(self) -> FloatArray:
        """Standard deviation of each frequency in Hz, if it reaches the bound at `snr`.

        Infinite where `snr` is not positive: no such window tells a frequency. It knows nothing of
        outliers: the highest peak of mere noise has a positive `snr` too, some 10 dB in the whole
        window, and claims the deviation of a tone that strong.
        """
        snr = self.snr
        usual = (snr > 0) & np.isfinite(snr)
        some, f = np.where(usual, snr, 1.0), np.where(usual, self.frequency, 0.0)
        if self.beside_constant:
            bound = crlb_frequency_std_dc(f, some, self.window, self.fs)
        else:
            bound = crlb_frequency_std(some, self.window, self.fs)
        return np.where(usual, bound, np.where(snr > 0, 0.0, np.inf))

    def measurements(self) -> tuple[FloatArray, FloatArray]:
        """Return frequencies and their deviations as `ekf` and `ml_start` take them.

        Returns
        -------
        z : ndarray, shape (..., K, S)
            `frequency` in Hz; NaN, which means missing, where `frequency_std` is infinite.
        sigma_f : ndarray, shape (..., K, S)
            `frequency_std` in Hz. Where `z` is NaN it is `fs`: a filter wants a number there, and
            does not use it. It is 0 in a window without noise, which a filter refuses.
        """
        std = self.frequency_std
        missing = np.isinf(std)
        return np.where(missing, np.nan, self.frequency), np.where(missing, self.fs, std)

    def _size(self):
        """Return what a tone of amplitude 1 leaves of the n samples' energy beside a constant."""
        n = self.window
        if not self.beside_constant:
            return n
        with np.errstate(divide="ignore", invalid="ignore"):
            return n - sum_of_ones(self.frequency * n / self.fs, n)[0] ** 2 / n


def sliding_doppler(
    x: ArrayLike,
    fs: float,
    window: int,
    hop: int,
    estimator: Callable[..., Any] = ml_frequency,
    *,
    band: Sequence[float] | None = None,
    tag: Literal["center", "end", "start"] = "center",
) -> DopplerRecord:
    """Return the Doppler shifts in windows that slide over IQ samples.

    Parameters
    ----------
    x : array_like of complex, shape (..., S, n)
        IQ samples of S sensors.
    fs : float
        Sampling rate in Hz.
    window : int
        Samples of a window, at least 3 and at most n.
    hop : int
        Samples from the start of one window to that of the next. Windows overlap if it is less
        than `window`; then their errors are correlated, see `overlap_correlation`.
    estimator : callable
        A function ``(x, fs, band)`` of this package, such as `ml_frequency`. With
        `ml_frequency_dc` itself, amplitude, noise and deviations are those beside a constant; with
        every other one those of a tone alone, for which a constant is noise.
    band : tuple of float, optional
        Lowest and highest frequency in Hz; -fs/2 and fs/2 if None.
    tag : {"center", "end", "start"}
        Which moment of the window its time is. The frequency of a window is that at its center:
        with another tag, it is late or early by half the window.

    Returns
    -------
    DopplerRecord

    Raises
    ------
    ValueError
        If a value is not finite, `window` does not fit into the record or is less than 3 (4 with
        `ml_frequency_dc`), a number is not positive, `tag` is none of the three, or the estimator
        refuses its arguments.

    Notes
    -----
    The noise variance is what the fit leaves, ``n mean |x|^2 - n amp2``, over n - 1.5: of 2n real
    numbers, frequency, phase and amplitude take three. A constant takes two more.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone([100.0, 150.0], 10e3, 1000, 20.0, rng=np.random.default_rng(1))
    >>> doppler = sliding_doppler(x, 10e3, window=250, hop=250)
    >>> (1e3 * doppler.time).round(2).tolist(), doppler.frequency.round(0)[0].tolist()
    ([12.45, 37.45, 62.45, 87.45], [100.0, 150.0])
    """
    x = _checks.finite_complex("x", x, (None, None))
    fs = _checks.positive_number("fs", fs)
    constant = estimator is ml_frequency_dc
    window = _checks.whole_number("window", window, least=4 if constant else 3)
    hop = _checks.whole_number("hop", hop)
    part = _TAGS[_checks.one_of("tag", tag, tuple(_TAGS))]
    n = x.shape[-1]
    if window > n:
        raise ValueError(f"window must be at most the {n} samples of the record, got {window}")
    firsts = np.arange(0, n - window + 1, hop)
    records = x.reshape(-1, n)
    estimate = _by_peaks if estimator is ml_frequency else _by_call
    values = estimate(records, fs, window, firsts, estimator, band)
    shape = (*x.shape[:-1], len(firsts))
    f, amp2, noise = (np.swapaxes(v.reshape(shape), -1, -2) for v in values)
    time = (firsts + part * (window - 1)) / fs
    return DopplerRecord(time, f, amp2, noise, window, hop, fs, constant)


def _by_peaks(records, fs, n, firsts, _, band):
    """Return frequencies, squared amplitudes and noise variances (R, K) of the highest peaks."""
    shape, rows, starts = _places(records, firsts)
    f, power = peaks(records, rows, starts, n, fs, band)
    amp2 = power.reshape(shape) / n**2
    left = _energies(records, n, firsts) - n * amp2
    # Less than zero is rounding: the power at one frequency is at most the whole.
    return f.reshape(shape), amp2, np.maximum(left, 0.0) / (n - 1.5)


def _by_call(records, fs, n, firsts, estimator, band):
    """Return the same of any estimator."""
    shape, rows, starts = _places(records, firsts)
    f, amp2, noise = np.empty((3, len(rows)))
    windows = np.lib.stride_tricks.sliding_window_view(records, n, axis=-1)
    t = np.arange(n)
    constant = estimator is ml_frequency_dc
    energy = _energies(records, n, firsts).ravel()
    step = max(1, _AT_ONCE // n)
    for a in range(0, len(rows), step):
        part = slice(a, a + step)
        x = windows[rows[part], starts[part]]
        with np.errstate(divide="ignore", invalid="ignore"):  # windows of zeros
            found = estimator(x, fs, band)
        none = ~np.isfinite(found)
        blank = np.flatnonzero(energy[part] == 0)  # by rounding, or because all are zero
        none[blank] |= (x[blank] == 0).all(axis=-1)
        found = np.where(none, np.nan, found)
        if constant:
            x = about_mean(x)
            energy[part] = np.sum(x.real**2 + x.imag**2, axis=-1)
        known = np.where(np.isnan(found), fs / n, found)
        Y = np.sum(x * np.exp(-2j * np.pi * known[:, None] / fs * t), axis=-1)
        size = n - sum_of_ones(known * n / fs, n)[0] ** 2 / n if constant else n
        f[part] = found
        amp2[part] = np.where(np.isnan(found), 0.0, np.abs(Y / size) ** 2)
        noise[part] = np.maximum(energy[part] - size * amp2[part], 0.0) / (
            n - (2.5 if constant else 1.5)
        )
    return f.reshape(shape), amp2.reshape(shape), noise.reshape(shape)


def _energies(records, n, firsts):
    """Return the sum of |x|^2 in each window (R, K)."""
    energy = np.zeros((len(records), records.shape[1] + 1))
    np.cumsum(records.real**2 + records.imag**2, axis=-1, out=energy[:, 1:])
    return energy[:, firsts + n] - energy[:, firsts]


def _places(records, firsts):
    """Return the shape of the results, and the row and first sample of each window in a line."""
    places = np.broadcast_arrays(np.arange(len(records))[:, None], firsts)
    return places[0].shape, *(v.ravel() for v in places)
