"""Radar waveforms: FSK and MFSK, two interleaved signals with the phase between their echoes.

Signals and targets are those of `waveforms`.
"""

from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Positive, checked, up_to
from .._typing import ArrayLike, ComplexArray, FloatArray
from .waveforms import SPEED_OF_LIGHT, ChirpRadar, echo_delays, strongest_tones

_MOST = 2**22  # samples of a signal


@checked
@_checks.quiet
def fsk_beats(
    radar: ChirpRadar,
    targets: ArrayLike,
    *,
    step: Positive = 1e6,
    samples: Annotated[int, up_to(_MOST, 3)] = 512,
) -> tuple[ComplexArray, ComplexArray]:
    """Return the beat signals of two alternating tones.

    Parameters
    ----------
    radar : ChirpRadar
        Whose carrier the first tone has, and whose measurement they fill.
    targets : array_like, shape (2,) or (targets, 2)
        Range in m and range rate in m/s.
    step : float
        Difference of the two frequencies in Hz.
    samples : int
        Samples of each tone in one measurement.

    Returns
    -------
    a, b : ndarray of complex, shape (samples,)
        Tone b is sent half an interval after tone a.

    Examples
    --------
    >>> radar = ChirpRadar(24e9, 150e6, 38e-3)
    >>> a, b = fsk_beats(radar, [30.0, -5.0], samples=64)
    >>> [round(one, 1) for one in fsk_solve(radar, a, b)]
    [29.9, -5.0]
    """
    T = radar.duration
    t = np.arange(samples) * T / samples
    delays = echo_delays(targets, t), echo_delays(targets, t + T / samples / 2)
    a, b = (
        np.exp(2j * np.pi * f * delay).sum(axis=0)
        for f, delay in zip((radar.carrier, radar.carrier + step), delays, strict=True)
    )
    return a, b


@_checks.quiet
def fsk_solve(
    radar: ChirpRadar, a: ArrayLike, b: ArrayLike, *, step: Positive = 1e6
) -> tuple[float, float]:
    """Return range and range rate of the strongest tone of an FSK measurement.

    Parameters
    ----------
    radar : ChirpRadar
        As for `fsk_beats`.
    a, b : array_like of complex, shape (samples,)
        From `fsk_beats`.
    step : float
        Difference of the two frequencies in Hz.

    Returns
    -------
    r, v : float
        In m and m/s. The range is unambiguous within c / (2 step).

    Raises
    ------
    ValueError
        If an argument is not of the kind described, or a signal has no tone.

    Examples
    --------
    >>> radar = ChirpRadar(24e9, 150e6, 38e-3)
    >>> a, b = fsk_beats(radar, [30.0, -5.0], samples=64)
    >>> [round(one, 1) for one in fsk_solve(radar, a, b)]
    [29.9, -5.0]
    """
    a, b, rate = _pair(radar, a, b)
    (frequency,) = strongest_tones(a, rate, 1)
    phase = _phase_at(b, frequency, rate) - _phase_at(a, frequency, rate)
    turns = (phase / (2 * np.pi) - frequency * radar.duration / len(a) / 2) % 1
    return float(turns * SPEED_OF_LIGHT / (2 * step)), float(frequency * radar.wavelength / 2)


@checked
@_checks.quiet
def mfsk_beats(
    radar: ChirpRadar, targets: ArrayLike, *, steps: int = 512, shift: float | None = None
) -> tuple[ComplexArray, ComplexArray]:
    """Return the beat signals of the two interleaved stepped chirps of MFSK.

    Parameters
    ----------
    radar : ChirpRadar
        Whose bandwidth each chirp covers in one measurement.
    targets : array_like, shape (2,) or (targets, 2)
        Range in m and range rate in m/s.
    steps : int
        Number of steps of each chirp.
    shift : float, optional
        Frequency of chirp B minus that of chirp A in Hz; half a step downwards if None.

    Returns
    -------
    a, b : ndarray of complex, shape (steps,)
        One sample at the end of each step.

    Examples
    --------
    >>> radar = ChirpRadar(24e9, 150e6, 38e-3)
    >>> a, b = mfsk_beats(radar, [30.0, -5.0])
    >>> mfsk_solve(radar, a, b).round(1).tolist()
    [[29.9, -5.0]]
    """
    up, dwell, shift = _stepped(radar, steps, shift)
    n = np.arange(steps)
    carriers = radar.carrier + up * n, radar.carrier + up * n + shift
    times = (2 * n + 1) * dwell, (2 * n + 2) * dwell
    a, b = (
        np.exp(2j * np.pi * f * echo_delays(targets, t)).sum(axis=0)
        for f, t in zip(carriers, times, strict=True)
    )
    return a, b


