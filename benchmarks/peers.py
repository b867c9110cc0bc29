"""The same extended Kalman filter, written with other libraries.

Each maker prepares whatever can be prepared outside the timed part and returns a function that
filters one record z (K, N) and returns x (K, 6) and P (K, 6, 6). Every cycle predicts, then
updates. All but `lambdified` get the Doppler shift and its Jacobian below, hand-vectorized, not
those of `dopplerlib`.
"""

from datetime import datetime, timedelta

import numpy as np
import sympy as sp
from filterpy.kalman import ExtendedKalmanFilter
from stonesoup.base import Property
from stonesoup.models.measurement.nonlinear import NonLinearGaussianMeasurement
from stonesoup.models.transition.linear import LinearGaussianTimeInvariantTransitionModel
from stonesoup.predictor.kalman import ExtendedKalmanPredictor
from stonesoup.types.array import CovarianceMatrix, StateVector
from stonesoup.types.detection import Detection
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.state import GaussianState
from stonesoup.updater.kalman import ExtendedKalmanUpdater

from dopplerlib.derive import doppler

_ONES = np.ones(3)


def shift(x, positions, doppler_per_speed):
    """Return the Doppler shift (N,) of the state x (6,): Eq 6 of Mittermaier et al. (2016)."""
    d = positions - x[:3]
    return doppler_per_speed * (d @ x[3:]) / np.sqrt((d * d) @ _ONES)


def jacobian(x, positions, doppler_per_speed):
    """Return its derivative (N, 6) with respect to the state."""
    d = positions - x[:3]
    inverse_square = 1 / ((d * d) @ _ONES)
    scale = (doppler_per_speed * np.sqrt(inverse_square))[:, None]
    H = np.empty((len(positions), 6))
    H[:, :3] = scale * (d * ((d @ x[3:]) * inverse_square)[:, None] - x[3:])
    H[:, 3:] = scale * d
    return H


def shift_and_jacobian(x, sensors):
    """Return both."""
    return shift(x, *sensors), jacobian(x, *sensors)


def less_k_h_p(P, K, H, S, R):
    """Return the updated covariance as Table 1 of the paper has it."""
    return P - K @ H @ P


def textbook(array, x0, P0, F, Q, R, covariance=less_k_h_p, model=shift_and_jacobian, sensors=None):
    """Return Table 1 of the paper line by line in NumPy, as a student writes it."""
    if sensors is None:
        sensors = array.positions, array.doppler_per_speed

    def run(z):
        x, P = x0, P0
        xs, Ps = np.empty((len(z), 6)), np.empty((len(z), 6, 6))
        for k, measured in enumerate(z):
            x = F @ x
            P = F @ P @ F.T + Q
            h, H = model(x, sensors)
            S = H @ P @ H.T + R
            K = P @ H.T @ np.linalg.inv(S)
            x = x + K @ (measured - h)
            P = covariance(P, K, H, S, R)
            xs[k], Ps[k] = x, P
        return xs, Ps

    return run


def lambdified(array, x0, P0, F, Q, R):
    """Return the same with h and H that SymPy's `lambdify` makes of the library's formulas."""
    symbols = [doppler.STATE, doppler.SENSOR, doppler.WAVELENGTH]
    formulas = [doppler.doppler_shift(), *doppler.doppler_gradient()]
    function = sp.lambdify(symbols, formulas, "numpy", cse=True)

    def model(x, sensors):
        h, *columns = function(x, *sensors)
        return h, np.stack(columns, axis=-1)

    sensors = array.positions.T, 2 / array.doppler_per_speed
    return textbook(array, x0, P0, F, Q, R, model=model, sensors=sensors)


