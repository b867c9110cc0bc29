"""Evidence on the path of a single radar."""

import numpy as np

from ....estimation import gaussian, recursion
from ....estimation.linear_kalman import kf
from ....estimation.radial_velocity import radial_velocity_update
from ....model.motion import ncv_transition
from ....replication.evidence import Draws, Readings
from ..measures import departure_times, rmse_ratio
from ..published import reported
from ..range_tracker import track_ranges
from ..settings import filter_settings

LONG = 60.0  # s: a record long enough for every track of the fixed gate to be left


def filtered(records):
    """Return the RangeTrack of both radars by settings, as long as claims look at it."""

    def run(name, end, gate="own", **options):
        own = filter_settings(name, gate=gate)
        return track_ranges(records.until(end).z[..., None, :], own, **options)

    return {
        "code": run("code", LONG),
        "code, no gate": run("code", LONG, gate=None),
        "code, no rate": run("code", 40.0, doppler=False),
        "text": run("text", 46.0),
        "text, no gate": run("text", 46.0, gate=None),
        "text, no rate": run("text", 40.0, doppler=False),
        "modern": run("modern", reported().scenario.tracks.duration),
    }


def error_ratio(a, b, time, low, high, rng):
    """Return the error of one tracker over that of another from one time to another."""
    # All begin at the first scan; some end sooner.
    K, middle = min(a.shape[-1], b.shape[-1]), (low + high) / 2
    return rmse_ratio(a[:, :K], b[:, :K], time[:K], middle, middle - low, rng=rng)


def found(records, tracks, rng):
    """Return the evidence by the id of the claim; `tracks` are those of `filtered`."""
    t, truth = records.time, records.ranges[..., 0]
    errors = {name: track.x[..., 0] - truth[:, : track.x.shape[2]]
              for name, track in tracks.items()}  # fmt: skip
    errors["measured"] = records.z[..., 0] - truth

    def ratio(a, b, low, high, radar):
        return error_ratio(errors[a][:, radar], errors[b][:, radar], t, low, high, rng)

    def windows(a, b, radar, *parts):
        return Readings(
            {f"{low} to {high} s": ratio(a, b, low, high, radar) for low, high in parts}
        )

    times = departure_times(tracks["code"].updated, t)
    plain = ("code", "text")
    return {
        "kf-improves": Readings(
            {name: ratio(f"{name}, no rate", "measured", 20, 30, 0) for name in plain}
        ),
        "doppler-R1": windows("code", "code, no rate", 0, (4, 12), (15, 40)),
        "doppler-R2": windows("code", "code, no rate", 1, (4, 12), (15, 40)),
        "R1-departs": Draws(times[:, 0]),
        "R1-in-range": Draws(times[:, 0]),
        "R2-departs": Draws(times[:, 1]),
        "good-snr-R1": windows("code", "measured", 0, (0, 7), (10, 20)),
        "good-snr-R2": windows("code", "measured", 1, (0, 7), (10, 20)),
        "follows-R1": ratio("code, no gate", "code", 49, 50, 0),
        "follows-R2": ratio("code, no gate", "code", 49, 50, 1),
        "ekf-needed": _largest_step_difference(records.z[0, 0, :300], filter_settings("code")),
    }


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
