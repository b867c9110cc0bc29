"""Which records a test of consistency refuses: its false alarms, and its power against faults."""

import numpy as np
from scipy.stats import norm

from .. import _checks
from .averages import average_interval, nees_samples
from .consistency import chi2_interval
from .whiteness import innovation_mean, innovation_whiteness

TESTS = (
    "NIS average",
    "innovation mean",
    "innovation whiteness",
    "NEES at the end",
    "NEES average",
    "NEES of a group",
)


def rejections(track, truth, F, Q, *, confidence=0.95, lags=20, group=20):
    """Return which records of a linear filter fail each test of consistency.

    Parameters
    ----------
    track : Track
        Estimates x of shape (runs, K, n), innovation, nis; P and S with the leading axis 1, for
        they are the same in every run.
    truth : array_like, shape (runs, K, n)
        True states.
    F, Q : array_like, shape (n, n)
        Transition matrix and process noise of the filter, for the memory of NEES.
    confidence : float
        Probability that a right filter passes.
    lags : int
        Lags of the test of whiteness.
    group : int
        Runs whose NEES at the last sample are averaged for the last test.

    Returns
    -------
    dict of str to ndarray of bool
        For each name in `TESTS`, whether a record is refused, shape (runs,); for the last one
        whether a group is, shape (runs // group,). The first three need no truth.

    Raises
    ------
    ValueError
        If an argument is refused by `innovation_mean` or `innovation_whiteness`, or P is not the
        same in every run.

    Notes
    -----
    Bar-Shalom, Li and Kirubarajan (2001), Section 5.4. The mean of the innovation is refused if
    that of any component is, at a level divided by their number (Bonferroni), which is a little
    cautious.
    """
    alarm = 1 - _checks.probability("confidence", confidence)
    group = _checks.whole_number("group", group)
    if track.P is None or track.P.shape[0] != 1:
        raise ValueError("track.P must have the leading axis 1")
    runs, samples, m = track.innovation.shape
    n = track.x.shape[-1]
    mean, deviation = innovation_mean(track.innovation, track.S)
    white = innovation_whiteness(track.innovation, track.S, lags)
    # One factor for all runs at a time; `nees` would factor again for each.
    error = np.moveaxis(truth - track.x, 0, -1)
    squared = np.sum(np.linalg.solve(np.linalg.cholesky(track.P[0]), error) ** 2, axis=1).T
    groups = squared[: runs // group * group, -1].reshape(-1, group).mean(axis=1)
    worth = nees_samples(track.P[0], F, Q)

    def outside(values, interval):
        return (values < interval[0]) | (values > interval[1])

    results = (
        outside(track.nis.mean(axis=-1), chi2_interval(m, samples, confidence)),
        (np.abs(mean / deviation) > norm.isf(alarm / 2 / m)).any(axis=-1),
        white.p_value < alarm,
        outside(squared[:, -1], chi2_interval(n, 1, confidence)),
        outside(squared.mean(axis=-1), average_interval(n, worth, confidence)),
        outside(groups, chi2_interval(n, group, confidence)),
    )
    return dict(zip(TESTS, results, strict=True))
