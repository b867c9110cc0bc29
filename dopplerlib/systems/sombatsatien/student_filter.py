"""The extended Kalman filter of the report, with its Jacobian as it is or as it should be."""

from typing import Literal

import numpy as np

from ... import _checks
from ..._hints import Covariance, Measurements, Positive, States, checked
from ..._typing import FloatArray
from ...estimation import recursion
from ...estimation.track import Track
from ...kernels.doppler import doppler_shift_and_gradient
from ...model.doppler import doppler_jacobian
from ...model.motion import constant_velocity
from ...model.radar_array import RadarArray

Jacobian = Literal["as reported", "derived", "velocity reversed", "all reversed"]
_SIGNS = {  # of the columns of position and of velocity
    "as reported": (-1.0, 1.0),
    "derived": (1.0, 1.0),
    "velocity reversed": (1.0, -1.0),
    "all reversed": (-1.0, -1.0),
}


@checked
def student_jacobian(
    x: States, array: RadarArray, jacobian: Jacobian = "as reported"
) -> FloatArray:
    """Return the derivative of the Doppler shifts, with the report's signs or the correct ones.

    x (..., 6): States in m and m/s.
    array: The N sensors.
    jacobian: "as reported": the three columns that belong to the position have the wrong sign.
        "derived": none has. Two more mistakes for comparison: the columns of the velocity, or all.
    Returns (..., N, 6): In Hz per m and Hz per m/s.
    Raises ValueError if `jacobian` is none of these, or `doppler_jacobian` refuses an argument.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> ring, x = RadarArray.ring(6, 0.2, normal="z"), [0.8, 0.1, 0.1, -0.7, -0.1, 0.0]
    >>> bool((student_jacobian(x, ring) == -student_jacobian(x, ring, "derived"))[:, :3].all())
    True
    """
    return doppler_jacobian(x, array) * _signs(jacobian)


@checked
@_checks.quiet
def student_ekf(
    z: Measurements,
    array: RadarArray,
    x0: States,
    P0: Covariance,
    T: Positive,
    sigma_a: Positive,
    sigma_f: Positive,
    jacobian: Jacobian = "as reported",
) -> Track:
    """Track a target as the report does: predict, then update in Joseph form.

    z (runs, K, N): Doppler measurements in Hz.
    array: The N sensors.
    x0 (6,) or (runs, 6): State one interval before the first sample.
    P0 (6, 6): Its covariance.
    T: Sampling interval in s.
    sigma_a: Standard deviation of the acceleration in m/s^2; Q has rank one.
    sigma_f: Standard deviation of the measurements in Hz.
    jacobian: See `student_jacobian`. With "derived" this is `dopplerlib.ekf`, written another way.
    Returns: Leading axis ``runs``.
    Raises ValueError if an argument has the wrong shape or is not finite, or `jacobian` is unknown.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> ring = RadarArray.ring(6, 0.2, normal="z")
    >>> z, x0 = np.full((1, 3, 6), 100.0), [0.8, 0.1, 0.1, -0.7, -0.1, 0.0]
    >>> student_ekf(z, ring, x0, 0.1 * np.eye(6), 0.001, 0.4, 0.4).x.shape
    (1, 3, 6)
    """
    _checks.check_shape("z", z, (len(array),))
    runs, samples, m = z.shape
    x = _checks.each_run("x0", x0, (runs,), (6,))
    P = np.broadcast_to(P0, (runs, 6, 6))
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
        solved = _solved(S, right, k)
        gain = solved[..., :6].mT
        x = x + (gain @ innovation[..., None])[..., 0]
        A = np.eye(6) - gain @ H
        P = A @ P @ A.mT + sigma_f**2 * gain @ gain.mT
        nis = np.sum(innovation * solved[..., 6], axis=-1)
        return (x, P), (x, P, innovation, S, nis)

    x, P, innovation, S, nis = recursion.scan(step, (x, P), range(samples), axis=1)
    _checks.estimates("z, x0, P0, T, sigma_a and sigma_f", x, nis)
    return Track(x, P, innovation, S, nis, np.ones((runs, samples), bool))


def _solved(S, right, k):
    try:
        return np.linalg.solve(S, right)
    except np.linalg.LinAlgError:
        raise ValueError(
            "P0, T, sigma_a and sigma_f must keep the innovation covariance regular, "
            f"got a singular one at sample {k}"
        ) from None


def _signs(jacobian):
    """Return the factors of the derivative's columns."""
    return np.repeat(_SIGNS[jacobian], 3)
