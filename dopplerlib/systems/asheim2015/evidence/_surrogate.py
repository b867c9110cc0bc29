"""Evidence on Chapter 6 from SIMULATED walks: its recordings are not published."""

import numpy as np

from ....evaluation.intervals import proportion_interval
from ....replication.evidence import Draws, Readings
from ..measures import position_errors
from ..position_tracker import clipped_bilateration
from ..published import reported
from ..range_tracker import track_ranges
from ..settings import filter_settings
from ..surrogate import WALKS, simulate_walk


def found(runs, rng):
    """Return the evidence by the id of the claim, from so many walks of each kind."""
    s = reported().scenario.real
    code = filter_settings("code", s.T)
    alone, *both = rng.spawn(1 + len(WALKS))
    k, found, dropped, kept = round(s.back / s.T), [], [], []
    for variant, child in zip(WALKS, both, strict=True):
        w = simulate_walk(runs, rng=child, variant=variant)
        start = w.ranges[:, 0].mean(axis=0)
        track = track_ranges(w.detections, code, x0=start)
        again = np.abs(track.x[..., 0] - w.ranges[..., 0])[:, 0, k + 3 : k + 9].max(axis=-1)
        found.append(again < code.box[0])
        other = track_ranges(w.detections, code, association="nearest-first", x0=start)
        dropped.append((track.updated & ~other.updated).any(axis=(1, 2)))
        kept.append((w, track))
    w, track = kept[0]
    before, y = w.time < s.gone, w.truth[:, 1]
    # The thesis tells of a walk that its filter follows; what one that is lost does, is no error.
    error = np.abs(track.x[..., 0] - w.ranges[..., 0])[..., before]
    follows = (error < code.box[0]).all(axis=(1, 2))
    off, raw = (
        position_errors(clipped_bilateration(d[:, 0], d[:, 1], s.baseline)[0], w.truth)[follows]
        for d in (track.x[..., 0], track.chosen[..., 0])
    )

    def mean(values, at):
        values = values[:, before & at]
        return Draws(np.nanmean(values[np.isfinite(values).any(axis=1)], axis=1))

    return {
        "reacquired": Draws(np.concatenate(found).astype(float)),
        "gate-walk": gate_on_a_walk(runs // 2, alone),
        "error-near": mean(off, y < 2.4),
        "raw-near": mean(raw, (y >= 2) & (y <= 3)),
        "raw-worst": Draws(np.nanmax(raw[:, before], axis=1)),
        "error-at-four": mean(off, np.abs(y - 4) < 0.2),
        "nearest-of-validated": proportion_interval(np.concatenate(dropped)),
    }


def gate_on_a_walk(runs, rng):
    """Return the fractions of walks in which the gate improves the filtered ranges of one radar.

    More even: with a smaller root mean square of the second differences up to the gap.
    """
    s = reported().scenario.real
    w = simulate_walk(runs, rng=rng, radar_count=1)
    # The first scans are empty: the person is nearer than the window.
    at = (w.time >= 4) & (w.time < s.gone)
    settle = [filter_settings("code", s.T, gate=gate) for gate in ("box", None)]
    paths = [track_ranges(w.detections, own, x0=s.guess).x[:, 0, at, 0] for own in settle]
    bends = [np.mean(np.diff(d, 2, axis=1) ** 2, axis=1) for d in paths]
    errors = [np.mean((d - w.ranges[0, at, 0]) ** 2, axis=1) for d in paths]
    return Readings(
        {
            "more even": proportion_interval(bends[0] < bends[1]),
            "smaller error": proportion_interval(errors[0] < errors[1]),
        }
    )
