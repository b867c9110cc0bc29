"""The extended Kalman filter of the report, with its Jacobian as it is or as it should be."""

import numpy as np

from ... import _checks
from ...estimation import recursion
from ...estimation.track import Track
from ...kernels.doppler import doppler_shift_and_gradient
from ...model.doppler import doppler_jacobian
from ...model.motion import constant_velocity

JACOBIANS = ("as reported", "derived")


def student_jacobian(x, array, jacobian="as reported"):
    """Return the derivative of the Doppler shifts, or what the report takes for it.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States in m and m/s.
    array : RadarArray
        The N sensors.
    jacobian : {"as reported", "derived"}
        "as reported": the three columns that belong to the position have the wrong sign.

    Returns
    -------
    ndarray, shape (..., N, 6)
        In Hz per m and Hz per m/s.

    Raises
    ------
    ValueError
        If `jacobian` is neither, or an argument is refused by `doppler_jacobian`.
    """
    return doppler_jacobian(x, array) * _signs(jacobian)


def student_ekf(z, array, x0, P0, T, sigma_a, sigma_f, jacobian="as reported"):
    """Track a target as the report does: predict, then update in the form of Joseph.

    Parameters
    ----------
    z : array_like, shape (runs, K, N)
        Doppler measurements in Hz.
    array : RadarArray
        The N sensors.
    x0 : array_like, shape (6,) or (runs, 6)
        State one interval before the first sample.
    P0 : array_like, shape (6, 6)
        Its covariance.
    T : float
        Sampling interval in s.
    sigma_a : float
        Standard deviation of the acceleration in m/s^2; Q has rank one.
    sigma_f : float
        Standard deviation of the measurements in Hz.
    jacobian : {"as reported", "derived"}
        See `student_jacobian`. With "derived" this is `dopplerlib.ekf`, written another way.

    Returns
    -------
    Track
        Leading axis ``runs``.

    Raises
    ------
    ValueError
        If an argument has the wrong shape or is not finite, or `jacobian` is unknown.
    """
    z = _checks.finite("z", z, (None, None, len(array)))
    runs, samples, m = z.shape
    x = np.broadcast_to(_checks.finite("x0", x0, (6,)), (runs, 6))
    P = np.broadcast_to(_checks.covariance("P0", P0, 6), (runs, 6, 6))
    F, Q = constant_velocity(T, sigma_a)
    signs, sensors = _signs(jacobian), (*array.positions.T, array.doppler_per_speed)
    R = sigma_f**2 * np.eye(m)

    def step(k, state):
        x, P = state
        x, P = x @ F.T, F @ P @ F.T + Q
        # The kernel gives the shifts and their derivatives at once.
        shift, *gradient = doppler_shift_and_gradient(*x.T[..., None], *sensors)
        innovation = z[:, k] - shift
        H = np.stack(gradient, axis=-1) * signs
        HP = H @ P
        S = HP @ H.mT + R
        # One decomposition of S for the gain and for NIS; P and S are symmetric.
        right = np.concatenate([HP, innovation[..., None]], axis=-1)
        solved = np.linalg.solve(S, right)
        gain = solved[..., :6].mT
        x = x + (gain @ innovation[..., None])[..., 0]
        A = np.eye(6) - gain @ H
        P = A @ P @ A.mT + sigma_f**2 * gain @ gain.mT
        nis = np.sum(innovation * solved[..., 6], axis=-1)
        return (x, P), (x, P, innovation, S, nis)

    track = recursion.scan(step, (x, P), range(samples), axis=1)
    return Track(*track, np.ones((runs, samples), bool))


def _signs(jacobian):
    """Return what the columns of the derivative are multiplied with."""
    reported = _checks.one_of("jacobian", jacobian, JACOBIANS) == "as reported"
    return np.repeat([-1.0 if reported else 1.0, 1.0], 3)
