"""Compile every loop that numba compiles, for all processes that follow.

Nothing needs this: a loop compiles when it is first called, and numba keeps what comes out. But
processes that start together, as those of the tests do, would all compile the same.
"""

import gc

import numpy as np

from dopplerlib import RadarArray, doppler_shift, ekf, ekf_online, ml_frequency, ml_initialize
from dopplerlib.estimation._ekf_loop import LANES
from dopplerlib.estimation.gaussian_sum import gaussian_sum
from dopplerlib.estimation.importance_sampling import importance_posterior
from dopplerlib.evaluation.path_bounds import path_crlb
from dopplerlib.signal.validity import valid_samples
from dopplerlib.systems import valarmathi
from dopplerlib.workspace.layouts import layout_quality
from tools.command import parser, start


def main(argv=None):
    """Call each of them once, on as little as it takes."""
    parser(__doc__).parse_args(argv)
    gc.disable()  # a tenth of the time, for a compiler's trees that are soon gone with the process
    array = RadarArray.ring(6, 0.2)
    start, box = np.array([1.0, 0, 0, -1, 0, 0]), np.full((2, 6), 1.0) * [[-2], [2]]
    for runs in (1, LANES):
        z = np.zeros((runs, 2, 6))
        ekf(z, array, start, np.eye(6), 0.001, 1.0, 1.0)
    ekf_online(array, start, np.eye(6), 0.001, 1.0, 1.0)(z[0, 0])
    ml_initialize(z, array, 1.0, 0.001, box)
    gaussian_sum(z[0], array, start, np.eye(6), 0.001, 1.0, 1.0)
    # Its prior holds the target of these shifts: without a state there is nothing to weigh.
    shifts, prior = np.tile(doppler_shift(start, array), (2, 1)), (start, 0.01 * np.eye(6))
    rng = np.random.default_rng(1)
    importance_posterior(shifts, array, *prior, 0.001, 1.0, 1.0, rng=rng, draws=100)
    path_crlb(np.ones((2, 6)), array, 1.0, np.eye(6))
    layout_quality(start[None], array)
    ml_frequency(np.ones(16, complex), 1.0)
    valid_samples(np.arange(64.0))
    rng = np.random.default_rng(1)
    table = valarmathi.window_table([0, 10], [0, 10], rng=rng, runs=1)
    valarmathi.run_algorithms("path 1", 0.0, 1, table, rng=rng)


if __name__ == "__main__":
    start(main)
