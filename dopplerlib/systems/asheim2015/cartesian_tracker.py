"""Filters whose state is the person's position and velocity in the plane."""

from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Positive, checked, exactly, shaped
from ..._typing import FloatArray
from ...estimation import gaussian, recursion
from ...estimation.nonlinear_kalman import ekf_records
from ...model.motion import cwna_process_noise, ncv_transition
from ...model.polar_radar import polar_radar_h, polar_radar_jacobian
from ...model.range_rate import range_rate, range_rate_jacobian
from ...tracking.bilateration import bilaterate
from ...tracking.gates import chi2_gate, fixed_box_gate
from .position_tracker import PositionTrack, clipped_bilateration
from .published import reported
from .scene import RadarRecords
from .settings import FilterSettings

PlaneStates = Annotated[FloatArray, shaped(4)]
_AXES = [1, 3, 0, 2]  # [y, v_y, x, v_x] of [x, y, v_x, v_y]


@checked
def central_filter(
    records: RadarRecords,
    settings: FilterSettings,
    *,
    q: Positive | None = None,
    start: PlaneStates | None = None,
) -> PositionTrack:
    """Track the person with one extended Kalman filter in the plane, fed by both radars.

    records: What both radars measured. Each detection updates the state at its own time.
    settings: "modern" settings: their interval, R and gate are used. The covariance of the start is
        that of the table `cartesian` of the scenario.
    q: Spectral density of the acceleration along x and y in m^2/s^3; that of the settings if None.
    start (..., 4): State at the first scan; if None, the position that the first scan gives, in
        front of the radars by at least the `start_y` of the scenario, at rest.
    Returns: States after both radars' updates, at the time of the second one.
    Raises ValueError if an argument is not of the kind described, or the second radar does not
        measure between two scans of the first.

    Notes
    -----
    The gate looks at each radar by itself, at range and range rate together. A person behind the
    radars gives the same ranges and rates as one in front: nothing but the start keeps the state
    there, and near the line through the radars it may pass to the other side.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import filter_settings, simulate_radars
    >>> records = simulate_radars(2, rng=np.random.default_rng(1), duration=1.0)
    >>> central_filter(records, filter_settings("modern")).x.shape
    (2, 11, 4)
    """
    c = reported().scenario.cartesian
    q = settings.Q[1, 1] / settings.T if q is None else q
    z, runs = records.z, len(records.z)
    if not 0 <= records.offset <= settings.T:
        raise ValueError(
            f"records must have an offset from 0 to the interval of {settings.T} s, "
            f"got {records.offset}"
        )
    if start is None:
        p, _ = clipped_bilateration(z[:, 0, 0, 0], z[:, 1, 0, 0], records.baseline)
        start = np.zeros((runs, 4))
        start[:, 0], start[:, 1] = p[:, 0], np.maximum(p[:, 1], c.start_y)
    if not np.isfinite(start).all():
        raise ValueError("records must begin with detections of both radars where start is None")
    x = _checks.each_run("start", start, (runs,), (4,))
    P = np.broadcast_to(c.start_covariance * np.eye(4), (runs, 4, 4))
    # Radar 2 lags radar 1 by the offset, and radar 1 radar 2 by what is left of the interval.
    motion = [_motion(dt, q) for dt in (settings.T - records.offset, records.offset)]

    def step(k, state):
        x, P = state
        used, values = [np.ones(runs, bool)] * 2, [np.full(runs, np.nan)] * 2
        for n in range(2):
            if k or n:
                x, P = gaussian.predict(x, P, *motion[n])
            if k:
                x, P, used[n], values[n] = _gated(x, P, z[:, n, k], records.sensors[n], settings)
        return (x, P), (x, P, np.stack(used, axis=-1), np.stack(values, axis=-1))

    x, P, used, values = recursion.scan(step, (x, P), range(z.shape[2]), axis=1)
    _checks.estimates("records, settings, start", x, P)
    swap = np.swapaxes(used, 1, 2)
    return PositionTrack(x[..., :2], np.ones(x.shape[:2], bool), swap, x, P, values.swapaxes(1, 2))


