"""Errors of plain and robust starts against the fraction of wrong windows.

Some ten minutes on one processor. A module beside a road, which a vehicle passes, and the ring of
six with a target before it; windows that are wrong are scattered, on one steady line, or on the
line of another target. Beside both starts stands a fit to the right windows alone.
"""

from itertools import product

import numpy as np

from dopplerlib import RadarArray, doppler_shift, ml_initialize
from dopplerlib.evaluation.robust_starts import KINDS

FILES = (".csv",)
PARAMETERS = {
    "seed": 2027,
    "fractions": [0.0, 0.05, 0.1, 0.2, 0.3],
    "chunks": 10,
    "road_runs": 10,
    "ring_runs": 3,
}
COLUMNS = "scene,kind,fraction,right_windows,robust,plain,robust_converged,plain_converged"

# Array, K, T, standard deviation in Hz, box, range of the states, range of wrong shifts in Hz.
SCENES = {
    "road": (
        RadarArray([[0, 0, 0]]), 150, 0.04, 5.0,
        ([-100, 0.5, 0, 3, 0, 0], [0, 15, 0, 30, 0, 0]),
        ([-40, 2, 0, 8, 0, 0], [-20, 6, 0, 15, 0, 0]), 2500.0,
    ),
    "ring": (
        RadarArray.ring(6, 0.2), 20, 0.02, 0.4,
        ([0.1, -0.75, -0.75, -2, -2, -2], [1.5, 0.75, 0.75, 2, 2, 2]),
        ([0.6, -0.3, -0.3, -1, -0.4, -0.4], [1.2, 0.3, 0.3, -0.3, 0.4, 0.4]), 300.0,
    ),
}  # fmt: skip


def parts():
    """Return scene, kind and fraction, and their runs: chunks of so many."""
    first = PARAMETERS["fractions"][0]
    return [
        (
            {"scene": scene, "kind": kind, "fraction": fraction},
            PARAMETERS["chunks"] * PARAMETERS[f"{scene}_runs"],
            PARAMETERS[f"{scene}_runs"],
        )
        for scene, kind, fraction in product(SCENES, KINDS, PARAMETERS["fractions"])
        if fraction > first or kind == KINDS[0]  # without wrong windows there is one kind
    ]


def compute(settings, seed, runs):
    """Return errors and convergence of some runs: each chunk has a seed, each run its child."""
    scene, kind, fraction = (settings[name] for name in ("scene", "kind", "fraction"))
    places, size = numbers(scene, kind, fraction), PARAMETERS[f"{scene}_runs"]
    children = [
        np.random.SeedSequence([seed, *places, run // size], spawn_key=(run % size,))
        for run in runs
    ]
    found = [outcome(scene, kind, fraction, np.random.default_rng(one)) for one in children]
    return {"outcome": np.array(found)}


def numbers(scene, kind, fraction):
    """Return the numbers of a part, which are part of its seeds."""
    return list(SCENES).index(scene), KINDS.index(kind), round(100 * fraction)


def outcome(scene, kind, fraction, rng):
    """Return position errors in m of three fits to one record, and whether two have converged."""
    array, _, T, sigma_f, box, states, _ = SCENES[scene]
    x = rng.uniform(*states)
    z, wrong = record(scene, x, kind, fraction, rng)
    plain = ml_initialize(z, array, sigma_f, T, box, workers=1)
    right = ml_initialize(np.where(wrong, np.nan, z), array, sigma_f, T, box, workers=1)
    robust = ml_initialize(z, array, sigma_f, T, box, loss="bisquare", rng=rng, workers=1)
    # What one module beside a road measures of the place is the miss distance.
    part = slice(1, 2) if scene == "road" else slice(3)
    errors = (np.linalg.norm(fit.x[part] - x[part]) for fit in (right, robust, plain))
    return [*errors, robust.converged, plain.converged]


def record(scene, x, kind, fraction, rng):
    """Return the shifts (K, N) of a target, and which of them are wrong.

    Of the ring any shift may be wrong. The steady line beside the road is seen for a while on end.
    """
    array, K, T, sigma_f, _, states, far = SCENES[scene]
    shape = K, len(array)

    def seen(x):
        path = np.tile(x, (K, 1))
        path[:, :3] += T * np.arange(K)[:, None] * path[:, 3:]
        return doppler_shift(path, array) + sigma_f * rng.standard_normal(shape)

    z, wrong = seen(x), np.zeros(K * len(array), bool)
    count = round(fraction * wrong.size)
    if kind == "line" and scene == "road":
        wrong[rng.integers(wrong.size - count + 1) + np.arange(count)] = True
    else:
        wrong[rng.choice(wrong.size, count, replace=False)] = True
    wrong = wrong.reshape(shape)
    if kind == "scattered":
        other = rng.uniform(-far, far, shape)
    elif kind == "line":
        other = rng.uniform(-far, far) + sigma_f * rng.standard_normal(shape)
    else:
        other = seen(rng.uniform(*states))
    return np.where(wrong, other, z), wrong


def contents(found):
    """Return a line for each run."""
    lines = [COLUMNS]
    for (settings, *_), part in zip(parts(), found, strict=True):
        scene, kind, _ = numbers(**settings)
        head = f"{scene},{kind},{settings['fraction']}"
        for *errors, robust, plain in part["outcome"]:
            values = ",".join(f"{error:.4g}" for error in errors)
            lines.append(f"{head},{values},{robust:.0f},{plain:.0f}")
    return ["\n".join(lines) + "\n"]
