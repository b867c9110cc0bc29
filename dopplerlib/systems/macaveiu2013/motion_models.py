"""Smoother, other noise, constant acceleration and interacting models, beside the filter."""

from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Positive, Probability, checked, exactly
from ..._typing import BoolArray, FloatArray
from ...estimation.imm import imm
from ...estimation.imm_records import ImmModel
from ...estimation.linear_kalman import kf
from ...estimation.smoother import rts_smooth
from ...model.motion import cwnj_process_noise, nca_transition, ncv_transition
from .linear_filter import Measured
from .settings import AutomotiveSettings, automotive_settings
from .truth import Truth

STAY = 0.99  # probability that a model stays for one step; ours: a change every 100 steps, 3.8 s


@checked
def smooth_vehicle(
    z: Measured, s: AutomotiveSettings | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return estimates of the document's filter, and those of the smoother that follows it.

    z (runs, K, 4): Measurements [x, v_x, y, v_y].
    s: Those of the data file if None.
    Returns filtered, smoothed (runs, K, 4)

    Examples
    --------
    >>> filtered, smoothed = smooth_vehicle([[[0.0, 0.0, 5.0, 0.0]] * 3])
    >>> smoothed.shape
    (1, 3, 4)
    """
    s = automotive_settings() if s is None else s
    F, E_z = ncv_transition(s.T), s.E_z
    track = kf(z[:, 1:], F, s.E_x, np.eye(4), E_z, x0=z[:, 0], P0=E_z)
    filtered = np.concatenate([z[:, :1], track.x], axis=1)
    P = np.concatenate([E_z[None], track.P[0]])
    return filtered, rts_smooth(filtered, P, F, s.E_x)[0]


@checked
def track_accelerating(
    z: Measured, q: Positive, a_max: Positive, s: AutomotiveSettings | None = None
) -> FloatArray:
    """Return estimates of a filter of nearly constant acceleration.

    z (runs, K, 4): Measurements.
    q: Spectral density of the jerk in m^2/s^5.
    a_max: Standard deviation of the acceleration before it is known, in m/s^2.
    s: Those of the data file if None.
    Returns (runs, K, 4): Without the accelerations.

    Examples
    --------
    >>> track_accelerating([[[0.0, 0.0, 5.0, 0.0]] * 3], q=0.1, a_max=1.0).shape
    (1, 3, 4)
    """
    s = automotive_settings() if s is None else s
    H = np.zeros((4, 6))
    H[[0, 1, 2, 3], [0, 1, 3, 4]] = 1
    x0 = z[:, 0] @ H
    P0 = H.T @ s.E_z @ H + np.diag([0, 0, a_max**2] * 2)
    track = kf(z[:, 1:], nca_transition(s.T), cwnj_process_noise(s.T, q), H, s.E_z, x0, P0)
    return np.concatenate([z[:, :1], track.x @ H.T], axis=1)


@checked
def track_two_models(
    z: Measured,
    w: tuple[Positive, Positive],
    s: AutomotiveSettings | None = None,
    stay: Probability = STAY,
) -> tuple[FloatArray, FloatArray]:
    """Return estimates of two interacting filters of constant velocity, a calm and an agile one.

    z (runs, K, 4): Measurements.
    w: Velocity step of each model in m/s.
    s: Those of the data file if None.
    stay: Probability that a model stays for one step.
    Returns x (runs, K, 4)
        agile (runs, K): Probability of the second model.

    Examples
    --------
    >>> x, agile = track_two_models([[[0.0, 0.0, 5.0, 0.0]] * 3], w=(0.01, 0.1))
    >>> agile.shape
    (1, 3)
    """
    s = automotive_settings() if s is None else s
    F, H = ncv_transition(s.T), np.eye(4)
    models = [ImmModel(F, s.with_(w=one).E_x, H, s.E_z) for one in w]
    switch = np.array([[stay, 1 - stay], [1 - stay, stay]])
    track = imm(z[:, 1:], models, switch, x0=z[:, 0], P0=s.E_z)
    half = np.full((len(z), 1), 0.5)
    return (
        np.concatenate([z[:, :1], track.x], axis=1),
        np.concatenate([half, track.mode[..., 1]], axis=1),
    )


@checked
def rms_of_runs(
    x: Measured,
    truth: Truth,
    where: Annotated[BoolArray, exactly(None, check=_checks.booleans)],
    component: Literal["position", "velocity"],
) -> FloatArray:
    """Return the root mean square error of each run.

    x (runs, K, 4): Estimates.
    truth (K, 4): True states.
    where (K,): Samples that count.
    component: Which error.
    Returns (runs,): In m or m/s.
    Raises ValueError if an argument is not of the kind described, or no sample counts.

    Examples
    --------
    >>> truth = [[0.0, 0.0, 5.0, 0.0]] * 2
    >>> rms_of_runs([[[3.0, 0.0, 9.0, 0.0]] * 2], truth, [True, True], "position").tolist()
    [5.0]
    """
    if x.shape[1] != len(truth) or where.shape != (len(truth),) or not where.any():
        raise ValueError(
            f"where must be some of the {len(truth)} samples of the truth, got {where.sum()} of "
            f"{len(where)} for estimates of shape {x.shape}"
        )
    part = slice(0, None, 2) if component == "position" else slice(1, None, 2)
    error = (x - truth)[:, where, part]
    return np.sqrt(np.mean(np.sum(error**2, axis=-1), axis=-1))
