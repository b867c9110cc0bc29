"""From a record of IQ samples to a record of Doppler shifts, each with the time it belongs to."""

from dataclasses import dataclass

import numpy as np

from .. import _checks
from .frequency import ml_frequency, peaks
from .laws import crlb_frequency_std

_TAGS = {"start": 0.0, "center": 0.5, "end": 1.0}
_AT_ONCE = 2**16  # samples in the windows that an estimator gets in one call: a megabyte


@dataclass(frozen=True)
class DopplerRecord:
    """Doppler shifts from windows of IQ samples.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time of each window in s, counted from the first sample, as tagged.
    frequency : ndarray, shape (..., K, S)
        Doppler shifts in Hz: measurements for `ekf`.
    amp2 : ndarray, shape (..., K, S)
        Squares of the amplitudes at these frequencies.
    noise_variance : ndarray, shape (..., K, S)
        Estimated variances of a complex noise sample.
    window : int
        Samples of a window.
    hop : int
        Samples from one window to the next.
    fs : float
        Sampling rate in Hz.
    """

    time: np.ndarray
    frequency: np.ndarray
    amp2: np.ndarray
    noise_variance: np.ndarray
    window: int
    hop: int
    fs: float

    @property
    def snr(self):
        """Measured signal-to-noise ratio of a sample, not in dB, shape (..., K, S).

        The power that noise adds at the peak is taken off.
        """
        return self.amp2 / self.noise_variance - 1.5 / self.window

    @property
    def frequency_std(self):
        """Standard deviation of each frequency in Hz, if it reaches the bound at `snr`."""
        return crlb_frequency_std(self.snr, self.window, self.fs)


def sliding_doppler(x, fs, window, hop, estimator=ml_frequency, *, band=None, tag="center"):
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
        A function ``(x, fs, band)`` of this package, such as `ml_frequency`.
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
        If a value is not finite, `window` does not fit into the record, a number is not positive,
        `tag` is none of the three, or the estimator refuses its arguments.

    Notes
    -----
    The noise variance is ``(mean |x|^2 - amp2) n / (n - 1.5)``: of 2n real numbers, frequency,
    phase and amplitude take three.

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
    window = _checks.whole_number("window", window, least=3)
    hop = _checks.whole_number("hop", hop)
    part = _TAGS[_checks.one_of("tag", tag, tuple(_TAGS))]
    n = x.shape[-1]
    if window > n:
        raise ValueError(f"window must be at most the {n} samples of the record, got {window}")
    firsts = np.arange(0, n - window + 1, hop)
    records = x.reshape(-1, n)
    estimate = _by_peaks if estimator is ml_frequency else _by_call
    f, power = estimate(records, fs, window, firsts, estimator, band)
    amp2 = power / window**2
    energy = np.zeros((len(records), n + 1))
    np.cumsum(records.real**2 + records.imag**2, axis=-1, out=energy[:, 1:])
    mean = (energy[:, firsts + window] - energy[:, firsts]) / window
    # Less than zero is rounding: the power at one frequency is at most the whole.
    noise = np.maximum(mean - amp2, 0.0) * (window / (window - 1.5))
    shape = (*x.shape[:-1], len(firsts))
    f, amp2, noise = (np.swapaxes(v.reshape(shape), -1, -2) for v in (f, amp2, noise))
    time = (firsts + part * (window - 1)) / fs
    return DopplerRecord(time, f, amp2, noise, window, hop, fs)


def _by_peaks(records, fs, window, firsts, _, band):
    """Return frequencies and powers (R, K) of the highest peaks."""
    shape = (len(records), len(firsts))
    rows, starts = (v.ravel() for v in np.broadcast_arrays(np.arange(shape[0])[:, None], firsts))
    f, power = peaks(records, rows, starts, window, fs, band)
    return f.reshape(shape), power.reshape(shape)


def _by_call(records, fs, window, firsts, estimator, band):
    """Return frequencies (R, K) of any estimator, and the powers there."""
    f, power = (np.empty((len(records), len(firsts))) for _ in range(2))
    windows = np.lib.stride_tricks.sliding_window_view(records, window, axis=-1)
    t = np.arange(window)
    step = max(1, _AT_ONCE // window)
    for row in range(len(records)):
        for a in range(0, len(firsts), step):
            part = slice(a, a + step)
            x = windows[row, firsts[part]]
            f[row, part] = estimator(x, fs, band)
            wave = np.exp(-2j * np.pi * f[row, part, None] / fs * t)
            power[row, part] = np.abs(np.sum(x * wave, axis=-1)) ** 2
    return f, power
