"""Standard deviations of measured frequencies from their scatter, beside the bound."""

from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Count, checked, up_to
from .._records import record
from .._typing import ArrayLike, FloatArray
from ._tapers import curvature_gain, error_correlation, weights

_THIRD = np.array([-1.0, 3.0, -3.0, 1.0])
_WIDE = 2  # window lengths between the frequencies of a difference
_SPAN = 8  # windows side by side over which the scatter is averaged
_OUTLYING = 3.0  # robust deviations from where on a difference counts as one that far off
_MOST = 2**24
_MEDIAN = 0.4549364231195725  # of the square of a standard normal variable


@checked
@record
class BoundTest:
    """Result of a test of claimed standard deviations against the scatter.

    Attributes
    ----------
    ratio : float
        Variance that is seen over the variance that is claimed; 0 if nothing is seen.
    degrees : float
        Degrees of freedom of the variance that is seen, overlap included; 0 if nothing is.
    p_value : float
        Probability of a ratio as large or larger if the claim is right; 1 if nothing is seen.
    typical : float
        The ratio by medians, which a steep part or a few wrong frequencies hardly move.
    """

    ratio: float
    degrees: float
    p_value: float
    typical: float


@checked
@_checks.quiet
def frequency_scatter(
    frequency: ArrayLike,
    window: Annotated[int, up_to(_MOST, 3)],
    hop: Count,
    *,
    span: Count = _SPAN,
    taper: Literal["hann", "rectangular"] = "hann",
) -> FloatArray:
    """Return the standard deviations of measured frequencies, from their own scatter.

    Parameters
    ----------
    frequency : array_like, shape (..., K)
        Frequencies in Hz, in windows one hop apart; NaN where there is none.
    window : int
        Samples of a window.
    hop : int
        Samples from the start of one window to that of the next.
    span : int
        Over how many windows side by side the scatter is averaged: as long as it may be taken to
        be steady. Eight tell a deviation to about a third.
    taper : {"hann", "rectangular"}
        Weights of the samples in a window.

    Returns
    -------
    ndarray, shape (..., K)
        Standard deviations in Hz; NaN where `frequency` is, and throughout a record that has less
        than a window's worth of differences.

    Notes
    -----
    What scatters are third differences ``f[k + 3 L] - 3 f[k + 2 L] + 3 f[k + L] - f[k]`` of
    windows two lengths apart, L hops: far enough for an error that is alike in neighbors, near
    enough for a curve that bends. They have 20 times the variance of a frequency, and no curve that
    is a parabola across seven windows shows in them. Their mean square is taken about
    each window, where squares beyond three robust deviations count as nine, with the factor that
    makes up for it in Gaussian scatter.

    Added in squares is the bias of a window in a curve: ``f'' T^2 / 40`` without a taper, where f''
    comes from the second difference. An error that stays for longer than some windows, such as that
    of a reflection that wanders about the body, is a motion to this function.

    Examples
    --------
    Noise on a curve, as windows have it of which each half overlaps, and its own deviation:

    >>> rng = np.random.default_rng(1)
    >>> noise = np.convolve(rng.standard_normal(401), [1, 1], "valid") * 3 / 2**0.5
    >>> f = 100 + 0.01 * np.arange(400) ** 2 + noise
    >>> std = frequency_scatter(f, window=256, hop=128)
    >>> round(float(np.sqrt(np.mean(std**2))), 1), round(float(noise.std()), 1)
    (2.3, 2.5)
    """
    f = _checks.measured("frequency", frequency, (None,))
    if (np.abs(f) > 1e60).any():
        raise ValueError(f"frequency must not exceed 1e60, got {np.nanmax(np.abs(f)):g}")
    lag = _lag(window, hop)
    rows = f.reshape(-1, f.shape[-1])
    std = np.array([_scatter(row, _WIDE * lag, span * lag) for row in rows]).reshape(f.shape)
    bias = np.zeros(f.shape)
    if f.shape[-1] > 2 * lag:
        second = f[..., 2 * lag :] - 2 * f[..., lag:-lag] + f[..., : -2 * lag]
        bend = curvature_gain(weights(taper, window)) / (lag * hop) ** 2
        bias[..., lag:-lag] = np.where(np.isnan(second), 0.0, second * bend)
    return np.where(np.isnan(f), np.nan, np.hypot(std, bias))


