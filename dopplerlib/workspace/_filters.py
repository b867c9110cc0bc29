"""Starts and filters of which the trackers of the workspace are made; unchecked."""

from typing import Any, NamedTuple

import numpy as np

from .._typing import FloatArray
from ..estimation import covariances, recursion
from ..estimation.extended_kalman import ekf
from ..estimation.gaussian_sum import gaussian_sum
from ..estimation.maximum_likelihood import ml_initialize
from ..estimation.nonlinear_kalman import ekf_records, ukf
from ..estimation.ring_model import RingModel
from ..model.doppler import doppler_jacobian, doppler_shift
from ..model.motion import constant_velocity, dwna_gain
from ..model.radar_array import RadarArray
from .targets import INTERVAL

FIRST = 10  # samples from which a start is made
ITERATIONS = 3  # linearizations of filters that iterate
PARTICLES = 3000
NOISES = 0.0, 0.1, 0.4  # accelerations in m/s^2 between which a sum finds out
_PAPER_P0 = 0.1 * np.eye(6)
# Where maximum likelihood searches: the room before the ring, and the speed of the paper's drives.
_BOX = [0.1, -0.75, -0.75, -2, -2, -2], [1.5, 0.75, 0.75, 2, 2, 2]


class Setting(NamedTuple):
    """Knowledge of a tracker beside the records, and the samples at which it is asked."""

    array: RadarArray
    sigma_a: float
    sigma_f: float
    mean: FloatArray
    P: FloatArray
    every: int
    rng: Any

    @property
    def given(self):
        """Arguments of `gaussian_sum` after the measurements."""
        return self.array, self.mean, self.P, INTERVAL, self.sigma_a, self.sigma_f

    @property
    def R(self):
        """Covariance of the measurements of a sample."""
        return self.sigma_f**2 * np.eye(len(self.array))


# Starts return the number of samples used, x (runs, 6) and P (runs, 6, 6) at the last of them.


def from_prior(z, s):
    """Return the prior itself, which is of time zero."""
    return 0, np.broadcast_to(s.mean, (len(z), 6)), np.broadcast_to(s.P, (len(z), 6, 6))


def from_bayes(z, s):
    """Return mean and covariance of the posterior of the first samples."""
    found = gaussian_sum(z[:, :FIRST], *s.given, every=FIRST)
    return FIRST, found.x[:, 0], found.P[:, 0]


def from_likelihood(z, s):
    """Return the likeliest state and its covariance, that of the prior if it has none."""
    found = ml_initialize(z[:, :FIRST], s.array, s.sigma_f, INTERVAL, _BOX, at="last")
    return FIRST, found.x, np.where(found.identifiable[:, None, None], found.P, s.P)


def from_paper(z, s):
    """Return the likeliest state and the covariance of the paper."""
    first, x, _ = from_likelihood(z, s)
    return first, x, np.broadcast_to(_PAPER_P0, (len(z), 6, 6))


# Filters return x (runs, K, 6) and P (runs, K, 6, 6).


def extended(z, s, x, P):
    """Filter by the extended Kalman filter."""
    track = ekf(z, s.array, x, P, INTERVAL, s.sigma_a, s.sigma_f, noise="per_axis")
    return track.x, track.P


def iterated(z, s, x, P):
    """Filter by the iterated extended Kalman filter."""
    f, F, Q, h, H = in_state(s)
    track = ekf_records(z, f, F, Q, h, H, s.R, x, P, iterations=ITERATIONS)
    return track.x, track.P


def cubature(z, s, x, P, iterations=1):
    """Filter by sigma points."""
    f, _, Q, h, _ = in_state(s)
    track = ukf(z, f, Q, h, s.R, x, P, iterations=iterations)
    return track.x, track.P


def posterior_linearization(z, s, x, P):
    """Filter by sigma points that are drawn anew from the posterior."""
    return cubature(z, s, x, P, ITERATIONS)


def ring_extended(z, s, x, P, iterations=1):
    """Filter by the extended Kalman filter in ring coordinates."""
    m = RingModel(s.array, INTERVAL, s.sigma_a)
    start = m.start(x, P)
    track = ekf_records(z, m.f, m.F, m.Q, m.h, m.H, s.R, *start, iterations=iterations)
    return m.state(track.x, track.P)


