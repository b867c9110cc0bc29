"""Symptoms of mistakes in a recording of an own array, each made on purpose in many runs.

Six minutes on one processor. The room is that of the example of the command line: five modules on
a wall, and a target that crosses it.
"""

import json
from dataclasses import replace

import numpy as np

from dopplerlib import RadarArray
from dopplerlib.chain.setup import example
from dopplerlib.chain.simulation import simulate_recording
from dopplerlib.evaluation.symptoms import symptoms
from dopplerlib.signal.synthesis import complex_noise
from studies._rows import rows, texts

FILES = (".json",)
PARAMETERS = {"seed": 20161128, "runs": 30, "fs": 4000.0, "length": 2.0, "snr_db": 24.0}
FREE = [0, 1, 3, 4]  # components of the state: the height is known


class Scene:
    """A target that crosses the room straight on, and the modules that record it."""

    def __init__(self, run):
        self.rng = np.random.default_rng([PARAMETERS["seed"], run])
        self.setup = example()
        self.array = self.setup.array
        self.fs, self.late = PARAMETERS["fs"], 0.0
        start = [4.8, 1.5, 1.2] + self.rng.uniform(-0.5, 0.5, 3) * [1, 1, 0]
        velocity = [-1.4, 0.4, 0] + self.rng.uniform(-0.3, 0.3, 3) * [1, 1, 0]
        self.one, self.other = self.rng.choice(len(self.array), 2, replace=False)
        self.time = np.arange(-0.2, PARAMETERS["length"] + 0.2, 1 / PARAMETERS["fs"])
        self.v = np.tile(velocity, (len(self.time), 1))
        self.x = start + self.time[:, None] * velocity

    def truth(self, time):
        """Return the states of the target at times."""
        both = np.hstack([self.x, self.v]).T
        return np.stack([np.interp(time, self.time + self.late, one) for one in both], axis=-1)

    def record(self, snr_db=None):
        """Return the recording that the modules make."""
        t = np.arange(round(PARAMETERS["length"] * self.fs)) / self.fs
        snr = PARAMETERS["snr_db"] if snr_db is None else snr_db
        return simulate_recording(
            self.truth(t)[:, :3], self.array, self.fs, rng=self.rng, snr_db=snr
        )


def echo(recording, change):
    """Return a recording with other samples, whose validity is decided anew."""
    return replace(recording, x=change(recording.x), valid=None)


def nothing(scene):
    return scene.record(), scene.setup


def branches(scene):
    return echo(scene.record(), lambda x: x.imag + 1j * x.real), scene.setup


def branches_of_one(scene):
    one = np.arange(len(scene.array))[:, None] == scene.one
    return echo(scene.record(), lambda x: np.where(one, x.imag + 1j * x.real, x)), scene.setup


def two_exchanged(scene):
    order = np.arange(len(scene.array))
    order[[scene.one, scene.other]] = scene.other, scene.one
    return echo(scene.record(), lambda x: x[order]), scene.setup


def mounted_elsewhere(scene):
    places = scene.array.positions.copy()
    aside = scene.rng.standard_normal(3)
    places[scene.one] += 0.3 * aside / np.linalg.norm(aside)
    scene.array = RadarArray(places, scene.array.wavelength)
    return scene.record(), scene.setup


def one_late(scene):
    by = round(scene.rng.uniform(0.03, 0.1) * scene.fs)
    one = np.arange(len(scene.array))[:, None] == scene.one
    recording = scene.record()
    late = np.roll(recording.x, by, axis=1)
    late[:, :by] = recording.x[:, :1]
    return echo(recording, lambda x: np.where(one, late, x)), scene.setup


def all_late(scene):
    scene.late = 0.05
    recording = scene.record()
    scene.late = 0.0
    return recording, scene.setup


def carrier(scene):
    setup = scene.setup
    array = RadarArray(setup.array.positions, 1.01 * setup.array.wavelength)
    recording = scene.record()
    return replace(recording, carrier=recording.carrier / 1.01), replace(setup, array=array)


def rate(scene):
    scene.fs *= 1.01
    return replace(scene.record(), fs=PARAMETERS["fs"]), scene.setup


def height(scene):
    scene.x[:, 2] += 0.4
    return scene.record(), scene.setup


def long_window(scene):
    return scene.record(), replace(scene.setup, window=0.4, hop=0.4, start=1.0)


def overlap(scene):
    return scene.record(), replace(scene.setup, hop=scene.setup.window / 4)


def hum(scene):
    recording = scene.record()
    t, size = recording.time, scene.rng.uniform(0.5, 1, (2, len(scene.array), 3, 1))
    lines = np.cos(2 * np.pi * 50 * np.arange(1, 4)[:, None] * t)
    added = 0.3 * 0.3 / 3 * np.sum((size[0] + 1j * size[1]) * lines, axis=1)
    return echo(recording, lambda x: x + added), scene.setup


