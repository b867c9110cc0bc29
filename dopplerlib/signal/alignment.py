"""Offset and rate between the clocks of two recorders, from what both of them have recorded."""

from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import AboveZero, Count, Number, Positive, Probability, Real, checked, up_to
from .._records import record
from .._typing import ArrayLike

_FINE = 16  # places in a sample at which a peak is looked for, before a parabola
_AROUND = 32  # samples on either side of a peak from which these are interpolated
_MARGIN = 4  # samples beside those by which the clocks may have run apart
_LEAST = 64  # samples of a part
_STILL = 1e-12  # of the energy of the whole
_SURE = 1e-3  # samples: so much interpolation leaves


@checked
@record
class ClockOffset:
    """Offset between the clocks of two recorders, and how it changes.

    Attributes
    ----------
    delay : float
        By how many seconds the second record began after the first.
    delay_std : float
        Standard deviation in s, for white noise.
    rate_ppm : float
        By how many millionths the clock of the second recorder is faster; NaN if fewer than three
        parts of the records tell their offset, and `delay` is that in their middle then.
    rate_std_ppm : float
        Its standard deviation; NaN as above.
    used : int
        How many parts have told their offset.

    Examples
    --------
    After a minute these clocks are 3 ms further apart:

    >>> found = ClockOffset(0.0185, 2e-5, 50.0, 1.2, used=16)
    >>> round(1e3 * 60 * 1e-6 * found.rate_ppm, 3)
    3.0
    """

    delay: Real
    delay_std: Real
    rate_ppm: Number
    rate_std_ppm: Number
    used: Count


