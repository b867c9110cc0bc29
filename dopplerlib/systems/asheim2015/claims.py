"""Evidence for the claims of Åsheim (2015), and what a simulated stand-in says of Chapter 6."""

import numpy as np

from ... import _checks
from ...estimation import gaussian, recursion
from ...estimation.linear_kalman import kf
from ...estimation.radial_velocity import radial_velocity_update
from ...evaluation.intervals import proportion_interval
from ...replication.readings import Draws, Readings
from ._claims_formulas import settings_and_formulas
from .measures import departure, distance_error, rmse_ratio, usable_range, usable_ratio
from .one_radar import filter_radar
from .published import quoted, scenario, settings
from .scene import simulate
from .stand_in import WALKS, walk
from .two_radars import triangulate

LONG = 60.0  # s: a record long enough for every track of the fixed gate to be left


def evidence(*, rng, runs=400):
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
    simulated, resampled, walking = rng.spawn(3)
    records = simulate(runs, rng=simulated, duration=LONG)
    tracks = filtered(records)
    return {
        **settings_and_formulas(),
        **one_radar(records, tracks, resampled),
        **two_radars(records, tracks, resampled),
        **stand_in_evidence(rng=walking, runs=2 * runs),
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
        "text": run("text", 46.0),
        "text, no gate": run("text", 46.0, gate=None),
        "text, no rate": run("text", 40.0, doppler=False),
        "modern": run("modern", scenario()["tracks"]["duration"]),
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

    def windows(a, b, radar, *parts):
        return Readings(
            {f"{low} to {high} s": ratio(a, b, low, high, radar) for low, high in parts}
        )

    times = departure(tracks["code"].updated, t)
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
        p, _ = triangulate(d1[:, : len(t)], d2[:, : len(t)], records.baseline)
        return distance_error(p, truth[: p.shape[1]]), p

    errors = {name: position_error(*np.moveaxis(track.x[..., 0], 1, 0))[0]
              for name, track in tracks.items()}  # fmt: skip
    errors["measured"], raw = position_error(*np.moveaxis(records.z[..., 0], 1, 0))
    inside = tracks["code"].updated[:, :, : len(t)].all(axis=1)
    errors["inside the gate"] = np.where(inside, errors["measured"], np.nan)
    single = tracks["code"].x[:, 0, : len(t), 0] - records.ranges[0, :, 0]
    at = int(np.argmin(np.hypot(*(truth[:, :2] - q["range"]["compared"]).T)))

    def of_each(name, low, high, value="root mean square"):
        # From here to there, seen from the origin.
        some = errors[name][:, (d >= low) & (d <= high)]
        largest = value == "largest"
        return Draws(some.max(axis=1) if largest else np.sqrt(np.mean(some**2, axis=1)))

    def ratio(a, b, low, high):
        a, b = errors[a], errors[b]
        K, middle = min(a.shape[-1], b.shape[-1]), (low + high) / 2
        return rmse_ratio(a[:, :K], b[:, :K], t[:K], middle, middle - low, rng=rng)

    return {
        "useful-range": Draws(np.minimum(usable_range(errors["code"][:, None], t, d), d[-1])),
        "raw-range": usable_ratio(errors["measured"], errors["code"], t, d, rng=rng),
        "fusion-shortens": usable_ratio(errors["code"], single, t, d, rng=rng),
        "raw-at-four": Draws(np.abs(raw[:, at, 0] - truth[at, 0])),
        "raw-near-simulated": Readings(
            {
                f"{value} from 2 to 3 m": of_each("measured", 2, 3, value)
                for value in ("root mean square", "largest")
            }
        ),
        "raw-beyond-four": Readings(
            {
                f"{name}, {low} to {high} m": of_each(track, low, high)
                for name, track, low, high in (
                    ("measured", "measured", 4.4, 4.7),
                    ("measured", "measured", 5, 5.66),
                    ("estimated", "code", 4.4, 4.7),
                )
            }
        ),
        "error-at-four-simulated": Readings(
            {
                name: of_each(track, 3.9, 4.1)
                for name, track in (("measured", "measured"), ("estimated", "code"))
            }
        ),
        "tweaked": usable_ratio(errors["modern"], errors["code"], t, d, rng=rng),
        "gate-triangulation": ratio("code, no gate", "code", 44, 46),
        "gate-triangulation-text": ratio("text, no gate", "text", 44, 46),
        "gate-measurements": ratio("measured", "inside the gate", 44, 46),
        "doppler-position": ratio("code", "code, no rate", 25, 40),
    }


def stand_in_evidence(*, rng, runs=800):
    """Return what the SIMULATED stand-in says on the claims of Chapter 6.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of all randomness.
    runs : int
        Number of simulated walks of each kind.

    Returns
    -------
    dict
        Evidence by the id of the claim.
    """
    _checks.generator("rng", rng)
    s = scenario()["real"]
    code = settings("code", s["T"])
    alone, *both = rng.spawn(1 + len(WALKS))
    k, found, dropped, kept = round(s["back"] / s["T"]), [], [], []
    for variant, child in zip(WALKS, both, strict=True):
        w = walk(runs, rng=child, variant=variant)
        start = w.ranges[:, 0].mean(axis=0)
        track = filter_radar(w.detections, code, x0=start)
        again = np.abs(track.x[..., 0] - w.ranges[..., 0])[:, 0, k + 3 : k + 9].max(axis=-1)
        found.append(again < code.box[0])
        other = filter_radar(w.detections, code, association="nearest-first", x0=start)
        dropped.append((track.updated & ~other.updated).any(axis=(1, 2)))
        kept.append((w, track))
    w, track = kept[0]
    before, y = w.time < s["gone"], w.truth[:, 1]
    # The thesis tells of a walk that its filter follows; what one that is lost does, is no error.
    error = np.abs(track.x[..., 0] - w.ranges[..., 0])[..., before]
    follows = (error < code.box[0]).all(axis=(1, 2))
    off, raw = (
        distance_error(triangulate(d[:, 0], d[:, 1], s["baseline"])[0], w.truth)[follows]
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
    """Return in what share of walks past one radar the gate is good for the filtered ranges.

    Parameters
    ----------
    runs : int
        Number of walks.
    rng : numpy.random.Generator
        Source of the walks.

    Returns
    -------
    Readings
        Shares of the walks in which the path up to the gap is more even (root mean square of its
        second differences), and in which its error is smaller, with the gate than without.
    """
    s = scenario()["real"]
    w = walk(runs, rng=rng, radar_count=1)
    # The first scans are empty: the person is nearer than the window.
    at = (w.time >= 4) & (w.time < s["gone"])
    settle = [settings("code", s["T"], gate=gate) for gate in ("box", None)]
    paths = [filter_radar(w.detections, own, x0=s["guess"]).x[:, 0, at, 0] for own in settle]
    bends = [np.mean(np.diff(d, 2, axis=1) ** 2, axis=1) for d in paths]
    errors = [np.mean((d - w.ranges[0, at, 0]) ** 2, axis=1) for d in paths]
    return Readings(
        {
            "more even": proportion_interval(bends[0] < bends[1]),
            "smaller error": proportion_interval(errors[0] < errors[1]),
        }
    )


def _largest_step_difference(z, own):
    """Return how far the pseudo-measurement filter is from a linear one, over a record, in m."""
    F, R = np.array([[1.0, own.T], [0.0, 1.0]]), np.diag(own.R(1.0))

    def step(k, state):
        x, P = gaussian.predict(*state, F, own.Q)
        x, P, _ = gaussian.update(x, P, z[k, :1] - x[:1], np.eye(2)[:1], R[:1, :1])
        x, P, _, _ = radial_velocity_update(x, P, z[k, 1], np.sqrt(R[1, 1]))
        return (x, P), (x,)

    (pseudo,) = recursion.scan(step, (z[0], own.P0), range(1, len(z)))
    linear = kf(z[1:], F, own.Q, np.eye(2), R, z[0], own.P0)
    return round(float(np.abs(linear.x - pseudo).max()), 9)
