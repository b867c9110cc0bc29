"""Compute with FilterPy what tests/estimation/test_imm.py compares.

Needs benchmarks/requirements.in; writes tests/estimation/imm_peers.json. The models are written out
here once more, not taken from `dopplerlib`.
"""

import json
from importlib.metadata import version
from pathlib import Path

import numpy as np
from filterpy.kalman import (
    IMMEstimator,
    KalmanFilter,
    MerweScaledSigmaPoints,
    UnscentedKalmanFilter,
)

TARGET = Path(__file__).resolve().parents[1] / "tests" / "estimation" / "imm_peers.json"
X0, P0 = np.array([8.0, 3.0, -1.0, 1.0]), np.diag([1.0, 1.0, 0.5, 0.5])
SWITCH, MODE0 = np.array([[0.9, 0.1], [0.2, 0.8]]), np.array([0.6, 0.4])
R, H = np.diag([0.04, 0.01]), np.eye(2, 4)
T, RATE = 0.5, 0.6
c, s = np.cos(RATE * T), np.sin(RATE * T)
# Straight flight, and a turn at a known rate: linear, as the rate is no unknown.
F = np.array(
    [
        [[1, 0, T, 0], [0, 1, 0, T], [0, 0, 1, 0], [0, 0, 0, 1]],
        [
            [1, 0, s / RATE, -(1 - c) / RATE],
            [0, 1, (1 - c) / RATE, s / RATE],
            [0, 0, c, -s],
            [0, 0, s, c],
        ],
    ]
)
Q = np.array([np.diag([0.001, 0.001, 0.01, 0.01]), np.diag([0.001, 0.001, 0.05, 0.05])])


def see(x):
    """Return range and azimuth from the origin."""
    return np.array([np.hypot(x[0], x[1]), np.arctan2(x[1], x[0])])


def linear(model):
    kf = KalmanFilter(4, 2)
    kf.F, kf.H = F[model], H
    return kf


def points(model):
    cubature = MerweScaledSigmaPoints(4, 1.0, 0.0, 0.0)
    return UnscentedKalmanFilter(4, 2, T, see, lambda x, dt: F[model] @ x, cubature)


def track(make, z):
    """Return x and the probabilities of each sample, and the last P, of FilterPy's estimator."""
    filters = [make(model) for model in range(2)]
    for model, one in enumerate(filters):
        one.x, one.P, one.Q, one.R = X0.copy(), P0.copy(), Q[model], R
    imm = IMMEstimator(filters, MODE0, SWITCH)
    xs, modes = [], []
    for measured in z:
        imm.predict()
        imm.update(measured)
        xs.append(np.ravel(imm.x).tolist())
        modes.append(np.ravel(imm.mu).tolist())
    return {"z": z.tolist(), "x": xs, "mode": modes, "P": imm.P.tolist()}


def main():
    rng, x, path = np.random.default_rng(44), X0, []
    for k in range(16):
        x = F[int(k >= 8)] @ x
        path.append(x)
    noise = rng.standard_normal((16, 2)) * np.sqrt(np.diag(R))
    tracks = {
        "linear": track(linear, np.array(path)[:, :2] + noise),
        "points": track(points, np.array([see(x) for x in path]) + noise),
    }
    setting = {"F": F, "Q": Q, "H": H, "R": R, "switch": SWITCH, "x0": X0, "P0": P0, "mode0": MODE0}
    content = {
        "made by": "python benchmarks/imm_peers.py",
        "versions": {name: version(name) for name in ("filterpy", "numpy")},
        "setting": {name: value.tolist() for name, value in setting.items()},
        "tracks": tracks,
    }
    TARGET.write_text(json.dumps(content) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