def drift(scene):
    recording = scene.record()
    return echo(recording, lambda x: x + 0.3 * recording.time / 2.0), scene.setup


def dead(scene):
    one = np.arange(len(scene.array))[:, None] == scene.one
    recording = scene.record()
    return echo(recording, lambda x: np.where(one & (recording.time > 0.7), 0, x)), scene.setup


def lost_samples(scene):
    recording = scene.record()
    kept = np.ones(recording.x.shape[1], bool)
    kept[4400:4600] = False
    return echo(recording, lambda x: x[:, kept]), scene.setup


def turns(scene):
    after = np.maximum(scene.time - 1.0, 0)[:, None]  # s: then 1 m/s^2 sideways, along y
    scene.v += after * [0, 1, 0]
    scene.x += after**2 / 2 * [0, 1, 0]
    return scene.record(), scene.setup


def extended(scene):
    recording = scene.record()
    n = recording.x.shape[1]
    # Points of reflection wander over the body, 3 mm in 50 ms, each sensor's on its own.
    way = np.cumsum(scene.rng.standard_normal((len(scene.array), n)), axis=1)
    phase = 4 * np.pi / scene.array.wavelength * 3e-3 / np.sqrt(200) * way
    dc = recording.x.mean(axis=1, keepdims=True)
    return echo(recording, lambda x: dc + (x - dc) * np.exp(1j * phase)), scene.setup


def no_target(scene):
    noise = complex_noise(scene.record().x.shape, 0.01, rng=scene.rng)
    return echo(scene.record(), lambda x: noise), scene.setup


# What is wrong, what makes it so, and the cause that `symptoms` should name.
MISTAKES = {
    "nothing": (nothing, "none found"),
    "I and Q exchanged": (branches, "I and Q exchanged"),
    "I and Q of one sensor exchanged": (branches_of_one, "I and Q of sensor # exchanged"),
    "two sensors exchanged": (two_exchanged, "sensors # and # exchanged"),
    "one sensor 0.3 m from its place": (mounted_elsewhere, "sensor # disagrees"),
    "one sensor late by 30 to 100 ms": (one_late, "sensor # late"),
    "all sensors late by 50 ms": (all_late, "none found"),
    "carrier 1 % too low": (carrier, "none found"),
    "sampling rate 1 % too low": (rate, "none found"),
    "height 0.4 m wrong": (height, "z not as known"),
    "window eight times as long": (long_window, "window too long"),
    "windows overlap by three quarters": (overlap, "windows overlap"),
    "hum": (hum, "hum at # Hz"),
    "DC offset drifts": (drift, "DC offset drifts"),
    "one module dies": (dead, "sensor # dead or blind"),
    "50 ms of samples lost": (lost_samples, "unexplained"),
    "target turns": (turns, "target maneuvers more"),
    "target is no point": (extended, "standard deviations too small"),
    "no target": (no_target, "no target"),
}


def parts():
    """Return the mistakes."""
    return [({"mistake": name}, PARAMETERS["runs"], 5) for name in MISTAKES]


def compute(settings, seed, runs):
    """Return the symptoms of a mistake in some runs."""
    return texts(row(settings["mistake"], run) for run in runs)


def row(name, run):
    """Return the symptoms of a run, and its error, which only the truth shows."""
    scene = Scene(run)
    recording, setup = MISTAKES[name][0](scene)
    sensors = [int(one) + 1 for one in (scene.one, scene.other)]
    one = {"mistake": name, "run": run, "sensors": sensors}
    return one | measured(scene, recording, setup)


def measured(scene, recording, setup):
    """Return the symptoms of a recording, its cause, and error and NEES at the last sample."""
    s = symptoms(recording, setup)
    row = {
        "cause": s.cause,
        "start": s.start,
        "NIS": s.nis,
        "lag1": s.lag1,
        "present": float(s.present.min()),
    }
    row["mean sigma"] = float(np.abs(s.sensors.mean).max()) if s.sensors else np.nan
    found = setup.track(setup.baseband(recording))
    time, x, P = found.live
    error = (x[-1] - scene.truth(time[-1]))[FREE]
    row["error"] = float(np.hypot(*error[:2]))
    row["NEES"] = float(error @ np.linalg.solve(P[-1][np.ix_(FREE, FREE)], error))
    return {key: _short(value) for key, value in row.items()}


def _short(value):
    if isinstance(value, float):
        return float(f"{value:.4g}") if np.isfinite(value) else None
    return value


def contents(found):
    """Return all runs, a line for each."""
    lines = ",\n".join("    " + json.dumps(one) for part in found for one in rows(part))
    return [f'{{\n  "rows": [\n{lines}\n  ]\n}}\n']
