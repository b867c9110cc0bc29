"""The posterior of a target before a plane array by importance sampling: a yardstick."""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Count, Positive, checked, up_to
from .._records import record
from .._typing import ArrayLike
from ..kernels import ring_coordinates as kernel
from ..model.motion import constant_velocity, ncv_transition
from ..model.radar_array import RadarArray
from ._ekf_setting import measurements, variances
from ._gaussian_sum_setting import _frame
from ._student_mixture import StudentMixture, efficiency, normalized
from .gaussian_sum import gaussian_sum

_BACKWARD = np.array([1.0, 1, 1, -1, -1, -1])  # of a state: that in reversed time
_MEMBERS = 100  # of the Gaussian sum that are taken, at most
_ROUNDS, _ENOUGH = 4, 0.5  # fits, at most, of the proposal; efficiency at which none follows
_BLOCK = 5  # samples that the Gaussian sum takes together, at most
_CLEAR = 1.1  # times the distance from the plane at which a Gaussian sum takes states
_BACK = 4.0  # times the covariance at the end, from which the Gaussian sum goes back
_NONE = np.nan, np.nan, 0.0, np.nan, np.nan  # where no state was found


@record
class ImportancePosterior:
    """Posterior of the state at the last sample; leading axes are those of the measurements.

    Attributes
    ----------
    x : ndarray, shape (..., 6)
        Mean in m and m/s; NaN if the Gaussian sum found no state.
    P : ndarray, shape (..., 6, 6)
        Covariance.
    efficiency : ndarray, shape (...)
        Effective sample size as a fraction of the draws.
    states : ndarray, shape (..., S, 6)
        The draws: states at the last sample; with process noise their means, given that at the
        first.
    weights : ndarray, shape (..., S)
        Their weights, of sum one.
    """

    x: np.ndarray
    P: np.ndarray
    efficiency: np.ndarray
    states: np.ndarray
    weights: np.ndarray


