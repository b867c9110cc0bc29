"""How far the filter lags behind an acceleration, and what a better choice of w can do."""

import numpy as np

from ...estimation.steady_state import steady_state_gain, steady_state_lag
from ...model.motion import ncv_transition
from .published import settings


def lag(a, s=None):
    """Return how far the settled filter stays behind a constant acceleration.

    Parameters
    ----------
    a : float
        Acceleration along an axis in m/s^2.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    ndarray, shape (2,)
        Truth minus mean estimate: position in m, velocity in m/s.
    """
    s = settings() if s is None else s
    F, K = _settled(s)
    return steady_state_lag(F, np.eye(2), K, a * np.array([s.T**2 / 2, s.T]))


def noise_deviation(s=None):
    """Return the deviation that the measurement noise leaves in the settled estimate.

    Parameters
    ----------
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    ndarray, shape (2,)
        Position in m, velocity in m/s. Smaller than the filter believes, since the target does
        not wander as E_x says.

    Notes
    -----
    The covariance of the error solves P = (A F) P (A F)' + K E_z K' with A = I - K.
    """
    from scipy.linalg import solve_discrete_lyapunov

    s = settings() if s is None else s
    F, K = _settled(s)
    P = solve_discrete_lyapunov((np.eye(2) - K) @ F, K @ s.E_z[:2, :2] @ K.T)
    return np.sqrt(np.diag(P))


def rms(a, s=None):
    """Return the root mean square error behind a constant acceleration: lag and noise together.

    Parameters
    ----------
    a : float
        Acceleration along an axis in m/s^2.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    ndarray, shape (2,)
        Position in m, velocity in m/s.
    """
    return np.hypot(lag(a, s), noise_deviation(s))


def best_w(a, component=1, s=None):
    """Return the w that makes the error behind a constant acceleration smallest.

    Parameters
    ----------
    a : float
        Acceleration along an axis in m/s^2.
    component : {0, 1}
        0 for the position, 1 for the velocity.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    float
        In m/s.
    """
    from scipy.optimize import minimize_scalar

    s = settings() if s is None else s
    found = minimize_scalar(
        lambda log_w: rms(a, s.with_(w=np.exp(log_w)))[component],
        bounds=(np.log(1e-3), np.log(1.0)),
        method="bounded",
    )
    return float(np.exp(found.x))


def response(rate, s=None):
    """Return how the settled filter renders a sinusoidal velocity.

    Parameters
    ----------
    rate : float
        Angular frequency of the velocity in rad/s.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    complex
        Estimated over true velocity: the modulus is the share of the amplitude that is left, the
        argument the phase, negative when late.

    Notes
    -----
    With positions and velocities p e^{j rate t} the estimate is (I - A F e^{-j rate T})^{-1} K
    times the truth.
    """
    s = settings() if s is None else s
    F, K = _settled(s)
    turn = np.exp(-1j * rate * s.T)
    truth = np.array([1 / (1j * rate), 1.0])
    estimate = np.linalg.solve(np.eye(2) - (np.eye(2) - K) @ F * turn, K @ truth)
    return complex(estimate[1])


def _settled(s):
    F = ncv_transition(s.T, dim=1)
    K, _ = steady_state_gain(F, s.E_x[:2, :2], np.eye(2), s.E_z[:2, :2])
    return F, K
