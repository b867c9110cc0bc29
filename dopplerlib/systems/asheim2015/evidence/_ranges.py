"""Evidence on the path of a single radar."""

from dataclasses import replace

import numpy as np

from ....estimation import gaussian, recursion
from ....estimation.linear_kalman import kf
from ....estimation.radial_velocity import radial_velocity_update
from ....evaluation.intervals import quantile_interval
from ....model.motion import ncv_transition
from ....replication.evidence import Draws, sweep
from ..cartesian_tracker import table_3_2
from ..measures import departure_times
from ..position_tracker import clipped_bilateration
from ..published import reported
from ..range_tracker import track_ranges
from ..settings import filter_settings
from ._ratios import choices, ratio, within

LONG = 60.0  # s: a record long enough for every track of the fixed gate to be left


def filtered(records, few):
    """Return the RangeTrack of both radars by settings, gate, and whether the rate is used.

    Those of which single runs are looked at have all records, others the first `few`.
    """
    all_z = records.z[..., None, :]

    def run(own, z=all_z[:few], doppler=True):
        return track_ranges(z, own, doppler=doppler)

    found = {("modern", "nis", True): run(filter_settings("modern"))}
    for name in ("code", "text"):
        own, free = (filter_settings(name, gate=gate) for gate in ("box", None))
        loose = replace(own, box=[own.box[0], 1e6])
        found |= {
            (name, "box", True): run(own, all_z),
            (name, "box", False): run(own, doppler=False),
            (name, "none", True): run(free),
            (name, "none", False): run(free, doppler=False),
            (name, "box of ranges", True): run(loose),
        }
    return found


def found(records, tracks, rng):
    """Return the evidence by the id of the claim; `tracks` are those of `filtered`."""
    t, truth = records.time, records.ranges[..., 0]
    errors = {key: track.x[..., 0] - truth for key, track in tracks.items()}
    errors["measured"] = records.z[..., 0] - truth

    def compared(child, a, b, window, metric, radar):
        at = within(t, window)
        return ratio(errors[a][:, radar][:, at], errors[b][:, radar][:, at], metric, child)

    def rate(child, settings, gate, part, metric):
        keys = [(settings, gate, doppler) for doppler in (True, False)]
        return {
            "kf-improves": compared(child, keys[1], "measured", part, metric, 0),
            "doppler-R1": compared(child, *keys, part, metric, 0),
            "doppler-R2": compared(child, *keys, part, metric, 1),
        }

    def near(child, settings, zoom, metric):
        key = settings, "box", True
        return {
            f"good-snr-R{n + 1}": compared(child, key, "measured", zoom, metric, n)
            for n in range(2)
        }

    def late(child, settings, end, metric):
        gated, free, loose = ((settings, gate, True) for gate in ("box", "none", "box of ranges"))
        return {
            "follows-R1": compared(child, free, gated, end, metric, 0),
            "follows-R2": compared(child, free, gated, end, metric, 1),
            "gate-both": compared(child, gated, loose, end, metric, 0),
        }

    def coasting(child, settings, metric):
        off = errors[settings, "box", True][:, 0]
        return ratio(
            off[:, within(t, "49 to 50 s")], off[:, within(t, "47 to 48 s")], metric, child
        )

    return {
        **sweep(choices("settings", "gate", "part", "metric"), rate, rng),
        **sweep(choices("settings", "zoom", "metric"), near, rng),
        **sweep(choices("settings", "end", "metric"), late, rng),
        "coasting-grows": sweep(choices("settings", "metric"), coasting, rng),
        **departures(records, tracks),
        "ekf-needed": sweep(choices("system"), lambda system: _largest_difference(records, system)),
    }


def departures(records, tracks):
    """Return the evidence on the times at which tracks are left."""

    def left(settings, misses, length):
        track, K = tracks[settings, "box", True], len(records.until(length).time)
        times = departure_times(track.updated[..., :K], records.time[:K], int(misses))
        return np.minimum(times, length).T  # one that is not left counts as left at the end

    def of_each(settings, misses, length):
        first, second = left(settings, misses, length)
        tells = np.minimum(first, second) < length  # a run that leaves neither does not
        return {
            "R1-departs": Draws(first),
            "R2-departs": Draws(second),
            "R2-longer": quantile_interval((second - first)[tells]),
        }

    return sweep(choices("settings", "misses", "record"), of_each)


def _largest_difference(records, system):
    """Return the largest difference of a nonlinear filter from the linear one, in m or m/s."""
    own, s = filter_settings("code"), reported().scenario.cartesian
    if system == "one for each radar":
        return _largest_step_difference(records.z[0, 0, :300], own)
    some = records.first(1).until(30.0)
    p, _ = clipped_bilateration(some.z[:, 0, :, 0], some.z[:, 1, :, 0], some.baseline)
    start = np.array([*p[0, 0], 0.0, 0.0])
    start[1] = max(start[1], s.start_y)
    Q, P0 = np.diag(s.Q_diagonal), s.start_covariance * np.eye(4)
    F = ncv_transition(own.T, dim=2, order="derivative")
    R = s.sigma_range**2 * np.eye(2)
    linear = kf(p[0, 1:], F, Q, np.eye(4)[:2], R, start, P0)
    extended = table_3_2(some, Q=Q, start=start)
    return float(np.abs(extended.x[0, 1:, :2] - linear.x[:, :2]).max())


def _largest_step_difference(z, own):
    """Return the largest difference of the pseudo-measurement filter from a linear one."""
    F, R = ncv_transition(own.T, dim=1), np.diag(own.R(1.0))

    def step(k, state):
        x, P = gaussian.predict(*state, F, own.Q)
        x, P, _ = gaussian.update(x, P, z[k, :1] - x[:1], np.eye(2)[:1], R[:1, :1])
        x, P, _, _ = radial_velocity_update(x, P, z[k, 1], np.sqrt(R[1, 1]))
        return (x, P), (x,)

    (pseudo,) = recursion.scan(step, (z[0], own.P0), range(1, len(z)))
    linear = kf(z[1:], F, own.Q, np.eye(2), R, z[0], own.P0)
    return round(float(np.abs(linear.x - pseudo).max()), 9)
