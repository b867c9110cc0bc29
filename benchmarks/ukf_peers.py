"""Compute with FilterPy and Stone Soup what tests/estimation/test_nonlinear_kalman.py compares.

Needs benchmarks/requirements.in; writes tests/estimation/ukf_peers.json. The model is written out
here once more, not taken from `dopplerlib`.
"""

import json
from datetime import datetime, timedelta
from importlib.metadata import version
from pathlib import Path

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter
from stonesoup.base import Property
from stonesoup.models.base import GaussianModel
from stonesoup.models.measurement.nonlinear import NonLinearGaussianMeasurement
from stonesoup.models.transition.base import TransitionModel
from stonesoup.predictor.kalman import CubatureKalmanPredictor, UnscentedKalmanPredictor
from stonesoup.types.array import CovarianceMatrix, StateVector
from stonesoup.types.detection import Detection
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.state import GaussianState
from stonesoup.updater.kalman import CubatureKalmanUpdater, UnscentedKalmanUpdater

TARGET = Path(__file__).resolve().parents[1] / "tests" / "estimation" / "ukf_peers.json"
Q, R = np.diag([0.01, 0.05, 0.01, 0.05]), np.diag([0.04, 0.01])
X0, P0 = np.array([0.0, 1.0, 0.0, 0.5]), np.diag([1.0, 0.5, 1.0, 0.5])
SETTINGS = {"cubature": (1.0, 0.0, 0.0), "negative": (0.5, 2.0, -1.0), "usual": (0.1, 2.0, 0.0)}


def move(x, dt=None):
    """Return the state after half a second; the velocity turns with the place."""
    a = 0.3 + 0.05 * x[0]
    vx, vy = x[1] * np.cos(a) - x[3] * np.sin(a), x[1] * np.sin(a) + x[3] * np.cos(a)
    return np.array([x[0] + 0.5 * vx, vx, x[2] + 0.5 * vy, vy])


def see(x):
    """Return range and angle from (-8, 2)."""
    return np.array([np.hypot(x[0] + 8.0, x[2] - 2.0), np.arctan2(x[2] - 2.0, x[0] + 8.0)])


def filterpy(z, alpha, beta, kappa):
    """Return x of each sample and the last P of FilterPy's filter."""
    points = MerweScaledSigmaPoints(4, alpha, beta, kappa)
    ukf = UnscentedKalmanFilter(4, 2, 0.5, see, move, points)
    ukf.x, ukf.P, ukf.Q, ukf.R = X0.copy(), P0.copy(), Q, R
    xs = []
    for measured in z:
        ukf.predict()
        ukf.update(measured)
        xs.append(ukf.x.tolist())
    return {"x": xs, "P": ukf.P.tolist()}


class Motion(TransitionModel, GaussianModel):
    """`move` as a model of Stone Soup."""

    ndim_state = 4

    def function(self, state, noise=False, **kwargs):
        return _columns(move, state.state_vector)

    def covar(self, **kwargs):
        return CovarianceMatrix(Q)

    def rvs(self, *args, **kwargs):
        raise NotImplementedError


class Sight(NonLinearGaussianMeasurement):
    """`see` as a model of Stone Soup."""

    ndim_state: int = Property(default=4)
    ndim_meas = 2

    def function(self, state, noise=False, **kwargs):
        return _columns(see, state.state_vector)


def _columns(function, vectors):
    values = [function(np.asarray(column, float).ravel()) for column in np.asarray(vectors).T]
    return type(vectors)(np.stack(values, axis=-1))


def stone_soup(z, settings):
    """Return the same of Stone Soup's filters; cubature if there are no settings."""
    sight = Sight(mapping=(0, 2), noise_covar=CovarianceMatrix(R))
    if settings is None:
        predictor, updater = CubatureKalmanPredictor(Motion()), CubatureKalmanUpdater(sight)
    else:
        alpha, beta, kappa = settings
        options = {"alpha": alpha, "beta": beta, "kappa": kappa}
        predictor = UnscentedKalmanPredictor(Motion(), **options)
        updater = UnscentedKalmanUpdater(sight, **options)
    time = datetime(2026, 1, 1)
    state, xs = GaussianState(StateVector(X0), CovarianceMatrix(P0), timestamp=time), []
    for measured in z:
        time += timedelta(seconds=0.5)
        prediction = predictor.predict(state, timestamp=time)
        detection = Detection(StateVector(measured), timestamp=time, measurement_model=sight)
        state = updater.update(SingleHypothesis(prediction, detection))
        xs.append(np.asarray(state.state_vector, float).ravel().tolist())
    return {"x": xs, "P": np.asarray(state.covar, float).tolist()}


def main():
    rng, x, path = np.random.default_rng(43), np.array([0.5, 1.2, -0.5, 0.3]), []
    for _ in range(12):
        x = move(x)
        path.append(x)
    noise = rng.standard_normal((12, 2)) * np.sqrt(np.diag(R))
    z = np.array([see(x) for x in path]) + noise
    tracks = {f"FilterPy, {name}": filterpy(z, *each) for name, each in SETTINGS.items()}
    for name, each in SETTINGS.items():
        tracks[f"Stone Soup, {name}"] = stone_soup(z, None if name == "cubature" else each)
    versions = {name: version(name) for name in ("filterpy", "stonesoup", "numpy")}
    content = {
        "made by": "python benchmarks/ukf_peers.py", "versions": versions,
        "path": np.array(path).tolist(), "noise": noise.tolist(), "tracks": tracks,
    }  # fmt: skip
    TARGET.write_text(json.dumps(content) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
