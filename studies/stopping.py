"""Decisions of several trackers to stop before a collision, on the same courses.

Ten minutes on one processor. Targets are drawn from the prior of the workspace, and what comes into
the ball about the center of the ring, nearly does, or passes is tracked.
"""

from io import BytesIO

import numpy as np

from dopplerlib.workspace.stop_study import SCENES, decision_numbers, stop_runs

FILES = (".npz",)
PARAMETERS = {
    "seed": 2031,
    "targets": 1700,  # in a part, of which collisions and near misses are taken
    "passing": [46, 80, 46],  # in a part of each of `SCENES`, about as many as collisions
    "parts": [30, 4, 5],  # of each
}


def items():
    """Return scene and number of each part."""
    parts = zip(SCENES, PARAMETERS["parts"], strict=True)
    return [(scene, part) for scene, count in parts for part in range(count)]


def rows(items):
    """Yield facts on the courses of a part, and when each tracker decides."""
    passing = dict(zip(SCENES, PARAMETERS["passing"], strict=True))
    for scene, part in items:
        sizes = PARAMETERS["targets"], passing[scene]
        study = stop_runs(scene, part, *sizes, seed=PARAMETERS["seed"])
        courses = study.courses
        facts = np.stack([courses.entry, courses.need, courses.closest], axis=-1)
        found = np.stack([decision_numbers(alarm) for alarm in study.alarm.values()])
        yield {"scene": scene, "courses": facts.round(6).tolist(), "decisions": found.tolist()}


def contents(rows):
    """Return the arrays of `saved_stops`."""
    arrays = {}
    for scene in SCENES:
        parts = [row for row in rows if row["scene"] == scene]
        arrays[f"{scene}: courses"] = np.concatenate([part["courses"] for part in parts])
        found = np.concatenate([np.array(part["decisions"], np.uint8) for part in parts], axis=1)
        # Differences from threshold to threshold are small numbers, which compress.
        arrays[f"{scene}: decisions"] = np.diff(found, axis=-1, prepend=np.uint8(0))
    file = BytesIO()
    np.savez_compressed(file, **arrays)
    return [file.getvalue()]
