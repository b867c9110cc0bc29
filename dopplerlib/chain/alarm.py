"""Alarm of a machine that has to stop before a target is too near."""

from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Array, Booleans, Positive, Probability, Reals, checked, exactly
from .._records import record
from .._typing import FloatArray
from .track import IqTrack


@checked
@record
class StopAlarm:
    """Distance to a point over time, and the alarm that it is too small.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time on the clock in s from which the distance is known.
    distance, distance_std : ndarray, shape (..., K)
        Distance in m and its standard deviation; NaN if there was no start.
    alarm : ndarray of bool, shape (..., K)
        Whether the target may be too near.

    Examples
    --------
    >>> one = StopAlarm([0.1, 0.2], [1.0, 0.5], [0.1, 0.1], [False, True])
    >>> float(one.first)
    0.2
    """

    time: Reals
    distance: Array
    distance_std: Array
    alarm: Booleans

    def __post_init__(self):
        """Check the fields."""
        for name in ("distance", "distance_std", "alarm"):
            _checks.check_shape(name, getattr(self, name), (*self.time.shape,))
            _checks.exact_shape(name, getattr(self, name), self.distance.shape)

    @property
    def first(self) -> FloatArray:
        """Time in s of the first alarm, shape (...); infinite where there is none."""
        return np.where(self.alarm, self.time, np.inf).min(axis=-1)


@checked
@_checks.quiet
def stop_alarm(
    found: IqTrack,
    point: Annotated[FloatArray, exactly(3)],
    distance: Positive,
    probability: Probability = 1e-3,
) -> StopAlarm:
    """Decide from a track when a target may be nearer to a point than a distance.

    Parameters
    ----------
    found : IqTrack
        Track of the target.
    point : array_like, shape (3,)
        Position in m that it must not come near.
    distance : float
        Distance in m that is too near.
    probability : float
        The alarm is given as soon as the target is nearer with this probability.

    Returns
    -------
    StopAlarm

    Notes
    -----
    Each decision uses the samples that are available by then, and a distance whose error is normal:
    its standard deviation is that of the position along the line to the point. It holds if the
    covariance does: read the checks of the track before the alarm. Without a start there is no
    alarm, and no safety: `distance` is NaN.

    Examples
    --------
    A target that approaches the origin at 1 m/s, known to a centimeter:

    >>> x, P = np.zeros((1, 4, 6)), np.tile(1e-4 * np.eye(6), (1, 4, 1, 1))
    >>> x[..., 0], x[..., 3] = 1 - 0.1 * np.arange(4), -1.0
    >>> z, nu, S = np.ones((4, 1)), np.zeros((1, 3, 1)), np.ones((1, 3, 1, 1))
    >>> time, rest = 0.1 * np.arange(4), (np.ones((1, 3)), 0.0, np.ones((1, 4)), 0, 0.01)
    >>> one = stop_alarm(IqTrack(time, time, z, z, 1, x, P, nu, S, *rest), [0, 0, 0], 0.75)
    >>> one.distance.round(1).tolist(), round(float(one.first), 3)
    ([1.0, 0.9, 0.8, 0.7], 0.3)
    """
    from scipy.special import ndtri

    time, x, P = found.live
    away = x[..., :3] - point
    length = np.sqrt(np.sum(away**2, axis=-1))
    u = away / length[..., None]
    std = np.sqrt(np.einsum("...i,...ij,...j->...", u, P[..., :3, :3], u))
    return StopAlarm(time, length, std, length + ndtri(probability) * std <= distance)
