"""Evidence on Chapter 6 from SIMULATED walks: its recordings are not published."""

from functools import cache
from types import SimpleNamespace

import numpy as np

from ....evaluation.bootstrap import bootstrap_interval
from ....evaluation.intervals import proportion_interval
from ....replication.evidence import Draws, sweep
from ..measures import position_errors
from ..position_tracker import clipped_bilateration
from ..published import reported
from ..range_tracker import track_ranges
from ..settings import filter_settings
from ..surrogate import simulate_walk
from ._ratios import choices, ratio


def found(records, tracks, runs, rng):
    """Return the evidence by the id of the claim, from so many walks of each kind.

    `records` and `tracks` of the simulation are what a walk is compared with.
    """
    both, alone, resampled = rng.spawn(3)
    (variant,) = choices("variant")
    children = dict(zip(variant.values, both.spawn(len(variant.values)), strict=True))

    @cache
    def walks(variant):
        return _walks(runs, variant, children[variant])

    simulated = _simulated(records, tracks)

    def mean(variant, path, low, high):
        w = walks(variant)
        return Draws(_rms(getattr(w, path), w.before & (w.y >= low) & (w.y <= high)))

    def worse(child, variant):
        w = walks(variant)
        real = _rms(w.estimated, w.before & (w.y > 4))
        n = min(len(real), len(simulated))
        return bootstrap_interval(
            lambda a, b: np.sqrt(a / b), [real[:n] ** 2, simulated[:n] ** 2], rng=child
        )

    def raw_near(variant, how):
        w = walks(variant)
        at = w.before & (w.y >= 2) & (w.y <= 3)
        if how == "root mean square":
            return Draws(_rms(w.measured, at))
        return Draws(np.nanmax(w.measured[:, at], axis=1))

    return {
        "reacquired": sweep(choices("variant"), lambda variant: Draws(walks(variant).again)),
        "gate-walk": _gate_on_a_walk(runs // 4, alone),
        "error-near": sweep(choices("variant"), lambda v: mean(v, "estimated", 0, 2.4)),
        "raw-near": sweep(choices("variant", "read-off"), raw_near),
        "raw-worst": sweep(
            choices("variant"),
            lambda v: Draws(np.nanmax(walks(v).measured[:, walks(v).before], axis=1)),
        ),
        "error-at-four": sweep(
            choices("variant", "at-four"), lambda v, half: mean(v, "estimated", 4 - half, 4 + half)
        ),
        "real-worse": sweep(choices("variant"), worse, resampled),
        "nearest-of-validated": sweep(
            choices("variant"), lambda variant: proportion_interval(walks(variant).dropped)
        ),
    }


def _walks(runs, variant, rng):
    """Return walks of both radars, tracked as the code does it, and what becomes of them."""
    s = reported().scenario.real
    own = filter_settings("code", s.T)
    w = simulate_walk(runs, rng=rng, variant=variant)
    start, k = w.ranges[:, 0].mean(axis=0), round(s.back / s.T)
    track = track_ranges(w.detections, own, x0=start)
    code = track_ranges(w.detections, own, association="nearest-first", x0=start)
    off, before = np.abs(track.x[..., 0] - w.ranges[..., 0]), w.time < s.gone
    # The thesis tells of a walk that its filter follows; what one that is lost does, is no error.
    follows = (off[..., before] < own.box[0]).all(axis=(1, 2))
    estimated, measured = (
        position_errors(clipped_bilateration(d[:, 0], d[:, 1], s.baseline)[0], w.truth)[follows]
        for d in (track.x[..., 0], track.chosen[..., 0])
    )
    return SimpleNamespace(
        again=(off[:, 0, k + 3 : k + 9].max(axis=-1) < own.box[0]).astype(float),
        dropped=(track.updated & ~code.updated).any(axis=(1, 2)),
        before=before,
        y=w.truth[:, 1],
        estimated=estimated,
        measured=measured,
    )


def _rms(error, at):
    """Return the root mean square of each walk that has errors there."""
    some = error[:, at]
    some = some[np.isfinite(some).any(axis=1)]
    return np.sqrt(np.nanmean(some**2, axis=1))


def _simulated(records, tracks):
    """Return the error of the simulation's estimate in each run, from 4 m to the window's end."""
    far, K = reported().scenario.real.window[1], tracks["code", "box", True].x.shape[2]
    d = tracks["code", "box", True].x[..., 0]
    p, _ = clipped_bilateration(d[:, 0], d[:, 1], records.baseline)
    at = (records.distance[:K] > 4) & (records.distance[:K] <= far)
    return _rms(position_errors(p, records.truth), at)


def _gate_on_a_walk(runs, rng):
    """Return the error, or the unevenness, of one radar's path with the gate over that without.

    Unevenness: second differences up to the gap.
    """
    s = reported().scenario.real
    walked, resampled = rng.spawn(2)
    (variants,) = choices("variant")

    def paths(variant, child):
        w = simulate_walk(runs, rng=child, radar_count=1, variant=variant)
        # The first scans are empty: the person is nearer than the window.
        at = (w.time >= 4) & (w.time < s.gone)
        settings = [filter_settings("code", s.T, gate=gate) for gate in ("box", None)]
        found = [track_ranges(w.detections, own, x0=s.guess).x[:, 0, at, 0] for own in settings]
        return {
            "evenness": [np.diff(d, 2, axis=1) for d in found],
            "error": [d - w.ranges[0, at, 0] for d in found],
        }

    known = {
        name: paths(name, child)
        for name, child in zip(variants.values, walked.spawn(len(variants.values)), strict=True)
    }

    def compared(child, variant, quality, metric):
        return ratio(*known[variant][quality], metric, child)

    return sweep(choices("variant", "quality", "metric"), compared, resampled)
