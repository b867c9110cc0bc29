"""Evidence on the conclusions of the report: starts, other filters, Doppler-only tracking.

Arguments are not checked.
"""

from functools import cache

import numpy as np

from ....estimation.linear_kalman import kf
from ....evaluation.intervals import mean_interval, proportion_interval, quantile_interval
from ....model.doppler import doppler_jacobian, doppler_shift
from ....model.motion import constant_velocity
from ....model.twin import planar_twin
from ....replication.documents import read_document
from ....replication.evidence import sweep
from ..descent import local_start
from ..diagnosis import mirrored
from ..published import reported
from ..variants import LONG, PostMortem, post_mortem, ring_scenario
from .outcomes import summary

TARGETS = "the target", "the target or its mirror image"


def conclusions_evidence(z: np.ndarray, as_reported: PostMortem) -> dict[str, object]:
    """Return the evidence from the repaired system, and from single repairs.

    z (runs, K, N): Measurements in Hz of the report's ring; the same noise serves for the paper's.
        Other starts take half of the runs, the repaired filter a third.
    as_reported: What the report's system made of them.
    Returns: By the id of the claim.
    """
    axes = read_document("sombatsatien").choice
    half, few, ten = max(len(z) // 2, 2), max(len(z) // 3, 2), reported().start.samples
    truth = reported().scenario.truth
    noise = z - doppler_shift(truth, reported().scenario.array)
    z = {plane: doppler_shift(truth, ring_scenario(plane).array) + noise for plane in "zx"}

    @cache
    def descent(plane, samples):
        if (plane, samples) == ("z", ten):
            return as_reported.start[:half]
        s, settings = ring_scenario(plane), reported().start
        box = settings.lower, settings.upper
        return local_start(z[plane][:half, :samples], s.array, settings.guess, box)[0]

    @cache
    def repaired(plane, start):
        if start == "report's":
            start = descent(plane, ten)[:few]
        return _repaired(plane, z[plane][:few], start)

    @cache
    def long(plane, samples):
        return _repaired(plane, z[plane][:few], "long", samples)

    @cache
    def linear(plane, tangent):
        return linear_error(plane, z[plane][:few], tangent)

    return {
        "ambiguity": sweep(
            axes("ring", "ambiguity"),
            lambda plane, what: (
                told_apart(plane, ten) - told_apart(plane, 1)
                if what == "which of two images"
                else quantile_interval(
                    start_error(plane, descent(plane, 1), 1)
                    - start_error(plane, descent(plane, ten), ten)
                )
            ),
        ),
        "start-sufficient": sweep(
            axes("convergence", "accuracy"),
            lambda to, accuracy: proportion_interval(
                final_distance(repaired("z", "report's"), to) < accuracy
            ),
        ),
        "start-critical": sweep(
            axes("ring", "accuracy"),
            lambda plane, accuracy: mean_interval(
                1.0 * (final_distance(repaired(plane, "truth")) < accuracy)
                - (final_distance(repaired(plane, "report's")) < accuracy)
            ),
        ),
        "linear": sweep(
            axes("ring", "tangent", "statistic"),
            lambda plane, tangent, statistic: summary(linear(plane, tangent), statistic),
        ),
        "limit": sweep(
            axes("ring", "start", "statistic"),
            lambda plane, samples, statistic: summary(
                final_distance(long(plane, samples)), statistic
            ),
        ),
        "feasible": sweep(
            axes("start", "accuracy"),
            lambda samples, accuracy: proportion_interval(
                final_distance(long("x", samples)) < accuracy
            ),
        ),
        "approaching": sweep(
            axes("filter", "approach", "start"),
            lambda which, approach, samples: proportion_interval(
                coming(as_reported if which == "as reported" else long("x", samples), approach)
            ),
        ),
    }


def _repaired(plane, z, start, samples=LONG):
    return post_mortem(
        len(z), rng=None, z=z, plane=plane, jacobian="derived", start=start, long=samples
    )


def told_apart(plane: str, samples: int) -> float:
    """Return the chi-square by which the average of the samples separates target and image."""
    s = ring_scenario(plane)
    image = mirrored(s.x0) if plane == "z" else planar_twin(s.x0)
    between = doppler_shift(image, s.array) - doppler_shift(s.x0, s.array)
    return float(samples * between @ between / s.sigma_f**2)


def start_error(plane: str, start: np.ndarray, samples: int) -> np.ndarray:
    """Return the position error of each start from so many samples, in m."""
    true = ring_scenario(plane).truth[samples - 1]
    return np.linalg.norm((start - true)[:, :3], axis=-1)


def final_distance(result: PostMortem, to: str = TARGETS[0]) -> np.ndarray:
    """Return the final position error of each run, or the distance to the nearer image, in m."""
    if to == TARGETS[0]:
        return result.position_error[:, -1]
    image = mirrored(result.truth[-1])[:3]
    to_image = np.linalg.norm(result.track.x[:, -1, :3] - image, axis=-1)
    return np.minimum(result.position_error[:, -1], to_image)


def linear_error(plane: str, z: np.ndarray, tangent: str) -> np.ndarray:
    """Return the final position error of a linear Kalman filter, its tangent taken once, in m."""
    s = ring_scenario(plane)
    place = s.truth[0 if tangent == "at the start" else s.samples // 2]
    H = doppler_jacobian(place, s.array)
    F, Q = constant_velocity(s.T, s.sigma_a)
    R = s.sigma_f**2 * np.eye(len(s.array))
    measured = z[:, 1:] - doppler_shift(place, s.array) + H @ place
    track = kf(measured, F, Q, H, R, s.truth[0], s.P0)
    return np.linalg.norm((track.x[:, -1] - s.truth[-1])[:, :3], axis=-1)


def coming(result: PostMortem, approach: str) -> np.ndarray:
    """Return in which runs the final estimate approaches, as the target does."""
    final = result.track.x[:, -1]
    if approach == "v_x":
        return final[:, 3] < 0
    return np.sum(final[:, :3] * final[:, 3:], axis=-1) < 0
