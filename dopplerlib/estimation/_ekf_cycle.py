"""One cycle of the EKF, compiled: the printed kernels in order, for runs side by side.

Runs are filtered in *lanes*: quantity i of lane j stands at ``memory[i * lanes + j]``, so that a
kernel becomes vector instructions. No operation crosses lanes and none is reordered, so a run gives
the same bits alone, sample by sample, and among ten thousand. All arrays have one axis: the fewer
types and functions there are, the sooner numba is through.
"""

import numpy as np

from .._compile import inner_njit
from .._straight import straight, where_known
from ..kernels import ekf as kernel

# Rows of the memory: the array `work` of the kernels, then these, then the arrays `sensor` of all
# sensors, and last, for all lanes, what `new_memory` writes.
_KEPT = kernel.ROWS  # the predicted factors, in case the gate is closed
SEEN = _KEPT + 21  # number of sensors that are there
UPDATES = SEEN + 1
SENSORS = UPDATES + 1

# Behind the interval of a sample that is filtered alone: columns of noise, variances, counts.
SAMPLE_NOISE, SAMPLE_VARIANCE = 1, 19

# A pivot of a covariance that is a smaller share of its variance is rounding.
_ROUNDING = 8 * np.finfo(float).eps


def _admit(work, sensor, lanes, lane, variance):
    """Count a sensor that is there; give one that is missing values that change nothing."""
    measured = sensor[kernel.MEASUREMENT * lanes + lane]
    work[SEEN * lanes + lane] += where_known(measured, 1.0, 0.0)
    sensor[kernel.VARIANCE * lanes + lane] = where_known(measured, variance, 1.0)
    for i in range(kernel.INNOVATION, kernel.GRADIENT + 6):
        value = sensor[i * lanes + lane]
        sensor[i * lanes + lane] = where_known(measured, value, 0.0)


def _begin(work, lanes, lane):
    """Begin an update that has corrected nothing, and keep the predicted factors."""
    for i in range(21):
        work[(_KEPT + i) * lanes + lane] = work[(kernel.FACTORS + i) * lanes + lane]
    for i in range(kernel.CORRECTION, kernel.NIS + 1):
        work[i * lanes + lane] = 0.0


def _accept(work, lanes, lane):
    work[UPDATES * lanes + lane] = 1.0
    for i in range(6):
        work[(kernel.PREDICTED + i) * lanes + lane] += work[(kernel.CORRECTION + i) * lanes + lane]


def _refuse(work, lanes, lane):
    work[UPDATES * lanes + lane] = 0.0
    for i in range(21):
        work[(kernel.FACTORS + i) * lanes + lane] = work[(_KEPT + i) * lanes + lane]


def _state_to(work, x, lanes, lane):
    for i in range(6):
        x[i] = work[(kernel.PREDICTED + i) * lanes + lane]


def _state_from(work, x, lanes, lane):
    for i in range(6):
        work[(kernel.PREDICTED + i) * lanes + lane] = x[i]


def _covariance_to(work, P, lanes, lane):
    row = kernel.COVARIANCE
    for i in range(6):
        for j in range(i, 6):
            P[6 * i + j] = work[row * lanes + lane]
            P[6 * j + i] = work[row * lanes + lane]
            row += 1


def _innovation_to(sensor, innovation, lanes, lane):
    measured = sensor[kernel.MEASUREMENT * lanes + lane]
    innovation[0] = where_known(measured, sensor[kernel.INNOVATION * lanes + lane], np.nan)


def _product_to(one, other, S, mirrored, lanes, lane, variance):
    """Write an entry of the innovation covariance, h' P h of two sensors and the variance."""
    total = variance
    for i in range(6):
        f = one[(kernel.PROJECTION + i) * lanes + lane]
        total = total + f * other[(kernel.WEIGHTED + i) * lanes + lane]
    S[0] = total
    mirrored[0] = total


_inline = inner_njit(forceinline=True)
_predict = straight(kernel.predict)
_add_noise = straight(kernel.add_noise)
_linearize = straight(kernel.linearize)
_project = straight(kernel.project)
_update = straight(kernel.update)
covariance = straight(kernel.covariance)
_admitted, _begun = straight(_admit), straight(_begin)
_accepted, _refused = straight(_accept, one=True), straight(_refuse, one=True)
write_state, read_state = straight(_state_to, one=True), straight(_state_from, one=True)
write_covariance = straight(_covariance_to, one=True)
_write_innovation = straight(_innovation_to, one=True)
_write_product = straight(_product_to, one=True)


def new_memory(lanes, positions, doppler_per_speed, lower, upper, more=0):
    """Return the memory of a group of lanes, with room for `more` numbers at its end."""
    sensors = len(positions)
    own = (SENSORS + sensors * kernel.SENSOR_ROWS) * lanes
    memory = np.zeros(own + 3 + 5 * sensors + more)
    memory[own] = doppler_per_speed
    memory[own + 1 : own + 2 + sensors] = lower
    memory[own + 2 + sensors : own + 3 + 2 * sensors] = upper
    memory[own + 3 + 2 * sensors : own + 3 + 5 * sensors] = positions.reshape(-1)
    return memory


