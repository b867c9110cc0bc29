"""Measures of the runs of a variant, and their bounds."""

from dataclasses import replace

import numpy as np

from ..._hints import States, checked
from ..._typing import BoolArray, FloatArray
from ...evaluation.bounds import crlb
from ...evaluation.consistency import nees
from ...model.motion import constant_velocity
from ...model.twin import planar_twin
from .published import reported
from .variants import Plane, PostMortem, ring_scenario


@checked
def nearer_to_twin(result: PostMortem) -> BoolArray:
    """Return which runs started nearer to the twin of the true state than to the state itself.

    result: Runs with the ring in the plane x = 0; see `planar_twin`.
    Returns (runs,)

    Examples
    --------
    >>> from dopplerlib.systems.sombatsatien import consistent_runs
    >>> result = consistent_runs(2, rng=np.random.default_rng(1))
    >>> nearer_to_twin(result).tolist()
    [False, False]
    """
    distance = [
        np.linalg.norm((result.start - x)[:, :3], axis=-1)
        for x in (planar_twin(result.true_start), result.true_start)
    ]
    return distance[0] < distance[1]


@checked
def final_bound(plane: Plane) -> float:
    """Return the least root mean square error of the final position, given the whole record.

    plane: Plane of the ring.
    Returns: In m: the Cramér-Rao bound for a target at constant velocity.

    Examples
    --------
    >>> round(1e3 * final_bound("x"), 2)  # mm
    0.21
    """
    s = ring_scenario(plane)
    P = crlb(s.x0, s.array, s.sigma_f, s.samples, s.T, "constant_velocity")
    F, _ = constant_velocity((s.samples - 1) * s.T, s.sigma_a)
    return float(np.sqrt(np.trace((F @ P @ F.T)[:3, :3])))


@checked
def measures(result: PostMortem) -> dict[str, FloatArray]:
    """Return four numbers for each run: two of error, two of consistency.

    result: Runs of one variant.
    Returns (runs,): By name and unit.

    Examples
    --------
    >>> from dopplerlib.systems.sombatsatien import consistent_runs
    >>> list(measures(consistent_runs(1, rng=np.random.default_rng(1))))
    ['position RMSE (m)', 'final error (m)', 'average NIS', 'final NEES']
    """
    last = replace(result.track, x=result.track.x[:, -1:], P=result.track.P[:, -1:])
    return {
        "position RMSE (m)": result.position_rmse,
        "final error (m)": result.position_error[:, -1],
        "average NIS": result.track.nis.mean(axis=-1),
        "final NEES": nees(last, result.truth[-1:])[:, 0],
    }


@checked
def outcomes(result: PostMortem) -> dict[str, FloatArray]:
    """Return the quantities that the report prints of its own run, for each of these runs.

    result: Runs of the report's system.
    Returns (runs,): By name and unit; `reported_outcomes` has the report's.

    Examples
    --------
    >>> from dopplerlib.systems.sombatsatien import consistent_runs
    >>> ours = outcomes(consistent_runs(1, rng=np.random.default_rng(1)))
    >>> ours.keys() == reported_outcomes().keys()
    True
    """
    final = result.track.x[:, -1]
    return {
        "position RMSE (m)": result.position_rmse,
        "velocity RMSE (m/s)": result.velocity_rmse,
        "final position error (m)": result.position_error[:, -1],
        "final x (m)": final[:, 0],
        **{f"final v_{c} (m/s)": final[:, 3 + i] for i, c in enumerate("xyz")},
    }


def reported_outcomes() -> dict[str, float]:
    """Return the results of the report under the names that `outcomes` uses for ours.

    Returns: By name and unit.
    """
    run = reported().run
    return {
        "position RMSE (m)": run.position_rmse,
        "velocity RMSE (m/s)": run.velocity_rmse,
        "final position error (m)": run.final_position_error,
        "final x (m)": run.final_x,
        **{f"final v_{c} (m/s)": float(v) for c, v in zip("xyz", run.final_velocity, strict=True)},
    }


@checked
def mirrored(x: States) -> FloatArray:
    """Return states mirrored at the plane z = 0: a ring in that plane sees no difference.

    x (..., 6): States in m and m/s.
    Returns (..., 6)

    Examples
    --------
    >>> mirrored([1, 2, 3, 4, 5, 6]).tolist()
    [1.0, 2.0, -3.0, 4.0, 5.0, -6.0]
    """
    return x * [1, 1, -1, 1, 1, -1]
