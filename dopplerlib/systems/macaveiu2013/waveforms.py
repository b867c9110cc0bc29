"""Pulses and chirps of Section II on simulated signals: what they measure, and what they confuse.

All signals are at complex baseband, after mixing with what is sent (the pulse: with the carrier).
Targets are rows of range in m and range rate in m/s, positive when receding; echoes have equal
strength. The phase is that of the exact delay 2 (r + v t) / c at every instant, so that the
textbook relations for beat frequencies, which the estimators invert, are approximations here too.
"""

import numpy as np

from .published import settings

C = 299_792_458.0  # m/s

# What is shown to the waveforms; ours.
SLOPES = (1.0, -1.0, 0.6, -0.3)  # of several chirps, in units of the bandwidth over T
CAR = np.stack([np.linspace(18, 22, 5), np.full(5, 10 / 3.6)], axis=-1)  # five points, 10 km/h
PEDESTRIAN = np.array([[12.0, v] for v in (-1.5, -0.7, 0.2, 0.8, 1.5)])  # torso, arms and legs


def noisy(signal, snr_db, *, rng):
    """Return a signal with white complex noise.

    Parameters
    ----------
    signal : ndarray of complex
        Sum of echoes, each of amplitude 1.
    snr_db : float
        Power of one echo over that of the noise, for each sample, in dB.
    rng : numpy.random.Generator
        Source of the noise.

    Returns
    -------
    ndarray of complex
    """
    deviation = np.sqrt(0.5 * 10 ** (-snr_db / 10))
    shape = (2, *signal.shape)
    return signal + deviation * np.tensordot([1, 1j], rng.standard_normal(shape), 1)


def echoes(targets, time):
    """Return the delays of the echoes of all targets.

    Parameters
    ----------
    targets : array_like, shape (targets, 2)
        Range in m at time zero and range rate in m/s.
    time : array_like
        Times in s, of any shape.

    Returns
    -------
    ndarray, shape (targets, ...)
        Delays in s; the axes after the first are those of `time`.
    """
    targets = np.atleast_2d(np.asarray(targets, float))
    r, v = targets[:, :1], targets[:, 1:]
    return (2 / C) * (r + v * np.ravel(time)).reshape(len(targets), *np.shape(time))


def pulse_train(targets, pulses=64, interval=20e-6, rate=600e6, reach=120.0, s=None):
    """Return the echoes of short rectangular pulses, one row for each pulse (Fig 1).

    Parameters
    ----------
    targets : array_like, shape (targets, 2)
        Range in m and range rate in m/s.
    pulses : int
        Number of pulses.
    interval : float
        Time between pulses in s.
    rate : float
        Sampling rate in Hz.
    reach : float
        Largest range that is recorded, in m.
    s : Settings, optional
        Those of the data file if None: a pulse is as long as the range resolution asks for.

    Returns
    -------
    distance : ndarray, shape (samples,)
        Range in m that the time of each sample stands for.
    signal : ndarray of complex, shape (pulses, samples)
    """
    s = settings() if s is None else s
    width = 2 * s.range_resolution / C
    fast = np.arange(round(2 * reach / C * rate)) / rate
    delay = echoes(targets, np.arange(pulses) * interval)[..., None]
    inside = (fast >= delay) & (fast < delay + width)
    return fast * C / 2, np.sum(inside * np.exp(-2j * np.pi * s.carrier * delay), axis=0)


def chirp_beat(targets, slope, duration, samples, begin=0.0, s=None):
    """Return the beat signal of one linear chirp: what was sent times the conjugate echo (Fig 2).

    Parameters
    ----------
    targets : array_like, shape (targets, 2)
        Range in m and range rate in m/s at time zero.
    slope : float
        Sweep rate in Hz/s, negative downwards.
    duration : float
        Length of the chirp in s.
    samples : int
        Number of samples.
    begin : float
        When the chirp begins, in s.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    ndarray of complex, shape (samples,)
        Each target gives nearly a tone, see `chirp_relation`.
    """
    s = settings() if s is None else s
    t = np.arange(samples) * duration / samples
    delay = echoes(targets, begin + t)
    # phi(t) - phi(t - delay) with phi(t) = 2 pi (f0 t + slope t^2 / 2)
    cycles = s.carrier * delay + slope * delay * (t - delay / 2)
    return np.exp(2j * np.pi * cycles).sum(axis=0)


def chirp_relation(slope, s=None):
    """Return the row [a, b] with beat frequency = a r + b v of a chirp.

    Parameters
    ----------
    slope : float
        Sweep rate in Hz/s.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    ndarray, shape (2,)
        In Hz per m and Hz per m/s.
    """
    s = settings() if s is None else s
    return np.array([2 * slope / C, 2 * s.carrier / C])


