"""Decisions of several trackers to stop before a collision, on the same courses.

Some thirty minutes on one processor. Targets are drawn from the prior of the workspace, and what
comes into the ball about the center of the ring, nearly does, or passes is tracked.
"""

from io import BytesIO

import numpy as np

from dopplerlib.workspace.stop_study import SCENES, decision_numbers, stop_runs
from studies._rows import rows, texts

FILES = (".npz",)
PARAMETERS = {
    "seed": 5309,
    "targets": 1700,  # in a part, of which collisions and near misses are taken
    "passing": [46, 80],  # in a part of each of `SCENES`, about as many as collisions
    "parts": [30, 15],  # of each
}


def parts():
    """Return the scenes, of each of which a run is a part of its courses."""
    numbers = zip(SCENES, PARAMETERS["passing"], PARAMETERS["parts"], strict=True)
    return [({"scene": scene, "near": passing}, runs, 1) for scene, passing, runs in numbers]


def compute(settings, seed, runs):
    """Return facts on the courses of some parts, and when each tracker decides."""
    return texts(row(settings, seed, run) for run in runs)


def row(settings, seed, part):
    """Return facts on the courses of a part, and when each tracker decides."""
    study = stop_runs(settings["scene"], part, settings["targets"], settings["near"], seed=seed)
    courses = study.courses
    facts = np.stack([courses.entry, courses.need, courses.closest], axis=-1)
    found = np.stack([decision_numbers(alarm) for alarm in study.alarm.values()])
    return {"courses": facts.round(6).tolist(), "decisions": found.tolist()}


def contents(found):
    """Return the arrays of `saved_stops`."""
    arrays = {}
    for scene, part in zip(SCENES, found, strict=True):
        kept = rows(part)
        arrays[f"{scene}: courses"] = np.concatenate([one["courses"] for one in kept])
        numbers = np.concatenate([np.array(one["decisions"], np.uint8) for one in kept], axis=1)
        # Differences from threshold to threshold are small numbers, which compress.
        arrays[f"{scene}: decisions"] = np.diff(numbers, axis=-1, prepend=np.uint8(0))
    file = BytesIO()
    np.savez_compressed(file, **arrays)
    return [file.getvalue()]
