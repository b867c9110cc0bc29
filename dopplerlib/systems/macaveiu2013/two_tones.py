"""FSK and MFSK of Section II: two signals, and the phase between them.

Signals and targets are those of `waveforms`.
"""

import numpy as np

from .published import settings
from .waveforms import C, echoes, tones


def fsk(targets, step=1e6, samples=512, s=None):
    """Return the beat signals of two tones sent in turn (Fig 2).

    Parameters
    ----------
    targets : array_like, shape (targets, 2)
        Range in m and range rate in m/s.
    step : float
        Difference of the two frequencies in Hz.
    samples : int
        Samples of each tone in one measurement of T.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    a, b : ndarray of complex, shape (samples,)
        Tone b is sent half an interval after tone a.
    """
    s = settings() if s is None else s
    t = np.arange(samples) * s.T / samples
    delays = echoes(targets, t), echoes(targets, t + s.T / samples / 2)
    carriers = s.carrier, s.carrier + step
    return tuple(
        np.exp(2j * np.pi * f * delay).sum(axis=0)
        for f, delay in zip(carriers, delays, strict=True)
    )


def fsk_range(a, b, step=1e6, s=None):
    """Return range and range rate of the strongest tone of an FSK measurement.

    Parameters
    ----------
    a, b : ndarray of complex, shape (samples,)
        From `fsk`.
    step : float
        Difference of the two frequencies in Hz.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    r, v : float
        In m and m/s. The range is unambiguous within c / (2 step).
    """
    s = settings() if s is None else s
    rate = len(a) / s.T
    (frequency,) = tones(a, rate, 1)
    phase = _phase_at(b, frequency, rate) - _phase_at(a, frequency, rate)
    v = frequency * C / (2 * s.carrier)
    turns = (phase / (2 * np.pi) - frequency * s.T / len(a) / 2) % 1
    return turns * C / (2 * step), v


def mfsk(targets, steps=512, shift=None, s=None):
    """Return the beat signals of the two interleaved stepped chirps of MFSK (Fig 4).

    Parameters
    ----------
    targets : array_like, shape (targets, 2)
        Range in m and range rate in m/s.
    steps : int
        Number of steps of each chirp, in one measurement of T.
    shift : float, optional
        Frequency of chirp B minus that of chirp A in Hz; half a step downwards if None.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    a, b : ndarray of complex, shape (steps,)
        One sample at the end of each step.
    """
    s = settings() if s is None else s
    n, dwell = np.arange(steps), s.T / (2 * steps)
    up = s.bandwidth / (steps - 1)
    shift = -up / 2 if shift is None else shift
    carriers = s.carrier + up * n, s.carrier + up * n + shift
    times = (2 * n + 1) * dwell, (2 * n + 2) * dwell
    return tuple(
        np.exp(2j * np.pi * f * echoes(targets, t)).sum(axis=0)
        for f, t in zip(carriers, times, strict=True)
    )


def mfsk_relations(steps=512, shift=None, s=None):
    """Return the 2 x 2 system of MFSK: [beat in Hz, phase in turns] = A [r, v].

    Parameters
    ----------
    steps, shift, s
        See `mfsk`.

    Returns
    -------
    ndarray, shape (2, 2)
    """
    s = settings() if s is None else s
    dwell = s.T / (2 * steps)
    up = s.bandwidth / (steps - 1)
    shift = -up / 2 if shift is None else shift
    return (2 / C) * np.array([[up / (2 * dwell), s.carrier], [shift, s.carrier * dwell]])


def mfsk_solve(a, b, count=1, shift=None, s=None):
    """Return range and range rate of the strongest tones of an MFSK measurement.

    Parameters
    ----------
    a, b : ndarray of complex, shape (steps,)
        From `mfsk`.
    count : int
        Number of tones to solve for.
    shift, s
        See `mfsk`.

    Returns
    -------
    ndarray, shape (count, 2)
        Range in m and range rate in m/s. The phase is taken to lie within half a turn.
    """
    s = settings() if s is None else s
    A = mfsk_relations(len(a), shift, s)
    rate = len(a) / s.T
    frequencies = tones(a, rate, count)
    phase = [_phase_at(b, f, rate) - _phase_at(a, f, rate) for f in frequencies]
    turns = (np.array(phase) / (2 * np.pi) + 0.5) % 1 - 0.5
    return np.linalg.solve(A, np.stack([frequencies, turns])).T


def _phase_at(signal, frequency, rate):
    """Return the phase of a tone in a signal at its first sample, in rad."""
    n = np.arange(len(signal))
    window = np.hanning(len(signal))
    return np.angle(np.sum(signal * window * np.exp(-2j * np.pi * frequency / rate * n)))
