"""Power of consistency tests: false alarms, and rejections of faulty filters."""

import numpy as np
from scipy.special import chdtri, gammaincinv, ndtri

from .. import _checks
from .._typing import ArrayLike, BoolArray
from ..estimation.track import Track
from ._innovations import of_track
from .averages import nees_samples
from .consistency import nees
from .whiteness import innovation_mean, innovation_whiteness

TESTS = (
    "NIS average",
    "innovation mean",
    "innovation whiteness",
    "NEES at the end",
    "NEES average",
    "NEES of a group",
)


def rejections(
    track: Track,
    truth: ArrayLike,
    F: ArrayLike,
    Q: ArrayLike,
    *,
    confidence: float = 0.95,
    lags: int = 20,
    group: int = 20,
) -> dict[str, BoolArray]:
    """Return the records of a linear filter that each consistency test rejects.

    Parameters
    ----------
    track : Track
        Estimates x of shape (..., K, n), P, innovation (NaN where a measurement is missing), S and
        nis. P and S may have a leading axis 1 if they are the same in every run.
    truth : array_like, shape (..., K, n)
        True states.
    F, Q : array_like, shape (n, n) or (K, n, n)
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
        For each name in `TESTS`, whether a record is refused, shape (...); for the last one
        whether a group of runs is, shape (runs // group,). The first three need no truth.

    Raises
    ------
    ValueError
        If an argument is refused by `nees`, `nees_samples`, `innovation_mean` or
        `innovation_whiteness`, the track lacks something, a record has no measurement or too few
        for the lags, or `nis` is NaN where there is one.

    Notes
    -----
    Bar-Shalom, Li and Kirubarajan (2001), Section 5.4. The mean of the innovation is refused if
    that of any component is, at a level divided by their number (Bonferroni), which is a little
    cautious.

    Examples
    --------
    Of twenty right filters, each test refuses about one:

    >>> from dopplerlib import kf
    >>> rng = np.random.default_rng(1)
    >>> truth = rng.standard_normal((20, 50, 1)).cumsum(axis=1)
    >>> z = truth + rng.standard_normal((20, 50, 1))
    >>> one = np.eye(1)
    >>> track = kf(z, one, one, one, one, [0.0], one)
    >>> refused = rejections(track, truth, one, one, lags=10, group=10)
    >>> {name: int(records.sum()) for name, records in refused.items()}["NIS average"]
    0
    """
    alarm = 1 - _checks.probability("confidence", confidence)
    group = _checks.whole_number("group", group)
    _, _, there = of_track(track)
    nis = _checks.measured("track.nis", track.nis, there.shape[:-1])
    if not np.array_equal(np.isnan(nis), ~there.any(axis=-1)):
        raise ValueError("track.nis must be NaN where no measurement is there, and only there")
    squared = nees(track, truth)
    P = np.reshape(track.P, (-1, *track.P.shape[-3:]))
    known = (np.diagonal(P, axis1=-2, axis2=-1) == 0).all(axis=(0, 1))
    n = P.shape[-1] - int(known.sum())
    mean, deviation = innovation_mean(track.innovation, track.S)
    p_value = innovation_whiteness(track.innovation, track.S, lags).p_value
    if np.isnan(p_value).any():
        raise ValueError(f"lags must be fewer than the values of a component, got {lags}")
    groups = squared[..., -1].ravel()
    groups = groups[: len(groups) // group * group].reshape(-1, group).sum(axis=1)
    worth = np.array([nees_samples(one, F, Q) for one in P]).reshape(track.P.shape[:-3])

    def outside(total, dof):
        low, high = 2 * gammaincinv(dof / 2, alarm / 2), chdtri(dof, alarm / 2)
        return (total < low) | (total > high)

    limit = -ndtri(alarm / 2 / there.any(axis=-2).sum(axis=-1, keepdims=True))
    results = (
        outside(np.nansum(nis, axis=-1), there.sum(axis=(-2, -1))),
        (np.abs(mean / deviation) > limit).any(axis=-1),
        p_value < alarm,
        outside(squared[..., -1], n),
        outside(squared.mean(axis=-1) * worth, n * worth),
        outside(groups, n * group),
    )
    return dict(zip(TESTS, results, strict=True))