@checked
def mfsk_relations(
    radar: ChirpRadar, *, steps: int = 512, shift: float | None = None
) -> FloatArray:
    """Return the 2 x 2 system of MFSK: [beat in Hz, phase in turns] = A [r, v].

    Parameters
    ----------
    radar : ChirpRadar
        As for `mfsk_beats`.
    steps : int
        Number of steps of each chirp.
    shift : float, optional
        As for `mfsk_beats`.

    Returns
    -------
    ndarray, shape (2, 2)

    Examples
    --------
    >>> mfsk_relations(ChirpRadar(24e9, 150e6, 38e-3))[0].round(1).tolist()
    [26.4, 160.1]
    """
    up, dwell, shift = _stepped(radar, steps, shift)
    rows = [[up / (2 * dwell), radar.carrier], [shift, radar.carrier * dwell]]
    return (2 / SPEED_OF_LIGHT) * np.array(rows)


@_checks.quiet
def mfsk_solve(
    radar: ChirpRadar, a: ArrayLike, b: ArrayLike, count: int = 1, *, shift: float | None = None
) -> FloatArray:
    """Return range and range rate of the strongest tones of an MFSK measurement.

    Parameters
    ----------
    radar : ChirpRadar
        As for `mfsk_beats`.
    a, b : array_like of complex, shape (steps,)
        From `mfsk_beats`.
    count : int
        Number of tones to solve for.
    shift : float, optional
        As for `mfsk_beats`.

    Returns
    -------
    ndarray, shape (count, 2)
        Range in m and range rate in m/s. The phase is taken to lie within half a turn.

    Raises
    ------
    ValueError
        If an argument is not of the kind described, a signal has fewer tones, or the shift leaves
        range and range rate apart in neither.

    Examples
    --------
    >>> radar = ChirpRadar(24e9, 150e6, 38e-3)
    >>> a, b = mfsk_beats(radar, [30.0, -5.0])
    >>> mfsk_solve(radar, a, b).round(1).tolist()
    [[29.9, -5.0]]
    """
    a, b, rate = _pair(radar, a, b)
    A = mfsk_relations(radar, steps=len(a), shift=shift)
    frequencies = strongest_tones(a, rate, count)
    phase = [_phase_at(b, f, rate) - _phase_at(a, f, rate) for f in frequencies]
    turns = (np.array(phase) / (2 * np.pi) + 0.5) % 1 - 0.5
    try:
        found = np.linalg.solve(A, np.stack([frequencies, turns])).T
    except np.linalg.LinAlgError:
        raise ValueError(f"shift must leave two equations for r and v, got {shift}") from None
    return _checks.estimates("radar, shift", found, what="targets")


def _pair(radar, a, b):
    """Return two signals of one length as arrays, and their sampling rate in Hz."""
    _checks.instance("radar", radar, ChirpRadar)
    a = _checks.one_row("a", a, _checks.finite_complex, least=3)
    b = _checks.one_row("b", b, _checks.finite_complex, least=3)
    if len(a) != len(b):
        raise ValueError(f"b must be as long as a with {len(a)} samples, got {len(b)}")
    return a, b, len(a) / radar.duration


def _stepped(radar, steps, shift):
    """Return the step of a chirp in Hz, its duration in s, and the shift in Hz."""
    _checks.instance("radar", radar, ChirpRadar)
    steps = _checks.count("steps", steps, _MOST, least=3)
    up = radar.bandwidth / (steps - 1)
    shift = -up / 2 if shift is None else _checks.one_number("shift", shift, _checks.moderate)
    return up, radar.duration / (2 * steps), shift


def _phase_at(signal, frequency, rate):
    """Return the phase of a tone in a signal at its first sample, in rad."""
    n = np.arange(len(signal))
    window = np.hanning(len(signal))
    return np.angle(np.sum(signal * window * np.exp(-2j * np.pi * frequency / rate * n)))
