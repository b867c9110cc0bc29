"""Targets that appear in front of the paper's ring and come near, and their Doppler records.

``ARRAY``, ``INTERVAL``, ``SIGMA_F``, ``SIGMA_A`` and ``TABLE_2`` are those of the paper. The prior,
``PRIOR_MEAN`` and ``PRIOR_COVARIANCE``, is that of truths and of trackers, at time zero; the
samples are at ``INTERVAL``, 2 ``INTERVAL``, ..., ``SAMPLES`` times ``INTERVAL``.
"""

from functools import partial
from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Count, Covariance, Positive, Runs, State, between, checked
from .._typing import FloatArray
from ..estimation import covariances
from ..model.doppler import doppler_shift
from ..model.radar_array import RadarArray

# The paper's: a test compares them with `data/`, which no module reads when it is imported.
ARRAY = RadarArray.ring(6, 0.2)
INTERVAL, SAMPLES = 1e-3, 1000
SIGMA_F = 0.4  # in Hz
SIGMA_A = 0.4  # in m/s^2, of each axis on its own
TABLE_2 = np.array([0.833, 0.111, 0.092, -0.75, -0.125, -0.018])

PRIOR_MEAN = np.array([0.8, 0.0, 0.0, -0.75, 0.0, 0.0])
PRIOR_COVARIANCE = np.diag(np.array([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2)
for _value in (TABLE_2, PRIOR_MEAN, PRIOR_COVARIANCE):
    _value.flags.writeable = False

NEAREST = 0.05  # in m: a record ends nearer to the plane of the ring, or to a sensor
_NEAREST_START, _FARTHEST_START = 0.45, 1.35  # in m: distance from the plane, from the center
_CLEAR = 200  # samples that every record has
_ATTEMPTS = 10_000  # to draw one target


@checked
def draw_targets(
    runs: Runs,
    *,
    rng: np.random.Generator,
    sigma_a: Annotated[float, between(0, 1e60)] = SIGMA_A,
    x0: State | None = None,
    prior: tuple[State, Covariance] = (PRIOR_MEAN, PRIOR_COVARIANCE),
    samples: Count = SAMPLES,
    array: RadarArray = ARRAY,
) -> FloatArray:
    """Draw the true paths of targets.

    Parameters
    ----------
    runs : int
        Number of targets.
    rng : numpy.random.Generator
        Source of randomness. Every run draws from a child of its own: run 3 is the same whether 10
        or 10 000 are asked for, and a second call goes on with the next runs.
    sigma_a : float
        Standard deviation in m/s^2 of the acceleration of each axis, constant during an interval
        and independent of the next one. Zero is uniform motion.
    x0 : array_like, shape (6,), optional
        State at time zero, in m and m/s. If None it is drawn from the prior, with x above 0.45 m,
        less than 1.35 m from the origin, and so that the record lasts for 0.2 s at least.
    prior : pair of array_like, shapes (6,) and (6, 6)
        Mean and covariance of the state at time zero. If hardly any state is as described above,
        that is an error.
    samples : int
        Number of samples K. Shorter paths are beginnings of longer ones.
    array : RadarArray
        Sensors that end a record.

    Returns
    -------
    ndarray, shape (runs, K, 6)
        States in m and m/s, the first one interval after time zero. They are NaN from the sample on
        at which the record has ended: nearer than 0.05 m to the plane x = 0 or to a sensor.

    Examples
    --------
    >>> paths = draw_targets(2, rng=np.random.default_rng(1), samples=300)
    >>> paths.shape, bool(np.isfinite(paths[:, :200]).all())
    ((2, 300, 6), True)
    """
    mean, root = prior[0], covariances.square_root(prior[1])
    paths = []
    for child in rng.spawn(runs):
        start = partial(_start, child, mean, root) if x0 is None else x0
        paths.append(_path(child, sigma_a, start, samples, array))
    return np.stack(paths)


@checked
def draw_records(
    paths: Annotated[FloatArray, partial(_checks.bounded, shape=(None, None, 6))],
    *,
    rng: np.random.Generator,
    array: RadarArray = ARRAY,
    sigma_f: Positive = SIGMA_F,
) -> FloatArray:
    """Return Doppler shifts along true paths, with white noise.

    Parameters
    ----------
    paths : array_like, shape (runs, K, 6)
        True states in m and m/s; NaN where there is no record.
    rng : numpy.random.Generator
        Source of randomness, a child for each run; another one than that of the paths.
    array : RadarArray
        The N sensors.
    sigma_f : float
        Standard deviation of a shift in Hz.

    Returns
    -------
    ndarray, shape (runs, K, N)
        Shifts in Hz, NaN where the path is.

    Examples
    --------
    >>> truths, noise = np.random.default_rng(1).spawn(2)
    >>> paths = draw_targets(2, rng=truths, samples=10)
    >>> draw_records(paths, rng=noise).shape
    (2, 10, 6)
    """
    there = ~np.isnan(paths).any(axis=-1)
    z = np.full((*paths.shape[:-1], len(array)), np.nan)
    z[there] = doppler_shift(paths[there], array)
    for child, record in zip(rng.spawn(len(z)), z, strict=True):
        record += sigma_f * child.standard_normal(record.shape)
    return z


def _path(rng, sigma_a, x0, samples, array):
    """Return one path (K, 6), from a state or from one that `x0` draws until all is clear."""
    for _ in range(_ATTEMPTS):
        start = x0() if callable(x0) else x0
        head = _moved(start, sigma_a * rng.standard_normal((_CLEAR, 3)))
        inside = start[0] > _NEAREST_START and np.linalg.norm(start[:3]) < _FARTHEST_START
        if not callable(x0) or (inside and not _ended(head, array).any()):
            break
    else:
        raise ValueError(f"prior must have room for targets, got none in {_ATTEMPTS} attempts")
    more = max(samples - _CLEAR, 0)
    path = np.concatenate([head, _moved(head[-1], sigma_a * rng.standard_normal((more, 3)))])
    path = path[:samples]
    path[np.maximum.accumulate(_ended(path, array))] = np.nan
    return path


def _start(rng, mean, root):
    return mean + root @ rng.standard_normal(6)


def _moved(x, a):
    """Return the states (K, 6) after each of the intervals with accelerations (K, 3)."""
    v = x[3:] + INTERVAL * np.cumsum(a, axis=0)
    before = np.concatenate([x[None, 3:], v[:-1]]) if len(v) else v
    p = x[:3] + INTERVAL / 2 * np.cumsum(before + v, axis=0)
    return np.concatenate([p, v], axis=-1)


def _ended(path, array):
    apart = path[:, None, :3] - array.positions
    near = np.einsum("kni,kni->kn", apart, apart).min(axis=1) < NEAREST**2
    return near | (path[:, 0] < NEAREST)
