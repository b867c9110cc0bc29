"""Performance of frequency estimates: bounds, thresholds, window lengths, correlation."""

from typing import Literal

import numpy as np

from .. import _checks
from .._hints import AboveZero, checked
from .._typing import ArrayLike, FloatArray
from ._bins import sum_of_ones
from ._tapers import error_correlation, weights

# The variance of a frequency estimate from a window of length T is VARIANCE / (cn0 T^3).
_VARIANCE = 6 / (2 * np.pi) ** 2
# Lengths, times the square root of the chirp, at which its peak is highest over the noise.
_BEST = {"rectangular": 1.4489322, "hann": 2.1078443}


@checked
@_checks.quiet
def crlb_frequency_std(snr: ArrayLike, n: ArrayLike, fs: AboveZero) -> FloatArray:
    """Return the Cramér-Rao bound on the standard deviation of a tone's frequency.

    Parameters
    ----------
    snr : array_like, shape (...)
        Power of the tone over the variance of a complex noise sample, not in dB.
    n : array_like of int, broadcast to (...)
        Number of samples, at least 2.
    fs : float
        Sampling rate in Hz.

    Returns
    -------
    ndarray, shape (...)
        Cramér-Rao lower bound in Hz, amplitude and phase unknown.

    Notes
    -----
    Rife and Boorstyn (1974): the variance is 6 fs^2 / ((2 pi)^2 snr n (n^2 - 1)).

    Examples
    --------
    >>> round(float(crlb_frequency_std(snr=10.0, n=250, fs=10e3)), 2)
    0.31
    """
    snr = _checks.positive("snr", snr)
    n = _checks.positive("n", n)
    if (n < 2).any():
        raise ValueError(f"n must be at least 2, got {n.min():g}")
    _checks.check_leading(snr=(snr, 0), n=(n, 0))
    bound = fs * np.sqrt(_VARIANCE / snr / n / (n**2 - 1))
    return _checks.estimates("snr, n, fs", bound, what="bound")


@checked
@_checks.quiet
def crlb_frequency_std_dc(f: ArrayLike, snr: ArrayLike, n: int, fs: AboveZero) -> FloatArray:
    """Return the Cramér-Rao bound on a tone's frequency with an unknown DC offset.

    Parameters
    ----------
    f : array_like, shape (...)
        Frequency of the tone in Hz, counted from that of the constant.
    snr, n, fs
        See `crlb_frequency_std`; `n` is at least 3.

    Returns
    -------
    ndarray, shape (...)
        Cramér-Rao lower bound in Hz; amplitude, phase and the constant are unknown. It tends to
        that of the tone alone with the number of cycles in the window, and is infinite for f = 0.

    Notes
    -----
    With times t in samples, counted from the middle of the window, and w = 2 pi f / fs, what the
    tone and the constant can imitate of a change of the frequency is the projection of t onto 1 and
    exp(-i w t). With D(w) the sum of cos(w t), n (n^2 - 1) / 12 in the information of a tone
    becomes n (n^2 - 1) / 12 - n D'(w)^2 / (n^2 - D(w)^2). For a thousandth of a cycle in the
    window, the smallest that `ml_frequency_dc` looks at, rounding leaves three digits.

    Examples
    --------
    Half a cycle, one, and ten and a half in 25 ms:

    >>> f = [20.0, 40.0, 420.0]
    >>> crlb_frequency_std_dc(f, snr=10.0, n=250, fs=10e3).round(2).tolist()
    [0.75, 0.37, 0.31]
    """
    f, snr = _checks.finite("f", f), _checks.positive("snr", snr)
    n = _checks.moderate("n", n)
    if (n < 3).any():
        raise ValueError(f"n must be at least 3, got {n.min():g}")
    _checks.check_leading(f=(f, 0), snr=(snr, 0), n=(n, 0))
    cycles = f * n / fs
    _checks.estimates("f, n, fs", cycles, what="cycles in a window")
    D, slope, _ = sum_of_ones(cycles, n)
    imitated = n * (slope * n / (2 * np.pi)) ** 2 / (n**2 - D**2)
    kept = 1 - imitated * 12 / (n * (n**2 - 1))
    factor = np.where(kept > 0, 1 / np.sqrt(kept), np.inf)
    return crlb_frequency_std(snr, n, fs) * factor


