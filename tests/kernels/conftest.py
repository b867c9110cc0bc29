"""Random EKF cycles: a state, its covariance, process noise, sensors and measurements."""

from dataclasses import dataclass

import numpy as np
import pytest

from dopplerlib.kernels import ekf as kernel

UPPER = np.triu_indices(6)


@dataclass(frozen=True)
class Cycle:
    """Everything that one cycle needs, for `runs` runs at once."""

    x: np.ndarray  # (runs, 6)
    P: np.ndarray  # (runs, 6, 6)
    Q: np.ndarray  # (6, 6)
    T: float
    sensors: np.ndarray  # (N, 3)
    g: float  # 2 / lambda
    variance: np.ndarray  # (N,)
    z: np.ndarray  # (runs, N), NaN where missing

    def work(self):
        """Return a work array, (ROWS, runs), before the cycle."""
        work = np.zeros((kernel.ROWS, len(self.x)))
        work[kernel.PREDICTED : kernel.PREDICTED + 6] = self.x.T
        work[kernel.COVARIANCE : kernel.COVARIANCE + 21] = self.P[:, *UPPER].T
        work[kernel.PROCESS_NOISE : kernel.PROCESS_NOISE + 21] = self.Q[UPPER][:, None]
        return work

    def measured(self, n):
        """Return measurement and presence of sensor `n`, as the loop enters them."""
        seen = ~np.isnan(self.z[:, n])
        return np.where(seen, self.z[:, n], 0.0), seen.astype(float)


def spd(rng, scale):
    """Return a covariance whose correlations have a condition number below about 100."""
    A = rng.normal(size=(6, 6)) / np.sqrt(6) + np.eye(6)
    P = A @ A.T + 0.1 * np.eye(6)
    return P * np.outer(scale, scale)


@pytest.fixture(scope="module")
def random_cycle():
    """Return a function (rng, sensors, runs, missing) -> Cycle of moderate, ordinary numbers."""

    def make(rng, n, runs, missing=0.0):
        sensors = rng.normal(size=(n, 3)) * 0.3
        x = np.concatenate([rng.normal(size=(runs, 3)), rng.normal(size=(runs, 3))], axis=1)
        x[:, 0] += 3.0  # clear of the sensors
        scale = np.repeat(10 ** rng.uniform(-2, -0.5, 2), 3)
        T = 10 ** rng.uniform(-3, 0)
        P = np.stack([spd(rng, scale) for _ in range(runs)])
        Q = spd(rng, scale * rng.uniform(0.1, 0.5))
        sigma = rng.uniform(0.5, 5.0, n)
        predicted = x.copy()
        predicted[:, :3] += T * x[:, 3:]
        d = sensors - predicted[:, None, :3]
        speed = np.sum(d * predicted[:, None, 3:], axis=-1) / np.linalg.norm(d, axis=-1)
        z = 160.0 * speed + rng.normal(size=(runs, n)) * 3 * sigma
        z[rng.uniform(size=z.shape) < missing] = np.nan
        return Cycle(x, P, Q, T, sensors, 160.0, sigma**2, z)

    return make
