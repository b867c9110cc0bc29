"""Tracking of many detections a scan, beside Stone Soup's global nearest neighbor.

``make bench NAME=detections`` writes what the chapter on benchmarks shows. A plane has as many
targets as a scan has detections; one in ten is missed, and a false alarm is seen instead. Gate,
costs (NIS), rules for the start and the end of a track and detections are the same. Both must give
every detection to the same track, with the same states, before any time is taken.
"""

import time
from datetime import datetime, timedelta

import numpy as np
from measuring import interleaved, save
from scipy.special import chdtri
from stonesoup.dataassociator.neighbour import GNNWith2DAssignment
from stonesoup.dataassociator.tree import DetectionKDTreeGNN2D
from stonesoup.deleter.time import UpdateTimeStepsDeleter
from stonesoup.hypothesiser.distance import DistanceHypothesiser
from stonesoup.initiator.simple import SimpleMeasurementInitiator
from stonesoup.measures import SquaredMahalanobis
from stonesoup.models.measurement.linear import LinearGaussian
from stonesoup.models.transition.linear import LinearGaussianTimeInvariantTransitionModel
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.tracker.simple import MultiTargetTracker
from stonesoup.types.detection import Detection
from stonesoup.types.state import GaussianState
from stonesoup.updater.kalman import KalmanUpdater

from dopplerlib import TrackManager
from dopplerlib.model.motion import cwna_process_noise, ncv_transition
from dopplerlib.tracking.multi_target import track_scans

COUNTS, SCANS = (1, 10, 100, 1000), 4  # detections a scan
T = 0.1  # s from scan to scan
SPACING = 10.0  # side of the square in m that each target has for itself, on average
Q_ACCELERATION, SIGMA_Z, SPEED = 1.0, 0.5, 5.0  # m²/s³, m, m/s
GATE, MISSES = 0.999, 3
RADIUS = 15.0  # m; no gate reaches so far
AGREEMENT = 1e-8
START = datetime(2026, 1, 1)
F = ncv_transition(T, dim=2, order="derivative")
Q = cwna_process_noise(T, Q_ACCELERATION, dim=2, order="derivative")
H = np.eye(2, 4)
R = SIGMA_Z**2 * np.eye(2)
P0 = np.diag([SIGMA_Z**2, SIGMA_Z**2, SPEED**2, SPEED**2])


def scenario(count, rng):
    """Return scans (count, 2), and the target of each detection, -1 for a false alarm."""
    side = SPACING * np.sqrt(count)
    x = np.hstack([rng.uniform(0, side, (count, 2)), rng.normal(0, SPEED, (count, 2))])
    noise = np.linalg.cholesky(Q)
    z, owners = [], []
    for _ in range(SCANS):
        x = x @ F.T + rng.standard_normal(x.shape) @ noise.T
        seen = rng.permutation(count)
        missed = rng.random(count) < 0.1
        scan = x[seen, :2] + rng.normal(0, SIGMA_Z, (count, 2))
        scan[missed] = rng.uniform(0, side, (missed.sum(), 2))
        z.append(scan)
        owners.append(np.where(missed, -1, seen))
    return z, owners


def ours(scans):
    """Return the tracks of dopplerlib."""
    return track_scans(
        scans, F, Q, lambda x: x[..., :2], lambda x: np.broadcast_to(H, (*x.shape[:-1], 2, 4)), R,
        lambda z: (np.pad(z, ((0, 0), (0, 2))), np.broadcast_to(P0, (len(z), 4, 4))),
        TrackManager(hits=1, window=1, delete_after=MISSES), GATE,
    )  # fmt: skip