def stacked(array, x0, P0, F, Q, R):
    """Return a filter of many records (R, K, N) at once: each line of Table 1 for all of them."""
    positions, doppler_per_speed = array.positions, array.doppler_per_speed

    def run(z):
        runs, K, N = z.shape
        x, P = np.tile(x0[:, None], (runs, 1, 1)), np.tile(P0, (runs, 1, 1))
        xs, Ps = np.empty((runs, K, 6)), np.empty((runs, K, 6, 6))
        H = np.empty((runs, N, 6))
        for k in range(K):
            x = F @ x
            P = F @ P @ F.T + Q
            d = positions - x[:, None, :3, 0]
            speed = d @ x[:, 3:]
            inverse_square = 1 / ((d * d) @ _ONES)[..., None]
            scale = doppler_per_speed * np.sqrt(inverse_square)
            H[..., :3] = scale * (d * (speed * inverse_square) - x[:, None, 3:, 0])
            H[..., 3:] = scale * d
            PH = P @ np.swapaxes(H, -1, -2)
            gain = PH @ np.linalg.inv(H @ PH + R)
            x = x + gain @ (z[:, k, :, None] - scale * speed)
            P = P - gain @ (H @ P)
            xs[:, k], Ps[:, k] = x[..., 0], P
        return xs, Ps

    return run


def filterpy(array, x0, P0, F, Q, R):
    """Return FilterPy's filter; `predict_update` is avoided, it takes H before the prediction."""
    sensors = array.positions, array.doppler_per_speed

    def run(z):
        ekf = ExtendedKalmanFilter(6, len(array))
        ekf.x, ekf.P, ekf.F, ekf.Q, ekf.R = x0.copy(), P0.copy(), F, Q, R
        xs, Ps = np.empty((len(z), 6)), np.empty((len(z), 6, 6))
        for k, measured in enumerate(z):
            ekf.predict()
            ekf.update(measured, jacobian, shift, args=sensors, hx_args=sensors)
            xs[k], Ps[k] = ekf.x, ekf.P
        return xs, Ps

    return run


class _NumericalDoppler(NonLinearGaussianMeasurement):
    """Doppler shifts with Stone Soup's own Jacobian, by finite differences."""

    sensors: object = Property(doc="positions (N, 3) and Doppler shift in Hz of 1 m/s")

    @property
    def ndim_meas(self):
        return len(self.sensors[0])

    def function(self, state, noise=False, **kwargs):
        # Its finite differences come as one matrix, a state a column.
        x = np.asarray(state.state_vector, float)
        shifts = [shift(column, *self.sensors) for column in x.T]
        return np.stack(shifts, axis=1).view(type(state.state_vector))


class _AnalyticDoppler(_NumericalDoppler):
    """Doppler shifts with their Jacobian."""

    def function(self, state, noise=False, **kwargs):
        x = np.asarray(state.state_vector, float)[:, 0]
        return shift(x, *self.sensors)[:, None].view(StateVector)

    def jacobian(self, state, **kwargs):
        return jacobian(np.asarray(state.state_vector, float)[:, 0], *self.sensors)


def stonesoup(array, x0, P0, F, Q, R, T, model=_AnalyticDoppler):
    """Return Stone Soup's filter; its detections are made by `run.prepare(z)`, outside the clock.

    The covariance is its default, P - K S K'.
    """
    sensors = array.positions, array.doppler_per_speed
    doppler = model(
        ndim_state=6, mapping=tuple(range(6)), noise_covar=CovarianceMatrix(R), sensors=sensors
    )
    motion = LinearGaussianTimeInvariantTransitionModel(
        transition_matrix=F, covariance_matrix=CovarianceMatrix(Q)
    )
    predictor, updater = ExtendedKalmanPredictor(motion), ExtendedKalmanUpdater(doppler)
    start = datetime(2016, 1, 1)

    def prepare(z):
        return [
            Detection(StateVector(measured), timestamp=start + timedelta(seconds=T * (k + 1)))
            for k, measured in enumerate(z)
        ]

    def run(detections):
        state = GaussianState(x0, P0, timestamp=start)
        xs, Ps = np.empty((len(detections), 6)), np.empty((len(detections), 6, 6))
        for k, detection in enumerate(detections):
            prediction = predictor.predict(state, timestamp=detection.timestamp)
            state = updater.update(SingleHypothesis(prediction, detection))
            xs[k], Ps[k] = state.state_vector[:, 0], state.covar
        return xs, Ps

    run.prepare = prepare
    return run


def stonesoup_numerical(*arguments):
    """Return Stone Soup's filter with the Jacobian by its own finite differences."""
    return stonesoup(*arguments, model=_NumericalDoppler)
