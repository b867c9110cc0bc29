"""The Kalman filter of the document behind one or two sensors, with a fixed or a chosen window."""

import numpy as np

from ... import _checks
from ..._records import record
from .doppler_filter import FilteredDoppler, measurement_variance, share
from .published import chosen, stated

FEEDBACK = ("none", "own", "fused")


@record
class VelocityTrack:
    """What the filters of one or two sensors make of their measurements.

    Attributes
    ----------
    first : int
        Sample of the first estimate.
    hop : int
        Samples from one estimate to the next.
    x : ndarray, shape (runs, sensors, K, 2)
        Velocity and acceleration as each sensor's filter has them, in m/s and m/s^2.
    P : ndarray, shape (runs, sensors, K, 2, 2)
        Their covariances.
    P12 : ndarray, shape (runs, K, 2, 2)
        Covariance between the errors of the two filters, for a target that does move as they
        suppose.
    fused_x : ndarray, shape (runs, K, 2)
        Naive fusion of the two; of one sensor its own state.
    fused_P : ndarray, shape (runs, K, 2, 2)
        Covariance that the naive fusion believes in.
    window : ndarray of int, shape (runs, sensors, K)
        Lengths of the windows that were used, in samples.
    innovation, S : ndarray, shape (runs, sensors, K)
        Innovations in m/s and their supposed variances; NaN at the start.
    """

    first: int
    hop: int
    x: np.ndarray
    P: np.ndarray
    P12: np.ndarray
    fused_x: np.ndarray
    fused_P: np.ndarray
    window: np.ndarray
    innovation: np.ndarray
    S: np.ndarray


def filter_velocity(
    doppler, snr_db, *, window=None, table=None, feedback="none", delayed=False, hop=1, scale=1.0
):
    """Run a filter behind each sensor, and fuse their states as the document does.

    Parameters
    ----------
    doppler : FilteredDoppler
        Measurements, ``v`` of shape (W, runs, sensors, K) with one or two sensors.
    snr_db : float
        True signal-to-noise ratio in dB, for the variance of the measurements.
    window : int, optional
        Length of the fixed window, or of the first one; that of `chosen` if None.
    table : WindowTable, optional
        For the choice of windows; needed with a feedback.
    feedback : {"none", "own", "fused"}
        What chooses the next window: nothing, each filter's own acceleration and measured
        signal-to-noise ratio, or the fused acceleration and the mean of the ratios.
    delayed : bool
        Whether the filters know that a measurement belongs to the middle of its window: H is
        [1, -delay] then and not [1, 0].
    hop : int
        Samples from one measurement that is used to the next.
    scale : float
        Factor to the supposed variance of the measurements.

    Returns
    -------
    VelocityTrack

    Raises
    ------
    ValueError
        If `doppler` has not one or two sensors, `window` is none of its windows, `feedback` is
        unknown, or one is asked for without a table of the same windows.

    Notes
    -----
    Eqs 7 to 12 and 15 to 17 of the document. The process noise, the variance of the measurements
    and the start are not stated there; see `chosen`.
    """
    from ._pair_kernel import compiled

    _checks.instance("doppler", doppler, FilteredDoppler)
    code = FEEDBACK.index(_checks.one_of("feedback", feedback, FEEDBACK))
    own, said = chosen(), stated()
    window = own.fixed_window if window is None else window
    if doppler.v.ndim != 4 or doppler.v.shape[2] not in (1, 2):
        raise ValueError(f"doppler.v must have shape (W, runs, 1 or 2, K), got {doppler.v.shape}")
    if window not in doppler.windows:
        raise ValueError(f"window must be one of {doppler.windows.tolist()}, got {window}")
    hop = _checks.whole_number("hop", hop)
    if code:
        if table is None or not np.array_equal(table.windows, doppler.windows):
            raise ValueError("table must be given for a feedback, and for the same windows")
        # Copies, for numba compiles anew for an array that must not be written to.
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
        measurement_variance(doppler.windows, snr_db) * _checks.positive_number("scale", scale),
        doppler.delays * bool(delayed),
        said.T * hop,
        own.q,
        own.acceleration_std,
        code,
        int(np.flatnonzero(doppler.windows == window)[0]),
    )
    results = x, P, P12, fused_x, fused_P, choice, innovation, S
    share(
        lambda part: compiled(
            v[:, part], seen[:, part], *settings, *lookup, *(one[part] for one in results)
        ),
        runs,
    )
    return VelocityTrack(
        doppler.first, hop, x, P, P12, fused_x, fused_P, doppler.windows[choice], innovation, S
    )
