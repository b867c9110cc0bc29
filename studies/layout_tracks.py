"""Layouts of sensors side by side: bounds, second valleys, exact solutions, and the tracker.

Twelve minutes on one processor. Targets are others than those over which layouts were searched.
"""

import numpy as np

from dopplerlib import RadarArray
from dopplerlib.evaluation.monte_carlo import skip_runs
from dopplerlib.evaluation.observability import observable_rank
from dopplerlib.workspace._layout_tracks import track_layout
from dopplerlib.workspace._solutions import same_shifts
from dopplerlib.workspace.layout_results import saved_arrays
from dopplerlib.workspace.layouts import layout_quality, named_layouts
from dopplerlib.workspace.targets import INTERVAL, TABLE_2, draw_targets
from studies._rows import by_kind, rows, texts

FILES = (".json",)
PARAMETERS = {
    "seed": 2017,
    "seed_tracks": 7127,  # of runs that no choice was made with
    "targets": 1000,  # of bounds and second valleys
    "targets_lost": 300,  # with a sensor lost
    "cases": [["A", 5, 100], ["T", 8, 50]],  # chunks, and runs of each
    "starts": 16,  # of the search for exact solutions
    "truths": 5,  # of that search, beside Table 2
    "map_x": [0.4, 0.6, 0.8, 1.0, 1.2],
    "map_y": [0.0, 0.1, 0.2, 0.3, 0.4, 0.5],
    "velocities": 40,  # of a map, at each place
}
LOSING = (
    "ring of six", "one moved to the center", "five and the center",
    "five and the center, two set back", "one in the center, two set back",
    "seven, 5 cm deep, best bound",
)  # fmt: skip
MAPPED = (
    "ring of six", "five and the center", "five and the center, two set back",
    "seven, 5 cm deep, best bound",
)  # fmt: skip
COUNTED = ("three", "four", "five", "six", "seven", "six, 5 cm deep", "ring of six")
MOVING = "three", "four", "six", "ring of six"  # of them, those along a path


def parts():
    """Return the one part, of which each run is an item; it depends on the layouts of a study."""
    places = {name: array.positions.tolist() for name, array in saved_arrays().items()}
    return [({"layouts": places}, len(items()), 1)]


def items():
    """Return kind of work, layout, and what else it is about."""
    sizes = {name: len(array) for name, array in saved_arrays().items()}
    lost = [(name, n) for name in LOSING for n in range(sizes[name])]
    work = [("quality", name, None) for name in sizes]
    paths = [(name, motion) for name in COUNTED for motion in (False, True)]
    chunks = [(case, c) for case, many, _ in PARAMETERS["cases"] for c in range(many)]
    work += [("track", name, None, *chunk) for name in sizes for chunk in chunks]
    work += [("map", name) for name in MAPPED]
    work += [("solutions", *path) for path in paths if path[1] is False or path[0] in MOVING]
    work += [("quality", name, n) for name, n in lost]
    work += [("track", name, n, "A", 0) for name, n in lost]
    return work


def compute(settings, seed, runs):
    """Return the numbers of some items."""
    work = items()
    return texts(row(*work[run]) for run in runs)


def row(kind, name, *how):
    """Return the numbers of an item."""
    one = {"kind": kind, "layout": name}
    if kind == "solutions":
        return one | {"motion": how[0]} | _solutions(name, *how)
    array = saved_arrays()[name]
    if kind != "map" and how[0] is not None:
        one["without"] = how[0]
        array = RadarArray(np.delete(array.positions, how[0], axis=0))
    if kind == "quality":
        return one | _quality(array, "without" in one)
    if kind == "map":
        return one | _map(array)
    return one | {"case": how[1], "chunk": how[2]} | _track(array, *how[1:])


def contents(found):
    """Return all rows by their kind, a line for each."""
    return [by_kind(rows(*found))]


def _start(path):
    return path - INTERVAL * np.pad(path[..., 3:], [(0, 0)] * (path.ndim - 1) + [(0, 3)])


def _targets(count):
    """Return states (R, 6) at time zero, and Table 2 turned about the axis in eight steps."""
    rng = np.random.default_rng(PARAMETERS["seed"])
    drawn = _start(draw_targets(count, rng=rng, sigma_a=0.0, samples=1)[:, 0])
    return drawn, np.stack([_turned(TABLE_2, angle) for angle in np.pi / 4 * np.arange(8)])


def _turned(x, angle):
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    return np.concatenate([turn @ x[:3], turn @ x[3:]])