def ring_iterated(z, s, x, P):
    """Filter by the iterated extended Kalman filter in ring coordinates."""
    return ring_extended(z, s, x, P, ITERATIONS)


def ring_cubature(z, s, x, P, iterations=1):
    """Filter by sigma points in ring coordinates."""
    m = RingModel(s.array, INTERVAL, s.sigma_a)
    track = ukf(z, m.f, m.Q, m.h, s.R, *m.start(x, P), iterations=iterations)
    return m.state(track.x, track.P)


def ring_posterior_linearization(z, s, x, P):
    """Filter by sigma points from the posterior in ring coordinates."""
    return ring_cubature(z, s, x, P, ITERATIONS)


def in_state(s):
    """Return f, F, Q, h and H of the Cartesian model."""
    F, Q = constant_velocity(INTERVAL, s.sigma_a, "per_axis")
    return (
        lambda x: x @ F.T,
        lambda x: np.broadcast_to(F, (*x.shape, 6)),
        Q,
        lambda x: doppler_shift(x, s.array),
        lambda x: doppler_jacobian(x, s.array),
    )


# Trackers that are not a filter after a start return x (runs, O, 6) and P (runs, O, 6, 6).


def bank(z, s):
    """Filter by the Gaussian sum."""
    found = gaussian_sum(z, *s.given, every=s.every)
    return found.x, found.P


def learning_bank(z, s):
    """Filter by Gaussian sums for several accelerations, weighed by their evidence."""
    found = gaussian_sum(z, s.array, s.mean, s.P, INTERVAL, NOISES, s.sigma_f, every=s.every)
    return found.x, found.P


def batch(z, s):
    """Fit a straight path to all samples so far, whatever `s.sigma_a` is, and without the prior."""
    ends = range(s.every, z.shape[1] + 1, s.every)
    found = [ml_initialize(z[:, :k], s.array, s.sigma_f, INTERVAL, _BOX, at="last") for k in ends]
    return np.stack([f.x for f in found], axis=1), np.stack([f.P for f in found], axis=1)


def particles(z, s):
    """Filter run by run by the regularized particle filter."""
    children = s.rng.spawn(len(z))
    tracks = [_particles(one, s, child) for one, child in zip(z, children, strict=True)]
    x, P = (np.stack(part)[:, s.every - 1 :: s.every] for part in zip(*tracks, strict=True))
    return x, P


def _particles(z, s, rng):
    """Return means (K, 6) and covariances (K, 6, 6) of one record z (K, N).

    Musso, Oudjane and Le Gland (2001): particles are drawn anew where their weights amount to less
    than half of them, and moved by a Gaussian kernel of the width that is best for a Gaussian. They
    are drawn together before, so that their covariance stays (West 1993).
    """
    n = 6
    width = (4 / (n + 2) / PARTICLES) ** (1 / (n + 4))
    G, sigma_a = dwna_gain(np.array(INTERVAL), s.sigma_a, "per_axis")

    def step(k, state):
        x, log = state
        push = sigma_a * rng.standard_normal((PARTICLES, 3)) @ G.T
        x = x + INTERVAL * np.pad(x[:, 3:], ((0, 0), (0, 3))) + push
        residual = np.nan_to_num((z[k] - doppler_shift(x, s.array)) / s.sigma_f)
        log = log - np.sum(residual**2, axis=-1) / 2
        w = np.exp(log - log.max())
        w /= w.sum()
        mean = w @ x
        spread = np.sqrt(w)[:, None] * (x - mean)
        P = spread.T @ spread
        if 1 / np.sum(w**2) < PARTICLES / 2:
            places = (rng.random() + np.arange(PARTICLES)) / PARTICLES
            x = x[np.searchsorted(np.cumsum(w), places).clip(max=PARTICLES - 1)]
            x = mean + np.sqrt(1 - width**2) * (x - mean)
            kernel = width * covariances.square_root(P)
            x = x + rng.standard_normal((PARTICLES, n)) @ kernel.T
            log = np.zeros(PARTICLES)
        return (x, log), (mean, P)

    x = s.mean + rng.standard_normal((PARTICLES, n)) @ covariances.square_root(s.P).T
    return recursion.scan(step, (x, np.zeros(PARTICLES)), range(len(z)))
