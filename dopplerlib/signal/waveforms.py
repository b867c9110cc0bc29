"""Radar waveforms: pulse trains, linear chirps and rapid chirps.

All signals are at complex baseband, after mixing with what is sent (the pulse: with the carrier).
Targets are rows of range in m and range rate in m/s, positive when receding; echoes have amplitude
1. The phase is that of the exact delay 2 (r + v t) / c at every instant, so that the textbook
relations for beat frequencies, which the estimators invert, are approximations here too. All
echoes together have at most 33 million samples.
"""

from collections.abc import Iterable
from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Positive, Real, checked, up_to
from .._records import record
from .._typing import ArrayLike, ComplexArray, FloatArray

SPEED_OF_LIGHT = 299_792_458.0  # m/s
_MOST = 2**25  # samples of all targets together


@checked
@record
class ChirpRadar:
    """Bandwidth and duration of the sweep of a chirp radar.

    Attributes
    ----------
    carrier : float
        Frequency at which a sweep begins, in Hz.
    bandwidth : float
        In Hz.
    duration : float
        Length of one measurement in s.

    Examples
    --------
    >>> radar = ChirpRadar(carrier=24e9, bandwidth=150e6, duration=38e-3)
    >>> round(radar.range_resolution, 2), round(radar.speed_resolution, 2)
    (1.0, 0.16)
    >>> round(radar.speed_limit(chirps=512))
    42
    """

    carrier: Positive
    bandwidth: Positive
    duration: Positive

    @property
    def wavelength(self) -> float:
        """Wavelength of the carrier in m."""
        return SPEED_OF_LIGHT / self.carrier

    @property
    def range_resolution(self) -> float:
        """Smallest difference of two ranges that a sweep separates, c / (2 B), in m."""
        return SPEED_OF_LIGHT / 2 / self.bandwidth

    @property
    def speed_resolution(self) -> float:
        """Smallest difference of two range rates, lambda / (2 T), in m/s."""
        return self.wavelength / 2 / self.duration

    @checked
    def speed_limit(self, chirps: Annotated[int, up_to(_MOST)] = 512) -> float:
        """Return the largest unambiguous range rate in m/s of a number of rapid chirps.

        A Doppler shift of half the rate of the chirps: lambda / (4 T_chirp).
        """
        return self.wavelength * chirps / (4 * self.duration)


@checked
@_checks.quiet
def echo_delays(targets: ArrayLike, time: ArrayLike) -> FloatArray:
    """Return the delays of the echoes of all targets.

    Parameters
    ----------
    targets : array_like, shape (2,) or (targets, 2)
        Range in m at time zero and range rate in m/s.
    time : array_like, shape (...)
        Times in s.

    Returns
    -------
    ndarray, shape (targets, ...)
        Delays in s; the axes after the first are those of `time`.

    Examples
    --------
    >>> echo_delays([[150.0, 0.0], [300.0, 10.0]], [0.0, 1.0]).round(9).tolist()
    [[1.001e-06, 1.001e-06], [2.001e-06, 2.068e-06]]
    """
    targets = np.atleast_2d(_checks.moderate("targets", targets, (2,)))
    targets = _checks.one_matrix("targets", targets)
    time = _checks.moderate("time", time)
    _checks.count("targets times time", max(len(targets) * time.size, 1), _MOST)
    r, v = targets[:, :1], targets[:, 1:]
    delays = (2 / SPEED_OF_LIGHT) * (r + v * np.ravel(time))
    return delays.reshape(len(targets), *time.shape)


