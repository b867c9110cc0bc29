"""Errors of the tracks of the whole chain."""

from collections.abc import Iterable
from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Array, Real, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...chain.track import IqTrack
from .published import reported


@checked
@record
class TrackErrors:
    """Errors and consistency of tracks of the target of Table 2.

    error (M, runs): Distance in m between estimated and true position, at M times.
    nees (M, runs): Normalized estimation error squared of the state there.
    nis (runs,): Normalized innovation squared of the hypothesis that counts in the end, averaged
        over the samples of the filter.
    lag1_autocorrelation (runs,): Autocorrelation of the innovations, see `IqTrack`.
    """

    error: Annotated[FloatArray, exactly(None, None)]
    nees: Annotated[FloatArray, exactly(None, None, check=_checks.finite)]
    nis: Array
    lag1_autocorrelation: Array


@checked
@_checks.quiet
def track_errors(
    found: IqTrack, times: Iterable[Real] = (0.5, 1.0), carry: bool = True
) -> TrackErrors:
    """Compare tracks with the truth of Table 2.

    found: Tracks of the target of Table 2.
    times: When to compare, in s on the clock: with the true state *at* that time.
    carry: See `IqTrack.at`.
    Raises ValueError if there is no time, or one is before the start is known.

    Examples
    --------
    >>> from dopplerlib.systems.mittermaier2016 import read_simulated_iq, track_iq
    >>> found = track_iq(read_simulated_iq()[0])
    >>> bool((track_errors(found).error < 0.1).all())
    True
    """
    if not times:
        raise ValueError("times must hold a number, got none")
    s = reported().scenario
    error, squared = [], []
    for time in times:
        truth = s.x0 + np.concatenate([time * s.x0[3:], np.zeros(3)])
        x, P, chosen = found.at(time, carry)
        off = truth - x
        error.append(np.linalg.norm(off[:, :3], axis=-1))
        try:
            solved = np.linalg.solve(P, off[..., None])[..., 0]
        except np.linalg.LinAlgError:
            raise ValueError(f"found must have covariances that are regular, got {P}") from None
        squared.append(np.sum(off * solved, axis=-1))
    rows = np.arange(len(chosen))
    nis = found.nis[rows, chosen].mean(axis=-1)
    return TrackErrors(np.array(error), np.array(squared), nis, found.lag1_autocorrelation)
