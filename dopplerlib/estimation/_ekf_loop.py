"""The EKF over a whole record, compiled: loops around the printed kernels, and nothing else.

Runs are filtered side by side in *lanes*: quantity i of lane j stands at ``work[i * lanes + j]``,
so that a loop over lanes becomes vector instructions. No operation crosses lanes and none is
reordered, so a run gives the same bits alone and among ten thousand.
"""

from functools import cache

import numpy as np

from .._compile import cached_njit, fingerprint, inner_njit
from ..kernels import ekf as kernel

LANES = 16

_PREDICTED = kernel.ROWS  # the predicted factors, kept in case the gate is closed
_ROWS = kernel.ROWS + 21

# A pivot of a covariance that is a smaller share of its variance is rounding.
_ROUNDING = 8 * np.finfo(float).eps

_inline = inner_njit(forceinline=True)
_predict = _inline(kernel.predict)
_add_noise = _inline(kernel.add_noise)
_linearize = _inline(kernel.linearize)
_project = _inline(kernel.project)
_update = _inline(kernel.update)
_covariance = _inline(kernel.covariance)


@_inline
def _copy(work, lanes, source, target, rows):
    for i in range(rows * lanes):
        work[target * lanes + i] = work[source * lanes + i]


@_inline
def _factor(P, U):
    """Write U and, in the place of its diagonal of ones, D to `U`, so that P = U D U'.

    What a direction leaves of its variance may be nothing, or lost in the rounding of `P`. Then D
    is that rounding: 2e-15 of the variance, and zero where the variance is.
    """
    for j in range(5, -1, -1):
        D = P[j, j]
        for k in range(j + 1, 6):
            D -= U[j, k] * U[j, k] * U[k, k]
        least = max(_ROUNDING * P[j, j], 0.0)
        U[j, j] = max(D, least)
        for i in range(j):
            product = P[i, j]
            for k in range(j + 1, 6):
                product -= U[i, k] * U[k, k] * U[j, k]
            U[i, j] = product / D if D > least else 0.0


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
                    f = sensor[n, (kernel.PROJECTION + i) * lanes + lane]
                    b = sensor[m, (kernel.WEIGHTED + i) * lanes + lane]
                    total += f * b
                S[upper + lane] = S[lower + lane] = total


@_inline
def _leave_out_missing(sensor, lanes, lane):
    """Give the missing sensors of one lane values that change nothing in the update."""
    for n in range(len(sensor)):
        if np.isnan(sensor[n, kernel.MEASUREMENT * lanes + lane]):
            sensor[n, kernel.VARIANCE * lanes + lane] = 1.0
            for i in range(kernel.INNOVATION, kernel.GRADIENT + 6):
                sensor[n, i * lanes + lane] = 0.0


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
        z, positions, doppler_per_speed, variance, T, noise, x0, P0, lower, upper,
        x, P, innovation, S, nis, updated,
    ):  # fmt: skip
        compiled_in  # noqa: B018  (see fingerprint)
        runs, samples, sensors = z.shape
        work = np.zeros(_ROWS * lanes)
        sensor = np.zeros((sensors, kernel.SENSOR_ROWS * lanes))
        S_rows = np.zeros(sensors * sensors * lanes)
        seen = np.zeros(lanes, np.int64)
        U = np.zeros((6, 6))
        # An array of size zero says that nobody wants this output.
        for first in range(0, runs, lanes):
            width = min(lanes, runs - first)
            for lane in range(width):
                _factor(P0[first + lane], U)
                row = kernel.FACTORS
                for i in range(6):
                    work[(kernel.PREDICTED + i) * lanes + lane] = x0[first + lane, i]
                    for j in range(i, 6):
                        work[row * lanes + lane] = U[i, j]
                        row += 1
            for k in range(samples):
                at = k if len(T) > 1 else 0  # one interval for all samples, or each its own
                for lane in range(width):
                    _predict(work, lanes, lane, T[at])
                for g in noise[at]:
                    for lane in range(width):
                        _add_noise(work, lanes, lane, g[0], g[1], g[2], g[3], g[4], g[5])
                seen[:] = 0
                for n in range(sensors):
                    for lane in range(width):
                        measured = z[first + lane, k, n]
                        seen[lane] += not np.isnan(measured)
                        sensor[n, kernel.MEASUREMENT * lanes + lane] = measured
                        sensor[n, kernel.VARIANCE * lanes + lane] = variance[k, n]
                    s_x, s_y, s_z = positions[n, 0], positions[n, 1], positions[n, 2]
                    for lane in range(width):
                        _linearize(work, sensor[n], lanes, lane, s_x, s_y, s_z, doppler_per_speed)
                if S.size:
                    for n in range(sensors):
                        for lane in range(width):
                            _project(work, sensor[n], lanes, lane)
                    _innovation_covariance(sensor, lanes, width, variance[k], S_rows)
                for lane in range(width):
                    if seen[lane] < sensors:
                        _leave_out_missing(sensor, lanes, lane)
                _copy(work, lanes, kernel.FACTORS, _PREDICTED, 21)
                for i in range(kernel.CORRECTION * lanes, (kernel.NIS + 1) * lanes):
                    work[i] = 0.0
                for n in range(sensors):
                    for lane in range(width):
                        _update(work, sensor[n], lanes, lane)
                for lane in range(width):
                    value = work[kernel.NIS * lanes + lane]
                    # Not a number fails both comparisons: a broken filter is never "updated".
                    accepted = seen[lane] > 0 and lower[seen[lane]] <= value <= upper[seen[lane]]
                    if accepted:
                        for i in range(6):
                            correction = work[(kernel.CORRECTION + i) * lanes + lane]
                            work[(kernel.PREDICTED + i) * lanes + lane] += correction
                    else:
                        for i in range(21):
                            predicted = work[(_PREDICTED + i) * lanes + lane]
                            work[(kernel.FACTORS + i) * lanes + lane] = predicted
                    nis[first + lane, k] = value if seen[lane] > 0 else np.nan
                    updated[first + lane, k] = accepted
                if P.size:
                    for lane in range(width):
                        _covariance(work, lanes, lane)
                for lane in range(width):
                    run = first + lane
                    for i in range(6):
                        x[run, k, i] = work[(kernel.PREDICTED + i) * lanes + lane]
                    if P.size:
                        _unpack(work, lanes, lane, kernel.COVARIANCE, P[run, k])
                    if innovation.size:
                        for n in range(sensors):
                            here = not np.isnan(sensor[n, kernel.MEASUREMENT * lanes + lane])
                            nu = sensor[n, kernel.INNOVATION * lanes + lane]
                            innovation[run, k, n] = nu if here else np.nan
                    if S.size:
                        for n in range(sensors):
                            for m in range(sensors):
                                S[run, k, n, m] = S_rows[(n * sensors + m) * lanes + lane]

    return filter_records