def theirs(radius=None):
    """Return a function that tracks detections with Stone Soup, and one that makes them.

    With a `radius` a tree picks the detections that are no further from a track.
    """
    model = LinearGaussian(ndim_state=4, mapping=(0, 1), noise_covar=R)
    motion = LinearGaussianTimeInvariantTransitionModel(transition_matrix=F, covariance_matrix=Q)
    predictor, updater = KalmanPredictor(motion), KalmanUpdater(model)
    gate = chdtri(2, 1 - GATE)
    nis = SquaredMahalanobis(state_covar_inv_cache_size=None)
    hypothesiser = DistanceHypothesiser(predictor, updater, nis, missed_distance=gate)
    if radius is None:
        associator = GNNWith2DAssignment(hypothesiser)
    else:
        associator = DetectionKDTreeGNN2D(hypothesiser, predictor, updater, max_distance=radius)

    def prepared(scans):
        return [
            (now, [Detection(row, timestamp=now, measurement_model=model) for row in z])
            for k, z in enumerate(scans)
            for now in [START + timedelta(seconds=T * k)]
        ]

    def run(detections):
        tracker = MultiTargetTracker(
            SimpleMeasurementInitiator(GaussianState(np.zeros(4), P0), model),
            UpdateTimeStepsDeleter(MISSES),
            [(now, set(some)) for now, some in detections],
            associator,
            updater,
        )
        return set().union(*(tracks.copy() for _, tracks in tracker))

    return run, prepared


def agreement(tracks, others, detections):
    """Return the largest difference of a state; ValueError if a detection changed its track."""
    number = {
        id(detection): (k, i) for k, (_, some) in enumerate(detections)
        for i, detection in enumerate(some)
    }  # fmt: skip
    theirs = {}
    for other in others:
        taken = [getattr(state, "hypothesis", None) for state in other]
        rows = [number[id(one.measurement)][1] if one else -1 for one in taken]
        theirs[number[id(taken[0].measurement)]] = rows, other[-1].state_vector[:, 0]
    worst = 0.0
    for track in tracks:
        rows, x = theirs.pop((track.scan[0], track.detection[0]))
        # Theirs is deleted with its last scan, ours before it.
        kept = len(track.detection)
        if rows[:kept] != track.detection.tolist() or max(rows[kept:], default=-1) >= 0:
            raise ValueError(
                f"the track of {track.scan[0]} must have {track.detection}, got {rows}"
            )
        if kept == len(rows):
            worst = max(worst, np.abs(track.x[-1] - x).max())
    if theirs or not worst < AGREEMENT:
        raise ValueError(
            f"states must agree to {AGREEMENT}, got {worst}, {len(theirs)} tracks more"
        )
    return worst


def right(tracks, owners):
    """Return the share of the targets' detections in tracks that began with the same target."""
    same = total = 0
    for track in tracks:
        taken = [owners[k][i] for k, i in zip(track.scan, track.detection, strict=True) if i >= 0]
        of_targets = np.array(taken[1:])
        total += np.sum(of_targets >= 0)
        same += np.sum((of_targets >= 0) & (of_targets == taken[0]))
    return same / max(total, 1)


def main():
    found = {}
    for count in COUNTS:
        z, owners = scenario(count, np.random.default_rng(count))
        tracks = ours(z)
        row = {"tracks": len(tracks), "right": right(tracks, owners)}
        clocks = {"dopplerlib": (lambda z=z: ours(z), max(1, 100 // count))}
        for name, radius in {"Stone Soup": None, "Stone Soup, k-d tree": RADIUS}.items():
            if radius is None and count > 100:
                continue  # a million pairs, each an object
            run, prepared = theirs(radius)
            detections = prepared(z)
            row[f"difference, {name}"] = agreement(tracks, run(detections), detections)
            clocks[name] = (lambda run=run, data=detections: run(data), max(1, 10 // count))
        times = interleaved(f"{count} detections a scan", clocks, time.process_time)
        found[count] = row | {"s a scan": {name: s / SCANS for name, s in times.items()}}
    save("detections", found, packages=("numpy", "numba", "scipy", "stonesoup"))


if __name__ == "__main__":
    main()
