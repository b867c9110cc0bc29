"""Compiling the filter takes seconds, so it must happen once."""

import subprocess
import sys

import numpy as np

from dopplerlib import RadarArray, doppler_shift, ekf
from dopplerlib.estimation._ekf_loop import LANES, compiled

RING = RadarArray.ring(6, 0.2)
X = np.array([0.8, 0.1, 0.1, -0.7, -0.1, 0.0])


def test_the_loop_is_compiled_once_however_the_arguments_are_given():
    z = np.tile(doppler_shift(X, RING), (LANES, 3, 1))
    each_x, each_P = np.tile(X, (LANES, 1)), np.tile(np.eye(6), (LANES, 1, 1))
    for measured in (z, np.broadcast_to(z[0], z.shape), z.tolist(), z[:, ::-1]):
        for x0, P0 in [(X, np.eye(6)), (each_x, np.eye(6)), (X, each_P), (each_x, each_P)]:
            for sigma in (0.4, np.full(6, 0.4), np.full((3, 6), 0.4)):
                ekf(measured, RING, x0, P0, 0.001, 0.4, sigma)
                ekf(measured, RING, x0, P0, 0.001, 0.4, sigma, keep=())
    assert len(compiled(LANES).signatures) == 1
    for mine in (z, each_x, each_P):
        assert mine.flags.writeable  # what the caller gave stays as it was


def test_loading_from_the_cache_needs_no_tables_of_numba():
    """They take four times as long, and load SciPy; who compiles afterwards gets them."""
    code = """
import sys
import numpy as np
from dopplerlib import RadarArray, ekf
start = [0.8, 0.1, 0.1, -0.7, 0, 0], np.eye(6)
track = ekf(np.zeros((3, 6)), RadarArray.ring(6, 0.2), *start, 0.001, 0.4, 0.4)
print(track.x.tobytes().hex(), "scipy.linalg" in sys.modules)
"""
    compile_more = (
        'import numba\nprint(numba.njit(lambda x: x + 1)(1), "scipy.linalg" in sys.modules)'
    )
    first, second = (
        subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
        for text in (code, code + compile_more)
    )
    x, _ = first.stdout.split()
    assert second.stdout.split() == [x, "False", "2", "True"]