@checked
@_checks.quiet
def importance_posterior(
    z: ArrayLike,
    array: RadarArray,
    x0: ArrayLike,
    P0: ArrayLike,
    T: Positive,
    sigma_a: float,
    sigma_f: ArrayLike,
    noise: Literal["shared", "per_axis"] = "per_axis",
    *,
    rng: np.random.Generator,
    draws: Annotated[int, up_to(10**6, least=100)] = 2000,
    inflation: Positive = 1.3,
    workers: Count | None = None,
) -> ImportancePosterior:
    """Return the posterior of the state at the last sample, given records of Doppler shifts.

    Parameters
    ----------
    z : array_like, shape (..., K, N)
        Doppler measurements in Hz; NaN says that this sensor is missing at this sample.
    array : RadarArray
        N sensors in a plane, not all on a line.
    x0, P0 : array_like, shape (6,) and (6, 6)
        Mean and covariance of the prior, one interval before the first sample; see `gaussian_sum`.
    T : float
        Sampling interval in s.
    sigma_a : float
        Standard deviation of the acceleration in m/s^2, see `constant_velocity`; zero if the
        velocity is constant, and known to be.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz.
    noise : {"shared", "per_axis"}
        Process noise, see `constant_velocity`.
    rng : numpy.random.Generator
        Source of randomness, a child for each record.
    draws : int
        Number of states S.
    inflation : float
        Factor of the covariances from which states are drawn. The result does not depend on it,
        but for the scatter of the draws.
    workers : int, optional
        Threads among which the records are shared; one for each processor if None. The result does
        not depend on it.

    Returns
    -------
    ImportancePosterior

    Notes
    -----
    States at the *first* sample are drawn, and weighted by prior and likelihood of the whole
    record: exactly if the velocity is constant. Process noise is integrated out along each path by
    an EKF of zero start covariance, which is linear to rounding as long as the noise moves the
    target by little against its distance.

    Draws come from a mixture of Student distributions in ring coordinates (`to_ring_coordinates`).
    Its first members are those of a Gaussian sum that goes back from the end of the record to the
    first sample; it is then fitted to the weighted draws, up to three times, weights being raised
    to a power that leaves enough of them (adaptive importance sampling; Cappé et al. 2008). Only
    draws of the last round count.

    Examples
    --------
    After 20 ms a ring of 0.2 m knows the distance of a target to a decimeter, no better:

    >>> from dopplerlib import doppler_shift
    >>> array, rng = RadarArray.ring(6, 0.2), np.random.default_rng(1)
    >>> path = np.tile([0.83, 0.11, 0.09, -0.75, -0.13, -0.02], (20, 1))
    >>> path[:, :3] += 1e-3 * np.arange(20)[:, None] * path[:, 3:]
    >>> z = doppler_shift(path, array) + 0.4 * rng.standard_normal((20, 6))
    >>> prior = [0.8, 0, 0, -0.75, 0, 0], np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
    >>> found = importance_posterior(z, array, *prior, 1e-3, 0.0, 0.4, rng=rng, draws=400)
    >>> bool(found.P[0, 0] ** 0.5 > 0.1)
    True
    """
    z = measurements(z, array)
    batch, (K, N) = z.shape[:-2], z.shape[-2:]
    variance = variances(sigma_f, (K, N))
    x0 = _checks.exact_shape("x0", _checks.moderate("x0", x0, (6,)), (6,))
    P0 = _checks.exact_shape("P0", _checks.covariance("P0", P0, 6), (6, 6))
    steady = _checks.one_number("sigma_a", sigma_a) == 0
    motion = {"T": T, "sigma_a": sigma_a, "noise": noise, "block": min(_BLOCK, K)}
    z = np.ascontiguousarray(z).reshape(-1, K, N)
    deviation = np.sqrt(variance)
    forward = gaussian_sum(z, array, x0, P0, sigma_f=deviation, every=K, workers=workers, **motion)

    F = ncv_transition(T, 3, "derivative")
    Q = np.zeros((6, 6)) if steady else constant_velocity(T, sigma_a, noise)[1]
    mean, information = F @ x0, np.linalg.inv(F @ P0 @ F.T + Q)
    center, axes, radius, *_, least = _frame(array, x0)
    to_ring, from_ring = _coordinates(center, axes, radius)
    weights = 1 / variance

    # Here, and not above, so that importing the library does not load numba.
    from ._importance_loop import record_likelihood

    def members(run):
        """Return a Gaussian sum of the first sample. Backward in time, shifts change their sign."""
        x, P = F @ forward.x[run, -1], _BACK * forward.P[run, -1]
        short = _CLEAR * least - axes[0] @ (x[:3] - center)
        if short > 0:  # at the sensors' plane no sum begins; draws need no more than to cover
            x[:3] += short * axes[0]
            P[:3, :3] += short**2 * np.outer(axes[0], axes[0])
        found = gaussian_sum(
            -z[run, ::-1], array, _BACKWARD * x, _backward(P), sigma_f=deviation[::-1],
            every=K, mixture=_MEMBERS, workers=1, **motion,
        )  # fmt: skip
        there = found.weights[-1] > 0
        x, P = _BACKWARD * found.means[-1, there], _backward(found.covariances[-1, there])
        return found.weights[-1, there], x, P

    def weigh(run, x):
        """Return the log density of prior and record at states (S, 6), and states at the end."""
        apart = x - mean
        x, P, likelihood = x.copy(), np.empty((draws, 6, 6)), np.empty(draws)
        record_likelihood(
            np.nan_to_num(z[run]), np.where(np.isnan(z[run]), 0.0, weights), x, array.positions,
            array.doppler_per_speed, float(T), Q, likelihood, P,
        )  # fmt: skip
        prior = -0.5 * np.einsum("si,ij,sj->s", apart, information, apart)
        return np.where(np.isnan(likelihood), -np.inf, likelihood + prior), x, P

    def one(run, rng):
        if np.isnan(forward.x[run, -1]).any():
            return _NONE
        weight, *moments = members(run)
        if not len(weight):
            return _NONE
        proposal = StudentMixture.around(weight, *_cubature(to_ring, *moments, inflation))
        for rounds in range(_ROUNDS):
            xi = proposal.draw(draws, rng)
            x, log_volume = from_ring(xi)
            log_target, ends, P = weigh(run, x)
            log_weight = log_target + log_volume - proposal.log_density(xi)
            w = normalized(log_weight)
            if rounds + 1 == _ROUNDS or efficiency(w) >= _ENOUGH:
                break
            proposal = proposal.fitted(xi, log_weight, inflation)
        x = w @ ends
        apart = ends - x
        P = np.einsum("s,sij->ij", w, P) + np.einsum("s,si,sj->ij", w, apart, apart)
        return x, P, efficiency(w), ends, w

    with ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
        parts = list(pool.map(one, range(len(z)), rng.spawn(len(z))))
    shapes = (6,), (6, 6), (), (draws, 6), (draws,)
    values = (
        np.array([np.broadcast_to(part[i], shape) for part in parts]).reshape((*batch, *shape))
        for i, shape in enumerate(shapes)
    )
    return ImportancePosterior(*values)


def _backward(P):
    return P * np.outer(_BACKWARD, _BACKWARD)


def _coordinates(center, axes, radius):
    """Return functions from states (..., 6) to ring coordinates in the frame of an array, and back.

    The latter also returns the logarithm of the volume of states over that of coordinates; it is
    -inf where there is no state.
    """
    turn = np.kron(np.eye(2), axes)
    origin = np.concatenate([center, np.zeros(3)])

    def to_ring(x):
        local = (x - origin) @ turn.T
        *seen, rho = kernel.to_coordinates(*np.moveaxis(local, -1, 0), radius)
        return np.stack([*seen, np.log(rho)], axis=-1)

    def from_ring(xi):
        *seen, scale = np.moveaxis(xi, -1, 0)
        with np.errstate(all="ignore"):
            local = np.stack(kernel.to_state(*seen, rho=np.exp(scale), r=radius)[:6], axis=-1)
            log_volume = 9 * scale - 2 * np.log(local[..., 0])
        there = np.isfinite(local).all(axis=-1) & np.isfinite(log_volume)
        local = np.where(there[..., None], local, radius)  # of no weight, wherever it is
        return local @ turn + origin, np.where(there, log_volume, -np.inf)

    return to_ring, from_ring


def _cubature(function, x, P, inflation):
    """Return means (M, n) and covariances (M, n, n) of a function of Gaussians, these inflated."""
    n = x.shape[-1]
    away = np.sqrt(n) * np.linalg.cholesky(P).mT
    y = function(x[:, None] + np.concatenate([away, -away], axis=1))
    mean = y.mean(axis=1)
    apart = y - mean[:, None]
    return mean, inflation * np.einsum("msi,msj->mij", apart, apart) / (2 * n)
