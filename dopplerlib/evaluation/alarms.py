"""Alarms: sequential tests of the innovations of a running filter."""

from collections.abc import Iterable

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, BoolArray, FloatArray
from ..estimation.track import Track
from ._innovations import chi2_tail, ljung_box, of_track, whiten


def innovation_alarms(
    track: Track, looks: Iterable[int], probability: float = 0.001, lags: int = 5
) -> dict[str, BoolArray]:
    """Test the innovations of a running filter for consistency, at given sample numbers.

    None of the tests needs the truth.

    Parameters
    ----------
    track : Track
        With `innovation`, in which NaN is a missing measurement, and `S`.
    looks : iterable of int
        Numbers of samples after which each test is taken, each time on all samples so far.
    probability : float
        Of a false alarm at any of the looks, at most, for each test.
    lags : int
        Of the test of whiteness, which leaves out components with fewer than ten values per lag.

    Returns
    -------
    dict of str to ndarray of bool, shape (..., looks)
        By the name of the test, whether it rejects at each look.

    Raises
    ------
    ValueError
        If a look is not a number of samples in the record, the track has no innovations or S, a
        record has no measurement at all, or another argument is refused.

    Notes
    -----
    "NIS average" is chi-square, and raises an alarm when it is too large: errors larger than the
    filter believes are what is dangerous. The "innovation mean" is taken over the innovations
    divided by their Cholesky factor, and its square is chi-square. "whiteness" is that of
    `innovation_whiteness`. Each look spends an equal part of `probability` (Bonferroni), so that
    looking often does not raise more false alarms.

    Bar-Shalom, Li and Kirubarajan (2001), Section 5.4.

    Examples
    --------
    A sensor that sticks ten deviations off after half of the record:

    >>> from dopplerlib import Track
    >>> innovation = np.resize([1.0, -1.0, 0.5], (60, 1))
    >>> innovation[30:] += 10
    >>> track = Track(None, None, innovation, np.ones((60, 1, 1)), None, None)
    >>> innovation_alarms(track, [30, 40])["NIS average"].tolist()
    [False, True]
    """
    innovation, S, there = of_track(track)
    samples = innovation.shape[-2]
    looks = _looks(looks)
    if max(looks) > samples:
        raise ValueError(f"looks must be at most the {samples} samples, got {max(looks)}")
    threshold = _checks.probability("probability", probability) / len(looks)
    least = 10 * _checks.whole_number("lags", lags)
    white = whiten(innovation, S)
    p = {name: [] for name in ("NIS average", "innovation mean", "whiteness")}
    for look in looks:
        part, known = white[..., :look, :], there[..., :look, :]
        n = known.sum(axis=-2)  # of each component
        total, of_means = n.sum(axis=-1), np.sum(n > 0, axis=-1)
        square = np.sum(part.sum(axis=-2) ** 2 / np.maximum(n, 1), axis=-1)
        p["NIS average"].append(chi2_tail(np.sum(part**2, axis=(-2, -1)), total))
        p["innovation mean"].append(chi2_tail(square, of_means))
        p["whiteness"].append(ljung_box(part, known, lags, least)[-1])
    # Where there is no value yet, there is no p-value either, and no alarm.
    return {name: np.stack(values, axis=-1) < threshold for name, values in p.items()}


@checked
def first_alarm(alarms: ArrayLike, looks: Iterable[int]) -> FloatArray:
    """Return the number of samples until the first alarm of each run.

    Parameters
    ----------
    alarms : array_like of bool, shape (..., looks)
        Of one test, see `innovation_alarms`.
    looks : iterable of int
        Numbers of samples, ascending.

    Returns
    -------
    ndarray, shape (...)
        Infinite where there is none.

    Examples
    --------
    >>> first_alarm([[False, True], [False, False]], [30, 40]).tolist()
    [40.0, inf]
    """
    looks = _looks(looks)
    if looks != sorted(set(looks)):
        raise ValueError(f"looks must ascend, got {looks}")
    alarms = _checks.booleans("alarms", alarms, (len(looks),))
    return np.where(alarms.any(axis=-1), np.array(looks, float)[alarms.argmax(axis=-1)], np.inf)


def _looks(looks):
    looks = [_checks.whole_number("looks", look) for look in _checks.iterable("looks", looks)]
    if not looks:
        raise ValueError("looks must hold a number of samples, got none")
    return looks
