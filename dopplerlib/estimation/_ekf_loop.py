"""The EKF over a whole record, compiled: loops around the printed kernels, and nothing else.

Runs are filtered side by side in *lanes*: quantity i of lane j stands at ``work[i * lanes + j]``,
so that a loop over lanes becomes vector instructions. No operation crosses lanes and none is
reordered, so a run gives the same bits alone and among ten thousand.
"""

from functools import cache

import numpy as np
from numba import njit

from .._compile import cached_njit, fingerprint
from ..kernels import ekf as kernel

LANES = 16

_PREDICTED = kernel.ROWS  # the predicted covariance, kept in case the gate is closed
_ROWS = kernel.ROWS + 21

_inline = njit(forceinline=True, error_model="numpy")
_predict = _inline(kernel.predict)
_linearize = _inline(kernel.linearize)
_project = _inline(kernel.project)
_update = _inline(kernel.update)


@_inline
def _copy(work, lanes, source, target, rows):
    for i in range(rows * lanes):
        work[target * lanes + i] = work[source * lanes + i]


@_inline
def _innovation_covariance(sensor, lanes, width, variance, S):
    """Write row n * N + m of `S`: h_n' P h_m, and the variance on the diagonal."""
    sensors = len(sensor)
    for n in range(sensors):
        for m in range(n, sensors):
            r = variance[n] if m == n else 0.0
            upper, lower = (n * sensors + m) * lanes, (m * sensors + n) * lanes
            for lane in range(width):
                total = r
                for i in range(6):
                    h = sensor[n, (kernel.GRADIENT + i) * lanes + lane]
                    u = sensor[m, (kernel.PROJECTION + i) * lanes + lane]
                    total += h * u
                S[upper + lane] = S[lower + lane] = total


@_inline
def _unpack(work, lanes, lane, first, matrix):
    """Write the symmetric matrix whose upper triangle starts at row `first` to `matrix`."""
    row = first
    for i in range(6):
        for j in range(i, 6):
            matrix[i, j] = matrix[j, i] = work[row * lanes + lane]
            row += 1


@cache
def compiled(lanes):
    """Return the loop for `lanes` runs at a time."""
    compiled_in = fingerprint(kernel)

    @cached_njit
    def filter_records(
        z, positions, doppler_per_speed, variance, T, Q, x0, P0, lower, upper,
        x, P, innovation, S, nis, updated,
    ):  # fmt: skip
        compiled_in  # noqa: B018  (see fingerprint)
        runs, samples, sensors = z.shape
        work = np.zeros(_ROWS * lanes)
        sensor = np.zeros((sensors, kernel.SENSOR_ROWS * lanes))
        S_rows = np.zeros(sensors * sensors * lanes)
        # An array of size zero says that nobody wants this output.
        for first in range(0, runs, lanes):
            width = min(lanes, runs - first)
            for lane in range(width):
                row = 0
                for i in range(6):
                    work[(kernel.PREDICTED + i) * lanes + lane] = x0[first + lane, i]
                    for j in range(i, 6):
                        work[(kernel.COVARIANCE + row) * lanes + lane] = P0[first + lane, i, j]
                        row += 1
            for k in range(samples):
                if k < len(T):  # one interval for all samples, or each its own
                    for lane in range(width):
                        row = kernel.PROCESS_NOISE
                        for i in range(6):
                            for j in range(i, 6):
                                work[row * lanes + lane] = Q[k, i, j]
                                row += 1
                    interval = T[k]
                for lane in range(width):
                    _predict(work, lanes, lane, interval)
                for n in range(sensors):
                    for lane in range(width):
                        measured = z[first + lane, k, n]
                        here = not np.isnan(measured)
                        sensor[n, kernel.MEASUREMENT * lanes + lane] = measured if here else 0.0
                        sensor[n, kernel.SEEN * lanes + lane] = 1.0 if here else 0.0
                    s_x, s_y, s_z = positions[n, 0], positions[n, 1], positions[n, 2]
                    for lane in range(width):
                        _linearize(work, sensor[n], lanes, lane, s_x, s_y, s_z, doppler_per_speed)
                if S.size:
                    for n in range(sensors):
                        for lane in range(width):
                            _project(work, sensor[n], lanes, lane)
                    _innovation_covariance(sensor, lanes, width, variance[k], S_rows)
                _copy(work, lanes, kernel.COVARIANCE, _PREDICTED, 21)
                for i in range(kernel.CORRECTION * lanes, (kernel.NIS + 1) * lanes):
                    work[i] = 0.0
                for n in range(sensors):
                    for lane in range(width):
                        _update(work, sensor[n], lanes, lane, variance[k, n])
                for lane in range(width):
                    run = first + lane
                    seen = 0
                    for n in range(sensors):
                        seen += sensor[n, kernel.SEEN * lanes + lane] > 0
                    value = work[kernel.NIS * lanes + lane]
                    # Not a number fails both comparisons: a broken filter is never "updated".
                    accepted = seen > 0 and lower[seen] <= value <= upper[seen]
                    if accepted:
                        for i in range(6):
                            correction = work[(kernel.CORRECTION + i) * lanes + lane]
                            work[(kernel.PREDICTED + i) * lanes + lane] += correction
                    else:
                        for i in range(21):
                            predicted = work[(_PREDICTED + i) * lanes + lane]
                            work[(kernel.COVARIANCE + i) * lanes + lane] = predicted
                    for i in range(6):
                        x[run, k, i] = work[(kernel.PREDICTED + i) * lanes + lane]
                    nis[run, k] = value if seen > 0 else np.nan
                    updated[run, k] = accepted
                    if P.size:
                        _unpack(work, lanes, lane, kernel.COVARIANCE, P[run, k])
                    if innovation.size:
                        for n in range(sensors):
                            here = sensor[n, kernel.SEEN * lanes + lane] > 0
                            nu = sensor[n, kernel.INNOVATION * lanes + lane]
                            innovation[run, k, n] = nu if here else np.nan
                    if S.size:
                        for n in range(sensors):
                            for m in range(sensors):
                                S[run, k, n, m] = S_rows[(n * sensors + m) * lanes + lane]

    return filter_records
