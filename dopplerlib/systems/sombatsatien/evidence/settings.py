"""Evidence on formulas, ring, noise and path of the report, and on the state they determine.

Arguments are not checked.
"""

import numpy as np

from ...._typing import FloatArray
from ....evaluation.bounds import crlb
from ....model.doppler import doppler_jacobian, doppler_shift
from ....model.motion import constant_velocity
from ....model.radar_array import RadarArray
from ....replication.documents import read_document
from ....replication.evidence import sweep
from ... import mittermaier2016
from ..diagnosis import final_bound
from ..published import reported
from ..student_filter import student_jacobian
from ..variants import ring_scenario


def settings_evidence() -> dict[str, object]:
    """Return the evidence that needs no noise.

    Returns: By the id of the claim.
    """
    axes = read_document("sombatsatien").choice
    paper, s = mittermaier2016.reported().scenario, reported().scenario
    H, true_H = student_jacobian(s.x0, s.array), doppler_jacobian(s.x0, s.array)
    return {
        "sigma-p": paper.sigma_a,
        "sigma-f": paper.sigma_f,
        "interval": paper.T,
        "ring": sweep(axes("setup"), lambda setup: _mismatch(setup, s.array, paper.array)),
        "h": formula(s.x0, s.array) / doppler_shift(s.x0, s.array),
        "cone": along_a_cone(s.x0, s.array),
        "jacobian": np.sum(H * true_H, axis=0) / np.sum(true_H**2, axis=0),
        "tracked": s.samples - reported().start.samples,
        "final-true-x": s.truth[-1, 0],
        "nearest": float(np.abs(s.truth[:, 0]).min()),
        "sensors": sweep(axes("samples"), lambda samples: float(determined(samples))),
        "range-poor": sweep(axes("ring", "samples"), range_bound),
        "limit-bound": sweep(axes("ring"), final_bound),
    }


def formula(x: FloatArray, array: RadarArray) -> FloatArray:
    """Return the Doppler shifts as the formula of the report's Section 2 gives them, in Hz."""
    line = array.positions - x[:3]
    return array.doppler_per_speed * (line @ x[3:]) / np.linalg.norm(line, axis=1)


def along_a_cone(x: FloatArray, array: RadarArray) -> FloatArray:
    """Return the least and the largest shift on the cone through a target, over that of it.

    The cone has its apex at the first sensor and the velocity as its axis; all its points move
    with the same velocity.
    """
    apex, velocity = array.positions[0], x[3:]
    axis = velocity / np.linalg.norm(velocity)
    line = x[:3] - apex
    across = line - (line @ axis) * axis
    other = np.cross(axis, across)
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)[:, None]
    around = (line @ axis) * axis + np.cos(angle) * across + np.sin(angle) * other
    places = apex + np.array([0.5, 1, 2])[:, None, None] * around
    states = np.concatenate([places, np.broadcast_to(velocity, places.shape)], axis=-1)
    ratio = doppler_shift(states, array)[..., 0] / doppler_shift(x, array)[0]
    return np.array([ratio.min(), ratio.max()])


def _mismatch(setup, array, other):
    """Return the largest difference of two rings, in shape or in place, in m."""
    ours, theirs = array.positions, other.positions
    if setup == "its shape":
        between = [np.linalg.norm(p[:, None] - p, axis=-1).ravel() for p in (ours, theirs)]
        return float(np.abs(np.sort(between[0]) - np.sort(between[1])).max())
    return float(np.linalg.norm(ours[:, None] - theirs, axis=-1).min(axis=1).max())


def _count(samples):
    """Return the number of samples of that name."""
    counts = {
        "one sample": 1,
        "ten samples": reported().start.samples,
        "the record": reported().scenario.samples,
    }
    return counts[samples]


def determined(samples: str) -> int:
    """Return the number of unknowns, of six, that one sensor determines by so many samples."""
    s, n = reported().scenario, _count(samples)
    H = doppler_jacobian(s.truth[:n], s.array)[:, 0]
    H[:, 3:] += s.time[:n, None] * H[:, :3]  # by the state at the first sample
    return int(np.linalg.matrix_rank(H / np.linalg.norm(H, axis=0), tol=1e-9))


def range_bound(plane: str, samples: str) -> float:
    """Return the least standard deviation of x at the last of so many samples, in m.

    Where it is infinite, the width of the box in which the report searches.
    """
    s, n, settings = ring_scenario(plane), _count(samples), reported().start
    P = crlb(s.x0, s.array, s.sigma_f, n, s.T, "constant_velocity")
    if not np.isfinite(P).all():
        return float(settings.upper[0] - settings.lower[0])
    F, _ = constant_velocity((n - 1) * s.T, s.sigma_a)
    return float(np.sqrt((F @ P @ F.T)[0, 0]))