@checked
@_checks.quiet
def bound_test(
    frequency: ArrayLike,
    std: ArrayLike,
    window: Annotated[int, up_to(_MOST, 3)],
    hop: Count,
    *,
    taper: Literal["hann", "rectangular"] = "hann",
) -> BoundTest:
    """Test whether frequencies scatter more than their claimed standard deviations allow.

    Parameters
    ----------
    frequency : array_like, shape (K,)
        Frequencies in Hz, in windows one hop apart; NaN where there is none.
    std : array_like, broadcast to (K,)
        Their claimed deviations in Hz, for example the bound of a pure tone; of those where
        `frequency` is NaN nothing is used.
    window, hop, taper
        See `frequency_scatter`.

    Returns
    -------
    BoundTest
        The claim is rejected at the level alpha if `p_value` is less.

    Notes
    -----
    The third differences of `frequency_scatter` are divided by the deviations that the claim gives
    them. Under the claim, the mean of their squares is 1 and, overlapping windows being correlated,
    chi-square distributed over its degrees of freedom n / (sum of squared correlations), of n
    differences: the approximation by the first two moments.

    Examples
    --------
    White scatter of 2 Hz, claimed to be 2 Hz and 1 Hz:

    >>> f = 100 + 2 * np.random.default_rng(1).standard_normal(300)
    >>> test = [bound_test(f, std, window=256, hop=256) for std in (2.0, 1.0)]
    >>> [round(t.ratio, 1) for t in test], [t.p_value < 0.01 for t in test]
    ([0.9, 3.8], [False, True])
    """
    from scipy.special import chdtrc  # here: it takes longer to load than all the rest

    f = _checks.one_row("frequency", frequency, _checks.bounded)
    there = ~np.isnan(f)
    std = _checks.real("std", std)
    try:
        std = np.broadcast_to(std, f.shape)
    except ValueError:
        raise ValueError(
            f"std must have a shape that broadcasts to {f.shape}, got {std.shape}"
        ) from None
    std = np.where(there, std, 1.0)
    _checks.positive("std", std)
    lag = _lag(window, hop)
    d = _differences(f, lag)
    seen = ~np.isnan(d)
    if not seen.any():
        return BoundTest(0.0, 0.0, 1.0, 0.0)
    claimed = sum(c**2 * std[k * lag : k * lag + len(d)] ** 2 for k, c in enumerate(_THIRD))
    squares = (d**2 / claimed)[seen]
    ratio, typical = float(np.mean(squares)), float(np.median(squares) / _MEDIAN)
    apart = np.arange(-len(d) + 1, len(d))
    pairs = np.correlate(seen.astype(float), seen.astype(float), "full")
    # Of the difference, by its products with one that begins `apart` windows later.
    kernel = np.correlate(_THIRD, _THIRD, "full") / np.sum(_THIRD**2)
    w = weights(taper, window)
    alike = sum(
        c * error_correlation(w, (apart + k * lag) * hop)
        for k, c in zip(range(-3, 4), kernel, strict=True)
    )
    degrees = float(seen.sum() ** 2 / np.sum(pairs * alike**2))
    return BoundTest(ratio, degrees, float(chdtrc(degrees, degrees * ratio)), typical)


def _lag(window, hop):
    """Return the number of hops after which windows do not overlap."""
    return -(-window // hop)


def _differences(f, lag):
    """Return the third differences (K - 3 lag,) of frequencies (K,), NaN where one is missing."""
    n = max(0, len(f) - 3 * lag)
    return sum(c * f[k * lag : k * lag + n] for k, c in enumerate(_THIRD))


def _scatter(f, lag, count):
    """Return the standard deviations (K,) by the nearest `count` differences of each."""
    d = _differences(f, lag)
    center = np.flatnonzero(~np.isnan(d))
    if len(center) < lag // _WIDE:
        return np.full(len(f), np.nan)
    square = d[center] ** 2 / np.sum(_THIRD**2)
    count = min(count, len(center))
    first = np.searchsorted(center + 1.5 * lag, np.arange(len(f))) - count // 2
    first = np.clip(first, 0, len(center) - count)
    used, place = np.unique(first, return_inverse=True)
    windows = np.lib.stride_tricks.sliding_window_view(square, count)[used]
    return np.sqrt(_mean_square(windows))[place]


def _mean_square(square):
    """Return means of squares (..., n) over the last axis, those of outlying values cut."""
    from scipy.special import ndtr

    c = _OUTLYING
    # Mean of min(z^2, c^2) for a standard normal z.
    kept = 2 * (ndtr(c) - 0.5 - c * np.exp(-(c**2) / 2) / np.sqrt(2 * np.pi)) + 2 * c**2 * ndtr(-c)
    v = np.median(square, axis=-1, keepdims=True) / _MEDIAN
    return np.minimum(square, c**2 * v).mean(axis=-1) / kept
