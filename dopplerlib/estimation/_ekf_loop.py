"""The EKF over a whole record, compiled: loops around the printed kernels, and nothing else.

Runs are filtered side by side in *lanes*: quantity i of lane j stands at ``work[i * lanes + j]``,
so that a loop over lanes becomes vector instructions. No operation crosses lanes and none is
reordered, so a run gives the same bits alone and among ten thousand.
"""

import hashlib
from functools import cache
from pathlib import Path

import numpy as np
from numba import njit

from ..kernels import ekf as kernel

LANES = 16

# numba's cache watches the file of the compiled function only. As a constant inside it, the
# fingerprint of the kernels makes a new kernel a new function.
_FINGERPRINT = hashlib.sha256(Path(kernel.__file__).read_bytes()).hexdigest()

_PREDICTED = kernel.ROWS  # the predicted covariance, kept in case the gate is closed
_ROWS = kernel.ROWS + 21

_inline = njit(forceinline=True, error_model="numpy")
_predict = _inline(kernel.predict)
_update = _inline(kernel.update)


@_inline
def _copy(work, lanes, source, target, rows):
    for i in range(rows * lanes):
        work[target * lanes + i] = work[source * lanes + i]


@_inline
def _unpack(work, lanes, lane, first, matrix):
    """Write the symmetric matrix whose upper triangle starts at row `first` to `matrix`."""
    row = first
    for i in range(6):
        for j in range(i, 6):
            matrix[i, j] = matrix[j, i] = work[row * lanes + lane]
            row += 1


@_inline
def _innovation_covariance(work, lanes, lane, gradient, variance, S):
    """Write H P H' + R to `S`, with P the predicted covariance."""
    P = np.empty((6, 6))
    _unpack(work, lanes, lane, _PREDICTED, P)
    for n in range(S.shape[0]):
        for m in range(n, S.shape[0]):
            total = variance[n] if m == n else 0.0
            for i in range(6):
                projected = 0.0
                for j in range(6):
                    projected += P[i, j] * gradient[(m * 6 + j) * lanes + lane]
                total += gradient[(n * 6 + i) * lanes + lane] * projected
            S[n, m] = S[m, n] = total


@cache
def compiled(lanes):
    """Return the loop for `lanes` runs at a time."""
    fingerprint = _FINGERPRINT

    @njit(nogil=True, error_model="numpy", cache=True)
    def filter_records(
        z, positions, doppler_per_speed, variance, Q, T, x0, P0, lower, upper,
        x, P, innovation, S, nis, updated,
    ):  # fmt: skip
        fingerprint  # noqa: B018  (see _FINGERPRINT)
        runs, samples, sensors = z.shape
        work = np.zeros(_ROWS * lanes)
        gradient = np.zeros(sensors * 6 * lanes)
        seen = np.zeros(lanes, np.int64)
        accepted = np.zeros(lanes, np.bool_)
        # An array of size zero says that nobody wants this output.
        for first in range(0, runs, lanes):
            width = min(lanes, runs - first)
            for lane in range(width):
                row = 0
                for i in range(6):
                    work[(kernel.PREDICTED + i) * lanes + lane] = x0[first + lane, i]
                    for j in range(i, 6):
                        work[(kernel.COVARIANCE + row) * lanes + lane] = P0[first + lane, i, j]
                        work[(kernel.PROCESS_NOISE + row) * lanes + lane] = Q[i, j]
                        row += 1
            for k in range(samples):
                for lane in range(width):
                    _predict(work, lanes, lane, T)
                _copy(work, lanes, kernel.COVARIANCE, _PREDICTED, 21)
                for i in range(kernel.CORRECTION * lanes, (kernel.NIS + 1) * lanes):
                    work[i] = 0.0
                seen[:] = 0
                for n in range(sensors):
                    for lane in range(width):
                        measured = z[first + lane, k, n]
                        here = not np.isnan(measured)
                        work[kernel.MEASUREMENT * lanes + lane] = measured if here else 0.0
                        work[kernel.SEEN * lanes + lane] = 1.0 if here else 0.0
                        seen[lane] += here
                    s_x, s_y, s_z = positions[n, 0], positions[n, 1], positions[n, 2]
                    r = variance[k, n]
                    for lane in range(width):
                        _update(work, lanes, lane, s_x, s_y, s_z, doppler_per_speed, r)
                    if S.size:
                        for i in range(6 * lanes):
                            gradient[n * 6 * lanes + i] = work[kernel.GRADIENT * lanes + i]
                    if innovation.size:
                        for lane in range(width):
                            there = work[kernel.SEEN * lanes + lane] > 0
                            nu = work[kernel.INNOVATION * lanes + lane]
                            innovation[first + lane, k, n] = nu if there else np.nan
                for lane in range(width):
                    value = work[kernel.NIS * lanes + lane]
                    count = seen[lane]
                    # Not a number fails both comparisons: a broken filter is never "updated".
                    accepted[lane] = count > 0 and lower[count] <= value <= upper[count]
                    nis[first + lane, k] = value if count > 0 else np.nan
                    updated[first + lane, k] = accepted[lane]
                for i in range(6):
                    for lane in range(width):
                        if accepted[lane]:
                            work[(kernel.PREDICTED + i) * lanes + lane] += work[
                                (kernel.CORRECTION + i) * lanes + lane
                            ]
                        x[first + lane, k, i] = work[(kernel.PREDICTED + i) * lanes + lane]
                for lane in range(width):
                    if S.size:
                        _innovation_covariance(
                            work, lanes, lane, gradient, variance[k], S[first + lane, k]
                        )
                for i in range(21):
                    for lane in range(width):
                        if not accepted[lane]:
                            work[(kernel.COVARIANCE + i) * lanes + lane] = work[
                                (_PREDICTED + i) * lanes + lane
                            ]
                if P.size:
                    for lane in range(width):
                        _unpack(work, lanes, lane, kernel.COVARIANCE, P[first + lane, k])

    return filter_records
