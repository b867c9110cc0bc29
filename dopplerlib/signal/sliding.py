"""Doppler shifts in sliding windows of IQ samples, with their timestamps."""

from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal

import numpy as np

from .. import _checks
from .._hints import Count, Positive, Probability, checked, up_to
from .._records import record
from .._typing import ArrayLike, FloatArray
from ._bins import TAGS, about_mean, limits, sum_of_ones, touched, unmoving
from ._quadratures import explained, relative_information
from .frequency import ml_frequency, ml_frequency_dc, peaks
from .laws import crlb_frequency_std, crlb_frequency_std_dc
from .real_tone import ml_frequency_real, ml_frequency_real_dc
from .validity import LARGEST, known_samples

_AT_ONCE = 2**14  # samples in the windows of one call of an estimator: a quarter of a megabyte
_MOST = 2**40  # samples in a window
_REAL = (ml_frequency_real, ml_frequency_real_dc)
_FINEST = 1e-6  # bins: so much the search for the peak leaves, see `_ml_kernel`


@checked
@record
class DopplerRecord:
    """Doppler shifts in windows of IQ samples.

    A window may be weak, or hold samples that are no measurements: then `frequency` says little or
    nothing, and the others are to go on. For a filter, take `measurements()`.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time of each window in s, counted from the first sample, as tagged.
    frequency : ndarray, shape (..., K, S)
        Doppler shifts in Hz, however weak the signal is; NaN where there is none: a sample is not
        valid, all are the same, or the estimator finds none.
    amp2 : ndarray, shape (..., K, S)
        Squares of the amplitudes at these frequencies; 0 where `frequency` is NaN. Of real samples,
        twice the mean power of the tone in the window.
    noise_variance : ndarray, shape (..., K, S)
        Estimated variances of a complex noise sample; NaN where a sample is not valid. Of real
        samples, four times their own: so much has complex noise that is as dense where their
        analytic signal is.
    window : int
        Samples of a window.
    hop : int
        Samples from one window to the next.
    fs : float
        Sampling rate in Hz.
    dc_fitted : bool
        Whether the windows hold a constant that was estimated together with the tone.
    quadrature : ndarray, shape (..., K, S), optional
        Fraction of the energy of a tone in real samples that is even about the middle of the
        window, on which its deviation depends; None for complex samples. The signs of the
        frequencies are then those of the band that was searched: the samples do not tell them.
    band_width : float, optional
        Width in Hz of the band that was searched; all frequencies if None.
    """

    time: np.ndarray
    frequency: np.ndarray
    amp2: np.ndarray
    noise_variance: np.ndarray
    window: Annotated[int, up_to(_MOST, 3)]
    hop: Count
    fs: Positive
    dc_fitted: bool = False
    quadrature: np.ndarray | None = None
    band_width: Positive | None = None

    def __post_init__(self):
        frequency = _checks.measured("frequency", self.frequency, (None, None))
        arrays = {
            "frequency": frequency,
            "amp2": _checks.finite("amp2", self.amp2),
            "noise_variance": _checks.measured("noise_variance", self.noise_variance, ()),
        }
        if self.quadrature is not None:
            arrays["quadrature"] = _checks.finite("quadrature", self.quadrature)
            if (arrays["quadrature"] > 1).any():
                raise ValueError(
                    f"quadrature must be at most 1, got {arrays['quadrature'].max():g}"
                )
        for name, value in arrays.items():
            if value.shape != frequency.shape:
                raise ValueError(
                    f"{name} must have shape {frequency.shape} of frequency, got {value.shape}"
                )
            if name != "frequency" and (value < 0).any():
                raise ValueError(f"{name} must not be negative, got {np.nanmin(value):g}")
        time = _checks.finite("time", self.time, frequency.shape[-2:-1])
        if time.ndim != 1:
            raise ValueError(f"time must have shape (K,), got {time.shape}")
        return {"time": time, **arrays}

    @property
    def snr(self) -> FloatArray:
        """Measured signal-to-noise ratio per sample, not in dB, shape (..., K, S).

        Without bias for a tone well above the noise: the power that noise adds at the peak is taken
        off, and so is what the mean of 1 / noise_variance is too large. Noise alone may leave it
        negative. It is 0 where `frequency` is NaN, and infinite where there is no noise.
        """
        # The noise variance is chi-square distributed, with twice as many degrees of freedom.
        dof = _noise_dof(self.window, self.dc_fitted, self.quadrature is not None) / 2
        size = np.where(np.isnan(self.frequency), 1.0, self._size())
        with np.errstate(all="ignore"):
            ratio = self.amp2 / self.noise_variance * ((dof - 1) / dof) - 1.5 / size
        return np.where(self.amp2 > 0, ratio, 0.0)

    @property
    def frequency_std(self) -> FloatArray:
        """Standard deviation of each frequency in Hz, by the Cramér-Rao bound at `snr`.

        Infinite where `snr` is not positive: no such window tells a frequency. It is a millionth of
        a bin at least, which is what the search for the peak leaves, so that it is not zero in a
        window without noise either. It knows nothing of outliers: the highest peak of mere noise
        has a positive `snr` too, some 10 dB in the whole window, and claims the deviation of a tone
        that strong.
        """
        snr = self.snr
        usual = (snr > 0) & np.isfinite(snr)
        some, f = np.where(usual, snr, 1.0), np.where(usual, self.frequency, 0.0)
        if self.quadrature is not None:
            bound = self._bound_of_real(f, some)
        elif self.dc_fitted:
            bound = crlb_frequency_std_dc(f, some, self.window, self.fs)
        else:
            bound = crlb_frequency_std(some, self.window, self.fs)
        finest = _FINEST * self.fs / self.window
        return np.where(snr > 0, np.maximum(np.where(usual, bound, 0.0), finest), np.inf)

    @property
    def noise_probability(self) -> FloatArray:
        """Probability that white noise alone gives a peak as high in the band, shape (..., K, S).

        That of a fraction of the energy at one frequency, times the number of places for a peak by
        Rice's formula; 1 at most, and where `frequency` is NaN. It does not depend on the power of
        the noise. Of noise that is not white it says little: see `detect_peaks`.
        """
        n, real = self.window, self.quadrature is not None
        left = _noise_dof(n, self.dc_fitted, real) / 2
        all_of_them = self.fs / 2 if real else self.fs
        width = all_of_them if self.band_width is None else min(self.band_width, all_of_them)
        with np.errstate(all="ignore"):
            # Half the real numbers that are left beside the two of the tone and the constant.
            dimensions = n / 2 - 1 - self.dc_fitted / 2 if real else n - 1 - self.dc_fitted
            ratio = self.amp2 * self._size() / self.noise_variance
            height = dimensions * np.log1p(ratio / left)
            places = 1 + width * n / self.fs * np.sqrt(np.pi / 3 * height)
            chance = np.where(np.isinf(height), 0.0, places * np.exp(-height))
        return np.where(self.amp2 > 0, np.minimum(chance, 1.0), 1.0)

    @checked
    def measurements(self, false_alarm: Probability = 1e-3) -> tuple[FloatArray, FloatArray]:
        """Return frequencies and standard deviations as `ekf` and `ml_initialize` take them.

        Parameters
        ----------
        false_alarm : float
            Probability that a window of white noise is taken for a measurement, at most.

        Returns
        -------
        z : ndarray, shape (..., K, S)
            `frequency` in Hz; NaN, which means missing, where `noise_probability` is larger than
            `false_alarm`, or `frequency_std` is not less than `fs`: so wide is what a frequency may
            be in without any sample.
        sigma_f : ndarray, shape (..., K, S)
            `frequency_std` in Hz. Where `z` is NaN it is `fs`: a filter wants a number there, and
            does not use it.

        Examples
        --------
        >>> x = np.exp(0.5j * np.arange(200))
        >>> doppler = sliding_doppler([x, 0 * x], 1e3, window=100, hop=100)
        >>> doppler.measurements()[0].round(1).tolist()
        [[79.6, nan], [79.6, nan]]
        """
        std = self.frequency_std
        known = (std < self.fs) & (self.noise_probability <= false_alarm)
        return np.where(known, self.frequency, np.nan), np.where(known, std, self.fs)

    def _bound_of_real(self, f, snr):
        """Return `crlb_frequency_std_real` at the phase of each tone."""
        n = self.window
        with np.errstate(all="ignore"):
            # Where the frequency is missing any will do: its deviation is infinite all the same.
            f = np.where(self.amp2 > 0, f, self.fs / 4)
            told = relative_information(self.quadrature, f, n, self.fs, self.dc_fitted)
            bound = self.fs / (2 * np.pi) / np.sqrt(2 * n * snr * told)
        return np.where(told > 0, bound, np.inf)

    def _size(self):
        """Return the energy of a tone of amplitude 1 in n samples, less that of its mean."""
        n = self.window
        if not self.dc_fitted or self.quadrature is not None:
            return n
        with np.errstate(all="ignore"):
            return n - sum_of_ones(self.frequency * n / self.fs, n)[0] ** 2 / n


