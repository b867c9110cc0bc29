"""Evidence on Section II: measurements and ambiguities of each waveform."""

from functools import cache

import numpy as np

from ....evaluation.intervals import mean_interval, proportion_interval
from ....replication.documents import read_document
from ....replication.evidence import sweep
from ....signal import fsk, waveforms
from .. import signals
from ..settings import automotive_settings

RUNS = 80
TARGETS = np.array([[30.0, -5.0], [40.0, 4.0]])  # range in m and range rate in m/s
FAR, FAST = (5.0, 100.0), (-10.0, 10.0)  # m and m/s: where random targets are


def found(rng):
    """Return evidence by the id of the claim."""
    choice = read_document("macaveiu2013").choice
    one_target, scenes = rng.spawn(2)
    return {
        "pulse-rate": sweep(choice("complexity", "range-cells", "chirps"), pulse_work),
        "lfm-single": float(np.linalg.matrix_rank(relations((1,)))),
        "lfm-ghosts": float(len(intersections(TARGETS, 2)[0]) - len(TARGETS)),
        **sweep(choice("echo-snr", "fsk-step"), fsk_errors, one_target),
        **sweep(choice("apart", "echo-phase", "fsk-step"), fsk_confusion),
        "slopes-resolve": sweep(choice("slopes", "targets"), resolved, scenes),
        "mfsk-solves": sweep(choice("beats", "echo-phase"), mfsk_error),
        "mfsk-time": 1 / slopes_needed(),
        "rapid-same-gate": sweep(choice("cells-apart", "echo-phase"), gate_error),
        "rapid-unambiguous": sweep(choice("chirps", "closing-speed"), folds),
        **sweep(choice("body", "shape-level"), shapes),
    }


def pulse_work(complexity, cells, chirps):
    """Return the work for pulses over that for as many rapid chirps."""
    s = automotive_settings()
    if complexity == "samples a second":
        return s.bandwidth * s.T / (cells * chirps)
    # A transform over the pulses in every range gate; over chirps, one of each chirp as well.
    return float(np.log2(chirps) / (np.log2(cells) + np.log2(chirps)))


def relations(slopes):
    """Return the rows that give the beat of each chirp, (slopes, 2)."""
    s = automotive_settings()
    return np.stack([waveforms.chirp_relation(s.radar, a * s.bandwidth / s.T) for a in slopes])


def intersections(targets, slopes):
    """Return the intersections of exact tones, and their misfit in Hz."""
    rows = relations(signals.SLOPES[:slopes])
    return waveforms.chirp_intersections(rows, [targets @ row for row in rows])


def explained(targets, slopes):
    """Return the number of intersections that all slopes explain within half a frequency cell."""
    return int(np.sum(intersections(targets, slopes)[1] < 0.5 / automotive_settings().T))


def resolved(rng, slopes, targets):
    """Return the fraction of scenes in which several slopes leave the targets and no ghost."""
    scenes = np.stack([rng.uniform(*ends, (RUNS, targets)) for ends in (FAR, FAST)], axis=-1)
    return proportion_interval([explained(scene, slopes) == targets for scene in scenes])


def slopes_needed():
    """Return the least number of slopes without a ghost of two targets."""
    for number in range(2, len(signals.SLOPES) + 1):
        if explained(TARGETS, number) == len(TARGETS):
            return number
    raise ValueError(f"SLOPES are too few for {len(TARGETS)} targets")


def fsk_errors(rng, snr, step):
    """Return the mean error of range and range rate of one target, in resolution cells."""
    radar, reach = automotive_settings().radar, waveforms.SPEED_OF_LIGHT / (2 * step)
    off = []
    for _ in range(RUNS):
        target = np.array([rng.uniform(5, 0.9 * reach), rng.uniform(*FAST)])
        pair = fsk.fsk_beats(radar, target, step=step)
        pair = [signals.noisy_echoes(one, snr, rng=rng) for one in pair]
        off.append(np.abs(fsk.fsk_solve(radar, *pair, step=step) - target))
    r, v = np.transpose(off)
    return {
        "fsk-range": mean_interval(r / radar.range_resolution),
        "fsk-speed": mean_interval(v / radar.speed_resolution),
    }


def fsk_confusion(apart, phase, step):
    """Return the distance of the range found from the nearer of two targets, in cells."""
    radar = automotive_settings().radar
    ranges = np.array([30.0, 30.0 + apart + phase * radar.wavelength / 2])

    def off(v):
        targets = np.stack([ranges, [v, v]], axis=-1)
        r, _ = fsk.fsk_solve(radar, *fsk.fsk_beats(radar, targets, step=step), step=step)
        return float(np.abs(r - ranges).min()) / radar.range_resolution

    return {"fsk-resolution": off(TARGETS[0, 1]), "fsk-at-rest": off(0.0)}


def mfsk_error(beats, phase):
    """Return the distance of the worst range found from the nearest target, in cells; no noise."""
    radar = automotive_settings().radar
    A, targets = fsk.mfsk_relations(radar), TARGETS.copy()
    if beats == "a shared beat":
        targets[1, 0] = 44.0
    targets[1, 0] += phase * radar.wavelength / 2
    if beats == "a shared beat":
        targets[1, 1] = (A[0] @ targets[0] - A[0, 0] * targets[1, 0]) / A[0, 1]
    count = 1 if beats == "a shared beat" else 2
    found = fsk.mfsk_solve(radar, *fsk.mfsk_beats(radar, targets), count)
    off = np.abs(found[:, :1] - targets[:, 0]).min(axis=1)
    return float(off.max()) / radar.range_resolution


def gate_error(apart, phase):
    """Return the worst error of two range rates in one range gate, in cells."""
    radar = automotive_settings().radar
    true = 1.0 + np.array([0.0, apart * radar.speed_resolution])
    targets = np.stack([[20.0, 20.0 + phase * radar.wavelength / 2], true], axis=-1)
    r, v, power = waveforms.range_doppler_map(radar, waveforms.rapid_chirps(radar, targets))
    column = power[:, np.argmin(np.abs(r - 20.0))]
    peaks = np.flatnonzero((column[1:-1] > column[:-2]) & (column[1:-1] >= column[2:])) + 1
    two = np.sort(v[peaks[np.argsort(column[peaks])[-2:]]])
    return float(np.abs(two - true).max()) / radar.speed_resolution


def folds(chirps, speed):
    """Return the number of times that the range rate of a car that comes nearer is folded."""
    radar = automotive_settings().radar
    signal = waveforms.rapid_chirps(radar, [50.0, -speed], chirps=chirps, samples=128)
    _, v = waveforms.strongest_cell(*waveforms.range_doppler_map(radar, signal))
    return float(round((v + speed) / (2 * radar.speed_limit(chirps))))


def shapes(body, level):
    """Return cells of range over cells of range rate, of a car and of a pedestrian."""

    def ratio(seen):
        ranges, rates = waveforms.occupied_cells(seen, level)
        return ranges / rates

    return dict(zip(("profile-car", "profile-pedestrian"), map(ratio, bodies(body)), strict=True))


@cache
def bodies(body):
    """Return the maps of a car and of a pedestrian, each stretched."""
    radar, middle = automotive_settings().radar, np.mean(signals.CAR, axis=0)
    car = middle + [body, 1.0] * (signals.CAR - middle)
    return [
        waveforms.range_doppler_map(radar, waveforms.rapid_chirps(radar, case))[2]
        for case in (car, signals.PEDESTRIAN * [1.0, body])
    ]
