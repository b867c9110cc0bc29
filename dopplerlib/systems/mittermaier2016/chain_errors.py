"""How far the tracks of the whole chain are from the truth."""

import numpy as np

from ..._records import record
from .published import scenario


@record
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
    lag1_autocorrelation : ndarray, shape (runs,)
        Autocorrelation of the innovations, see `IqTrack`.
    """

    error: np.ndarray
    nees: np.ndarray
    nis: np.ndarray
    lag1_autocorrelation: np.ndarray


def judged(found, moments=(0.5, 1.0), carry=True):
    """Compare tracks with the truth of Table 2.

    Parameters
    ----------
    found : IqTrack
        Tracks of the target of Table 2.
    moments : sequence of float
        When to compare, in s on the clock: with the true state *at* that moment.
    carry : bool
        See `IqTrack.at`.

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
    rows = np.arange(len(chosen))
    nis = found.nis[rows, chosen].mean(axis=-1)
    return Judged(np.array(error), np.array(squared), nis, found.lag1_autocorrelation)
