"""Evidence for the claims of ``data/asheim2015/claims.toml``."""

import numpy as np

from ... import _checks
from ...estimation.linear_kalman import _predict, _update
from ...estimation.radial_velocity import radial_velocity_update
from ...evaluation.intervals import share_interval
from ...evaluation.verdicts import Draws, Readings
from ._claims_formulas import settings_and_formulas
from .measures import departure, distance_error, usable_range_of_each
from .one_radar import filter_radar
from .published import quoted, scenario, settings
from .resampling import rmse_ratio, usable_ratio
from .scene import simulate
from .stand_in import WALKS, walk
from .two_radars import triangulate

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
    records = simulate(runs, rng=simulated, duration=LONG)
    tracks = filtered(records)
    return {
        **settings_and_formulas(),
        **one_radar(records, tracks, resampled),
        **two_radars(records, tracks, resampled),
        **real_radars(2 * runs, walked),
    }


def filtered(records):
    """Return what the filters of both radars make of the records, by settings and variant.

    Parameters
    ----------
    records : Records
        What both radars measured.

    Returns
    -------
    dict of str to RadarTrack
        Each as long as a claim looks at it.
    """

    def run(name, end, gate="own", **options):
        return filter_radar(
            records.until(end).z[..., None, :], settings(name, gate=gate), **options
        )

    return {
        "code": run("code", LONG),
        "code, no gate": run("code", LONG, gate=None),
        "code, no rate": run("code", 40.0, doppler=False),
        "code, first used twice": run("code", 5.0, reuse_first=True),
        "text": run("text", 46.0),
        "text, no gate": run("text", 46.0, gate=None),
        "text, no rate": run("text", 40.0, doppler=False),
    }


def one_radar(records, tracks, rng):
    """Return the evidence on the path of a single radar.

    Parameters
    ----------
    records : Records
        What both radars measured.
    tracks : dict of str to RadarTrack
        See `filtered`.
    rng : numpy.random.Generator
        Source of the bootstrap.

    Returns
    -------
    dict
    """
    t, truth = records.time, records.ranges[..., 0]
    errors = {name: track.x[..., 0] - truth[:, : track.x.shape[2]]
              for name, track in tracks.items()}  # fmt: skip
    errors["measured"] = records.z[..., 0] - truth

    def ratio(a, b, low, high, radar):
        # All begin at the first scan; some end sooner.
        a, b = errors[a][:, radar], errors[b][:, radar]
        K, middle = min(a.shape[-1], b.shape[-1]), (low + high) / 2
        return rmse_ratio(a[:, :K], b[:, :K], t[:K], middle, middle - low, rng=rng)

    times = departure(tracks["code"].updated, t)
    plain = ("code", "text")
    return {
        "kf-improves": Readings(
            {name: ratio(f"{name}, no rate", "measured", 20, 30, 0) for name in plain}
        ),
        "doppler-R1": ratio("code", "code, no rate", 5, 40, 0),
        "doppler-R2": ratio("code", "code, no rate", 5, 40, 1),
        "R1-departs": Draws(times[:, 0]),
        "R1-in-range": Draws(times[:, 0]),
        "R2-departs": Draws(times[:, 1]),
        "good-snr-R1": ratio("code", "measured", 0, 10, 0),
        "good-snr-R2": ratio("code", "measured", 0, 10, 1),
        "follows-R1": ratio("code, no gate", "code", 49, 50, 0),
        "follows-R2": ratio("code, no gate", "code", 49, 50, 1),
        "first-used-twice": ratio("code, first used twice", "code", 0, 5, 0),
        "ekf-needed": _largest_step_difference(records.z[0, 0, :300], settings("code")),
    }


def two_radars(records, tracks, rng):
    """Return the evidence on the triangulated position.

    Parameters
    ----------
    records : Records
        What both radars measured.
    tracks : dict of str to RadarTrack
        See `filtered`.
    rng : numpy.random.Generator
        Source of the bootstrap.

    Returns
    -------
    dict
    """
    q = quoted()
    records = records.until(scenario()["tracks"]["duration"])
    t, truth, d = records.time, records.truth, records.distance

    def position_error(d1, d2):
        p, valid = triangulate(d1[:, : len(t)], d2[:, : len(t)], records.baseline)
        return distance_error(p, truth[: p.shape[1]]), p, valid

    errors = {name: position_error(*np.moveaxis(track.x[..., 0], 1, 0))[0]
              for name, track in tracks.items()}  # fmt: skip
    errors["measured"], raw, valid = position_error(*np.moveaxis(records.z[..., 0], 1, 0))
    inside = tracks["code"].updated[:, :, : len(t)].all(axis=1)
    errors["inside the gate"] = np.where(inside, errors["measured"], np.nan)
    single = tracks["code"].x[:, 0, : len(t), 0] - records.ranges[0, :, 0]
    at = int(np.argmin(np.hypot(*(truth[:, :2] - q["range"]["compared"]).T)))
    later = errors["measured"][:, (t >= 31) & (t <= 33)]
    late = (t >= 40) & (t < 50)

    def ratio(a, b, low, high):
        a, b = errors[a], errors[b]
        K, middle = min(a.shape[-1], b.shape[-1]), (low + high) / 2
        return rmse_ratio(a[:, :K], b[:, :K], t[:K], middle, middle - low, rng=rng)

    return {
        "useful-range": Draws(np.minimum(usable_range_of_each(errors["code"], t, d), d[-1])),
        "raw-range": usable_ratio(errors["measured"], errors["code"], t, d, rng=rng),
        "fusion-shortens": usable_ratio(errors["code"], single, t, d, rng=rng),
        "raw-at-four": Draws(np.abs(raw[:, at, 0] - truth[at, 0])),
        "raw-beyond-four": Draws(np.sqrt(np.mean(later**2, axis=1))),
        "gate-triangulation": ratio("code, no gate", "code", 44, 46),
        "gate-triangulation-text": ratio("text, no gate", "text", 44, 46),
        "gate-measurements": ratio("measured", "inside the gate", 44, 46),
        "doppler-position": ratio("code", "code, no rate", 25, 40),
        "circles-meet": share_interval(valid[:, late][:, ::20].ravel()),
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
