"""Evidence on other rings and other motions than those of Section 4."""

import numpy as np

from ...._data import read_json, results
from ...._hints import checked
from ....estimation.extended_kalman import ekf
from ....estimation.nonlinear_kalman import ukf
from ....evaluation.intervals import ConfidenceInterval, quantile_interval
from ....model.coordinated_turn import coordinated_turn
from ....model.doppler import doppler_shift
from ....model.motion import constant_velocity
from ....model.radar_array import RadarArray
from ....replication.evidence import sweep
from ..published import reported
from ._first_covariance import errors_of, neglected
from ._runs import GATES, choices, starts, tracked

_BRAKING = 100
_TURNING = 10


@checked
def motion_evidence(rng: np.random.Generator) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    braking, turns = rng.spawn(2)
    return (
        _rotation()
        | sweep(
            choices("deceleration", "process-noise", "start", "later", "whose-error"),
            _decelerated,
            braking,
        )
        | sweep(choices("turn-rate", "turning-noise"), _turning, turns)
    )


ANGLES = (10, 20, 30, 40, 50)  # degrees, as the choice `angle` has them
WHEN = ("average over the record", "at the end")
AXES = {"y": 1, "z": 2, "vz": 5}


def turned_rings(gate, start, runs, rng):
    """Return logarithms of errors with the ring turned, less those with the ring as drawn.

    Of the same noise; shape (runs, angles, 2, 3), with `WHEN` and `AXES` last.
    """
    s = reported().scenario
    F, _ = constant_velocity(s.T, s.sigma_a)
    before = np.linalg.solve(F, starts()[start])
    noise = s.sigma_f * rng.standard_normal((runs, s.samples, 6))
    found = []
    for angle in (0, *ANGLES):
        array = RadarArray.ring(6, 0.2, phase=np.deg2rad(angle))
        z = doppler_shift(s.truth, array) + noise
        track = ekf(z, array, before, s.P0, s.T, s.sigma_a, s.sigma_f, gate=GATES[gate], keep=())
        error = np.abs(track.x - s.truth)[..., list(AXES.values())]
        found.append(np.log(np.stack([error.mean(axis=1), error[:, -1]], axis=1)))
    return np.stack(found[1:], axis=1) - found[0][:, None]


def _rotation():
    """Return geometric means of the ratios of errors, since errors of one run are skewed."""
    study = read_json("turned_ring.json", folder=results)
    parts = {}
    for one in study["parts"]:
        parts.setdefault((one["gate"], one["start"]), []).append((one["mean"], one["square"]))
    number = study["chunks"] * study["runs"]

    def ratios(gate, start, angle, when):
        mean, square = np.mean(parts[gate, start], axis=0)[:, ANGLES.index(angle), WHEN.index(when)]
        half = 1.96 * np.sqrt((square - mean**2) / number)
        ends = np.exp([mean, mean - half, mean + half]).T.tolist()
        return {
            f"rotation-{axis}": ConfidenceInterval(*one)
            for axis, one in zip(AXES, ends, strict=True)
        }

    return sweep(choices("gate", "start", "angle", "whole-or-end"), ratios)


def _decelerated(rng, deceleration, noise, start, moment, whose):
    """Return the linearization error for a target that brakes all the time."""
    s = reported().scenario
    direction = s.x0[3:] / np.linalg.norm(s.x0[3:])
    t = s.time[:, None]
    truth = s.truth.copy()
    truth[:, :3] -= deceleration * t**2 / 2 * direction
    truth[:, 3:] -= deceleration * t * direction
    k = round(moment / s.T)
    z = doppler_shift(truth[: k + 1], s.array)
    z = z + s.sigma_f * rng.standard_normal((_BRAKING, *z.shape))
    # The process noise has to cover the deceleration, or the filter is wrong for another reason.
    sigma_a = max(s.sigma_a, deceleration)
    track = tracked(z, s.array, starts()[start], s.P0, sigma_a, noise, keep=("P",))
    x, P = track.x[:, -1], track.P[:, -1]
    return {
        "constant-acceleration": quantile_interval(
            neglected(x, errors_of(x, P, truth[k], whose, rng))
        )
    }


def _turning(rng, rate, part):
    """Return the error of an unscented filter over that of the extended one, for a turning target.

    The turn is level, at the speed of Table 2. Both filters have the same process noise, a stated
    part of the turn's acceleration on each axis, and a start within a centimeter.
    """
    s = reported().scenario
    speed = np.hypot(*s.x0[3:5])
    flat = np.array([s.x0[0], s.x0[1], s.x0[3], s.x0[4], rate])
    truth = np.empty((s.samples, 6))
    for k in range(s.samples):
        truth[k] = [flat[0], flat[1], s.x0[2], flat[2], flat[3], 0.0]
        flat = coordinated_turn(flat, s.T)
    z = doppler_shift(truth, s.array)
    z = z + s.sigma_f * rng.standard_normal((_TURNING, *z.shape))
    sigma_a = part * rate * speed
    F, Q = constant_velocity(s.T, sigma_a, "per_axis")
    deviation = 0.01  # m and m/s
    start = truth[0] + deviation * rng.standard_normal((_TURNING, 6))
    before = np.linalg.solve(F, start[..., None])[..., 0]
    P0 = deviation**2 * np.eye(6)
    R = s.sigma_f**2 * np.eye(6)
    unscented = ukf(z, lambda x: x @ F.T, Q, lambda x: doppler_shift(x, s.array), R, before, P0)
    extended = ekf(z, s.array, before, P0, s.T, sigma_a, s.sigma_f, "per_axis", keep=())
    errors = (
        np.sqrt(np.mean((track.x - truth)[..., :3] ** 2, axis=(1, 2)))
        for track in (unscented, extended)
    )
    return {"ukf-turns": quantile_interval(np.divide(*errors))}