def tones(signal, rate, count):
    """Return the frequencies of the strongest tones of a signal.

    Parameters
    ----------
    signal : ndarray of complex, shape (samples,)
        Sum of tones.
    rate : float
        Sampling rate in Hz.
    count : int
        How many tones to look for.

    Returns
    -------
    ndarray, shape (count,)
        In Hz, from low to high: the peaks of the windowed spectrum, padded to 16 times its length.
    """
    n = 16 * len(signal)
    power = np.abs(np.fft.fft(signal * np.hanning(len(signal)), n))
    peaks = np.flatnonzero((power > np.roll(power, 1)) & (power >= np.roll(power, -1)))
    best = peaks[np.argsort(power[peaks])[-count:]]
    return np.sort(np.fft.fftfreq(n, 1 / rate)[best])


def intersections(relations, frequencies):
    """Return every target that explains one tone of each of the first two chirps.

    Parameters
    ----------
    relations : ndarray, shape (chirps, 2)
        From `chirp_relation`.
    frequencies : sequence of ndarray
        The tones of each chirp in Hz.

    Returns
    -------
    targets : ndarray, shape (pairs, 2)
        Range in m and range rate in m/s. With n targets, n^2 - n of them are ghosts.
    misfit : ndarray, shape (pairs,)
        Largest distance of the predicted tone from the nearest one in the other chirps, in Hz; zero
        if there are only two.
    """
    first, second = np.meshgrid(frequencies[0], frequencies[1], indexing="ij")
    pairs = np.stack([first.ravel(), second.ravel()])
    targets = np.linalg.solve(relations[:2], pairs).T
    misfit = np.zeros(len(targets))
    for relation, tones_there in zip(relations[2:], frequencies[2:], strict=True):
        off = np.abs((targets @ relation)[:, None] - np.asarray(tones_there))
        misfit = np.maximum(misfit, off.min(axis=1))
    return targets, misfit


def rapid_chirps(targets, chirps=512, samples=256, s=None):
    """Return the beat signals of a sequence of fast chirps, one row for each (Fig 5).

    Parameters
    ----------
    targets : array_like, shape (targets, 2)
        Range in m and range rate in m/s.
    chirps : int
        Number of chirps in one measurement of T.
    samples : int
        Samples of each chirp.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    ndarray of complex, shape (chirps, samples)
    """
    s = settings() if s is None else s
    one = s.T / chirps
    begins = np.arange(chirps) * one
    return np.stack([chirp_beat(targets, s.bandwidth / one, one, samples, t, s) for t in begins])


def range_doppler_map(signal, s=None):
    """Return power over range and range rate: an FFT of each chirp, then one across the chirps.

    Parameters
    ----------
    signal : ndarray of complex, shape (chirps, samples)
        From `rapid_chirps`.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    r : ndarray, shape (samples / 2,)
        Ranges in m.
    v : ndarray, shape (chirps,)
        Range rates in m/s, within `speed_limit`.
    power : ndarray, shape (chirps, samples / 2)
        In dB; a single echo has a peak of 0 dB.
    """
    s = settings() if s is None else s
    chirps, samples = signal.shape
    window = np.hanning(chirps)[:, None] * np.hanning(samples)
    spectrum = np.fft.fftshift(np.fft.fft2(signal * window / window.sum()), axes=0)
    v = np.fft.fftshift(np.fft.fftfreq(chirps, s.T / chirps)) * C / (2 * s.carrier)
    # The second FFT sees the Doppler shift alone. The first sees it as well, as r + v f0 T / B.
    r = np.arange(samples // 2) * C / (2 * s.bandwidth)
    return r, v, 20 * np.log10(np.abs(spectrum[:, : samples // 2]) + 1e-12)


def speed_limit(chirps=512, s=None):
    """Return the largest range rate that a sequence of chirps measures without ambiguity, in m/s.

    Parameters
    ----------
    chirps : int
        Number of chirps in one measurement of T.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    float
        lambda / (4 T_chirp): a Doppler shift of half the rate of the chirps.
    """
    s = settings() if s is None else s
    return C / s.carrier * chirps / (4 * s.T)


def spread(power, drop=10.0):
    """Return how many cells of a map an echo fills, in range and in range rate.

    Parameters
    ----------
    power : ndarray, shape (range rates, ranges)
        In dB; a part of a map with one target in it.
    drop : float
        Cells count that are no weaker than the strongest one by more than this, in dB.

    Returns
    -------
    ranges, rates : int
        Columns and rows that hold such a cell.
    """
    strong = power >= power.max() - drop
    return int(strong.any(axis=0).sum()), int(strong.any(axis=1).sum())


def strongest(r, v, power):
    """Return range and range rate of the highest peak of a map.

    Parameters
    ----------
    r, v, power : ndarray
        From `range_doppler_map`.

    Returns
    -------
    r, v : float
        In m and m/s.
    """
    i, j = np.unravel_index(power.argmax(), power.shape)
    return float(r[j]), float(v[i])