def sliding_doppler(
    x: ArrayLike,
    fs: float,
    window: int,
    hop: int,
    estimator: Callable[..., Any] = ml_frequency,
    *,
    band: Sequence[float] | None = None,
    timestamp: Literal["center", "end", "start"] = "center",
    valid: ArrayLike | None = None,
) -> DopplerRecord:
    """Return the Doppler shifts in sliding windows of IQ samples.

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
        `ml_frequency_real` and `ml_frequency_real_dc` those of the real parts of the samples, which
        come from a module without Q; with every other one those of a tone alone, for which a
        constant is noise.
    band : tuple of float, optional
        Lowest and highest frequency in Hz; -fs/2 and fs/2 if None. For real samples of one sign,
        which is that of the shifts.
    timestamp : {"center", "end", "start"}
        Which moment of the window its time is. The frequency of a window is that at its center:
        with another timestamp, it is late or early by half the window.

    valid : array_like of bool, broadcast to (..., S, n), optional
        Which samples are measurements, see `valid_samples`; all if None. A window that touches
        another one is missing.

    Returns
    -------
    DopplerRecord

    Raises
    ------
    ValueError
        If a valid sample is not finite or beyond 1e140, `window` does not fit into the record or is
        less than 3 (4 with `ml_frequency_dc`, 5 for real samples), a number is not positive,
        `timestamp` is none of the three, or `estimator` is no function or refuses its arguments.

    Notes
    -----
    The noise variance is what the fit leaves, ``n mean |x|^2 - n amp2``, over n - 1.5: of 2n real
    numbers, frequency, phase and amplitude take three. A constant takes two more. Of n real samples
    the tone takes three, a constant one.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone([100.0, 150.0], 10e3, 1000, 20.0, rng=np.random.default_rng(1))
    >>> doppler = sliding_doppler(x, 10e3, window=250, hop=250)
    >>> (1e3 * doppler.time).round(2).tolist(), doppler.frequency.round(0)[0].tolist()
    ([12.45, 37.45, 62.45, 87.45], [100.0, 150.0])
    """
    x, valid = known_samples("x", x, valid, (None, None))
    largest = max(np.abs(part).max(initial=0.0) for part in (x.real, x.imag))
    if largest > LARGEST:
        raise ValueError(f"x must not exceed {LARGEST:g}, or its square is lost, got {largest:g}")
    fs = _checks.moderate_number("fs", fs)
    real = _checks.function("estimator", estimator) in _REAL
    constant = estimator in (ml_frequency_dc, ml_frequency_real_dc)
    window = _checks.whole_number("window", window, least=5 if real else 4 if constant else 3)
    hop = _checks.whole_number("hop", hop)
    part = TAGS[_checks.one_of("timestamp", timestamp, tuple(TAGS))]
    n = x.shape[-1]
    if window > n:
        raise ValueError(f"window must be at most the {n} samples of the record, got {window}")
    firsts = np.arange(0, n - window + 1, hop)
    records = x.reshape(-1, n)
    estimate = _by_peaks if estimator is ml_frequency else _of_real if real else _by_call
    with np.errstate(under="ignore"):
        f, amp2, noise, *share = estimate(records, fs, window, firsts, estimator, band)
    if valid is not None:
        gone = touched(~valid.reshape(-1, n), window, firsts)
        f[gone], amp2[gone], noise[gone] = np.nan, 0.0, np.nan
    shape = (*x.shape[:-1], len(firsts))
    f, amp2, noise, *share = (
        np.swapaxes(v.reshape(shape), -1, -2) for v in (f, amp2, noise, *share)
    )
    time = (firsts + part * (window - 1)) / fs
    low, high, _ = limits(band, fs)
    quadrature = share[0] if share else None
    return DopplerRecord(
        time, f, amp2, noise, window, hop, fs, constant, quadrature, max(high - low, fs / n)
    )


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
    still = unmoving(records, rows, starts, n)
    step = max(1, _AT_ONCE // n)
    for a in range(0, len(rows), step):
        part = slice(a, a + step)
        x = windows[rows[part], starts[part]]
        with np.errstate(divide="ignore", invalid="ignore"):  # windows of zeros
            found = _checks.called("estimator", estimator, x, fs, band)
        found = _checks.real("estimator(x, fs, band)", found)
        _checks.exact_shape("estimator(x, fs, band)", found, x.shape[:-1])
        found = np.where(np.isfinite(found) & ~still[part], found, np.nan)
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


def _of_real(records, fs, n, firsts, estimator, band):
    """Return the same of the real parts, and the fraction of the energy in even quadratures."""
    records, constant = records.real, estimator is ml_frequency_real_dc
    shape, rows, starts = _places(records, firsts)
    windows = np.lib.stride_tricks.sliding_window_view(records, n, axis=-1)
    f, power, share, energy = np.empty((4, len(rows)))
    step = max(1, _AT_ONCE // n)
    for a in range(0, len(rows), step):
        part = slice(a, a + step)
        y = windows[rows[part], starts[part]]
        f[part] = estimator(y, fs, band)
        y = about_mean(y) if constant else y
        energy[part] = np.sum(y**2, axis=-1)
        known = np.where(np.isnan(f[part]), fs / 4, f[part])
        power[part], share[part] = explained(y, known, fs, constant)
    power[np.isnan(f)] = 0.0
    noise = 4 * np.maximum(energy - power, 0.0) / _noise_dof(n, constant, real=True)
    return tuple(v.reshape(shape) for v in (f, 2 * power / n, noise, share))


def _noise_dof(n, constant, real):
    """Return the degrees of freedom of the residuals of a tone, which takes three."""
    return n - 3 - constant if real else 2 * n - 3 - 2 * constant


def _energies(records, n, firsts):
    """Return the sum of |x|^2 in each window (R, K)."""
    # Each sum by itself: a difference of running sums would keep the rounding of a loud moment.
    windows = np.lib.stride_tricks.sliding_window_view(
        records.real**2 + records.imag**2, n, axis=-1
    )
    hop = firsts[1] - firsts[0] if len(firsts) > 1 else 1
    return windows[:, : firsts[-1] + 1 : hop].sum(axis=-1)


def _places(records, firsts):
    """Return the shape of the results, and the row and first sample of each window in a line."""
    places = np.broadcast_arrays(np.arange(len(records))[:, None], firsts)
    return places[0].shape, *(v.ravel() for v in places)
