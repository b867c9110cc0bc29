"""Accuracy of a pulse radar: signal-to-noise ratio, resolution, probability of detection."""

import numpy as np

from .. import _checks
from .._hints import Positive, Probability, Real, checked
from .._typing import ArrayLike, FloatArray


@checked
def linear_snr(d: ArrayLike, at_zero: Real, slope: Real) -> FloatArray:
    """Return a signal-to-noise ratio whose decibels fall linearly with the range.

    Parameters
    ----------
    d : array_like, shape (...)
        Range in m.
    at_zero : float
        Signal-to-noise ratio at range zero in dB.
    slope : float
        Loss in dB per meter.

    Returns
    -------
    ndarray, shape (...)
        Signal-to-noise ratio in dB.

    Notes
    -----
    Åsheim (2015), Eq 5.1. Decibels that fall linearly are a power that falls exponentially, as in
    an absorbing medium; see `fourth_power_snr` for free space.

    Examples
    --------
    >>> linear_snr([1.0, 2.0], at_zero=52, slope=12).tolist()
    [40.0, 28.0]
    """
    d = _checks.moderate("d", d)
    return at_zero - d * slope


@checked
def fourth_power_snr(d: ArrayLike, at_one: float) -> FloatArray:
    """Return the signal-to-noise ratio of the radar equation: 12 dB lost per doubling of range.

    Parameters
    ----------
    d : array_like, shape (...)
        Range in m, positive.
    at_one : float
        Signal-to-noise ratio at 1 m in dB.

    Returns
    -------
    ndarray, shape (...)
        Signal-to-noise ratio in dB.

    Notes
    -----
    The echo of a small target in free space falls with the fourth power of the range.

    Examples
    --------
    >>> fourth_power_snr([1.0, 10.0], at_one=42).tolist()
    [42.0, 2.0]
    """
    return at_one - 40 * np.log10(_checks.positive("d", d))


@checked
def range_std(resolution: Positive, snr_db: ArrayLike) -> FloatArray:
    """Return the standard deviation of a range or range rate at a given resolution.

    Parameters
    ----------
    resolution : float
        Resolution in m or m/s.
    snr_db : array_like, shape (...)
        Signal-to-noise ratio in dB.

    Returns
    -------
    ndarray, shape (...)
        Standard deviation, in the unit of the resolution.

    Notes
    -----
    resolution / sqrt(2 SNR): Åsheim (2015), Eqs 5.4 and 5.6. It holds for a peak that stands
    clearly above the noise. Near 0 dB and below, the largest peak is often one of the noise, and
    the error is no longer small.

    Examples
    --------
    >>> float(range_std(0.15, 20.0).round(4))
    0.0106
    """
    return resolution / np.sqrt(2 * 10 ** (_checks.decibels("snr_db", snr_db) / 10))


@checked
def detection_probability(snr_db: ArrayLike, false_alarm: Probability) -> FloatArray:
    """Return the probability of detection of a steady echo by one pulse.

    Parameters
    ----------
    snr_db : array_like, shape (...)
        Signal-to-noise ratio after integration in dB.
    false_alarm : float
        Chance that noise alone passes the threshold.

    Returns
    -------
    ndarray, shape (...)
        Chance to detect.

    Notes
    -----
    Square-law detector of one pulse of unknown phase: the power is chi-square distributed with two
    degrees of freedom, with noncentrality 2 SNR if there is an echo (the Q function of Marcum).

    Examples
    --------
    >>> detection_probability([-100.0, 13.2], 1e-6).round(2).tolist()
    [0.0, 0.9]
    """
    from scipy.stats import ncx2  # here: it takes longer to load than all the rest

    # Beyond 60 dB an echo passes any threshold, and SciPy's series is lost.
    snr_db = np.minimum(_checks.decibels("snr_db", snr_db), 60.0)
    threshold = -2 * np.log(false_alarm)
    return ncx2.sf(threshold, 2, 2 * 10 ** (snr_db / 10))
