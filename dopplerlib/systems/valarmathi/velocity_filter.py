"""The Kalman filter of the document behind one or two sensors, with a fixed or a chosen window."""

from functools import partial
from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Array, Count, Index, Positive, checked, shaped
from ..._records import record
from ..._typing import FloatArray, IntArray
from .published import reported
from .window_choice import WindowTable
from .window_transform import FilteredDoppler, _share, measurement_variance

_decibels = partial(_checks.one_number, check=_checks.decibels)
FEEDBACK = ("none", "own", "fused", "state")


@checked
@record
class VelocityTrack:
    """Estimates of the filters behind one or two sensors, and of their fusion.

    first: Sample of the first estimate.
    hop: Samples from one estimate to the next.
    x (runs, sensors, K, 2): Velocity and acceleration as each sensor's filter has them, in m/s and
        m/s^2.
    P (runs, sensors, K, 2, 2): Their covariances.
    P12 (runs, K, 2, 2): Covariance between the errors of the two filters, for a target that does
        move as they assume.
    fused_x (runs, K, 2): Naive fusion of the two; of one sensor its own state.
    fused_P (runs, K, 2, 2): Covariance that the naive fusion reports.
    window (runs, sensors, K): Lengths of the windows that were used, in samples.
    innovation, S (runs, sensors, K): Innovations in m/s and their variances as the filter reports
        them; NaN at the start.
    """

    first: Index
    hop: Count
    x: Annotated[FloatArray, shaped(None, None, None, 2)]
    P: Annotated[FloatArray, shaped(None, None, None, 2, 2)]
    P12: Annotated[FloatArray, shaped(None, None, 2, 2)]
    fused_x: Annotated[FloatArray, shaped(None, None, 2)]
    fused_P: Annotated[FloatArray, shaped(None, None, 2, 2)]
    window: Annotated[IntArray, shaped(None, None, None)]
    innovation: Array
    S: Array


@checked
def filter_velocity(
    doppler: FilteredDoppler,
    snr_db: Annotated[FloatArray, _checks.decibels],
    *,
    window: Count | None = None,
    table: WindowTable | None = None,
    feedback: Literal["none", "own", "fused", "state"] = "none",
    delayed: bool = False,
    hop: Count = 1,
    scale: Positive = 1.0,
    q: Positive | None = None,
) -> VelocityTrack:
    """Run a filter behind each sensor, and fuse their states as the document does.

    doppler: Measurements, ``v`` of shape (W, runs, sensors, K) with one or two sensors.
    snr_db () or (sensors,): Signal-to-noise ratio in dB that each filter takes, for the variance of
        the measurements.
    window: Length of the fixed window, or of the first one; that of `chosen` if None.
    table: For the choice of windows; needed with a feedback.
    feedback: What chooses the next window: nothing, each filter's own acceleration and measured
        signal-to-noise ratio, or the fused acceleration and the mean of the ratios. With "state"
        both filters also go on from the fused state and covariance, which counts it twice.
    delayed: Whether the filters know that a measurement belongs to the middle of its window: H is
        [1, -delay] then and not [1, 0].
    hop: Samples from one measurement that is used to the next.
    scale: Factor to the assumed variance of the measurements.
    q: Intensity of the white jerk in (m/s^2)^2/s; that of `chosen` if None.
    Raises ValueError if an argument is not of the kind described, `doppler` has not one or two
        sensors or begins with what is missing, `snr_db` is of another number of sensors, `window`
        is none of its windows, or a feedback is asked for without a table of the same windows.

    Notes
    -----
    Eqs 7 to 12 and 15 to 17 of the document. The process noise, the variance of the measurements
    and the start are not stated there; see the table `chosen`.

    Examples
    --------
    >>> doppler = FilteredDoppler([64], 0, np.full((1, 1, 2, 20), 250.0), np.zeros((1, 1, 2, 20)))
    >>> filter_velocity(doppler, 15.0).fused_x[0, -1].round().tolist()
    [250.0, 0.0]
    """
    from ._pair_kernel import compiled

    code = FEEDBACK.index(feedback)
    own, said = reported().chosen, reported().stated
    window = int(own.fixed_window) if window is None else window
    if doppler.v.ndim != 4 or doppler.v.shape[2] not in (1, 2):
        raise ValueError(f"doppler.v must have shape (W, runs, 1 or 2, K), got {doppler.v.shape}")
    if snr_db.shape not in ((), doppler.v.shape[2:3]):
        raise ValueError(
            f"snr_db must be one number, or one a sensor of {doppler.v.shape[2]}, got {snr_db}"
        )
    if window not in doppler.windows:
        raise ValueError(f"window must be one of {doppler.windows.tolist()}, got {window}")
    if code:
        if table is None or not np.array_equal(table.windows, doppler.windows):
            raise ValueError("table must be given for a feedback, and for the same windows")
        # Copies, here and below: numba compiles anew, which takes ten seconds, for an array that
        # has another layout or must not be written to.
        lookup = (
            table.accelerations.copy(),
            table.snrs_db.copy(),
            np.log(table.best),
            np.log(table.windows),
        )
    else:
        lookup = np.zeros(2), np.zeros(2), np.zeros((2, 2)), np.log(doppler.windows)

    v, seen = doppler.v[..., ::hop], doppler.snr_db[..., ::hop]
    runs, sensors, count = v.shape[1:]
    shape = (runs, sensors, count)
    x, P = np.empty((*shape, 2)), np.empty((*shape, 2, 2))
    P12, fused_P = np.zeros((runs, count, 2, 2)), np.empty((runs, count, 2, 2))
    fused_x, choice = np.empty((runs, count, 2)), np.empty(shape, np.int64)
    innovation, S = np.empty(shape), np.empty(shape)
    settings = (
        measurement_variance(doppler.windows[:, None], np.broadcast_to(snr_db, sensors)) * scale,
        doppler.delays * bool(delayed),
        said.T * hop,
        own.q if q is None else q,
        own.acceleration_std,
        code,
        int(np.flatnonzero(doppler.windows == window)[0]),
    )
    results = x, P, P12, fused_x, fused_P, choice, innovation, S

    def work(part):
        measured = (one[:, part].copy() for one in (v, seen))
        compiled(*measured, *settings, *lookup, *(one[part] for one in results))

    _share(work, runs)
    return VelocityTrack(
        doppler.first, hop, x, P, P12, fused_x, fused_P, doppler.windows[choice], innovation, S
    )
