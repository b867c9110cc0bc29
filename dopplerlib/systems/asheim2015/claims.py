"""Evidence for the claims of ``data/asheim2015/claims.toml``."""

import numpy as np

from ... import _checks
from ...estimation.linear_kalman import _predict, _update
from ...estimation.radial_velocity import radial_velocity_update
from ...evaluation.intervals import share_interval
from ...evaluation.verdicts import Draws, Readings
from ._claims_formulas import settings_and_formulas
from .measures import departure, distance_error, over_runs, usable_range
from .one_radar import filter_radar
from .published import quoted, scenario, settings
from .scene import simulate
from .stand_in import WALKS, walk
from .two_radars import (
    filter_then_triangulate,
    raw_positions,
    triangulate,
)

LONG = 60.0  # s: a record long enough for every track of the fixed gate to be left


def evidence(*, rng, runs=200):
    """Return our numbers for every claim.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of all randomness.
    runs : int
        Number of simulated records.

    Returns
    -------
    dict
        Evidence by the id of the claim.
    """
    _checks.generator("rng", rng)
    simulated, walked, resampled = rng.spawn(3)
    return {
        **settings_and_formulas(),
        **one_radar(runs, simulated, resampled),
        **two_radars(runs, simulated, resampled),
        **real_radars(2 * runs, walked),
    }


def one_radar(runs, rng, resampling):
    """Return the evidence on the path of a single radar.

    Parameters
    ----------
    runs : int
        Number of records.
    rng, resampling : numpy.random.Generator
        Sources of the noise and of the bootstrap.

    Returns
    -------
    dict
    """
    records = simulate(runs, rng=rng, duration=LONG)
    code, no_gate = settings("code"), settings("code", gate=None)
    z = records.z[..., None, :]
    gated, free = filter_radar(z, code), filter_radar(z, no_gate)
    t, truth = records.time, records.ranges[..., 0]
    raw = records.z[..., 0] - truth
    error = gated.x[..., 0] - truth
    short = records.until(40.0)
    z, t40 = short.z[..., None, :], short.time
    plain = {
        name: filter_radar(z, settings(name), doppler=False).x[..., 0] - short.ranges[..., 0]
        for name in ("code", "text")
    }
    twice = filter_radar(z[:, :, t40 <= 5], code, reuse_first=True).x[..., 0]
    twice = twice - truth[:, t <= 5]

    def ratio(a, b, ta, tb, low, high, radar):
        a, b = _squares(a[:, radar], ta, low, high), _squares(b[:, radar], tb, low, high)
        return _rms_ratio(a, b, resampling)

    times = departure(gated.updated, t)
    ekf_step = _largest_step_difference(records.z[0, 0, :300], code)
    return {
        "kf-improves": Readings(
            {name: ratio(e, raw, t40, t, 20, 30, 0) for name, e in plain.items()}
        ),
        "doppler-R1": ratio(error, plain["code"], t, t40, 5, 40, 0),
        "doppler-R2": ratio(error, plain["code"], t, t40, 5, 40, 1),
        "R1-departs": Draws(times[:, 0]),
        "R1-in-range": Draws(times[:, 0]),
        "R2-departs": Draws(times[:, 1]),
        "good-snr-R1": ratio(error, raw, t, t, 0, 10, 0),
        "good-snr-R2": ratio(error, raw, t, t, 0, 10, 1),
        "follows-R1": ratio(free.x[..., 0] - truth, error, t, t, 49, 50, 0),
        "follows-R2": ratio(free.x[..., 0] - truth, error, t, t, 49, 50, 1),
        "first-used-twice": ratio(twice, error, t40[t40 <= 5], t, 0, 5, 0),
        "ekf-needed": ekf_step,
    }


def two_radars(runs, rng, resampling):
    """Return the evidence on the triangulated position.

    Parameters
    ----------
    runs : int
        Number of records.
    rng, resampling : numpy.random.Generator
        Sources of the noise and of the bootstrap.

    Returns
    -------
    dict
    """
    q = quoted()
    records = simulate(runs, rng=rng)
    t, truth, d = records.time, records.truth, records.distance
    track = filter_radar(records.z[..., None, :], settings("code"))
    fused = filter_then_triangulate(records, settings("code"), track=track)
    error = distance_error(fused.p, truth)
    single = track.x[:, 0, :, 0] - records.ranges[0, :, 0]
    raw = raw_positions(records)
    raw_error = distance_error(raw.p, truth)
    gated_raw = distance_error(raw_positions(records, fused.updated).p, truth)

    def other(end, name, gate="own", **options):
        part = records.until(end)
        result = filter_then_triangulate(part, settings(name, gate=gate), **options)
        return np.pad(
            distance_error(result.p, part.truth),
            [(0, 0), (0, len(t) - len(part.time))],
            constant_values=np.nan,
        )

    no_gate = {name: other(46.0, name, gate=None) for name in ("code", "text")}
    text, plain = other(46.0, "text"), other(40.0, "code", doppler=False)
    at = int(np.argmin(np.hypot(*(truth[:, :2] - q["range"]["compared"]).T)))
    x_error = np.abs(raw.p[:, at, 0] - truth[at, 0])
    late = (t >= 40) & (t < 50)

    def ratio(a, b, low, high):
        return _rms_ratio(_squares(a, t, low, high), _squares(b, t, low, high), resampling)

    def first_beyond(e):
        return np.minimum([usable_range(one[None], t, d) for one in e], d[-1])

    def range_ratio(a, b):
        return over_runs(
            lambda a, b: usable_range(a, t, d) / min(usable_range(b, t, d), d[-1]),
            a,
            b,
            rng=resampling,
        )

    total, count = _squares(raw_error, t, 31, 33)
    return {
        "useful-range": Draws(first_beyond(error)),
        "raw-range": range_ratio(raw_error, error),
        "fusion-shortens": range_ratio(error, single),
        "raw-at-four": Draws(x_error),
        "raw-beyond-four": Draws(np.sqrt(total / count)),
        "gate-triangulation": ratio(no_gate["code"], error, 44, 46),
        "gate-triangulation-text": ratio(no_gate["text"], text, 44, 46),
        "gate-measurements": ratio(raw_error, gated_raw, 44, 46),
        "doppler-position": ratio(error, plain, 25, 40),
        "circles-meet": share_interval(raw.valid[:, late][:, ::20].ravel()),
    }


