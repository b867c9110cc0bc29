"""Which window suits which acceleration and noise: the document's error, table and choice."""

import numpy as np

from ... import _checks
from ..._records import record
from ...signal.synthesis import iq_from_velocity, velocity_profile
from .doppler_filter import doppler_filter
from .filters import filter_velocity
from .published import chosen, stated


@record
class WindowTable:
    """The best window for some accelerations and signal-to-noise ratios.

    Attributes
    ----------
    accelerations : ndarray, shape (A,)
        In m/s^2, rising.
    snrs_db : ndarray, shape (B,)
        In dB, rising.
    windows : ndarray of int, shape (W,)
        Lengths that were tried, in samples.
    cee : ndarray, shape (A, B, W)
        Their cumulative estimation errors at the end of a record, mean over the runs.
    """

    accelerations: np.ndarray
    snrs_db: np.ndarray
    windows: np.ndarray
    cee: np.ndarray

    @property
    def best(self):
        """Windows with the least error, shape (A, B)."""
        return self.windows[np.argmin(self.cee, axis=-1)]


def cumulative_error(v, estimate):
    """Return the running mean of the relative errors, which the document judges by.

    Parameters
    ----------
    v : array_like, shape (K,)
        True velocity in m/s, nowhere zero.
    estimate : array_like, shape (..., K)
        Estimated velocities.

    Returns
    -------
    ndarray, shape (..., K)

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, or a true velocity is zero.

    Notes
    -----
    Eq 13 of the document, "cee".

    Examples
    --------
    >>> cumulative_error([100.0, 100.0], [101.0, 100.0]).tolist()
    [0.01, 0.005]
    """
    v = _checks.finite("v", v, (None,))
    estimate = _checks.finite("estimate", estimate, v.shape[-1:])
    if (v == 0).any():
        raise ValueError("v must not be zero: a relative error has no meaning there")
    count = np.arange(1, v.shape[-1] + 1)
    return np.cumsum(np.abs(estimate - v) / np.abs(v), axis=-1) / count


def window_table(
    accelerations=None,
    snrs_db=None,
    *,
    rng,
    runs=20,
    windows=None,
    judge="measurement",
    duration=1.2,
):
    """Find the best window for every acceleration and signal-to-noise ratio by simulation.

    Parameters
    ----------
    accelerations, snrs_db : sequence of float, optional
        Rising, at least two of each, in m/s^2 and dB; those of `chosen` if None.
    rng : numpy.random.Generator
        Source of randomness.
    runs : int
        Records of one sensor in each cell.
    windows : sequence of int, optional
        Lengths to try; those of `chosen` if None.
    judge : {"measurement", "filter"}
        Whose velocities the error is computed of: those of the Doppler filter, or those of the
        Kalman filter behind it. The document does not say.
    duration : float
        How long the target decelerates in s, after a while without.

    Returns
    -------
    WindowTable

    Raises
    ------
    ValueError
        If `accelerations` or `snrs_db` does not rise or has less than two entries, `judge` is
        neither of the two, `runs` is not a positive whole number, or `rng` is not a generator.

    Notes
    -----
    Sec 3.2 of the document: the window with the least cumulative error is the best.
    """
    runs = _checks.whole_number("runs", runs)
    _checks.generator("rng", rng)
    own, said = chosen(), stated()
    accelerations = rising(
        "accelerations", own.table_accelerations if accelerations is None else accelerations
    )
    snrs_db = rising("snrs_db", own.table_snrs_db if snrs_db is None else snrs_db)
    _checks.one_of("judge", judge, ("measurement", "filter"))
    windows = np.array(own.windows if windows is None else windows)
    begin = own.scored * said.T
    t = said.T * np.arange(own.scored + round(duration / said.T))
    cee = np.empty((len(accelerations), len(snrs_db), len(windows)))
    for i, a in enumerate(accelerations):
        v, _ = velocity_profile(t, said.v_before, [(begin, begin + duration, -a)])
        for j, snr_db in enumerate(snrs_db):
            x = iq_from_velocity(v, said.T, own.wavelength, snr_db, rng=rng, size=runs)
            doppler = doppler_filter(x[:, None], windows)
            for w, window in enumerate(windows):
                found = doppler.v[w, :, 0]
                if judge == "filter":
                    found = filter_velocity(doppler, snr_db, window=int(window)).x[:, 0, :, 0]
                error = cumulative_error(v[own.scored :], found[:, own.scored - own.first :])
                cee[i, j, w] = error[:, -1].mean()
    return WindowTable(accelerations, snrs_db, windows, cee)


def choose_window(table, acceleration, snr_db):
    """Return the window that a table suggests.

    Parameters
    ----------
    table : WindowTable
        As `window_table` returns it.
    acceleration : array_like, shape (...)
        In m/s^2; its sign does not matter.
    snr_db : array_like, broadcast to (...)
        In dB.

    Returns
    -------
    ndarray of int, shape (...)
        One of the windows of the table: the nearest one, in the logarithm, to what linear
        interpolation of the logarithms of the best windows gives. Outside of the table, that of
        its edge.

    Raises
    ------
    ValueError
        If a value is not finite.
    """
    _checks.instance("table", table, WindowTable)
    from ._pair_kernel import choose

    a, snr_db = np.broadcast_arrays(
        _checks.finite("acceleration", acceleration), _checks.finite("snr_db", snr_db)
    )
    lookup = table.accelerations, table.snrs_db, np.log(table.best), np.log(table.windows)
    found = [choose(one, snr, *lookup) for one, snr in zip(a.flat, snr_db.flat, strict=True)]
    return table.windows[np.array(found, int).reshape(a.shape)]


def rising(name, values):
    """Return `values` as an array, or raise unless they rise and are at least two."""
    array = _checks.finite(name, values, (None,))
    if array.ndim != 1 or len(array) < 2 or (np.diff(array) <= 0).any():
        raise ValueError(f"{name} must rise and hold at least two numbers, got {array.tolist()}")
    return array
