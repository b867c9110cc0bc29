"""A Kalman filter that takes colored measurement noise for white."""

from typing import Annotated

import numpy as np

from .._hints import Count, Index, Positive, checked, exactly
from .._records import record
from .._typing import FloatArray
from ..estimation.linear_kalman import kf
from .intervals import ConfidenceInterval, mean_interval


@checked
@record
class RandomWalkFilter:
    """A scalar Kalman filter over a random walk, judged after it has settled.

    Attributes
    ----------
    nis : ConfidenceInterval
        Mean of the normalized innovation squared; 1 if the filter is consistent.
    nees : ConfidenceInterval
        Mean of the normalized estimation error squared; 1 if the filter is consistent.
    autocorrelation : tuple of ConfidenceInterval, length lags + 1
        Of the innovations, from lag 0 on; 0 beyond lag 0 if the filter is optimal.
    """

    nis: ConfidenceInterval
    nees: ConfidenceInterval
    autocorrelation: tuple[ConfidenceInterval, ...]


@checked
def random_walk_filter(
    noise: Annotated[FloatArray, exactly(None, None)],
    q: Positive,
    r: Positive = 1.0,
    *,
    rng: np.random.Generator,
    lags: Count = 30,
    settle: Index = 300,
) -> RandomWalkFilter:
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
    RandomWalkFilter

    Raises
    ------
    ValueError
        If a value is not finite or not positive, or the record is too short.

    Notes
    -----
    A run gives one number to each interval, as only runs are independent of each other.

    Examples
    --------
    Noise that is white leaves the filter consistent:

    >>> rng = np.random.default_rng(1)
    >>> white = random_walk_filter(rng.standard_normal((20, 400)), 1e-2, rng=rng, lags=2)
    >>> white.nis.low < 1 < white.nis.high
    True
    """
    if len(noise) < 2:
        raise ValueError(f"noise must have two runs or more, got {len(noise)}")
    if noise.shape[-1] <= settle + lags:
        raise ValueError(
            f"noise must have more than settle + lags = {settle + lags} samples, "
            f"got {noise.shape[-1]}"
        )
    R = np.mean(noise**2)
    if not R * q * r > 0:
        raise ValueError(f"noise must have a power above zero, got {R}")
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
    return RandomWalkFilter(
        nis=mean_interval(np.mean(track.nis[..., k], axis=-1)),
        nees=mean_interval(np.mean(error**2 / track.P[..., k, 0, 0], axis=-1)),
        autocorrelation=tuple(mean_interval(p / power) for p in products),
    )
