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
    U: np.ndarray  # (runs, 6, 6), unit upper triangular
    D: np.ndarray  # (runs, 6): P = U diag(D) U'
    G: np.ndarray  # (6, columns): Q = G G'
    T: float
    sensors: np.ndarray  # (N, 3)
    g: float  # 2 / lambda
    variance: np.ndarray  # (N,)
    z: np.ndarray  # (runs, N), NaN where missing

    @property
    def P(self):
        return self.U * self.D[:, None] @ np.swapaxes(self.U, 1, 2)

    @property
    def Q(self):
        return self.G @ self.G.T

    def work(self):
        """Return a work array, (ROWS, runs), before the cycle."""
        work = np.zeros((kernel.ROWS, len(self.x)))
        work[kernel.PREDICTED : kernel.PREDICTED + 6] = self.x.T
        factors = self.U.copy()
        factors[:, range(6), range(6)] = self.D
        work[kernel.FACTORS : kernel.FACTORS + 21] = factors[:, *UPPER].T
        return work

    def measured(self, n):
        """Return the measurements of sensor `n`, 0 where it is missing."""
        return np.nan_to_num(self.z[:, n])

    def leave_out_missing(self, n, sensor, number):
        """Give sensor `n`, where it is missing, what changes nothing in the update."""
        missing = np.isnan(self.z[:, n])
        sensor[kernel.VARIANCE] = number(np.where(missing, 1.0, self.variance[n]))
        for row in range(kernel.INNOVATION, kernel.GRADIENT + 6):
            sensor[row] = sensor[row] * number(np.where(missing, 0.0, 1.0))


def factored(rng, scale):
    """Return U and D of a covariance whose correlations have a condition number below about 100."""
    A = rng.normal(size=(6, 6)) / np.sqrt(6) + np.eye(6)
    P = (A @ A.T + 0.1 * np.eye(6)) * np.outer(scale, scale)
    L = np.linalg.cholesky(P[::-1, ::-1])[::-1, ::-1]  # upper triangular, L L' = P
    return L / np.diag(L), np.diag(L) ** 2


@pytest.fixture(scope="module")
def random_cycle():
    """Return a function (rng, sensors, runs, missing) -> Cycle of moderate, ordinary numbers."""

    def make(rng, n, runs, missing=0.0):
        sensors = rng.normal(size=(n, 3)) * 0.3
        x = np.concatenate([rng.normal(size=(runs, 3)), rng.normal(size=(runs, 3))], axis=1)
        x[:, 0] += 3.0  # clear of the sensors
        scale = np.repeat(10 ** rng.uniform(-2, -0.5, 2), 3)
        T = 10 ** rng.uniform(-3, 0)
        U, D = (np.stack(f) for f in zip(*(factored(rng, scale) for _ in range(runs)), strict=True))
        G = rng.uniform(0.1, 0.5) * scale[:, None] * rng.normal(size=(6, rng.integers(1, 4)))
        sigma = rng.uniform(0.5, 5.0, n)
        predicted = x.copy()
        predicted[:, :3] += T * x[:, 3:]
        d = sensors - predicted[:, None, :3]
        speed = np.sum(d * predicted[:, None, 3:], axis=-1) / np.linalg.norm(d, axis=-1)
        z = 160.0 * speed + rng.normal(size=(runs, n)) * 3 * sigma
        z[rng.uniform(size=z.shape) < missing] = np.nan
        return Cycle(x, U, D, G, T, sensors, 160.0, sigma**2, z)

    return make