def _quality(array, lost):
    """Return mean square, geometric mean and 95 % quantile of bounds in mm, and mean chances."""
    found = {}
    both = _targets(PARAMETERS["targets_lost" if lost else "targets"])
    for name, x in zip(("workspace", "Table 2"), both, strict=True):
        quality = layout_quality(x, array)
        part = {}
        for key in ("static", "moving", "range"):
            bound = 1e3 * getattr(quality, key)
            numbers = (
                np.exp(np.mean(np.log(bound))), np.sqrt(np.mean(bound**2)), np.quantile(bound, 0.95)
            )  # fmt: skip
            part[key] = [round(float(number), 2) for number in numbers]
        for key in ("early", "late"):
            chance = getattr(quality, key)
            error = chance.std() / np.sqrt(len(chance))
            part[key] = [round(float(chance.mean()), 5), round(float(error), 5)]
        found[name] = part
    return found


def _track(array, case, chunk):
    """Return sums over runs, at four times, of squares and of what counts."""
    runs = next(runs for name, _, runs in PARAMETERS["cases"] if name == case)
    streams = np.random.default_rng(PARAMETERS["seed_tracks"]).spawn(2)
    truths, noise = (skip_runs(rng, chunk * runs) for rng in streams)
    x0 = _turned(TABLE_2, chunk * np.pi / 4) if case == "T" else None
    found = track_layout(array, runs, truths=truths, noise=noise, x0=x0)
    position, away, nees = (1e3 * found.position) ** 2, (1e3 * found.range) ** 2, found.nees
    values = {
        "position": position, "position2": position**2, "range": away, "range2": away**2,
        "bound": (1e3 * found.bound) ** 2, "nees": nees, "nees2": nees**2,
        "wrong": found.wrong > 0.5, "lost": found.lost,
    }  # fmt: skip
    there = ~np.isnan(found.position)
    sums = {k: np.where(there, value, 0).sum(axis=0) for k, value in values.items()}
    digits = {k: [float(f"{one:.6g}") for one in each] for k, each in sums.items()}
    return {"n": there.sum(axis=0).tolist(), **digits}


def _map(array):
    """Return, over places in the plane z = 0, bounds in mm and chances, mean over velocities."""
    where = [np.array(PARAMETERS[f"map_{axis}"]) for axis in "xy"]
    rng = np.random.default_rng([PARAMETERS["seed"], 2])
    v = np.array([-0.75, 0, 0]) + 0.25 * rng.standard_normal((PARAMETERS["velocities"], 3))
    x = np.zeros((len(where[1]), len(where[0]), len(v), 6))
    x[..., 0], x[..., 1] = (each[..., None] for each in np.meshgrid(*where))
    x[..., 3:] = v
    quality = layout_quality(x.reshape(-1, 6), array)
    moving, early = (each.reshape(x.shape[:3]) for each in (quality.moving, quality.early))
    bound = 1e3 * np.exp(np.mean(np.log(moving), axis=-1))
    return {"bound": bound.round(2).tolist(), "early": early.mean(axis=-1).round(5).tolist()}


def _solutions(name, motion):
    """Return ranks of the derivatives, and numbers of exact solutions, for a few targets."""
    rng = np.random.default_rng([PARAMETERS["seed"], COUNTED.index(name)])
    n = 3 + min(COUNTED.index(name), 4)
    if name.startswith("ring") or "deep" in name:
        n = 6
    r, angle, depth = 0.2 * np.sqrt(rng.random(n)), 2 * np.pi * rng.random(n), rng.random(n)
    places = [0.05 * depth * ("deep" in name), r * np.cos(angle), r * np.sin(angle)]
    array = named_layouts().get(name) or RadarArray(np.stack(places, axis=-1) * [-1, 1, 1])
    time = [0.0, 0.1, 0.2] if motion else [0.0]
    truths = np.concatenate([TABLE_2[None], _targets(PARAMETERS["truths"])[0]])
    counts, ranks = [], []
    for x in truths:
        K = 200 if motion else 1
        like = "constant_velocity" if motion else "stationary"
        ranks.append(int(observable_rank(x, array, K, INTERVAL, like)))
        if ranks[-1] < 6:
            counts.append(None)
            continue
        found = same_shifts(x, array, time, rng=rng, starts=PARAMETERS["starts"])
        counts.append(len(found))
    return {"sensors": n, "ranks": ranks, "counts": counts}
