"""What Eq 8 assumes, noise without memory, put to a Kalman filter whose noise has one."""

import numpy as np

from ... import _checks
from ..._records import record
from ...estimation.linear_kalman import kf
from ...evaluation.intervals import ConfidenceInterval, mean_interval


@record
class WalkFilter:
    """A scalar Kalman filter over a random walk, judged after it has settled.

    Attributes
    ----------
    nis : ConfidenceInterval
        Mean of the normalized innovation squared; 1 if the filter is consistent.
    nees : ConfidenceInterval
        Mean of the normalized estimation error squared; 1 if the filter is consistent.
    autocorrelation : list of ConfidenceInterval, length lags + 1
        Of the innovations, from lag 0 on; 0 beyond lag 0 if the filter is optimal.
    """

    nis: ConfidenceInterval
    nees: ConfidenceInterval
    autocorrelation: list


def walk_filter(noise, q, r=1.0, *, rng, lags=30, settle=300):
    """Track a random walk through given measurement noise, which the filter believes white.

    Parameters
    ----------
    noise : array_like, shape (runs, K)
        Errors of the measurements; at least two runs.
    q : float
        Variance of a step of the walk over that of `noise`. The filter knows it.
    r : float
        Variance of the noise that the filter assumes, over the true one.
    rng : numpy.random.Generator
        Source of the walk.
    lags : int
        Number of lags of the autocorrelation.
    settle : int
        Number of samples that are left out at the start, less than K - lags.

    Returns
    -------
    WalkFilter

    Raises
    ------
    ValueError
        If a value is not finite or not positive, or the record is too short.

    Notes
    -----
    Mittermaier et al. (2016), Eq 8. A run gives one number to each interval, as only runs are
    independent of each other.
    """
    noise = _checks.finite("noise", noise, (None, None))
    q, r = _checks.positive_number("q", q), _checks.positive_number("r", r)
    _checks.generator("rng", rng)
    lags = _checks.whole_number("lags", lags)
    settle = _checks.whole_number("settle", settle, least=0)
    if noise.shape[-1] <= settle + lags:
        raise ValueError(
            f"noise must have more than settle + lags = {settle + lags} samples, "
            f"got {noise.shape[-1]}"
        )
    R = np.mean(noise**2)
    walk = np.cumsum(np.sqrt(q * R) * rng.standard_normal(noise.shape), axis=-1)
    one = np.eye(1)
    track = kf((walk + noise)[..., None], one, q * R * one, one, r * R * one, np.zeros(1), R * one)
    k = slice(settle, None)
    innovation = track.innovation[..., k, 0]
    power = np.mean(innovation**2)
    K = innovation.shape[-1]
    products = [
        np.mean(innovation[..., lag:] * innovation[..., : K - lag], axis=-1)
        for lag in range(lags + 1)
    ]
    error = track.x[..., k, 0] - walk[..., k]
    return WalkFilter(
        nis=mean_interval(np.mean(track.nis[..., k], axis=-1)),
        nees=mean_interval(np.mean(error**2 / track.P[..., k, 0, 0], axis=-1)),
        autocorrelation=[mean_interval(p / power) for p in products],
    )