@checked
@_checks.quiet
def clock_offset(
    x: ArrayLike,
    y: ArrayLike,
    fs: AboveZero,
    *,
    parts: Annotated[int, up_to(1000)] = 16,
    most_ppm: Positive = 200.0,
    false_alarm: Probability = 1e-3,
) -> ClockOffset:
    """Estimate the delay between two recorders, and the difference of their clocks' rates.

    Parameters
    ----------
    x, y : array_like, shape (n,) and (m,)
        What the first and the second recorder have in common: a channel into which both got the
        same signal, or the powers ``abs(recording.x[0]) ** 2`` of a moment that both sensors saw, a
        hand that covers them or a clap in front of them. Powers ripple with the Doppler shift if
        there is a constant, and with twice that if branches are unequal: remove both before. What
        ripple is left is no white noise, and the offset is good to a fraction of its period only.
    fs : float
        Sampling rate of both in Hz.
    parts : int
        In how many parts of `y` the offset is looked for, of 64 samples or more.
    most_ppm : float
        By how many millionths the rates of the clocks may differ.
    false_alarm : float
        Probability that signals without anything in common pass.

    Returns
    -------
    ClockOffset

    Raises
    ------
    ValueError
        If `x` and `y` have nothing in common, a sample is not finite, or parts are too short.

    Notes
    -----
    The part of `y` that correlates best with any place of `x` gives the offset to a sample. Beside
    it the correlation of each part has its peak between the samples, and a line through these peaks
    gives offset and rate. This is done with the signals and with means of 2, 4, 8, ... of their
    samples, and the result with the least deviation counts: noise beyond the band of the signal is
    gone then. Parts without a peak are left out; by chance the highest of L correlation
    coefficients reaches ``sqrt(2 log(L / p))`` of their deviations with a probability of at most p.
    The deviation is that of the coefficients at all places. So a hum, which correlates everywhere,
    tells nothing, but two records with a short event in each are taken to have it in common.

    A Doppler shift does not notice the difference of rates, of which it is a millionth part. But
    the offset grows: by 6 ms in a minute for 100 ppm. Once it matters, read and align the records
    in parts.

    Examples
    --------
    The second recorder began 2.5 samples later:

    >>> event = np.exp(-(((np.arange(4000) - 1800) / 5) ** 2))
    >>> later = np.exp(-(((np.arange(3900) - 1797.5) / 5) ** 2))
    >>> noise = 1e-3 * np.random.default_rng(1).standard_normal(7900)
    >>> found = clock_offset(event + noise[:4000], later + noise[4000:], 1e3)
    >>> round(1e3 * found.delay, 2), found.used
    (2.5, 1)
    """
    x, y = _checks.one_row("x", x, least=_LEAST), _checks.one_row("y", y, least=_LEAST)
    m = min(len(y) // parts, len(x) // 2)
    if m < _LEAST:
        raise ValueError(
            f"parts must have {_LEAST} samples of y or more, and half of x at most, got {parts} "
            f"for {len(x)} and {len(y)} samples"
        )
    found, refused = [], []
    scales = 2 ** np.arange(int(np.log2(m / _LEAST)) + 1)
    for scale in scales:
        a, b = (v[: len(v) // scale * scale].reshape(-1, scale).mean(axis=1) for v in (x, y))
        try:
            found.append(_offset(a, b, fs / scale, parts, most_ppm, false_alarm / len(scales)))
        except ValueError as error:
            refused.append(error)
    if not found:
        raise refused[0]
    return min(found, key=lambda one: one.delay_std)


def _offset(x, y, fs, parts, most_ppm, false_alarm):
    """Return the offset by signals at one sampling rate, or raise if they do not tell it."""
    m = min(len(y) // parts, len(x) // 2)
    x = np.pad(x - x.mean(), _AROUND)  # so that a peak beside an end has values on both sides
    firsts = np.arange(parts) * m
    found = [_correlation(x, y[a : a + m]) for a in firsts]
    heights = [np.max(r / deviation) for r, deviation in found]
    places = len(x) - m + 1
    if not max(heights) > _threshold(places * parts, false_alarm):
        raise ValueError(
            "x and y must have something in common, got a highest correlation of "
            f"{max(r.max() for r, _ in found):.2g}, which noise gives as well"
        )
    best = int(np.argmax(heights))
    lag = int(np.argmax(found[best][0])) - firsts[best]
    told = []
    for a, (r, deviation) in zip(firsts, found, strict=True):
        reach = int(np.ceil(most_ppm * 1e-6 * abs(a - firsts[best]))) + _MARGIN
        low, high = max(a + lag - reach, 0), min(a + lag + reach + 1, places)
        if high - low < 3:
            continue
        top = low + int(np.argmax(r[low:high]))
        if r[top] > deviation * _threshold((2 * reach + 1) * parts, false_alarm):
            place = _peak(r, top)
            variance = _variance(x[top : top + m], y[a : a + m], place - top)
            if np.isfinite(variance):
                told.append((a + (m - 1) / 2, place - _AROUND - a, variance))
    if not told:
        raise ValueError("x and y must have an overlap in which they correlate, got none")
    return _line(np.array(told), fs)


def _threshold(places, false_alarm):
    """Return the limit of the highest of so many normalized correlation coefficients."""
    return np.sqrt(2 * np.log(places / false_alarm))


def _correlation(x, part):
    """Return correlation coefficients of a part with all places of x, and their spread."""
    from scipy.signal import oaconvolve

    n, m = len(x), len(part)
    part = part - part.mean()
    own, whole = np.sum(part**2), np.sum(x**2)
    if not own * whole > 0:
        return np.zeros(n - m + 1), 1.0
    sums = np.zeros((2, n + 1))
    np.cumsum([x, x**2], axis=1, out=sums[:, 1:])
    one, two = sums[:, m:] - sums[:, :-m]
    energy = two - one**2 / m
    # Where hardly anything moves only rounding is left.
    energy = np.where(energy > _STILL * whole, energy, np.inf)
    r = oaconvolve(x, part[::-1], mode="valid") / np.sqrt(energy * own)
    # By the median, which a peak does not move; at least that of white noise.
    return r, max(1.4826 * float(np.median(np.abs(r))), 1 / np.sqrt(m))


def _peak(r, top):
    """Return where a sequence is highest beside its value at `top`, between the samples."""
    from scipy.signal import resample_poly

    low = max(top - _AROUND, 0)
    fine = resample_poly(r[low : top + _AROUND + 1], _FINE, 1)
    middle = (top - low) * _FINE
    i = middle - _FINE + 1 + int(np.argmax(fine[middle - _FINE + 1 : middle + _FINE]))
    before, here, after = fine[i - 1 : i + 2]
    bend = before - 2 * here + after
    return low + (i + (0.5 * (before - after) / bend if bend < 0 else 0.0)) / _FINE


def _variance(x, y, ahead):
    """Return the variance of the place of a peak in samples, `ahead` of these parts.

    The slope of the correlation there is noise: the slope of the signal times that of either, and
    that of one noise times the other. It is divided by the energy D of the signal's slope, which
    the slopes of both have in common.
    """
    x, y = x - x.mean(), y - y.mean()
    x = x + ahead * np.gradient(x)
    y = y * np.sqrt(np.sum(x**2) / np.sum(y**2))
    noise, D = np.mean((y - x) ** 2), np.sum(np.gradient(x) * np.gradient(y))
    variance = noise / D + len(x) * (np.pi * noise / D) ** 2 / 12
    # By the noise of both alone, D has a standard deviation of noise sqrt(n) / 4.
    return variance if D > 1.25 * noise * np.sqrt(len(x)) else np.inf


def _line(told, fs):
    """Return the offset at the second record's first sample and its rate, by places (K, 3)."""
    place, lag, variance = told.T
    columns = np.ones((len(told), 1))
    if len(told) >= 3:
        columns = np.column_stack([columns, place])
    weights = 1 / np.sqrt(variance + _SURE**2)
    covariance = np.linalg.pinv((columns * weights[:, None]).T @ (columns * weights[:, None]))
    value = covariance @ (columns.T @ (weights**2 * lag))
    std = np.sqrt(np.diagonal(covariance))
    rate, rate_std = (-1e6 * value[1], 1e6 * std[1]) if len(value) > 1 else (np.nan, np.nan)
    return ClockOffset(value[0] / fs, std[0] / fs, rate, rate_std, len(told))
