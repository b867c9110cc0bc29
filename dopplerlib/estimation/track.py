"""The record that filters return."""

import numpy as np

from .._records import record


@record
class Track:
    """Estimates of a filter over a record, after the updates.

    Leading axes are those of the measurements (runs first), then K times.

    Attributes
    ----------
    x : ndarray, shape (..., K, n)
        State estimates.
    P : ndarray, shape (..., K, n, n), or None
        Their covariances as the filter believes them.
    innovation : ndarray, shape (..., K, m), or None
        Measurement minus predicted measurement; NaN where the measurement is missing.
    S : ndarray, shape (..., K, m, m), or None
        Innovation covariances.
    nis : ndarray, shape (..., K)
        Normalized innovation squared over the measurements that are there; NaN where none is.
    updated : ndarray of bool, shape (..., K)
        False where the state was only predicted: nothing measured, or outside the gate.
    """

    x: np.ndarray
    P: np.ndarray | None
    innovation: np.ndarray | None
    S: np.ndarray | None
    nis: np.ndarray
    updated: np.ndarray
