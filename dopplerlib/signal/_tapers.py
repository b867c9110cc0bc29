"""Tapers of a window: their weights, and the accuracy with which they measure a tone."""

import numpy as np

TAPERS = "hann", "rectangular"
# Bins apart from which on white noise is uncorrelated; from there on a tone has only side lobes.
APART = {"hann": 3, "rectangular": 1}


def weights(taper, n):
    """Return the weights (n,) of a taper, symmetric about the middle of the window.

    Those of Hann's lie on the middles of n intervals: so the transform has three bins, as if it
    were periodic.
    """
    if taper == "rectangular":
        return np.ones(n)
    return 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(n) + 0.5) / n)


def side_lobes(taper, apart):
    """Return a bound on the power of a tone so many bins off its peak, which is 1."""
    d = np.maximum(np.abs(apart), APART[taper] - 0.5)
    fall = np.pi * d * ((d**2 - 1) if taper == "hann" else 1.0)
    return 1 / fall**2


def frequency_gain(w):
    """Return std sqrt(snr) of the frequency of a tone, in radians a sample.

    From the highest point of the periodogram of weighted samples, small errors: the error is
    ``Im(sum w t noise) / sum w t^2`` with times from the middle.
    """
    t = np.arange(len(w)) - (len(w) - 1) / 2
    return np.sqrt(np.sum((w * t) ** 2) / 2) / np.sum(w * t**2)


def curvature_gain(w):
    """Return the bias of an estimate for a curvature of 1 (a sample squared) of the frequency.

    The phase error ``2 pi t^3 / 6`` leaves ``sum w t^4 / (6 sum w t^2)``: 1/40 of the square of the
    window if it is rectangular.
    """
    t = np.arange(len(w)) - (len(w) - 1) / 2
    return np.sum(w * t**4) / np.sum(w * t**2) / 6


def error_correlation(w, lag):
    """Return the correlation of the errors of two windows, `lag` (...) samples apart."""
    t = np.arange(len(w)) - (len(w) - 1) / 2
    full = np.correlate(w * t, w * t, "full")[len(w) - 1 :]
    lag = np.minimum(np.abs(lag), len(w)).astype(int)
    return np.append(full, 0.0)[lag] / full[0]


def power_correlation(w, lag):
    """Return the correlation of the powers of white noise in one bin of two such windows."""
    full = np.correlate(w, w, "full")[len(w) - 1 :]
    lag = np.minimum(np.abs(lag), len(w)).astype(int)
    return (np.append(full, 0.0)[lag] / full[0]) ** 2
