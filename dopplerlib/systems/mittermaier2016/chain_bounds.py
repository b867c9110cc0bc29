"""Cramér-Rao bounds on the position: from windows side by side, and from the samples."""

from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Positive, between, checked, covariances, exactly, up_to
from ..._typing import FloatArray
from ...evaluation.bounds import crlb
from ...signal.laws import crlb_frequency_std
from .published import reported

Time = Annotated[float, between(0, 1.1)]  # s: then the target is behind the ring
Echo = Annotated[float, between(1e-9, 1e15)]  # Hz
Rate = Annotated[float, between(1, 1e7)]  # Hz


@checked
def position_bound(
    time: Time,
    window: Annotated[float, between(1e-6, 1)],
    cn0: Echo,
    *,
    first: Time = 0.0,
    samples_per_second: Rate = 100e3,
) -> FloatArray:
    """Return the Cramér-Rao bound on the position at a time, from windows side by side.

    time: In s; the windows end there at the latest.
    window: Length of a window in s.
    cn0: Power of an echo over the noise power in 1 Hz, in Hz.
    first: When the first window begins, in s.
    samples_per_second: Sampling rate in Hz, of little influence.
    Returns (3, 3): Covariance of the position in m^2 at the bound, for the target of Table 2 and
        constant velocity; infinite entries on the diagonal where the windows are too few.

    See Also
    --------
    position_bound_iq : the bound of the samples, which know more than their windows.
    Raises ValueError if a number is out of its range (times 0 to 1.1 s, windows 1e-6 to 1 s, echoes
        1e-9 to 1e15 Hz, rates 1 to 1e7 Hz), or no window fits.

    Notes
    -----
    `crlb` of the moving likelihood with the deviations of `crlb_frequency_std`. It sees the middles
    of the windows only, no chirp inside them.

    Examples
    --------
    >>> bool(position_bound(0.5, 0.05, 1e6)[0, 0] > position_bound_iq(0.5, 1e6)[0, 0])
    True
    """
    s = reported().scenario
    K = int((time - first) / window + 1e-9)
    if K < 1:
        raise ValueError(f"time must leave room for a window of {window} s, got {time}")
    n = max(2, round(window * samples_per_second))
    sigma = crlb_frequency_std(cn0 * window / n, n, n / window)
    middle, F = first + window / 2, np.eye(6)
    F[:3, 3:] = middle * np.eye(3)
    P = crlb(F @ s.x0, s.array, sigma, K, window, "constant_velocity")
    F[:3, 3:] = (time - middle) * np.eye(3)
    return (F @ P @ F.T)[:3, :3]


@checked
def position_bound_iq(
    time: Time, cn0: Echo, *, first: Time = 0.0, samples_per_second: Rate = 2000.0
) -> FloatArray:
    """Return the Cramér-Rao bound on the position at a time, from the IQ samples up to it.

    time: In s; the samples end there.
    cn0: Power of an echo over the noise power in 1 Hz, in Hz.
    first: When the samples begin, in s.
    samples_per_second: Sampling rate in Hz, of little influence.
    Returns (3, 3): Covariance of the position in m^2 at the bound, for the target of Table 2 and
        constant velocity. Amplitude and phase of each sensor's echo are unknown.
    Raises ValueError if a number is out of its range, see `position_bound`, or there are less than
        three samples.

    Notes
    -----
    Slepian-Bangs: with a signal-to-noise ratio of `cn0` over the rate, a sample of phase phi adds
    ``2 snr dphi dphi^T`` to the information on what phi depends on. The phase of sensor n is an
    unknown plus -4 pi r_n / wavelength. The unknown takes the mean of the slopes of r_n away; the
    amplitude takes nothing, as it is in quadrature.

    Examples
    --------
    >>> position_bound_iq(0.5, 1e6).shape
    (3, 3)
    """
    s = reported().scenario
    fs, length = samples_per_second, time - first
    if not length * fs >= 3:
        raise ValueError(f"time must leave room for three samples, got {time}")
    t = first + (np.arange(round(length * fs)) + 0.5) / fs
    path = s.x0[:3] + t[:, None] * s.x0[3:]
    away = path - s.array.positions[:, None]  # (N, n, 3)
    toward = away / np.linalg.norm(away, axis=-1, keepdims=True)
    # The state at the time is unknown: a velocity moves the position of earlier samples back.
    slopes = np.concatenate([toward, (t[:, None] - time) * toward], axis=-1)
    slopes *= 4 * np.pi / s.array.wavelength
    slopes = (slopes - slopes.mean(axis=1, keepdims=True)).reshape(-1, 6)
    scale = np.linalg.norm(slopes, axis=0)
    information = 2 * cn0 / fs * (slopes / scale).T @ (slopes / scale)
    return (np.linalg.inv(information) / np.outer(scale, scale))[:3, :3]


@checked
def record_length(error: Positive, cn0: Echo) -> float:
    """Return the length of record at which the bound on the position falls to an error.

    error: Wanted root mean square of the position error at the end of the record, in m.
    cn0: Power of an echo over the noise power in 1 Hz, in Hz.
    Returns: Length in s at which `position_bound_iq` comes down to `error`, for a record that
        begins with the track of Table 2; infinite if the whole track does not do it.
    Raises ValueError if a number is not positive.

    Examples
    --------
    >>> round(record_length(0.05, 1e6), 2)
    0.07
    """

    def enough(length):
        P = position_bound_iq(length, cn0, samples_per_second=400 / length)
        return np.sqrt(np.trace(P)) <= error

    low, high = 1e-3, float(reported().scenario.time[-1])
    if not enough(high):
        return np.inf
    while high > low * (1 + 1e-6):
        middle = np.sqrt(low * high)
        low, high = (low, middle) if enough(middle) else (middle, high)
    return float(high)


@checked
def median_error(
    P: Annotated[FloatArray, exactly(3, 3, check=covariances)],
    *,
    rng: np.random.Generator,
    draws: Annotated[int, up_to(10**7)] = 20_000,
) -> float:
    """Return the median length of a normal error.

    P (3, 3): Covariance of the error in m^2.
    rng: Source of randomness.
    draws: How many errors are drawn.
    Returns: In m, good to about a percent with 20 000 draws.
    Raises ValueError if `P` is no covariance, `draws` is not positive, or `rng` is not a generator.

    Examples
    --------
    >>> round(median_error(np.eye(3), rng=np.random.default_rng(1)), 1)
    1.5
    """
    _checks.covariance("P", P, 3)
    normal = rng.standard_normal((draws, 3))
    return float(np.median(np.linalg.norm(normal @ np.linalg.cholesky(P).T, axis=-1)))
