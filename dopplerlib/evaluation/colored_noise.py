"""Kalman filters under colored measurement noise, taken for white or treated."""

from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Count, Index, Positive, Real, Runs, checked, exactly
from .._records import record
from .._typing import ArrayLike, FloatArray
from ..estimation.colored_errors import augment_linear
from ..estimation.linear_kalman import kf
from ..estimation.thinning import remedy_errors
from .intervals import ConfidenceInterval, mean_interval
from .whiteness import innovation_whiteness

_WHITE = 1e-3  # of sigma: `kf` wants some white noise beside the colored one


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


@record
class RemedyRuns:
    """Runs of a filter under correlated errors, after it has settled.

    Attributes
    ----------
    squared_error : ndarray, shape (runs, n)
        Mean square of the error of each component.
    nis : ndarray, shape (runs,)
        Mean NIS over its degrees of freedom; 1 if the filter is consistent.
    nees : ndarray, shape (runs,)
        Mean NEES over its degrees of freedom; 1 if the filter is consistent.
    autocorrelation : ndarray, shape (runs, lags)
        Of the innovations, mean over the components, at lags 1, 2, ... of the samples used.
    p_value : ndarray, shape (runs,)
        Of the test that the innovations are white.
    """

    squared_error: np.ndarray
    nis: np.ndarray
    nees: np.ndarray
    autocorrelation: np.ndarray
    p_value: np.ndarray


@checked
@_checks.quiet
def remedy_runs(
    F: ArrayLike,
    Q: ArrayLike,
    H: ArrayLike,
    rho: Real,
    every: Count = 1,
    *,
    rng: np.random.Generator,
    runs: Runs = 100,
    samples: Count = 300,
    settle: Index = 100,
    lags: Count = 10,
) -> dict[str, RemedyRuns]:
    """Track through AR(1) errors of variance 1 with the four filters of `remedy_errors`.

    Parameters
    ----------
    F, Q, H, rho, every
        See `remedy_errors`; `rho` is above zero.
    rng : numpy.random.Generator
        Source of states and errors, which all filters share.
    runs : int
        Number of records.
    samples : int
        Their length; every filter has more than `lags` of them after `settle`.
    settle : int
        Number of samples that are left out at the start.
    lags : int
        Lags of the test of whiteness.

    Returns
    -------
    dict of str to RemedyRuns
        "white", "inflated", "thinned" and "colored".

    Notes
    -----
    The filters start with the covariance of the white one in steady state, and with an error of
    that size.

    Examples
    --------
    A slow random walk. Neighboring innovations are alike if the errors are taken for white:

    >>> rng = np.random.default_rng(1)
    >>> found = remedy_runs([[1]], [[1e-3]], [[1]], 0.8, rng=rng, runs=20)
    >>> for name in ("white", "colored"):
    ...     print(name, round(float(found[name].autocorrelation[:, 0].mean()), 1))
    white 0.8
    colored 0.0
    """
    if not 0 < rho < 1:
        raise ValueError(f"rho must be inside (0, 1), got {rho}")
    F, Q, H = (_checks.finite(name, one) for name, one in (("F", F), ("Q", Q), ("H", H)))
    P0 = remedy_errors(F, Q, H, rho, every)["white"].actual
    if samples - settle <= lags * every:
        raise ValueError(
            f"samples must be above settle + lags every = {settle + lags * every}, got {samples}"
        )
    m, n = H.shape
    errors = rng.standard_normal((samples, runs, m))
    x = rng.multivariate_normal(np.zeros(n), P0, runs)
    pushes = rng.multivariate_normal(np.zeros(n), Q, (samples, runs))
    truth = np.empty((runs, samples, n))
    z = np.empty((runs, samples, m))
    for k in range(samples):
        x = x @ F.T + pushes[k]
        if k:
            errors[k] = rho * errors[k - 1] + np.sqrt(1 - rho**2) * errors[k]
        truth[:, k], z[:, k] = x, x @ H.T + errors[k]
    _checks.estimates("F, Q and H", z, what="measurements")
    one, start = np.eye(m), (np.zeros(n), P0)
    kept = np.arange(samples) % every == 0
    colored = augment_linear(F, Q, H, _WHITE**2 * one, *start, sigma=1, tau=-1 / np.log(rho), T=1)
    tracks = {
        "white": kf(z, F, Q, H, one, *start),
        "inflated": kf(z, F, Q, H, (1 + rho) / (1 - rho) * one, *start),
        "thinned": kf(np.where(kept[:, None], z, np.nan), F, Q, H, one, *start),
        "colored": kf(z, *colored),
    }
    after = np.arange(samples) >= settle
    return {
        name: _judged(track, truth, after, after & kept if name == "thinned" else after, lags)
        for name, track in tracks.items()
    }


def _judged(track, truth, after, used, lags):
    """Return errors and statistics of a settled track; `used` are the samples of its updates."""
    n, m = truth.shape[-1], track.S.shape[-1]
    error = (track.x[..., :n] - truth)[:, after]
    weighted = np.linalg.solve(track.P[:, after, :n, :n], error[..., None])[..., 0]
    white = innovation_whiteness(track.innovation[:, used], track.S[:, used], lags)
    return RemedyRuns(
        squared_error=np.mean(error**2, axis=1),
        nis=np.mean(track.nis[:, used], axis=1) / m,
        nees=np.mean(np.sum(error * weighted, axis=-1), axis=1) / n,
        autocorrelation=np.mean(white.autocorrelation, axis=-1),
        p_value=white.p_value,
    )