@checked
@_checks.quiet
def pulse_train(
    radar: ChirpRadar,
    targets: ArrayLike,
    *,
    pulses: Annotated[int, up_to(_MOST)] = 64,
    interval: Positive = 20e-6,
    rate: Positive = 600e6,
    reach: Positive = 120.0,
) -> tuple[FloatArray, ComplexArray]:
    """Return the echoes of short rectangular pulses, one row for each pulse.

    Parameters
    ----------
    radar : ChirpRadar
        A pulse is as long as its range resolution asks for: 1 / B.
    targets : array_like, shape (2,) or (targets, 2)
        Range in m and range rate in m/s.
    pulses : int
        Number of pulses.
    interval : float
        Time between pulses in s.
    rate : float
        Sampling rate in Hz.
    reach : float
        Largest range that is recorded, in m.

    Returns
    -------
    distance : ndarray, shape (samples,)
        Range in m that the time of each sample stands for.
    signal : ndarray of complex, shape (pulses, samples)

    Examples
    --------
    >>> radar = ChirpRadar(24e9, 150e6, 38e-3)
    >>> distance, signal = pulse_train(radar, [30.0, -5.0], pulses=2)
    >>> distance[np.abs(signal[0]) > 0].round(1).tolist()
    [30.2, 30.5, 30.7, 31.0]
    """
    samples = 2 * reach / SPEED_OF_LIGHT * rate
    if not 0.5 < samples * pulses < _MOST or samples < 0.5:
        raise ValueError(
            f"rate must give one sample within reach or more, and {_MOST} of all pulses or less, "
            f"got {samples:g} of each of {pulses} pulses"
        )
    fast = np.arange(round(samples)) / rate
    delay = echo_delays(targets, np.arange(pulses) * interval)[..., None]
    _checks.count("targets times samples", max(delay.size * len(fast), 1), _MOST)
    inside = (fast >= delay) & (fast < delay + 1 / radar.bandwidth)
    echo = np.sum(inside * np.exp(-2j * np.pi * radar.carrier * delay), axis=0)
    return fast * SPEED_OF_LIGHT / 2, echo


@checked
@_checks.quiet
def chirp_beat(
    radar: ChirpRadar,
    targets: ArrayLike,
    slope: Real,
    *,
    duration: Positive | None = None,
    samples: Annotated[int, up_to(_MOST)] = 1024,
    begin: Real = 0.0,
) -> ComplexArray:
    """Return the beat signal of one linear chirp: the transmitted signal times the conjugate echo.

    Parameters
    ----------
    radar : ChirpRadar
        Whose carrier the chirp begins at.
    targets : array_like, shape (2,) or (targets, 2)
        Range in m and range rate in m/s at time zero.
    slope : float
        Sweep rate in Hz/s, negative downwards.
    duration : float, optional
        Length of the chirp in s; that of the measurement if None.
    samples : int
        Number of samples.
    begin : float
        When the chirp begins, in s.

    Returns
    -------
    ndarray of complex, shape (samples,)
        Each target gives nearly a tone, see `chirp_relation`.

    Examples
    --------
    >>> radar = ChirpRadar(24e9, 150e6, 38e-3)
    >>> signal = chirp_beat(radar, [30.0, 0.0], 150e6 / 38e-3)
    >>> bool(np.allclose(np.abs(signal), 1))
    True
    """
    T = radar.duration if duration is None else duration
    t = np.arange(samples) * T / samples
    delay = echo_delays(targets, begin + t)
    # phi(t) - phi(t - delay) with phi(t) = 2 pi (f0 t + slope t^2 / 2)
    cycles = radar.carrier * delay + slope * delay * (t - delay / 2)
    return np.exp(2j * np.pi * cycles).sum(axis=0)


@checked
def chirp_relation(radar: ChirpRadar, slope: Real) -> FloatArray:
    """Return the row [a, b] with beat frequency = a r + b v of a chirp.

    Parameters
    ----------
    radar : ChirpRadar
        Whose carrier the chirp begins at.
    slope : float
        Sweep rate in Hz/s.

    Returns
    -------
    ndarray, shape (2,)
        In Hz per m and Hz per m/s.

    Examples
    --------
    >>> chirp_relation(ChirpRadar(24e9, 150e6, 38e-3), 150e6 / 38e-3).round(1).tolist()
    [26.3, 160.1]
    """
    return np.array([2 * slope / SPEED_OF_LIGHT, 2 * radar.carrier / SPEED_OF_LIGHT])