def real_radars(runs, rng):
    """Return what the SIMULATED stand-in says on the claims of Chapter 6.

    Parameters
    ----------
    runs : int
        Number of records.
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    dict
    """
    s = scenario()["real"]
    code = settings("code", s["T"])
    found, kept, dropped = {}, {}, []
    for variant, child in zip(WALKS, rng.spawn(2), strict=True):
        w = walk(runs, rng=child, variant=variant)
        track = filter_radar(w.detections, code, x0=_guess(w))
        k = round(s["back"] / s["T"])
        again = np.abs(track.x[..., 0] - w.ranges[..., 0])[:, 0, k + 3 : k + 9].max(axis=-1)
        found[variant] = share_interval(again < code.box[0])
        kept[variant] = w, track
        other = filter_radar(w.detections, code, association="nearest-first", x0=_guess(w))
        dropped.append((track.updated & ~other.updated).any(axis=(1, 2)))
    w, track = kept[WALKS[0]]
    p, _ = triangulate(track.x[:, 0, :, 0], track.x[:, 1, :, 0], s["baseline"])
    raw, _ = triangulate(track.chosen[:, 0, :, 0], track.chosen[:, 1, :, 0], s["baseline"])
    off, raw_off = distance_error(p, w.truth), distance_error(raw, w.truth)
    before = w.time < s["gone"]
    y = w.truth[:, 1]
    near = before & (y < 2.4)
    two_to_three = before & (y >= 2) & (y <= 3)
    four = before & (np.abs(y - 4) < 0.2)
    return {
        "reacquired": Readings(found),
        "error-near": Draws(np.mean(off[:, near], axis=1)),
        "raw-near": Draws(np.nanmean(raw_off[:, two_to_three], axis=1)),
        "raw-worst": Draws(np.nanmax(np.where(before, raw_off, np.nan), axis=1)),
        "error-at-four": Draws(np.mean(off[:, four], axis=1)),
        "nearest-of-validated": share_interval(np.concatenate(dropped)),
    }


def _guess(w):
    """Return the start of the thesis's code for one radar, or the truth of the walk for two."""
    if len(w.sensors) == 1:
        return np.array(scenario()["real"]["guess"])
    return w.ranges[:, 0].mean(axis=0)


def _largest_step_difference(z, own):
    """Return how far the pseudo-measurement filter is from a linear one, over a record, in m."""
    x = x_pseudo = z[0]
    P = P_pseudo = own.P0
    F, R = np.array([[1.0, own.T], [0.0, 1.0]]), np.diag(own.R(1.0))
    largest = 0.0
    for one in z[1:]:
        x, P, _, _ = _update(*_predict(x, P, F, own.Q), one, np.eye(2), R)
        x_pseudo, P_pseudo = _predict(x_pseudo, P_pseudo, F, own.Q)
        x_pseudo, P_pseudo, _, _ = _update(x_pseudo, P_pseudo, one[:1], np.eye(2)[:1], R[:1, :1])
        x_pseudo, P_pseudo, _, _ = radial_velocity_update(
            x_pseudo, P_pseudo, one[1], np.sqrt(R[1, 1])
        )
        largest = max(largest, float(np.abs(x - x_pseudo).max()))
    return round(largest, 9)


def _squares(error, time, low, high):
    """Return sum and number of squares of each run between two times, NaN left out."""
    there = error[:, (time >= low) & (time <= high)]
    return np.nansum(np.square(there), axis=-1), np.isfinite(there).sum(axis=-1)


def _rms_ratio(a, b, rng):
    return over_runs(
        lambda sa, na, sb, nb: np.sqrt(sa.sum() / na.sum() / (sb.sum() / nb.sum())),
        *a,
        *b,
        rng=rng,
    )
