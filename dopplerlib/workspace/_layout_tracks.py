"""Layouts of sensors judged by the tracker: errors, consistency and wrong valleys."""

import numpy as np

from .._records import record
from ..estimation.gaussian_sum import gaussian_sum
from ..evaluation.path_bounds import path_crlb
from .errors import BOUNDS, FAR
from .layout_results import TIMES
from .targets import (
    INTERVAL,
    PRIOR_COVARIANCE,
    PRIOR_MEAN,
    SIGMA_A,
    SIGMA_F,
    draw_records,
    draw_targets,
)

_EVERY = 10  # samples from one estimate to the next
_HEAVIEST = 16  # members of the sum that are looked at


@record
class LayoutTracks:
    """Errors of the Gaussian sum filter before one array; NaN where a record has ended.

    Attributes
    ----------
    position, range : ndarray, shape (runs, 4)
        Error in m of the position, and of its distance from the origin, after 0.01, 0.1, 0.2 and
        0.5 s.
    bound : ndarray, shape (runs, 4)
        Cramer-Rao bound of the position in m along the path, with the prior.
    nees : ndarray, shape (runs, 4)
        Normalized estimation error squared.
    wrong : ndarray, shape (runs, 4)
        Weight of the members on the other side (see Notes) whose position is off by more than 5 cm.
    """

    position: np.ndarray
    range: np.ndarray
    bound: np.ndarray
    nees: np.ndarray
    wrong: np.ndarray

    @property
    def lost(self):
        """Whether a position is off by more than 5 cm and 4 bounds; NaN without a record."""
        lost = (self.position > FAR) & (self.position > BOUNDS * self.bound)
        return np.where(np.isnan(self.position), np.nan, lost)


def track_layout(array, runs, *, truths, noise, x0=None):
    """Track targets of the workspace, with process noise, before an array.

    Parameters
    ----------
    array : RadarArray
        Sensors near the plane x = 0.
    runs : int
        Number of targets.
    truths, noise : numpy.random.Generator
        Sources of the paths and of the noise, see `draw_targets`.
    x0 : array_like, shape (6,), optional
        State of all targets at time zero in m and m/s; from the prior if None.

    Returns
    -------
    LayoutTracks

    Notes
    -----
    With m = beta - b eta of ring coordinates, the second valley has delta = eta - m / b turned by
    about half a turn. A member is on the other side if its delta has a negative product with the
    true one.
    """
    samples = round(TIMES[-1] / INTERVAL)
    paths = draw_targets(runs, rng=truths, x0=x0, samples=samples)
    z = draw_records(paths, rng=noise, array=array)
    track = gaussian_sum(
        z, array, PRIOR_MEAN, PRIOR_COVARIANCE, INTERVAL, SIGMA_A, SIGMA_F,
        every=_EVERY, mixture=_HEAVIEST,
    )  # fmt: skip
    bounds = path_crlb(paths, array, SIGMA_F, PRIOR_COVARIANCE, INTERVAL, SIGMA_A, every=_EVERY)
    at = [round(t / INTERVAL / _EVERY) - 1 for t in TIMES]
    x = paths[:, _EVERY - 1 :: _EVERY][:, at]
    ended = np.isnan(x[..., 0])
    P = np.where(ended[..., None, None], np.eye(6), track.P[:, at])
    error = np.where(ended[..., None], np.nan, track.x[:, at] - x)
    solved = np.linalg.solve(P, np.nan_to_num(error)[..., None])[..., 0]
    bound = np.sqrt(np.trace(bounds[:, at, :3, :3], axis1=-2, axis2=-1))
    means, weights = track.means[:, at], track.weights[:, at]
    other = np.sum(_delta(means, array) * _delta(x, array)[..., None, :], axis=-1) < 0
    off = np.linalg.norm(means[..., :3] - x[..., None, :3], axis=-1)
    other &= off > FAR
    return LayoutTracks(
        np.linalg.norm(error[..., :3], axis=-1),
        np.abs(np.linalg.norm(track.x[:, at, :3], axis=-1) - np.linalg.norm(x[..., :3], axis=-1)),
        bound,
        np.where(ended, np.nan, np.sum(error * solved, axis=-1)),
        np.where(ended, np.nan, np.sum(weights * other, axis=-1)),
    )


def _delta(x, array):
    """Return eta - m / b (..., 2), by which the target does not come straight along its sight."""
    around = array.positions - array.positions.mean(axis=0)
    square = np.mean(np.sum(around**2, axis=-1))
    p, v = x[..., :3], x[..., 3:]
    square = np.sum(p * p, axis=-1, keepdims=True) + square
    return 2 * p[..., 1:] / square - v[..., 1:] / np.sum(p * v, axis=-1, keepdims=True)
