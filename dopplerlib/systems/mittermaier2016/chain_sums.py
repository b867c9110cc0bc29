"""A Gaussian sum behind the signal chain, on the track of Table 2."""

from collections.abc import Iterable

import numpy as np

from ..._data import read_lines, results
from ..._hints import Positive, checked
from ..._typing import FloatArray
from ...chain.track import IqTrack
from ...estimation import covariances
from ...estimation.gaussian_sum import gaussian_sum
from ...workspace.targets import PRIOR_COVARIANCE, PRIOR_MEAN
from .published import reported


@checked
def sum_errors(
    found: IqTrack, times: Iterable[Positive] = (0.5, 1.0)
) -> tuple[FloatArray, FloatArray]:
    """Track the target of Table 2 by a Gaussian sum from the shifts that the chain has measured.

    The start is the prior of `dopplerlib.workspace`; the velocity is constant, and known to be. The
    errors of the shifts are taken as independent, with the deviations that the chain states.

    found: Tracks of the target of Table 2, of which only shifts and their deviations are used.
    times: When to compare with the truth, in s on the clock.
    Returns error (M, runs): Distance in m between estimated and true position, at M times.
        nees (M, runs): Normalized estimation error squared of the state there.
    Raises ValueError if a time is before the second shift is known.

    Examples
    --------
    >>> from dopplerlib.systems.mittermaier2016 import read_simulated_iq, track_iq
    >>> error, _ = sum_errors(track_iq(read_simulated_iq()[0]), (0.5,))
    >>> bool(error[0, 0] < 0.02)
    True
    """
    s = reported().scenario
    T = found.time[1] - found.time[0]
    before = _motion(found.time[0] - T)  # the prior is of time zero
    x0, P0 = before @ PRIOR_MEAN, before @ PRIOR_COVARIANCE @ before.T
    error, squared = [], []
    for time in times:
        K = int(np.sum(found.available_at <= time + 1e-9))
        if K < 2:
            raise ValueError(f"times must be after the second shift is known, got {time}")
        F, truth = _motion(time - found.time[K - 1]), _motion(time) @ s.x0
        for z, std in zip(found.shift[:, :K], found.shift_std[:, :K], strict=True):
            one = gaussian_sum(
                z, s.array, x0, P0, T, 0.0, np.where(np.isnan(z), 1.0, std), every=K, block=1,
                workers=1,
            )  # fmt: skip
            off = truth - F @ one.x[-1]
            error.append(np.linalg.norm(off[:3]))
            squared.append(off @ covariances.solve(F @ one.P[-1] @ F.T, off[:, None])[:, 0])
    return np.reshape(error, (len(times), -1)), np.reshape(squared, (len(times), -1))


@checked
def saved_sum_errors() -> FloatArray:
    """Return the errors of the EKF and of the Gaussian sum in the study that is saved in `results`.

    Returns (2, 2, 4, runs): For windows of 25 ms side by side, and every 2.5 ms; after 0.5 and 1 s:
        position error in m and NEES of the chain's EKF, and of the Gaussian sum.

    Notes
    -----
    Made by ``make study NAME=sum_iq``; see the README of ``results``.

    Examples
    --------
    >>> saved_sum_errors().shape[:3]
    (2, 2, 4)
    """
    rows = np.loadtxt(read_lines("sum_iq.csv", folder=results), delimiter=",", skiprows=1)
    runs, times, hops = (np.unique(rows[:, i], return_inverse=True)[1] for i in range(3))
    found = np.empty((2, 2, 4, runs.max() + 1))
    found[1 - hops, times, :, runs] = rows[:, 3:] * [1e-3, 1, 1e-3, 1]
    return found


def _motion(time):
    """Return the transition of constant velocity over a time, which may be negative."""
    return np.eye(6) + time * np.eye(6, k=3)
