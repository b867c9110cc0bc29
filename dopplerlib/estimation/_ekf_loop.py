"""The EKF, compiled: whole records, and one sample alone. The work is done by `_ekf_cycle`."""

from functools import cache

import numpy as np

from .. import _straight
from .._compile import cached_njit, fingerprint
from ..kernels import ekf as kernel
from . import _ekf_cycle
from ._ekf_cycle import (
    SAMPLE_NOISE,
    SAMPLE_VARIANCE,
    SENSORS,
    UPDATES,
    clear_of_sensors,
    covariance,
    cycle,
    factor,
    new_memory,
    read_state,
    write_covariance,
    write_innovation_covariance,
    write_innovations,
    write_state,
)

LANES = 16
NIS = kernel.NIS
INFINITE, REFUSED, UPDATED = range(3)  # what becomes of a sample


@cache
def compiled(lanes):
    """Return the loop over records for `lanes` runs at a time."""
    compiled_in = fingerprint(kernel, _straight, _ekf_cycle)

    @cached_njit
    def filter_records(
        memory, sensors, samples, columns, z, T, noise, variance, x0, P0,
        x, P, innovation, S, nis, updated,
    ):  # fmt: skip
        """Return whether no measurement is infinite, and no start in doubt.

        That is one with a P0 that may be none, or one that is predicted onto a sensor at once.
        """
        compiled_in  # noqa: B018  (see fingerprint)
        good = True
        runs = len(nis) // samples
        # An array of size zero says that nobody wants this output.
        for first in range(0, runs, lanes):
            width = min(lanes, runs - first)
            for lane in range(width):
                read_state(memory, lane, x0, (first + lane) * 6, lanes)
                certain = factor(P0, (first + lane) * 36, memory, lane, lanes)
                clear = clear_of_sensors(memory, sensors, lanes, lane, T[0])
                good = good and certain and clear
            for k in range(samples):
                # One interval and one variance for all samples, or each its own.
                step = k if len(T) > 1 else 0
                row = k * sensors if len(variance) > sensors else 0
                for n in range(sensors):
                    sensor = (SENSORS + n * kernel.SENSOR_ROWS + kernel.MEASUREMENT) * lanes
                    for lane in range(width):
                        measured = z[((first + lane) * samples + k) * sensors + n]
                        memory[sensor + lane] = measured
                        good = good and measured != np.inf and measured != -np.inf
                cycle(
                    memory, sensors, lanes, width, T[step], noise, step * 6 * columns, columns,
                    variance, row, len(S) > 0,
                )  # fmt: skip
                if len(P):
                    covariance(memory, 0, lanes)
                for lane in range(width):
                    at = (first + lane) * samples + k
                    write_state(memory, lane, x, at * 6, lanes)
                    nis[at] = memory[kernel.NIS * lanes + lane]
                    updated[at] = memory[UPDATES * lanes + lane] > 0.0
                    if len(P):
                        write_covariance(memory, lane, P, at * 36, lanes)
                    if len(innovation):
                        write_innovations(memory, sensors, lanes, lane, innovation, at * sensors)
                    if len(S):
                        write_innovation_covariance(
                            memory, sensors, lanes, lane, variance, row,
                            S, at * sensors * sensors,
                        )  # fmt: skip
        return good

    return filter_records


@cache
def compiled_step():
    """Return two functions: one writes a start to a memory, one filters a sample.

    All that the cycle needs is in the memory, see `SampleMemory`. What it gives goes to `results`,
    at the place that the memory names: x, then what is wanted of P, innovation and S.
    """
    compiled_in = fingerprint(kernel, _straight, _ekf_cycle)

    @cached_njit
    def begin(memory, x0, P0):
        compiled_in  # noqa: B018  (see fingerprint)
        read_state(memory, 0, x0, 0, 1)
        factor(P0, 0, memory, 0, 1)

    @cached_njit
    def filter_sample(memory, results):
        """Return whether the state was updated, or, if nothing was done, that z is infinite."""
        compiled_in  # noqa: B018  (see fingerprint)
        sensors, columns = int(memory[len(memory) - 6]), int(memory[len(memory) - 5])
        for n in range(sensors):
            measured = memory[SENSORS + n * kernel.SENSOR_ROWS + kernel.MEASUREMENT]
            if measured == np.inf or measured == -np.inf:
                return INFINITE
        own = SENSORS + sensors * kernel.SENSOR_ROWS + 3 + 5 * sensors
        noise, variance = own + SAMPLE_NOISE, own + SAMPLE_VARIANCE
        wanted, place = variance + sensors + 2, variance + sensors + 5
        with_S = memory[wanted + 2] > 0.0
        cycle(memory, sensors, 1, 1, memory[own], memory, noise, columns, memory, variance, with_S)
        at = int(memory[place])
        write_state(memory, 0, results, at, 1)
        at += 6
        if memory[wanted] > 0.0:
            covariance(memory, 0, 1)
            write_covariance(memory, 0, results, at, 1)
            at += 36
        if memory[wanted + 1] > 0.0:
            write_innovations(memory, sensors, 1, 0, results, at)
            at += sensors
        if with_S:
            write_innovation_covariance(memory, sensors, 1, 0, memory, variance, results, at)
            at += sensors * sensors
        memory[place] = at
        return UPDATED if memory[UPDATES] > 0.0 else REFUSED

    return begin, filter_sample


class SampleMemory:
    """The memory of `compiled_step`, with names for its parts."""

    def __init__(self, positions, doppler_per_speed, lower, upper, columns, wanted):
        N = len(positions)
        tail = SAMPLE_VARIANCE + N + 6
        self.all = new_memory(1, positions, doppler_per_speed, lower, upper, tail)
        own = self.all[-tail:]
        self.T, self.noise = own[:1], own[SAMPLE_NOISE:SAMPLE_VARIANCE]
        self.variance, self.place = own[SAMPLE_VARIANCE:-6], own[-1:]
        own[-6:-1] = N, columns, *wanted
        self.z = self.all[SENSORS + kernel.MEASUREMENT :: kernel.SENSOR_ROWS][:N]