@checked
@_checks.quiet
def window_for_std(std: ArrayLike, cn0: ArrayLike) -> FloatArray:
    """Return the window length at which the bound on the frequency has a given standard deviation.

    Parameters
    ----------
    std : array_like, shape (...)
        Wanted standard deviation in Hz.
    cn0 : array_like, broadcast to (...)
        Power of the tone over the noise power in 1 Hz, in Hz: snr times fs.

    Returns
    -------
    ndarray, shape (...)
        Length in s, for a window of many samples.

    Notes
    -----
    The bound of `crlb_frequency_std` for large n, solved for T = n / fs.

    Examples
    --------
    >>> round(1e3 * float(window_for_std(0.4, cn0=1e5)), 1)  # ms
    21.2
    """
    std, cn0 = _checks.positive("std", std), _checks.positive("cn0", cn0)
    _checks.check_leading(std=(std, 0), cn0=(cn0, 0))
    length = np.cbrt(_VARIANCE / std / std / cn0)
    return _checks.estimates("std, cn0", length, what="length")


@checked
@_checks.quiet
def integrated_snr_for_std(std: ArrayLike, T: ArrayLike) -> FloatArray:
    """Return the integrated signal-to-noise ratio for a given standard deviation of the frequency.

    Parameters
    ----------
    std : array_like, shape (...)
        Wanted standard deviation in Hz.
    T : array_like, broadcast to (...)
        Length of the window in s.

    Returns
    -------
    ndarray, shape (...)
        n times the ratio of a sample, not in dB. How many samples there are does not matter.

    Notes
    -----
    The bound of `crlb_frequency_std` for large n, solved for n snr.

    Examples
    --------
    >>> round(float(10 * np.log10(integrated_snr_for_std(0.4, 1e-3))), 1)  # dB
    59.8
    """
    std, T = _checks.positive("std", std), _checks.positive("T", T)
    _checks.check_leading(std=(std, 0), T=(T, 0))
    snr = _VARIANCE / (std * T) ** 2
    return _checks.estimates("std, T", snr, what="ratio")


@checked
@_checks.quiet
def outlier_probability(integrated_snr: ArrayLike, candidates: AboveZero) -> FloatArray:
    """Return the probability of an outlier: a peak of the noise above that of the tone.

    Parameters
    ----------
    integrated_snr : array_like, shape (...)
        n times the signal-to-noise ratio of a sample, not in dB.
    candidates : float
        Number of independent places for a peak, at least 2: n, or with a band its width times the
        window.

    Returns
    -------
    ndarray, shape (...)
        Probability that another place wins.

    Notes
    -----
    Rife and Boorstyn (1974): the tone's power is noncentral chi-square distributed with two
    degrees of freedom, every other one's is exponential; all are taken to be independent.

    Examples
    --------
    >>> outlier_probability([10.0, 20.0], candidates=250).round(4).tolist()
    [0.1445, 0.003]
    """
    from scipy.special import ive

    # From far below the limit on, exp(-a^2) is zero, and so is the probability.
    s = np.minimum(_checks.positive("integrated_snr", integrated_snr), 1e6)[..., None]
    if candidates < 2:
        raise ValueError(f"candidates must be at least 2, got {candidates:g}")
    # The amplitude is Rice distributed: nine deviations of 0.7 around its mode hold all of it.
    offset, weight = np.polynomial.legendre.leggauss(200)
    low, high = np.maximum(np.sqrt(s) - 6.5, 0), np.sqrt(s) + 6.5
    a = low + (high - low) * (offset + 1) / 2
    density = 2 * a * np.exp(-((a - np.sqrt(s)) ** 2)) * ive(0, 2 * a * np.sqrt(s))
    beaten = -np.expm1((candidates - 1) * np.log1p(-np.exp(-(a**2))))
    return np.sum(weight * density * beaten, axis=-1) * (high - low)[..., 0] / 2


@checked
def overlap_correlation(tau: ArrayLike) -> FloatArray:
    """Return the correlation between the errors of two overlapping windows.

    Parameters
    ----------
    tau : array_like, shape (...)
        Distance of the windows over their length.

    Returns
    -------
    ndarray, shape (...)
        1 - 3 tau + 2 tau^3 up to tau = 1, and 0 beyond.

    Examples
    --------
    Half an overlap leaves less than nothing in common:

    >>> overlap_correlation([0, 0.5, 0.75, 1]).tolist()
    [1.0, -0.25, -0.40625, 0.0]
    """
    tau = np.minimum(np.abs(_checks.finite("tau", tau)), 1.0)
    return 1 - 3 * tau + 2 * tau**3