@_checks.quiet
def strongest_tones(signal: ArrayLike, rate: float, count: int) -> FloatArray:
    """Return the frequencies of the strongest tones of a signal.

    Parameters
    ----------
    signal : array_like of complex, shape (samples,)
        Sum of tones.
    rate : float
        Sampling rate in Hz.
    count : int
        How many tones to look for.

    Returns
    -------
    ndarray, shape (count,)
        In Hz, from low to high: the peaks of the windowed spectrum, padded to 16 times its length.

    Raises
    ------
    ValueError
        If an argument is not of the kind described, or the spectrum has fewer peaks.

    Examples
    --------
    >>> n = np.arange(256)
    >>> signal = np.exp(2j * np.pi * 0.1 * n) + np.exp(2j * np.pi * 0.3 * n)
    >>> strongest_tones(signal, 1000.0, 2).round().tolist()
    [100.0, 300.0]
    """
    signal = _checks.one_row("signal", signal, _checks.finite_complex, least=3)
    rate, count = _checks.moderate_number("rate", rate), _checks.count("count", count, _MOST)
    n = 16 * len(signal)
    power = np.abs(np.fft.fft(signal * np.hanning(len(signal)), n))
    _checks.estimates("signal", power, what="powers")
    peaks = np.flatnonzero((power > np.roll(power, 1)) & (power >= np.roll(power, -1)))
    if len(peaks) < count:
        raise ValueError(f"signal must have a spectrum of {count} peaks, got {len(peaks)}")
    best = peaks[np.argsort(power[peaks])[-count:]]
    return np.sort(np.fft.fftfreq(n, 1 / rate)[best])


@checked
@_checks.quiet
def chirp_intersections(
    relations: ArrayLike, frequencies: Iterable[ArrayLike]
) -> tuple[FloatArray, FloatArray]:
    """Return the intersections in range and range rate of the tones of the first two chirps.

    Parameters
    ----------
    relations : array_like, shape (chirps, 2)
        From `chirp_relation`: of two chirps or more, the first two with different slopes.
    frequencies : iterable of array_like, shape (tones,)
        The tones of each chirp in Hz.

    Returns
    -------
    targets : ndarray, shape (pairs, 2)
        Range in m and range rate in m/s. With n targets, n^2 - n of them are ghosts.
    misfit : ndarray, shape (pairs,)
        Largest distance of the predicted tone from the nearest one in the other chirps, in Hz; zero
        if there are only two.

    Examples
    --------
    Two slopes, up and down, and two targets: two of four are ghosts.

    >>> relations = np.array([[26.0, 160.0], [-26.0, 160.0]])
    >>> targets = np.array([[30.0, -5.0], [40.0, 4.0]])
    >>> found, _ = chirp_intersections(relations, [targets @ row for row in relations])
    >>> len(found)
    4
    """
    relations = _checks.matrix("relations", relations, (None, 2))
    tones = [
        _checks.one_row(f"frequencies[{i}]", one)
        for i, one in enumerate(_checks.iterable("frequencies", frequencies))
    ]
    if len(relations) < 2 or len(tones) != len(relations):
        raise ValueError(
            f"frequencies must be those of each of two chirps or more, got {len(tones)} for "
            f"{len(relations)} relations"
        )
    first, second = np.meshgrid(*tones[:2], indexing="ij")
    try:
        targets = np.linalg.solve(relations[:2], np.stack([first.ravel(), second.ravel()])).T
    except np.linalg.LinAlgError:
        raise ValueError(
            f"relations must differ in slope, got {relations[:2].tolist()} of the first two chirps"
        ) from None
    misfit = np.zeros(len(targets))
    for relation, there in zip(relations[2:], tones[2:], strict=True):
        off = np.abs((targets @ relation)[:, None] - there)
        misfit = np.maximum(misfit, off.min(axis=1))
    return _checks.estimates("relations, frequencies", targets, misfit, what="targets")


@checked
def rapid_chirps(
    radar: ChirpRadar,
    targets: ArrayLike,
    *,
    chirps: Annotated[int, up_to(_MOST)] = 512,
    samples: int = 256,
) -> ComplexArray:
    """Return the beat signals of a sequence of fast chirps, one row for each.

    Parameters
    ----------
    radar : ChirpRadar
        Each chirp sweeps its bandwidth; together they last as long as its measurement.
    targets : array_like, shape (2,) or (targets, 2)
        Range in m and range rate in m/s.
    chirps : int
        Number of chirps in one measurement.
    samples : int
        Samples of each chirp.

    Returns
    -------
    ndarray of complex, shape (chirps, samples)

    Examples
    --------
    >>> rapid_chirps(ChirpRadar(24e9, 150e6, 38e-3), [20.0, 3.0], chirps=8, samples=4).shape
    (8, 4)
    """
    _checks.count("chirps times samples", chirps * samples, _MOST)
    one = radar.duration / chirps
    return np.stack([
        chirp_beat(
            radar, targets, radar.bandwidth / one, duration=one, samples=samples, begin=begin
        )
        for begin in np.arange(chirps) * one
    ])  # fmt: skip