@checked
def table_3_2(
    records: RadarRecords,
    *,
    Q: Annotated[FloatArray, exactly(4, 4)] | None = None,
    sigma_angle: Positive | None = None,
    start: PlaneStates | None = None,
) -> PositionTrack:
    """Run the extended Kalman filter of Table 3.2 on bilaterated ranges and angles (Fig 3.5).

    records: What both radars measured.
    Q (4, 4): Covariance of the process noise; that of the scenario if None.
    sigma_angle: Standard deviation of the angle in rad; that of the scenario if None.
    start (..., 4): State at the first scan; the first bilaterated position at rest if None.
    Returns: Where the circles do not meet, the scan is left out.

    Notes
    -----
    The measurement is [d, alpha] from the origin, with independent noise of fixed size. That is
    not what bilaterated ranges have: see `range_crlb`. The innovation is z - h(x) as in Eq 3.18,
    not z - H x as in the table, and the angle is that of both coordinates, not of their quotient.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import simulate_radars
    >>> records = simulate_radars(2, rng=np.random.default_rng(1), duration=1.0)
    >>> table_3_2(records).p.shape
    (2, 11, 2)
    """
    c = reported().scenario.cartesian
    Q = np.diag(c.Q_diagonal) if Q is None else Q
    R = np.diag([c.sigma_range, c.sigma_angle if sigma_angle is None else sigma_angle]) ** 2
    x_tri, y_tri, valid = bilaterate(records.z[:, 0, :, 0], records.z[:, 1, :, 0], records.baseline)
    measured = np.stack([np.hypot(x_tri, y_tri), np.arctan2(y_tri, x_tri)], axis=-1)
    if start is None:
        y0 = np.maximum(np.where(valid[:, 0], y_tri[:, 0], 0.0), c.start_y)
        start = np.stack([x_tri[:, 0], y0, 0 * y0, 0 * y0], axis=-1)
    if not np.isfinite(start).all():
        raise ValueError("records must begin with detections of both radars where start is None")
    x = _checks.each_run("start", start, (len(measured),), (4,))
    P = np.broadcast_to(c.start_covariance * np.eye(4), (len(x), 4, 4))
    F = ncv_transition(records.time[1] - records.time[0], dim=2, order="derivative")
    track = ekf_records(
        measured[:, 1:], lambda x: (F @ x[..., None])[..., 0], lambda x: F, Q,
        range_and_angle, range_and_angle_jacobian, R, x, P, wrap=(1,),
    )  # fmt: skip
    x, P = (
        np.insert(np.asarray(after), 0, begin, axis=1)
        for after, begin in ((track.x, x), (track.P, P))
    )
    return PositionTrack(x[..., :2], valid, np.stack([valid, valid], axis=1), x, P)


@checked
def range_and_angle(x: PlaneStates) -> FloatArray:
    """Return distance from the origin and angle of states in the plane.

    x (..., 4): States [x, y, v_x, v_y] in m and m/s.
    Returns (..., 2): In m and rad, zero along +x. They are those of `polar_radar_h` with the axes
        exchanged, whose azimuth is zero along +y.

    Examples
    --------
    >>> range_and_angle([0.0, 2.0, 0.1, 0.1]).round(3).tolist()
    [2.0, 1.571]
    """
    return polar_radar_h(x[..., _AXES])[..., :2]


@checked
def range_and_angle_jacobian(x: PlaneStates) -> FloatArray:
    """Return the derivative of `range_and_angle`, Eq 3.19.

    x (..., 4): States.
    Returns (..., 2, 4)

    Examples
    --------
    >>> range_and_angle_jacobian([0.0, 2.0, 0.1, 0.1]).round(3)[0].tolist()
    [0.0, 1.0, 0.0, 0.0]
    """
    return polar_radar_jacobian(x[..., _AXES])[..., :2, np.argsort(_AXES)]


def _motion(dt, q):
    if not dt:
        return np.eye(4), np.zeros((4, 4))
    return (
        ncv_transition(dt, dim=2, order="derivative"),
        cwna_process_noise(dt, q, dim=2, order="derivative"),
    )


def _gated(x, P, z, sensor, settings):
    """Update with one radar's detection where the gate lets it through."""
    predicted = range_rate(x, sensor[None])[:, 0]
    H = range_rate_jacobian(x, sensor[None])[:, 0]
    R = settings.R(predicted[:, 0])[..., None] * np.eye(2)
    nu = z - predicted
    xu, Pu, S = gaussian.update(x, P, nu, H, R)
    # The quadratic form of the inverse of S, written out: a solver takes longer.
    d, v, a, b, c = nu[:, 0], nu[:, 1], S[:, 0, 0], S[:, 0, 1], S[:, 1, 1]
    nis = (c * d * d - 2 * b * d * v + a * v * v) / (a * c - b * b)
    if settings.gate == "box":
        accept = fixed_box_gate(nu, settings.box)
    elif settings.gate == "nis":
        accept = chi2_gate(nis, 2, settings.gate_probability)
    else:
        accept = np.isfinite(nis)
    x = np.where(accept[:, None], xu, x)
    return x, np.where(accept[:, None, None], Pu, P), accept, nis
