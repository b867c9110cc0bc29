"""Evidence on decisions of the thesis: order of the steps, sequential filter, gate, baseline."""

from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np

from ....estimation import gaussian, recursion
from ....estimation.linear_kalman import kf
from ....estimation.radial_velocity import radial_velocity_update
from ....evaluation.bootstrap import bootstrap_interval
from ....model.motion import ncv_transition
from ....replication.evidence import sweep
from ..cartesian_tracker import (
    central_filter,
    range_and_angle,
    range_and_angle_jacobian,
    table_3_2,
)
from ..expected_error import one_scan_bound
from ..measures import position_errors
from ..position_tracker import clipped_bilateration, filter_then_bilaterate
from ..published import reported
from ..range_tracker import track_ranges
from ..scene import maneuver_track, scan_times, simulate_radars, straight_track
from ..settings import filter_settings
from ._ratios import choices, ratio, within

TRACKS = {"straight": straight_track, "maneuver": maneuver_track}
FROM, TO = 10.0, 25.0  # s: from where the angle at the origin is known, to after the turn


def found(records, tracks, runs, rng):
    """Return the evidence by the id of the claim; `tracks` are those of `_ranges.filtered`."""
    order, sequential, gates, baselines = rng.spawn(4)
    return {
        "filter-first": _order(records.first(max(1, runs // 6)), tracks, order),
        **_sequential(max(3, runs // 8), sequential),
        "elliptical-gate": _elliptical(max(1, runs // 6), gates),
        "baseline": _baselines(max(1, runs // 3), baselines),
    }


def process_noise(settings):
    """Return the Q of the settings for both axes of the plane, components x, y, v_x, v_y."""
    return np.kron(filter_settings(settings).Q, np.eye(2))


def _order(records, tracks, rng):
    """Return the error of filter first over that of bilateration first."""
    few, some, s = len(records.z), records.until(40.0), reported().scenario.cartesian
    t, truth, start = some.time, some.truth, np.array([0.0, s.start_y, 0.0, 0.0])

    def positions_first(settings, first_step, sigma):
        Q = process_noise(settings)
        if first_step == "extended filter of Table 3.2":
            p = table_3_2(some, Q=Q, sigma_angle=sigma, start=start).p
        else:
            raw, _ = clipped_bilateration(some.z[:, 0, :, 0], some.z[:, 1, :, 0], some.baseline)
            F = ncv_transition(t[1] - t[0], dim=2, order="derivative")
            R, P0 = s.sigma_range**2 * np.eye(2), s.start_covariance * np.eye(4)
            p = kf(raw[:, 1:], F, Q, np.eye(4)[:2], R, np.tile(start, (few, 1)), P0).x[..., :2]
            p = np.insert(p, 0, start[:2], axis=1)
        return position_errors(p, truth)

    later, earlier = {}, {}
    for settings in ("code", "text"):
        for rate, doppler in (("ranges", False), ("ranges and rates", True)):
            d = tracks[settings, "none", doppler].x[:few, :, : len(t), 0]
            p, _ = clipped_bilateration(d[:, 0], d[:, 1], some.baseline)
            earlier[settings, rate] = position_errors(p, truth)

    def compared(child, settings, rate, first_step, sigma, part, metric):
        key = settings, first_step, sigma if first_step.startswith("extended") else None
        if key not in later:
            later[key] = positions_first(*key)
        at = within(t, part)
        return ratio(earlier[settings, rate][:, at], later[key][:, at], metric, child)

    axes = choices("settings", "rate", "first-step", "angle-noise", "part", "metric")
    return sweep(axes, compared, rng)


def _sequential(runs, rng):
    """Return the error of the sequential filter over that of others."""

    def product_of(*names):
        return list(product(*(one.values for one in choices(*names))))

    worlds, noises = product_of("track", "settings"), product_of("rate-noise", "angle-noise")
    own, resampled = rng.spawn(2)
    children = dict(zip(worlds, own.spawn(len(worlds)), strict=True))

    @cache
    def seen(*world):
        return filtered_in_the_plane(runs, *world, noises, children[world])

    def compared(child, track, settings, rate, angle, metric, tracker="ideal"):
        of_noise, errors = noises.index((rate, angle)), seen(track, settings)
        return ratio(errors("sequential")[of_noise], errors(tracker)[of_noise], metric, child)

    axes = choices("track", "settings", "rate-noise", "angle-noise", "metric")
    return {
        "sequential-superior": sweep((*axes, *choices("tracker")), compared, resampled),
        "sequential-ideal": sweep(axes, compared, resampled),
    }


def filtered_in_the_plane(runs, track, settings, noises, rng):
    """Return a function that gives position errors of a filter of one radar, by its name.

    The radar measures range, angle and rate.

    runs: Number of records.
    track, settings: One of `TRACKS`; whose process noise.
    noises: Standard deviations of rate and angle in m/s and rad; that of a range is the thesis's.
    rng: Source of the noise.
    Returns (M, runs, K): In m, of "sequential", the filter of Table 3.3, of the extended one
        "without the rate" and "with the rate, all at once", and of the "ideal" one, which has its
        derivatives at the true state.
    """
    T, s = reported().scenario.tracks.T, reported().scenario
    time = scan_times()[round(FROM / T) : round(TO / T) + 1]
    truth, batch = TRACKS[track](time), (len(noises), runs)
    rate, angle = np.array(noises).T[..., None]
    sigma = np.stack([np.full(rate.shape, s.filter.sigma_range), angle, rate], axis=-1)
    R = sigma[..., None] ** 2 * np.eye(3)
    noise = sigma[:, :, None] * rng.standard_normal((*batch, len(time), 3))
    z = h(truth) + noise
    F, Q = ncv_transition(T, dim=2, order="derivative"), process_noise(settings)
    P0 = np.broadcast_to(s.cartesian.start_covariance * np.eye(4), (*batch, 4, 4))
    x0 = truth[0] + np.sqrt(s.cartesian.start_covariance) * rng.standard_normal((*batch, 4))

    names = {"sequential": 2, "without the rate": 2, "with the rate, all at once": 3, "ideal": 3}

    @cache
    def filtered(name):
        m = names[name]

        def step(k, state):
            x, P = gaussian.predict(*state, F, Q)
            at = truth[k] if name == "ideal" else x
            J = jacobian(at)[..., :m, :]
            expected = h(at)[..., :m] + (J @ (x - at)[..., None])[..., 0]
            x, P, _ = gaussian.update(x, P, z[..., k, :m] - expected, J, R[..., :m, :m])
            if name == "sequential":
                x, P, _, _ = radial_velocity_update(x, P, z[..., k, 2], rate)
            return (x, P), (x,)

        (x,) = recursion.scan(step, (x0, P0), range(1, len(time)), axis=2)
        return position_errors(x[..., :2], truth[1:])

    return filtered


def h(x):
    """Return range, angle and range rate of states (..., 4), seen from the origin, (..., 3)."""
    d, v = x[..., :2], x[..., 2:]
    rate = (d * v).sum(axis=-1) / np.hypot(d[..., 0], d[..., 1])
    return np.concatenate([range_and_angle(x), rate[..., None]], axis=-1)


def jacobian(x):
    """Return the derivative of `h`, shape (..., 3, 4)."""
    polar = range_and_angle_jacobian(x)
    u, across, v = polar[..., 0, :2], polar[..., 1, :2], x[..., 2:]
    # The direction turns by the angle's derivative, to its left.
    left = np.stack([-u[..., 1], u[..., 0]], axis=-1)
    bend = (left * v).sum(axis=-1)[..., None] * across
    return np.concatenate([polar, np.concatenate([bend, u], axis=-1)[..., None, :]], axis=-2)


def _elliptical(runs, rng):
    """Return the error with an elliptical gate over that with the box, while the target turns."""
    noise, false, resampled = rng.spawn(3)
    s = reported().scenario
    records = simulate_radars(runs, rng=noise, track=maneuver_track, duration=s.tracks.turn_stop)
    one = records.z[..., None, :]
    # False detections as dense as in the stand-in: over the window, and over its velocities.
    own, (near, far) = s.surrogate, s.real.window
    shape = one.shape[:-1]
    clutter = false.uniform((near, -own.clutter_velocity), (far, own.clutter_velocity), (*shape, 2))
    there = false.random(shape) < own.clutter
    both = np.concatenate([one, np.where(there[..., None], clutter, np.nan)], axis=-2)
    at, truth, known = records.time >= s.tracks.turn_start, records.truth, {}

    def errors(detections, settings, level=None):
        key = detections, settings, level
        if key not in known:
            gate = filter_settings(settings, gate="box" if level is None else "nis")
            if level is not None:
                gate = replace(gate, gate_probability=level)
            z = one if detections == "the target's" else both
            d = track_ranges(z, gate).x[..., 0]
            p, _ = clipped_bilateration(d[:, 0], d[:, 1], records.baseline)
            known[key] = position_errors(p, truth)[:, at]
        return known[key]

    def compared(child, detections, settings, level, metric):
        a, b = errors(detections, settings, level), errors(detections, settings)
        return ratio(a, b, metric, child)

    axes = choices("detections", "settings", "gate-level", "metric")
    return sweep(axes, compared, resampled)


def _baselines(runs, rng):
    """Return the error with the radars of the recordings over that with those of the simulation."""
    s = reported().scenario
    apart = s.real.baseline, s.radars.baseline
    bounds = [one_scan_bound(s.error_area.position, b) for b in apart]
    *noises, resampled = rng.spawn(3)
    squares = {"thesis's tracker": [], "one filter for both": []}
    for b, noise in zip(apart, noises, strict=True):
        records = simulate_radars(runs, rng=noise, duration=31.0, baseline=b)
        four = np.abs(records.distance - 4) <= 0.25
        for name, track in (
            ("thesis's tracker", filter_then_bilaterate(records, filter_settings("code"))),
            ("one filter for both", central_filter(records, filter_settings("modern"))),
        ):
            error = position_errors(track.p, records.truth)[:, four]
            squares[name].append(np.mean(error**2, axis=1))

    def grown(child, name):
        if name.startswith("bound"):
            parts = [np.trace(b) if "position" in name else b[0, 0] for b in bounds]
            return float(np.sqrt(parts[0] / parts[1]))
        return bootstrap_interval(lambda a, b: np.sqrt(a / b), squares[name], rng=child)

    return sweep(choices("baseline-error"), grown, resampled)