@_inline
def _row(i, j):
    """Return the row of entry i, j of the factors, of which the upper triangle is kept."""
    return kernel.FACTORS + (i * (11 - i) >> 1) + j


@_inline
def factor(P0, at, memory, lane, lanes):
    """Write U and, in the place of its diagonal of ones, D, so that P0 = U D U'.

    Return whether `P0` is symmetric, finite and positive definite beyond doubt.

    What a direction leaves of its variance may be nothing, or lost in the rounding of `P0`. Then D
    is that rounding: 2e-15 of the variance, and zero where the variance is.
    """
    certain = True
    for j in range(5, -1, -1):
        D = variance = P0[at + 7 * j]
        for k in range(j + 1, 6):
            U = memory[_row(j, k) * lanes + lane]
            D -= U * U * memory[_row(k, k) * lanes + lane]
        least = _ROUNDING * variance if variance > 0.0 else 0.0
        memory[_row(j, j) * lanes + lane] = D if D > least else least
        certain = certain and D > least  # neither is true of what is not finite
        for i in range(j):
            product = P0[at + 6 * i + j]
            certain = certain and product == P0[at + 6 * j + i]
            for k in range(j + 1, 6):
                weighted = memory[_row(i, k) * lanes + lane] * memory[_row(k, k) * lanes + lane]
                product -= weighted * memory[_row(j, k) * lanes + lane]
            memory[_row(i, j) * lanes + lane] = product / D if D > least else 0.0
    return certain


@_inline
def clear_of_sensors(memory, sensors, lanes, lane, T):
    """Return whether the next prediction is finite and on no sensor, see `check_clear_of_sensors`.

    One that is out of sight may be called not finite, too.
    """
    s = (SENSORS + sensors * kernel.SENSOR_ROWS) * lanes + 3 + 2 * sensors
    for _ in range(sensors):
        square = 0.0
        for i in range(kernel.PREDICTED, kernel.PREDICTED + 3):
            d = memory[i * lanes + lane] + T * memory[(i + 3) * lanes + lane] - memory[s]
            square += d * d
            s += 1
        if not 0.0 < square < np.inf:
            return False
    return True


@_inline
def cycle(memory, sensors, lanes, width, T, noise, first, columns, variance, row, project):
    """Predict, linearize, update and gate, once, for the measurements that the sensors hold.

    The noise has `columns` of six numbers each, which begin at ``noise[first]``; the variances of
    the measurements begin at ``variance[row]``.
    """
    own = (SENSORS + sensors * kernel.SENSOR_ROWS) * lanes
    lower, upper = own + 1, own + 2 + sensors
    _predict(memory, 0, lanes, T)
    for g in range(first, first + 6 * columns, 6):
        _add_noise(
            memory, 0, lanes,
            noise[g], noise[g + 1], noise[g + 2], noise[g + 3], noise[g + 4], noise[g + 5],
        )  # fmt: skip
    for lane in range(lanes):
        memory[SEEN * lanes + lane] = 0.0
    for n in range(sensors):
        sensor = (SENSORS + n * kernel.SENSOR_ROWS) * lanes
        s = own + 3 + 2 * sensors + 3 * n
        _linearize(
            memory, 0, memory, sensor, lanes, memory[s], memory[s + 1], memory[s + 2], memory[own]
        )
        if project:
            _project(memory, 0, memory, sensor, lanes)
        _admitted(memory, 0, memory, sensor, lanes, variance[row + n])
    _begun(memory, 0, lanes)
    for n in range(sensors):
        _update(memory, 0, memory, (SENSORS + n * kernel.SENSOR_ROWS) * lanes, lanes)
    for lane in range(width):
        nis, seen = memory[kernel.NIS * lanes + lane], int(memory[SEEN * lanes + lane])
        # Not a number fails both comparisons: a broken filter is never "updated".
        if seen > 0 and memory[lower + seen] <= nis <= memory[upper + seen]:
            _accepted(memory, lane, lanes)
        else:
            _refused(memory, lane, lanes)
            if seen == 0:
                memory[kernel.NIS * lanes + lane] = np.nan


@_inline
def write_innovations(memory, sensors, lanes, lane, innovation, at):
    for n in range(sensors):
        sensor = (SENSORS + n * kernel.SENSOR_ROWS) * lanes + lane
        _write_innovation(memory, sensor, innovation, at + n, lanes)


@_inline
def write_innovation_covariance(memory, sensors, lanes, lane, variance, row, S, at):
    for n in range(sensors):
        f = (SENSORS + n * kernel.SENSOR_ROWS) * lanes + lane
        for m in range(n, sensors):
            b = (SENSORS + m * kernel.SENSOR_ROWS) * lanes + lane
            r = variance[row + n] if m == n else 0.0
            upper, lower = at + n * sensors + m, at + m * sensors + n
            _write_product(memory, f, memory, b, S, upper, S, lower, lanes, r)