@checked
def overlap_correlation_discrete(
    n: int, lag: ArrayLike, taper: Literal["rectangular", "hann"] = "rectangular"
) -> FloatArray:
    """Return the correlation between the errors of two overlapping windows of n samples.

    Parameters
    ----------
    n : int
        Samples of a window, at least 2.
    lag : array_like of int, shape (...)
        Distance of the windows in samples.
    taper : {"rectangular", "hann"}
        Weights of the samples, as in `detect_peaks`.

    Returns
    -------
    ndarray, shape (...)

    Notes
    -----
    The error is the noise weighted with the distance from the middle of the window, and with the
    taper. Without one, in the m = n - lag samples in common the products of these weights add up
    to (m (m^2 - 1) - 3 m lag^2) / 12.

    Examples
    --------
    >>> overlap_correlation_discrete(250, [0, 10, 125, 250]).round(3).tolist()
    [1.0, 0.88, -0.25, 0.0]
    """
    n = _checks.whole_number("n", n, least=2)
    lag = np.minimum(np.abs(_checks.finite("lag", lag)), n)
    if taper == "hann":
        return error_correlation(weights(taper, n), lag)
    m = n - lag
    products = np.where(m > 0, m * (m**2 - 1 - 3 * lag**2), 0.0)
    return products / (n * (n**2 - 1))


@checked
@_checks.quiet
def optimal_window_end(cn0: ArrayLike, chirp: ArrayLike) -> FloatArray:
    """Return the optimal window length for the frequency at the end of the window.

    Parameters
    ----------
    cn0 : array_like, shape (...)
        Power of the tone over the noise power in 1 Hz, in Hz.
    chirp : array_like, broadcast to (...)
        Rate of change of the frequency in Hz/s, not 0: then the longest window is the best.

    Returns
    -------
    ndarray, shape (...)
        Length in s with the least mean-square error.

    Notes
    -----
    The error is 6 / ((2 pi)^2 cn0 T^3) + (chirp T / 2)^2.

    Examples
    --------
    >>> round(1e3 * float(optimal_window_end(cn0=1e5, chirp=50.0)), 1)  # ms
    20.5
    """
    cn0, chirp = _checks.positive("cn0", cn0), _nonzero("chirp", chirp)
    _checks.check_leading(cn0=(cn0, 0), chirp=(chirp, 0))
    length = (6 * _VARIANCE / cn0 / chirp / chirp) ** (1 / 5)
    return _checks.estimates("cn0, chirp", length, what="length")


@checked
@_checks.quiet
def optimal_window_center(cn0: ArrayLike, curvature: ArrayLike) -> FloatArray:
    """Return the optimal window length for the frequency at the middle of the window.

    Parameters
    ----------
    cn0 : array_like, shape (...)
        Power of the tone over the noise power in 1 Hz, in Hz.
    curvature : array_like, broadcast to (...)
        Second derivative of the frequency in Hz/s^2, not 0: then the longest window is best.

    Returns
    -------
    ndarray, shape (...)
        Length in s with the least mean-square error.

    Notes
    -----
    The error is 6 / ((2 pi)^2 cn0 T^3) + (curvature T^2 / 40)^2.

    Examples
    --------
    >>> round(1e3 * float(optimal_window_center(cn0=1e5, curvature=500.0)), 1)  # ms
    68.8
    """
    cn0, curvature = _checks.positive("cn0", cn0), _nonzero("curvature", curvature)
    _checks.check_leading(cn0=(cn0, 0), curvature=(curvature, 0))
    length = (1200 * _VARIANCE / cn0 / curvature / curvature) ** (1 / 7)
    return _checks.estimates("cn0, curvature", length, what="length")


@checked
@_checks.quiet
def optimal_window_detection(
    chirp: ArrayLike, taper: Literal["rectangular", "hann"] = "rectangular"
) -> FloatArray:
    """Return the window length at which the peak of a chirp stands highest above the noise.

    Parameters
    ----------
    chirp : array_like, shape (...)
        Rate of change of the frequency in Hz/s, not 0: then the longest window is the best.
    taper : {"rectangular", "hann"}
        Weights of the samples, as in `detect_peaks`.

    Returns
    -------
    ndarray, shape (...)
        Length in s.

    Notes
    -----
    In a window of length T the tone is spread over ``chirp T``: from about 1 / T on, a longer one
    gathers more noise and no more of it. The maximum of ``|sum w exp(i pi chirp t^2)|^2 / sum w^2``
    is at ``1.449 / sqrt(chirp)``; with Hann's taper, which weighs the ends less, at 2.108.

    Examples
    --------
    A car that passes at 14 m/s, when its Doppler shift at 24 GHz changes by 1 kHz/s:

    >>> round(1e3 * float(optimal_window_detection(1000.0, "hann")))  # ms
    67
    """
    chirp = np.abs(_nonzero("chirp", chirp))
    return _checks.estimates("chirp", _BEST[taper] / np.sqrt(chirp), what="length")


def _nonzero(name, value):
    array = _checks.finite(name, value)
    if (array == 0).any():
        raise ValueError(f"{name} must not be zero, got {value}")
    return array
