"""Checks of a track that need no truth: start, NIS, mean and whiteness of innovations, sensors."""

import numpy as np

from .._hints import checked
from .._records import record
from ..chain.track import IqTrack
from ..estimation.track import Track
from ._innovations import chi2_tail, ljung_box, of_track, whiten, winsorized
from .checklist import Check

_LAGS = 5  # of the test of whiteness, at most: each takes ten samples
LIMIT = 1e-3  # false-alarm probability of each check


@record
class SensorChecks:
    """Innovations of each sensor by itself.

    Attributes
    ----------
    present : ndarray, shape (..., N)
        Fraction of the samples in which the sensor has a measurement.
    mean : ndarray, shape (..., N)
        Mean of its innovations over their standard deviations, times the square root of their
        number: standard normal if the filter is consistent; NaN without a measurement.
    nis : ndarray, shape (..., N)
        Mean square of its innovations over their standard deviations, expected 1.
    p_value : ndarray, shape (..., N)
        Probability of a larger `nis` if the filter is consistent.
    """

    present: np.ndarray
    mean: np.ndarray
    nis: np.ndarray
    p_value: np.ndarray


def sensor_checks(track: Track) -> SensorChecks:
    """Judge the innovations of each sensor by itself.

    Parameters
    ----------
    track : Track
        With `innovation`, in which NaN is a missing measurement, and `S`.

    Returns
    -------
    SensorChecks

    Raises
    ------
    ValueError
        If the track has no innovations or S, or a record has no measurement at all.

    Notes
    -----
    Innovations of a consistent filter are independent in time, those of different sensors at one
    time are not: so the squares of one sensor over its own variance are chi-square, and those of
    two sensors are dependent. A sensor that is mounted elsewhere pulls the others, too: the largest
    value is a hint, leaving the sensor out is the proof.

    Examples
    --------
    >>> innovation = np.resize([1.0, -1.0], (50, 2)) * [1, 3]
    >>> track = Track(None, None, innovation, np.tile(np.eye(2), (50, 1, 1)), None, None)
    >>> found = sensor_checks(track)
    >>> found.nis.tolist(), (found.p_value < 1e-6).tolist()
    ([1.0, 9.0], [False, True])
    """
    innovation, S, there = of_track(track)
    z = innovation / np.sqrt(np.diagonal(S, axis1=-2, axis2=-1))
    n = there.sum(axis=-2)
    some = np.where(n > 0, n, np.nan)
    square = np.sum(z**2, axis=-2)
    return SensorChecks(
        n / z.shape[-2], z.sum(axis=-2) / np.sqrt(some), square / some, chi2_tail(square, n)
    )


@checked
def track_checks(found: IqTrack) -> tuple[Check, ...]:
    """Test a track for consistency with its own measurements.

    Parameters
    ----------
    found : IqTrack
        Of one record: without leading axes, or of one run.

    Returns
    -------
    tuple of Check
        "start": chi-square of the initial estimate is not too large. "NIS": nor is that of the
        innovations. "sensors": nor is that of any sensor by itself (Bonferroni). "mean": the
        innovations have the mean zero. "whiteness": they are independent in time. Each value is a
        p-value; NaN, which fails, where nothing was filtered.

    Raises
    ------
    ValueError
        If there are several records.

    Notes
    -----
    Each fails a track that is right with a probability of 0.001. A NIS that is too *small* passes:
    the stated standard deviations are then too large, which costs accuracy, not safety. No check
    detects an error that all sensors share, such as a common delay.

    Bar-Shalom, Li and Kirubarajan (2001), Section 5.4.

    Examples
    --------
    >>> x, P = np.zeros((1, 61, 6)), np.tile(np.eye(6), (1, 61, 1, 1))
    >>> nu = np.random.default_rng(1).standard_normal((1, 60, 1))
    >>> z, S, time = np.ones((61, 1)), np.ones((1, 60, 1, 1)), np.arange(61.0)
    >>> rest = nu[..., 0] ** 2, 0.0, np.ones((1, 61)), 1, 0.1
    >>> checks = track_checks(IqTrack(time, time, z, z, 1, x, P, nu, S, *rest))
    >>> [check.name for check in checks if not check.passed]
    []
    """
    if found.score.size != np.prod(found.score.shape[-2:]):
        raise ValueError(f"found must be of one record, got shape {found.shift.shape[:-2]}")
    degrees = float(np.sum(found.degrees))
    cost = float(np.min(found.score[..., 0]))
    start = chi2_tail(cost, degrees) if np.isfinite(cost) else np.nan
    track = found.final_track
    values = [np.nan] * 4
    if np.isfinite(track.innovation).any():
        innovation, S, there = of_track(track)
        white = whiten(innovation, S)
        n, square = there.sum(axis=-2), np.sum(white**2, axis=(-2, -1))
        mean = np.sum(white.sum(axis=-2) ** 2 / np.maximum(n, 1), axis=-1)
        each = sensor_checks(track).p_value
        worst = np.nanmin(each) * np.sum(np.isfinite(each))
        lags = max(1, min(_LAGS, int(n.max()) // 10))
        # Outliers would hide the correlation of the others.
        memory = ljung_box(winsorized(white, there, 4.0), there, lags, lags + 2)[-1]
        values = [
            chi2_tail(square, n.sum(axis=-1)),
            worst,
            chi2_tail(mean, np.sum(n > 0, -1)),
            memory,
        ]
    names = "start", "NIS", "sensors", "mean", "whiteness"
    values = [float(np.squeeze(v)) for v in (start, *values)]
    return tuple(
        Check(name, "statistical", min(v, 1.0) if v == v else v, LIMIT)
        for name, v in zip(names, values, strict=True)
    )
