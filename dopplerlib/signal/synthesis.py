"""Simulated IQ samples: tones, radial velocities, paths in front of an array."""

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Positive, checked, up_to
from .._typing import ArrayLike, ComplexArray, FloatArray
from ..model.doppler import check_clear_of_sensors
from ..model.radar_array import RadarArray

_AMPLITUDES = {"constant": 0, "r^-2": -2}


def velocity_profile(
    t: ArrayLike, v0: float, segments: Sequence[tuple[float, float, float]]
) -> tuple[FloatArray, FloatArray]:
    """Return a velocity with constant acceleration in some intervals and none between them.

    Parameters
    ----------
    t : array_like, shape (n,)
        Times in s.
    v0 : float
        Velocity before the first segment in m/s.
    segments : iterable of tuple (float, float, float)
        Start and end in s, and acceleration between them in m/s^2. Where segments overlap,
        their accelerations add up.

    Returns
    -------
    v : ndarray, shape (n,)
        Velocity in m/s, exact at each time.
    a : ndarray, shape (n,)
        Acceleration in m/s^2; at a start that of the segment, at an end what follows.

    Raises
    ------
    ValueError
        If a value is not finite or beyond 1e60, or a segment does not end after its start.

    Examples
    --------
    From 250 m/s, for one second 10 m/s^2 slower:

    >>> v, a = velocity_profile([0, 1, 1.5, 2, 3], 250, [(1, 2, -10)])
    >>> v.tolist(), a.tolist()
    ([250.0, 250.0, 245.0, 240.0, 240.0], [0.0, -10.0, -10.0, 0.0, 0.0])
    """
    t = _checks.moderate("t", t, (None,))
    v = np.full(t.shape, _checks.one_number("v0", v0, _checks.moderate))
    a = np.zeros(t.shape)
    for i, segment in enumerate(_checks.iterable("segments", segments)):
        numbers = _checks.moderate(f"segments[{i}]", segment, (3,))
        if numbers.ndim > 1:
            raise ValueError(f"segments[{i}] must be three numbers, got shape {numbers.shape}")
        start, end, acceleration = numbers.tolist()
        if not start < end:
            raise ValueError(f"segments[{i}] must end after its start, got {segment}")
        v += acceleration * (np.clip(t, start, end) - start)
        a += acceleration * ((t >= start) & (t < end))
    return v, a


@checked
def complex_noise(
    shape: int | tuple[int, ...], variance: float, *, rng: np.random.Generator
) -> ComplexArray:
    """Return circular white Gaussian noise.

    Parameters
    ----------
    shape : int or tuple of int
        Shape of the result.
    variance : float
        Variance of a complex sample; I and Q have half of it each.
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    ndarray of complex, shape `shape`

    Examples
    --------
    >>> noise = complex_noise(10000, 2.0, rng=np.random.default_rng(1))
    >>> round(float(np.mean(np.abs(noise) ** 2)), 1)
    2.0
    """
    if variance < 0:
        raise ValueError(f"variance must not be negative, got {variance}")
    noise = rng.standard_normal((*_checks.shape("shape", shape), 2)).view(complex)[..., 0]
    noise *= np.sqrt(variance / 2)
    return noise


@checked
def tone(
    f: ArrayLike,
    fs: Positive,
    n: Annotated[int, up_to(2**40)],
    snr_db: float | None,
    *,
    rng: np.random.Generator,
    chirp: ArrayLike = 0.0,
) -> ComplexArray:
    """Return tones of amplitude 1 and random phase in white noise.

    Parameters
    ----------
    f : array_like, shape (...)
        Frequency at the middle of the window in Hz.
    fs : float
        Sampling rate in Hz.
    n : int
        Number of samples.
    snr_db : float or None
        Power of the tone over the variance of a complex noise sample in dB; None for no noise.
    rng : numpy.random.Generator
        Source of the phases and of the noise.
    chirp : array_like, broadcast to (...)
        Rate of change of the frequency in Hz/s.

    Returns
    -------
    ndarray of complex, shape (..., n)

    Examples
    --------
    >>> x = tone(250.0, 1000.0, 4, None, rng=np.random.default_rng(1))
    >>> np.allclose(x / x[0], [1, 1j, -1, -1j])
    True
    """
    f, chirp = _checks.moderate("f", f), _checks.moderate("chirp", chirp)
    _checks.check_broadcast("chirp", chirp.shape, "f", f.shape)
    f, chirp = np.broadcast_arrays(f, chirp)
    t = (np.arange(n) - (n - 1) / 2) / fs
    cycles = f[..., None] * t + chirp[..., None] * t**2 / 2
    return _signal(cycles, 1.0, snr_db, rng)


