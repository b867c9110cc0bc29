"""How far the tracks of the whole chain are from the truth, and how near they could be."""

from dataclasses import dataclass

import numpy as np

from ... import _checks
from ...evaluation.bounds import crlb
from ...signal.laws import crlb_frequency_std
from .published import scenario


@dataclass(frozen=True)
class Judged:
    """Tracks of the target of Table 2 beside the truth.

    Attributes
    ----------
    error : ndarray, shape (M, runs)
        Distance in m between estimated and true position, at M moments.
    nees : ndarray, shape (M, runs)
        Normalized estimation error squared of the state there.
    nis : ndarray, shape (runs,)
        Normalized innovation squared of the hypothesis that counts in the end, averaged over the
        samples of the filter.
    """

    error: np.ndarray
    nees: np.ndarray
    nis: np.ndarray


def judged(found, moments=(0.5, 1.0), carry=True):
    """Compare tracks with the truth of Table 2.

    Parameters
    ----------
    found : EndToEnd
        Tracks of the target of Table 2.
    moments : sequence of float
        When to compare, in s on the clock: with the true state *at* that moment.
    carry : bool
        See `EndToEnd.at`.

    Returns
    -------
    Judged

    Raises
    ------
    ValueError
        If a moment is before the start is known.
    """
    s = scenario()
    error, squared = [], []
    for moment in moments:
        truth = s.x0 + np.concatenate([moment * s.x0[3:], np.zeros(3)])
        x, P, chosen = found.at(moment, carry)
        off = truth - x
        error.append(np.linalg.norm(off[:, :3], axis=-1))
        squared.append(np.sum(off * np.linalg.solve(P, off[..., None])[..., 0], axis=-1))
    nis = found.nis[np.arange(len(chosen)), chosen].mean(axis=-1)
    return Judged(np.array(error), np.array(squared), nis)


def position_bound(moment, window, cn0, *, first=0.0, samples_per_second=100e3):
    """Return how well the position at a moment can be known from windows side by side.

    Parameters
    ----------
    moment : float
        In s; the windows end there at the latest.
    window : float
        Length of a window in s.
    cn0 : float
        Power of an echo over the noise power in 1 Hz, in Hz.
    first : float
        When the first window begins, in s.
    samples_per_second : float
        Sampling rate in Hz, of little influence.

    Returns
    -------
    ndarray, shape (3, 3)
        Covariance of the position in m^2 at the bound, for the target of Table 2 and constant
        velocity; infinite entries on the diagonal where the windows are too few.

    Raises
    ------
    ValueError
        If a number is not positive where it has to be, or no window fits.

    Notes
    -----
    `crlb` of the moving likelihood with the deviations of `crlb_frequency_std`. It sees the middles
    of the windows only, no chirp inside them.
    """
    s = scenario()
    window = _checks.positive_number("window", window)
    cn0 = _checks.positive_number("cn0", cn0)
    K = int((_checks.one_number("moment", moment) - first) / window + 1e-9)
    if K < 1:
        raise ValueError(f"moment must leave room for a window of {window} s, got {moment}")
    n = max(2, round(window * samples_per_second))
    sigma = crlb_frequency_std(cn0 * window / n, n, n / window)
    middle, F = first + window / 2, np.eye(6)
    F[:3, 3:] = middle * np.eye(3)
    P = crlb(F @ s.x0, s.array, sigma, K, window, "moving")
    F[:3, 3:] = (moment - middle) * np.eye(3)
    return (F @ P @ F.T)[:3, :3]
