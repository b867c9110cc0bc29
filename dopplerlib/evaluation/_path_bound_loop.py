"""The covariance of an EKF that is linearized at the true path, compiled: no data, no states."""

import numpy as np

from .._compile import cached_njit, fingerprint, inner_njit
from ..kernels import ekf as kernel

_inline = inner_njit(forceinline=True)
_predict = _inline(kernel.predict)
_add_noise = _inline(kernel.add_noise)
_linearize = _inline(kernel.linearize)
_update = _inline(kernel.update)
_covariance = _inline(kernel.covariance)


def _cached(compiled_in):
    """Return the loop over paths, compiled once for all processes."""

    @cached_njit
    def bound_paths(x, positions, doppler_per_speed, variance, T, noise, factors, every, out):
        """Write the bound at each `every`-th sample of paths (R, K, 6), up to the first NaN.

        `factors` are those of the prior, as the kernels keep them.
        """
        compiled_in  # noqa: B018  (see fingerprint)
        work, sensor = np.zeros(kernel.ROWS), np.zeros(kernel.SENSOR_ROWS)
        for run in range(len(x)):
            for i in range(21):
                work[kernel.FACTORS + i] = factors[i]
            for k in range(x.shape[1]):
                if np.isnan(x[run, k, 0]):
                    break
                _predict(work, 1, 0, T[k])
                for g in noise[k]:
                    _add_noise(work, 1, 0, g[0], g[1], g[2], g[3], g[4], g[5])
                for i in range(6):
                    work[kernel.PREDICTED + i] = x[run, k, i]
                for n in range(len(positions)):
                    if variance[k, n] < np.inf:  # a missing measurement has none
                        s = positions[n]
                        sensor[kernel.VARIANCE] = variance[k, n]
                        _linearize(work, sensor, 1, 0, s[0], s[1], s[2], doppler_per_speed)
                        _update(work, sensor, 1, 0)
                if (k + 1) % every == 0:
                    _covariance(work, 1, 0)
                    row = kernel.COVARIANCE
                    P = out[run, (k + 1) // every - 1]
                    for i in range(6):
                        for j in range(i, 6):
                            P[i, j] = P[j, i] = work[row]
                            row += 1

    return bound_paths


bound_paths = _cached(fingerprint(kernel))