@checked
def iq_from_velocity(
    v: ArrayLike,
    T: Positive,
    wavelength: Positive,
    snr_db: float | None,
    *,
    rng: np.random.Generator,
    size: int | None = None,
) -> ComplexArray:
    """Return the IQ samples of one sensor for a radial velocity.

    Parameters
    ----------
    v : array_like, shape (..., n)
        Speed of approach at each sample in m/s; between samples it is taken to be linear.
    T : float
        Sampling interval in s.
    wavelength : float
        In m.
    snr_db : float or None
        Power of the signal, of amplitude 1, over the variance of a noise sample in dB; None for
        no noise.
    rng : numpy.random.Generator
        Source of the start phases and of the noise.
    size : int, optional
        Number of independent records.

    Returns
    -------
    ndarray of complex, shape (..., n) or (size, ..., n)
        Doppler frequencies 2 v / wavelength, positive when the target approaches.

    Examples
    --------
    >>> x = iq_from_velocity([1.0, 1.0], 1 / 640, 0.0125, None, rng=np.random.default_rng(1))
    >>> complex((x[1] / x[0]).round(12))  # a quarter turn: 160 Hz
    1j
    """
    v = _checks.moderate("v", v, (None,))
    cycles = np.zeros(v.shape)
    np.cumsum((v[..., 1:] + v[..., :-1]) * (T / wavelength), axis=-1, out=cycles[..., 1:])
    return _signal(cycles, 1.0, snr_db, rng, size)


@checked
def iq_from_geometry(
    position: ArrayLike,
    array: RadarArray,
    snr_db: float | None,
    *,
    rng: np.random.Generator,
    amplitude: Literal["constant", "r^-2"] = "constant",
    size: int | None = None,
) -> ComplexArray:
    """Return the IQ samples of every sensor of an array for a target on a path.

    Parameters
    ----------
    position : array_like, shape (..., n, 3)
        Position of the target at each sample in m.
    array : RadarArray
        The N sensors.
    snr_db : float or None
        Power of the signal over the variance of a complex noise sample in dB; with
        ``amplitude="r^-2"`` it holds at a range of one meter. None for no noise.
    rng : numpy.random.Generator
        Source of the start phases, one for each sensor and record, and of the noise.
    amplitude : {"constant", "r^-2"}
        1 at every range, or the inverse square of the range in m, as the radar equation gives
        it for a small target.
    size : int, optional
        Number of independent records of the same path.

    Returns
    -------
    ndarray of complex, shape (..., N, n) or (size, ..., N, n)

    Notes
    -----
    The wave travels the range r twice, so its phase is -4 pi r / wavelength, and its derivative
    is 2 pi times the Doppler shift of Eq 6 of Mittermaier et al. (2016): positive when the
    target approaches.

    Examples
    --------
    One millimeter nearer is 0.16 cycles of 12.5 mm, there and back:

    >>> from dopplerlib import RadarArray
    >>> x = iq_from_geometry(
    ...     [[1, 0, 0], [0.999, 0, 0]], RadarArray([[0, 0, 0]]), None, rng=np.random.default_rng(1)
    ... )
    >>> x.shape, round(float(np.angle(x[0, 1] / x[0, 0]) / (2 * np.pi)), 3)
    ((1, 2), 0.16)
    """
    position = _checks.moderate("position", position, (None, 3))
    power = _AMPLITUDES[amplitude]
    check_clear_of_sensors("position", position, array)
    r = np.linalg.norm(position[..., None, :, :] - array.positions[:, None], axis=-1)
    return _signal(-2 * r / array.wavelength, r**power, snr_db, rng, size)


def _signal(cycles, amplitude, snr_db, rng, size=None):
    """Return amplitude exp(2 pi j cycles) with a random phase for each record, and noise."""
    if size is not None:
        cycles = np.broadcast_to(cycles, (_checks.count("size", size, 2**40), *cycles.shape))
    start = rng.uniform(size=(*cycles.shape[:-1], 1))
    x = amplitude * np.exp(2j * np.pi * (cycles + start))
    if snr_db is not None:
        snr_db = _checks.one_number("snr_db", snr_db, _checks.decibels)
        x += complex_noise(x.shape, 10 ** (-snr_db / 10), rng=rng)
    return x
