"""Evidence on Section III: the sensor, and the scheme from detections to tracks."""

from functools import cache
from itertools import chain

import numpy as np

from ....evaluation.intervals import mean_interval, proportion_interval
from ....model.polar_radar import polar_radar_h, polar_radar_jacobian
from ....replication.documents import read_document
from ....replication.evidence import sweep
from .. import polar_filters, processing, processing_study
from ..crossing import crossing_paths, track_crossing
from ..settings import automotive_settings
from ..truth import vehicle_paths

RUNS = 60
RECORDS, THINNED = 4, 5  # records of a path whose objects are counted, and every which scan
VIEW = 0.8  # rad: half of the field of view, as in `processing.simulate_scans`


def found(rng):
    """Return evidence by the id of the claim."""
    choice = read_document("macaveiu2013").choice
    crossings, records = rng.spawn(2)
    return {
        "all-measured": float(np.linalg.matrix_rank(polar_radar_jacobian([5.0, 1.0, 5.0, 1.0]))),
        "diagonal": sweep(choice("path", "azimuth-noise"), correlation),
        "clutter-removed": sweep(choice("clutter-limit", "rate-noise"), removed),
        "slow-is-clutter": sweep(choice("clutter-limit"), deleted_scans),
        "ego-compensation": sweep(choice("ego-speed", "clutter-limit"), uncompensated),
        "grouped": sweep(choice("path", "object-gate"), grouping(records)),
        "false-candidates": mean_interval(candidates()),
        "false-tracks": sweep(choice("confirmation"), false_tracks),
        "target-tracked": sweep(choice("target", "rule-for"), least_tracked),
        "hungarian": sweep(
            choice("failure", "nearest-neighbor", "crossing-angle", "compared"),
            comparison(crossings),
        ),
    }


def correlation(path, sigma_phi):
    """Return the largest correlation of the measured x and y of a target on a path."""
    seen = polar_radar_h(vehicle_paths()[path].truth)
    _, P = polar_filters.start_polar(seen, polar_filters.polar_noise(sigma_phi))
    return float(np.abs(P[:, 0, 2] / np.sqrt(P[:, 0, 0] * P[:, 2, 2])).max())


def removed(limit, sigma_rate):
    """Return the fraction of stationary reflections that the rule deletes."""
    return processing_study.deleted_fraction(limit=limit, sigma_rate=sigma_rate)


def deleted_scans(limit):
    """Return the number of scans in which the rule deletes the target of Fig 8."""
    return float(processing.hidden_scans(vehicle_paths()[8].truth, limit).sum())


def uncompensated(speed, limit):
    """Return the fraction of stationary reflections that the rule deletes from a moving car.

    Relative to that from a standing one.
    """
    azimuth = np.linspace(-VIEW, VIEW, 401)
    x, y = 30 * np.sin(azimuth), 30 * np.cos(azimuth)
    passing = np.stack([x, 0 * x, y, 0 * y - speed], axis=-1)
    moving = processing_study.deleted_fraction(passing, limit)
    return moving / processing_study.deleted_fraction(limit=limit)


def grouping(rng):
    """Return a function: fraction of scans whose detections of the target make one object."""
    truths = {figure: path.truth[::THINNED] for figure, path in vehicle_paths().items()}
    scans = {
        figure: [processing.simulate_scans(truth, rng=child) for child in rng.spawn(RECORDS)]
        for figure, truth in truths.items()
    }

    def together(path, size):
        box = tuple(size * np.array(processing.BOX))
        one_object = []
        for scan in chain.from_iterable(scans[path]):
            own = processing.group_detections(scan.z, box)[1][scan.source == processing.TARGET]
            if len(own) > 1:
                one_object.append(len(set(own)) == 1)
        return proportion_interval(one_object)

    return together


def candidates():
    """Return tracks begun that are not the target's, of each saved record."""
    plain = [processing_study.saved_outcomes()[figure, "as in Fig 6"] for figure in vehicle_paths()]
    return np.concatenate([one["begun"] - one["tracks"] for one in plain])


def false_tracks(confirmation):
    """Return the fraction of the saved records of Fig 9 in which a false track is confirmed."""
    variant = {"4 hits of 6": "as in Fig 6", "8 hits of 10": "8 hits of 10"}[confirmation]
    return proportion_interval(processing_study.saved_outcomes()[9, variant]["false"] > 0)


def least_tracked(target, rule_for):
    """Return the fraction of scans with a track, on the path where it is least."""
    variant = {
        ("a car", "all"): "as in Fig 6",
        ("a car", "those of new tracks"): "rule for new tracks only",
        ("a pedestrian", "all"): "pedestrian as in Fig 6",
        ("a pedestrian", "those of new tracks"): "pedestrian with rule for new tracks only",
    }[target, rule_for]
    samples = automotive_settings().samples
    held = [
        mean_interval(one["held"] / samples)
        for (_, name), one in processing_study.saved_outcomes().items()
        if name == variant
    ]
    return min(held, key=lambda share: share.value)


def comparison(rng):
    """Return a function for the excess of failures of the Hungarian algorithm, on one noise."""
    seed = int(rng.integers(2**32))

    @cache
    def crossing(rule, angle, velocity):
        truth = crossing_paths(np.deg2rad(angle))
        return track_crossing(truth, rule, RUNS, rng=np.random.default_rng(seed), velocity=velocity)

    def more(failure, rule, angle, compared):
        which = "lost" if failure == "both tracks on one target" else "swapped"
        velocity = compared == "positions and velocities"
        both = [crossing(name, angle, velocity) for name in ("Hungarian", rule)]
        hungarian, other = (getattr(one, which).astype(float) for one in both)
        return mean_interval(hungarian - other)

    return more
