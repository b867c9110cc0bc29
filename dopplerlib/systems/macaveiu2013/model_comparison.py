"""Filters and smoothers on the same records, each over the range of its free constant.

``make study NAME=model_errors`` compares them; what it found is in ``results`` and read here.
"""

from functools import partial

import numpy as np

from ..._data import read_json, results
from ..._hints import Runs, checked
from ..._typing import FloatArray
from .linear_filter import filter_vehicle, measure_vehicle
from .motion_models import rms_of_runs, smooth_vehicle, track_accelerating, track_two_models
from .published import KMH
from .settings import automotive_settings
from .truth import hard_turn, vehicle_paths

# Each competitor gets its constant by a rule or over a range, and the ranges do not depend on what
# comes out: velocity steps from half the acceleration of Fig 10 to that of a car that brakes, times
# T; a jerk that changes the acceleration in 19 s by a tenth of that of Fig 10, up to that of the
# hard turn; an agile model by the rule a_max T, or half of it; a change of model every 1, 4, 38 s.
STEPS = (0.003, 0.01, 0.03, 0.1)  # m/s
JERKS = (1e-5, 1e-4, 1e-3, 1e-2, 0.1)  # m^2/s^5
AGILE = (0.028, 0.055)  # m/s
STAYS = (0.962, 0.99, 0.999)
_TURN = 10 * KMH * (np.pi / 2) / 3  # m/s^2: acceleration of the hard turn


@checked
def model_errors(runs: Runs, *, rng: np.random.Generator) -> dict[str, dict[str, FloatArray]]:
    """Return velocity errors of filters of several models, and of the smoother.

    runs: Number of independent records of each path.
    rng: Source of the measurement noise; all competitors see the same records.
    Returns (runs,): Root mean square error in m/s by the case ("Fig 7", "Fig 10", "Fig 11", "in the
        turn", "before it") and the competitor with its constant; of two models the agile step and
        the probability to stay.

    Examples
    --------
    >>> found = model_errors(1, rng=np.random.default_rng(1))
    >>> len(found["Fig 10"]), len(found)
    (20, 5)
    """
    s, (hard, turning) = automotive_settings(), hard_turn()
    settled = np.arange(s.samples) >= s.skip
    paths = {f"Fig {i}": path for i, path in vehicle_paths().items() if i in (7, 10, 11)}
    paths["hard"] = hard
    cases = {name: [(name, settled)] for name in paths}
    cases["hard"] = [("in the turn", turning), ("before it", settled & (s.time < 8))]
    children = zip(paths.values(), rng.spawn(len(paths)), strict=True)
    z = np.concatenate([measure_vehicle(path.truth, runs, rng=child) for path, child in children])
    found: dict[str, dict[str, FloatArray]] = {
        case: {} for each in cases.values() for case, _ in each
    }
    for competitor, estimate in _competitors(s).items():
        x = np.split(estimate(z), len(paths))  # at once: a step of a filter costs more than a run
        for (name, path), estimates in zip(paths.items(), x, strict=True):
            for case, where in cases[name]:
                error = rms_of_runs(estimates, path.truth, where, "velocity")
                found[case][competitor] = error
    return found


def saved_model_errors() -> dict[str, dict[str, FloatArray]]:
    """Return `model_errors` of 60 runs, to five decimals, as the study saved them.

    Examples
    --------
    >>> saved_model_errors()["Fig 10"]["measurement"].shape
    (60,)
    """
    stored = read_json("model_errors.json", folder=results)
    return {
        case: {name: np.array(errors) for name, errors in row.items()}
        for case, row in stored.items()
    }


def _competitors(s):
    """Return a function from measurements to estimates for each competitor."""
    made = {f"filter {w:g}": partial(filter_vehicle, s=s.with_(w=w)) for w in STEPS}
    for q in JERKS:
        made[f"acceleration {q:g}"] = partial(track_accelerating, q=q, a_max=_TURN)
    for w in AGILE:
        for stay in STAYS:
            made[f"IMM {w:g} / {stay:g}"] = partial(_mixed, w=w, stay=stay)
    for w in STEPS:
        made[f"smoother {w:g}"] = partial(_smoothed, s=s.with_(w=w))
    return made | {"measurement": lambda z: z}


def _mixed(z, w, stay):
    return track_two_models(z, (automotive_settings().w, w), stay=stay)[0]


def _smoothed(z, s):
    return smooth_vehicle(z, s)[1]
