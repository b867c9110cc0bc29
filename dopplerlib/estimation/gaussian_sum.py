"""A Gaussian sum filter for Doppler shifts at a plane array, from a broad prior."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Count, Positive, Probability, checked, up_to
from .._records import record
from .._typing import ArrayLike
from ..model.radar_array import RadarArray
from ._ekf_setting import measurements, variances
from ._gaussian_sum_average import average
from ._gaussian_sum_setting import Estimates, blank, new_bank, prepare, to_caller

_Members = Annotated[int, up_to(1000, least=0)]


@record
class GaussianSumTrack:
    """Estimates of a Gaussian sum filter; leading axes are those of the measurements.

    Attributes
    ----------
    x : ndarray, shape (..., O, 6)
        Mean of the state in m and m/s; NaN before the first block and if all members are lost.
    P : ndarray, shape (..., O, 6, 6)
        Covariance of the state.
    members : ndarray of int, shape (..., O)
        Gaussians that the sum has then.
    weights : ndarray, shape (..., O, M)
        Weights of the M heaviest Gaussians, the heaviest first; 0 where there are fewer. They add
        up to one if none is left out.
    means : ndarray, shape (..., O, M, 6)
        Mean of the state in m and m/s under each of them, NaN where there are fewer.
    covariances : ndarray, shape (..., O, M, 6, 6)
        Covariance of the state under each of them, NaN where there are fewer.
    evidence : ndarray, shape (..., O)
        Logarithm of the density of the measurements up to the last multiple of `block` samples,
        in 1/Hz to the power of their number; -inf where there is no Gaussian.
    probabilities : ndarray, shape (..., O, S)
        Probability of each `sigma_a` given these measurements.
    """

    x: np.ndarray
    P: np.ndarray
    members: np.ndarray
    weights: np.ndarray
    means: np.ndarray
    covariances: np.ndarray
    evidence: np.ndarray
    probabilities: np.ndarray


@checked
@_checks.quiet
def gaussian_sum(
    z: ArrayLike,
    array: RadarArray,
    x0: ArrayLike,
    P0: ArrayLike,
    T: Positive,
    sigma_a: ArrayLike,
    sigma_f: ArrayLike,
    noise: Literal["shared", "per_axis"] = "per_axis",
    *,
    every: Count = 1,
    mixture: _Members = 0,
    block: Count = 5,
    lightest: Probability = 1e-8,
    loss: Positive = 1e-3,
    gate_probability: Probability | None = None,
    workers: Count | None = None,
) -> GaussianSumTrack:
    """Filter records of Doppler shifts with a sum of Gaussians in ring coordinates.

    The filter needs no initial estimate, only a prior, which may be as broad as the workspace. It
    keeps the second state that a plane array confuses with the right one as long as it is likely.

    Parameters
    ----------
    z : array_like, shape (..., K, N)
        Doppler measurements in Hz; NaN says that this sensor is missing at this sample.
    array : RadarArray
        N sensors, not all on a line, in a plane or near it.
    x0 : array_like, shape (6,)
        Mean of the prior, one interval before the first sample, in m and m/s; not in the plane of
        the sensors. The target is on the same side.
    P0 : array_like, shape (6, 6)
        Covariance of the prior, positive definite.
    T : float
        Sampling interval in s.
    sigma_a : array_like, scalar or shape (S,)
        Standard deviation of the acceleration in m/s^2, see `constant_velocity`; 0 for a target
        that goes straight. Of several ones, any may be right: each has a filter of its own, and
        the estimate is their average by their evidence (Magill 1965).
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz.
    noise : {"shared", "per_axis"}
        Process noise, see `constant_velocity`.
    every : int
        Estimates are returned at the samples every - 1, 2 every - 1, ...
    mixture : int
        Number M of the heaviest Gaussians whose weights, means and covariances are returned, too.
    block : int
        Samples that are averaged while there are more than two Gaussians. In a block the target
        should turn little about any sensor.
    lightest : float
        Weight below which a Gaussian is dropped.
    loss : float
        Kullback-Leibler cost, at most, of uniting two Gaussians.
    gate_probability : float, optional
        Probability with which a right sample passes. A sample of one sensor whose distance from the
        filter's prediction is less likely is left out, in the first block one that is as far from
        its median. If None all count.
    workers : int, optional
        Threads among which the runs are shared; one for each processor if None. The result does
        not depend on it.

    Returns
    -------
    GaussianSumTrack
        O = K // every.

    Raises
    ------
    ValueError
        If an argument has the wrong shape or value, the sensors are on a line, or `x0` is not in
        front of them.

    Notes
    -----
    Alspach and Sorenson (1972); the coordinates are those of `to_ring_coordinates`, with the root
    of the sensors' mean squared distance from their center as the radius, in which no linearization
    invents knowledge of range. At the start, the prior and the first block are split by a grid of
    Gaussian windows over direction and range, coarse ones in the tails, as far as five deviations;
    in each the mode is found by Gauss and Newton, and Laplace's approximation gives weight and
    covariance. Every second block, the lightest Gaussians are united with their neighbors while the
    cost after Runnalls (2007) allows.

    An estimate is made from whole blocks: between the ends of two blocks it is a prediction.

    With ``sigma_a=0`` the scans are kept. After 30 blocks, and then whenever there are a quarter
    more, up to 512, each Gaussian is moved to the mode of the posterior given all of them, if at
    most twenty are left; equal modes become one, and weights are Laplace's. All stay as they are
    while a valley is still curved and needs several Gaussians: where the members are, those at the
    modes must have the density of the posterior, to a Kullback-Leibler cost of 0.05.

    Examples
    --------
    A second in front of the paper's ring, from a prior over the workspace:

    >>> from dopplerlib import doppler_shift
    >>> array = RadarArray.ring(6, 0.2)
    >>> path = np.tile([0.83, 0.11, 0.09, -0.75, -0.13, -0.02], (1000, 1))
    >>> path[:, :3] += 1e-3 * np.arange(1000)[:, None] * path[:, 3:]
    >>> z = doppler_shift(path, array) + 0.4 * np.random.default_rng(1).standard_normal((1000, 6))
    >>> prior = [0.8, 0, 0, -0.75, 0, 0], np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
    >>> found = gaussian_sum(z, array, *prior, T=1e-3, sigma_a=0.1, sigma_f=0.4, every=500)
    >>> bool(np.abs(found.x[-1, :3] - path[-1, :3]).max() < 0.005)
    True
    """
    z = measurements(z, array)
    weights = 1 / variances(sigma_f, z.shape[-2:])
    batch, (K, N) = z.shape[:-2], z.shape[-2:]
    rest = noise, block, lightest, loss, gate_probability
    prepared = [prepare(array, x0, P0, T, s, *rest) for s in _guesses(sigma_a)]
    z = np.ascontiguousarray(z).reshape(-1, K, N)
    for value in (z, weights):
        value.flags.writeable = False
    found = [blank(len(z), K // every, mixture=mixture) for _ in prepared]

    # Here, and not above, so that importing the library does not load numba.
    from ._gaussian_sum_loop import track

    def one(run):
        for (_, setting), arrays in zip(prepared, found, strict=True):
            out = Estimates(*(value[run] for value in arrays))
            track(setting, new_bank(setting), z[run], weights, every, out)

    with ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
        list(pool.map(one, range(len(z))))
    mean, probabilities = average(found)
    results = *to_caller(mean, prepared[0][0]), probabilities
    return GaussianSumTrack(*(value.reshape(*batch, *value.shape[1:]) for value in results))


@checked
@_checks.quiet
def gaussian_sum_online(
    array: RadarArray,
    x0: ArrayLike,
    P0: ArrayLike,
    T: Positive,
    sigma_a: ArrayLike,
    sigma_f: ArrayLike,
    noise: Literal["shared", "per_axis"] = "per_axis",
    *,
    mixture: _Members = 0,
    block: Count = 5,
    lightest: Probability = 1e-8,
    loss: Positive = 1e-3,
    gate_probability: Probability | None = None,
) -> Callable[[ArrayLike], GaussianSumTrack]:
    """Prepare the filter of `gaussian_sum` for samples that come one by one.

    Parameters
    ----------
    array : RadarArray
        N sensors, see `gaussian_sum`.
    x0 : array_like, shape (6,)
        Mean of the prior, one interval before the first sample, in m and m/s.
    P0 : array_like, shape (6, 6)
        Covariance of the prior.
    T : float
        Sampling interval in s.
    sigma_a : array_like, scalar or shape (S,)
        Standard deviation of the acceleration in m/s^2, or several ones, see `gaussian_sum`.
    sigma_f : array_like, broadcast to (N,)
        Standard deviation of the measurements in Hz.
    noise : {"shared", "per_axis"}
        Process noise, see `constant_velocity`.
    mixture, block : int
        See `gaussian_sum`.
    lightest, loss, gate_probability : float
        See `gaussian_sum`.

    Returns
    -------
    callable
        A function that takes the next sample (N,) in Hz, NaN for a missing sensor, and returns the
        estimate after it, a `GaussianSumTrack` without the axis of time: to the last bit what
        `gaussian_sum` returns. It remembers the samples before; each call of `gaussian_sum_online`
        gives another one, for another target.

    Raises
    ------
    ValueError
        As `gaussian_sum`; the function, if a sample has not N values.

    Examples
    --------
    >>> from dopplerlib import doppler_shift
    >>> array, x = RadarArray.ring(6, 0.2), np.array([0.8, 0.1, 0.1, -0.7, 0, 0])
    >>> prior = [0.8, 0, 0, -0.75, 0, 0], np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
    >>> update = gaussian_sum_online(array, *prior, T=1e-3, sigma_a=0.1, sigma_f=0.4)
    >>> for _ in range(5):
    ...     found = update(doppler_shift(x, array))
    >>> found.x.shape, int(found.members) > 10
    ((6,), True)
    """
    weights = 1 / variances(sigma_f, (1, len(array)))
    weights.flags.writeable = False
    rest = noise, block, lightest, loss, gate_probability
    prepared = [prepare(array, x0, P0, T, s, *rest) for s in _guesses(sigma_a)]
    banks = [new_bank(setting) for _, setting in prepared]

    @_checks.quiet
    def update(z: ArrayLike) -> GaussianSumTrack:
        """Take the next sample (N,) in Hz and return the estimate after it."""
        from ._gaussian_sum_loop import track

        sample = measurements(np.asarray(z)[None], array)
        sample.flags.writeable = False
        found = [blank(1, mixture=mixture) for _ in banks]
        for (_, setting), bank, out in zip(prepared, banks, found, strict=True):
            track(setting, bank, sample, weights, 1, out)
        mean, probabilities = average(found)
        results = *to_caller(mean, prepared[0][0]), probabilities
        return GaussianSumTrack(*(value[0] for value in results))

    return update


def _guesses(sigma_a):
    """Return one or several values of `sigma_a` as a tuple."""
    sigma_a = _checks.moderate("sigma_a", sigma_a)
    if sigma_a.ndim > 1 or not sigma_a.size:
        raise ValueError(
            f"sigma_a must be one number or one row of numbers, got shape {sigma_a.shape}"
        )
    return tuple(float(s) for s in np.atleast_1d(sigma_a))
