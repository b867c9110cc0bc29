"""Alarm of a machine that has to stop before a target is too near."""

from collections.abc import Callable
from math import sqrt
from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Array, Booleans, Positive, Probability, Reals, checked, exactly
from .._records import filled, record
from .._typing import FloatArray
from ..estimation.track import Track
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


@record
class StopDecision:
    """Distance to a point now, and whether it may be too small.

    Attributes
    ----------
    distance, distance_std : float
        Distance in m and its standard deviation.
    alarm : bool
        Whether the target may be too near, or the track holds no numbers.

    Examples
    --------
    >>> StopDecision(0.5, 0.1, False).alarm
    False
    """

    distance: float
    distance_std: float
    alarm: bool


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


@checked
def stop_alarm_online(
    point: Annotated[FloatArray, exactly(3)], distance: Positive, probability: Probability = 1e-3
) -> Callable[[Track], StopDecision]:
    """Prepare the rule of `stop_alarm` for estimates that come one by one, from `ekf_online`.

    Parameters
    ----------
    point : array_like, shape (3,)
        Position in m that the target must not come near.
    distance : float
        Distance in m that is too near.
    probability : float
        The alarm is given as soon as the target is nearer with this probability.

    Returns
    -------
    callable
        A function that takes an estimate, a `Track` without the axis of time and with P, and
        returns a `StopDecision`. It remembers nothing.

    Notes
    -----
    As `stop_alarm`. A track that holds no numbers any more is an alarm: a machine that has lost its
    tracker stops.

    Examples
    --------
    >>> from dopplerlib import RadarArray, doppler_shift, ekf_online
    >>> array, x = RadarArray.ring(6, 0.2), [0.8, 0.1, 0.1, -0.7, 0, 0]
    >>> update = ekf_online(array, x, 1e-4 * np.eye(6), T=0.001, sigma_a=0.4, sigma_f=0.4)
    >>> decide = stop_alarm_online([0, 0, 0], 0.75)
    >>> decide(update(doppler_shift(x, array))).alarm
    False
    """
    from scipy.special import ndtri

    (p_x, p_y, p_z), quantile = point.tolist(), float(ndtri(probability))

    def decide(found: Track) -> StopDecision:
        """Decide from one estimate."""
        x, y, z, *_ = found.x.tolist()  # numbers, of which there are too few for arrays
        (xx, xy, xz, *_), (_, yy, yz, *_), (_, _, zz, *_), *_ = found.P.tolist()
        x, y, z = x - p_x, y - p_y, z - p_z
        length = sqrt(x * x + y * y + z * z)
        square = x * (x * xx + 2 * (y * xy + z * xz)) + y * (y * yy + 2 * z * yz) + z * z * zz
        std = sqrt(max(square, 0.0)) / length if length > 0 else 0.0
        # Not a number fails the comparison.
        alarm = not length + quantile * std > distance
        fields = {"distance": length, "distance_std": std, "alarm": alarm}
        return filled(StopDecision, fields)

    return decide
