"""Steady-state lag and noise of the filter, and the w that minimizes its error."""

from functools import cache
from typing import Literal

import numpy as np

from ..._hints import Positive, Real, checked
from ..._typing import FloatArray
from ...estimation.steady_state import steady_state_gain, steady_state_lag
from ...model.motion import ncv_transition
from .settings import AutomotiveSettings, automotive_settings


@checked
def acceleration_lag(a: Real, s: AutomotiveSettings | None = None) -> FloatArray:
    """Return the steady-state lag of the filter behind a constant acceleration.

    a: Acceleration along an axis in m/s^2.
    s: Those of the data file if None.
    Returns (2,): Truth minus mean estimate: position in m, velocity in m/s.
    Raises ValueError if an argument is not of the kind described, or leaves no settled filter.

    Examples
    --------
    >>> acceleration_lag(0.15).round(2).tolist()
    [0.25, 0.26]
    """
    s = automotive_settings() if s is None else s
    F, K = _settled(s)
    return steady_state_lag(F, np.eye(2), K, a * np.array([s.T**2 / 2, s.T]))


@checked
def settled_noise_std(s: AutomotiveSettings | None = None) -> FloatArray:
    """Return the standard deviation that the measurement noise leaves in the settled estimate.

    s: Those of the data file if None.
    Returns (2,): Position in m, velocity in m/s. Smaller than the filter reports, since the target
        does not wander as E_x says.
    Raises ValueError if `s` is not of the kind described, or leaves no settled filter.

    Notes
    -----
    The covariance of the error solves P = (A F) P (A F)' + K E_z K' with A = I - K.

    Examples
    --------
    >>> settled_noise_std().round(3).tolist()
    [0.083, 0.037]
    """
    from scipy.linalg import solve_discrete_lyapunov

    s = automotive_settings() if s is None else s
    F, K = _settled(s)
    P = solve_discrete_lyapunov((np.eye(2) - K) @ F, K @ s.E_z[:2, :2] @ K.T)
    return np.sqrt(np.diag(P))


@checked
def settled_rms(a: Real, s: AutomotiveSettings | None = None) -> FloatArray:
    """Return the root mean square error behind a constant acceleration: lag and noise together.

    a: Acceleration along an axis in m/s^2.
    s: Those of the data file if None.
    Returns (2,): Position in m, velocity in m/s.
    Raises ValueError if an argument is not of the kind described, or leaves no settled filter.

    Examples
    --------
    >>> settled_rms(0.0).round(3).tolist()
    [0.083, 0.037]
    """
    return np.hypot(acceleration_lag(a, s), settled_noise_std(s))


@checked
def best_w(a: Real, component: Literal[0, 1] = 1, s: AutomotiveSettings | None = None) -> float:
    """Return the w that makes the error behind a constant acceleration smallest.

    a: Acceleration along an axis in m/s^2.
    component: 0 for the position, 1 for the velocity.
    s: Those of the data file if None.
    Returns: In m/s, between 0.001 and 1.
    Raises ValueError if an argument is not of the kind described, or leaves no settled filter.

    Examples
    --------
    >>> round(best_w(0.15), 3)
    0.04
    """
    from scipy.optimize import minimize_scalar

    s = automotive_settings() if s is None else s
    found = minimize_scalar(
        lambda log_w: settled_rms(a, s.with_(w=np.exp(log_w)))[component],
        bounds=(np.log(1e-3), np.log(1.0)),
        method="bounded",
    )
    return float(np.exp(found.x))


@checked
def velocity_response(rate: Positive, s: AutomotiveSettings | None = None) -> complex:
    """Return the frequency response of the steady-state filter, from true to estimated velocity.

    rate: Angular frequency of the velocity in rad/s.
    s: Those of the data file if None.
    Returns: Estimated over true velocity: the modulus is the fraction of the amplitude that is
        left, the argument the phase, negative when late.
    Raises ValueError if an argument is not of the kind described, or leaves no settled filter.

    Notes
    -----
    With positions and velocities p e^{j rate t} the estimate is (I - A F e^{-j rate T})^{-1} K
    times the truth.

    Examples
    --------
    >>> round(abs(velocity_response(0.33)), 2)
    0.97
    """
    s = automotive_settings() if s is None else s
    F, K = _settled(s)
    turn = np.exp(-1j * rate * s.T)
    truth = np.array([1 / (1j * rate), 1.0])
    estimate = np.linalg.solve(np.eye(2) - (np.eye(2) - K) @ F * turn, K @ truth)
    return complex(estimate[1])


@cache
def _settled(s):
    F = ncv_transition(s.T, dim=1)
    K, _ = steady_state_gain(F, s.E_x[:2, :2], np.eye(2), s.E_z[:2, :2])
    return F, K