@checked
@_checks.quiet
def range_doppler_map(
    radar: ChirpRadar, signal: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the range-Doppler map: an FFT of each chirp, then one across the chirps.

    Parameters
    ----------
    radar : ChirpRadar
        As for `rapid_chirps`.
    signal : array_like of complex, shape (chirps, samples)
        From `rapid_chirps`: three chirps or more, of three samples or more.

    Returns
    -------
    r : ndarray, shape (samples / 2,)
        Ranges in m.
    v : ndarray, shape (chirps,)
        Range rates in m/s, within the `speed_limit` of the radar.
    power : ndarray, shape (chirps, samples / 2)
        In dB; a single echo has a peak of 0 dB.

    Examples
    --------
    >>> radar = ChirpRadar(24e9, 150e6, 38e-3)
    >>> r, v, power = range_doppler_map(radar, rapid_chirps(radar, [20.0, 3.0], chirps=64))
    >>> [round(one) for one in strongest_cell(r, v, power)]
    [20, 3]
    """
    signal = _checks.one_matrix("signal", _checks.finite_complex("signal", signal, (None, None)))
    chirps, samples = signal.shape
    if min(signal.shape) < 3:
        raise ValueError(f"signal must have 3 chirps of 3 samples or more, got {signal.shape}")
    window = np.hanning(chirps)[:, None] * np.hanning(samples)
    spectrum = np.fft.fftshift(np.fft.fft2(signal * window / window.sum()), axes=0)
    _checks.estimates("signal", spectrum, what="powers")
    v = np.fft.fftshift(np.fft.fftfreq(chirps, radar.duration / chirps)) * radar.wavelength / 2
    # The second FFT sees the Doppler shift alone. The first sees it as well, as r + v f0 T / B.
    r = np.arange(samples // 2) * radar.range_resolution
    return r, v, 20 * np.log10(np.abs(spectrum[:, : samples // 2]) + 1e-12)


@checked
def occupied_cells(power: ArrayLike, drop: float = 10.0) -> tuple[int, int]:
    """Return the number of cells that an echo occupies in range and in range rate.

    Parameters
    ----------
    power : array_like, shape (range rates, ranges)
        In dB; a part of a map with one target in it.
    drop : float
        Cells count that are no weaker than the strongest one by more than this, in dB.

    Returns
    -------
    ranges, rates : int
        Columns and rows that hold such a cell.

    Examples
    --------
    >>> occupied_cells([[-30.0, -9.0], [-30.0, 0.0], [-30.0, -8.0]])
    (1, 3)
    """
    power = _cells(power)
    strong = power >= power.max() - drop
    return int(strong.any(axis=0).sum()), int(strong.any(axis=1).sum())


@checked
def strongest_cell(r: ArrayLike, v: ArrayLike, power: ArrayLike) -> tuple[float, float]:
    """Return range and range rate of the highest peak of a range-Doppler map.

    Parameters
    ----------
    r : array_like, shape (ranges,)
        Ranges in m.
    v : array_like, shape (range rates,)
        In m/s.
    power : array_like, shape (range rates, ranges)
        From `range_doppler_map`.

    Returns
    -------
    r, v : float
        In m and m/s.

    Examples
    --------
    >>> strongest_cell([0.0, 1.0], [-2.0, 0.0, 2.0], [[-9, -9], [-9, -3], [-9, 0]])
    (1.0, 2.0)
    """
    power = _cells(power)
    r, v = _checks.one_row("r", r), _checks.one_row("v", v)
    _checks.exact_shape("power", power, (len(v), len(r)))
    i, j = np.unravel_index(power.argmax(), power.shape)
    return float(r[j]), float(v[i])


def _cells(power):
    power = _checks.matrix("power", power, (None, None))
    if not power.size:
        raise ValueError(f"power must have a cell, got shape {power.shape}")
    return power
