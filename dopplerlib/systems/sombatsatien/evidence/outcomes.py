"""Evidence on the report's run: its system in many runs, and that run again.

Arguments are not checked.
"""

import numpy as np

from ....evaluation.consistency import chi2_interval
from ....evaluation.intervals import (
    ConfidenceInterval,
    proportion_interval,
    quantile_interval,
    rms_interval,
)
from ....replication.documents import read_document
from ....replication.evidence import Draws, sweep
from ..published import reported
from ..variants import PostMortem, post_mortem, reported_record

_COMPONENTS = ("x", "y", "z", "vx", "vy", "vz")


def outcomes_evidence(
    result: PostMortem, misfit: np.ndarray, *, rng: np.random.Generator
) -> dict[str, object]:
    """Return the evidence from runs of the report's system as it is.

    result: The runs.
    misfit (runs,): What the search for their starts left, see `local_start`.
    rng: Source of starts within the rounding of the published one.
    Returns: By the id of the claim.
    """
    axes = read_document("sombatsatien").choice
    return {
        **of_one_run(result),
        **_rerun(rng),
        "optimizer": sweep(
            axes("run"),
            lambda run: _run(unexplained(misfit), run),
        ),
        "numerical": sweep(axes("run"), lambda run: _run(positivity(result), run, "small")),
        "initial-error": sweep(
            axes("initial"), lambda initial: Draws(initial_error(result, initial))
        ),
        "decreases": sweep(
            axes("initial", "settled", "run"),
            lambda initial, settled, run: _run(
                settled_error(result, settled) / initial_error(result, initial), run
            ),
        ),
        "settled-above": sweep(
            axes("settled", "run"),
            lambda settled, run: _run(settled_error(result, settled), run, "small"),
        ),
        "settled-below": sweep(
            axes("settled", "run"), lambda settled, run: _run(settled_error(result, settled), run)
        ),
        "no-divergence": sweep(
            axes("windows", "run"), lambda windows, run: _run(growth(result, windows), run)
        ),
        "consistent": sweep(
            axes("consistent", "confidence", "windows", "run"),
            lambda *choices: _consistent(result, *choices),
        ),
        "shape": sweep(
            axes("shape", "run"), lambda shape, run: _run(likeness(result, shape), run, "small")
        ),
        **sweep(
            axes("when", "statistic"),
            lambda when, statistic: dict.fromkeys(
                ("centimeter", "range-lost"), summary(x_error(result, when), statistic)
            ),
        ),
    }


def of_one_run(result: PostMortem) -> dict[str, object]:
    """Return the quantities that the report prints of its run, in many, and the share behind."""
    final = result.track.x[:, -1]
    return {
        **{f"start-{c}": Draws(result.start[:, i]) for i, c in enumerate(_COMPONENTS)},
        "position-rmse": Draws(result.position_rmse),
        "velocity-rmse": Draws(result.velocity_rmse),
        "final-x": Draws(final[:, 0]),
        "final-error": Draws(result.position_error[:, -1]),
        **{f"final-{c}": Draws(final[:, i]) for i, c in enumerate(_COMPONENTS) if i >= 3},
        "behind": proportion_interval(final[:, 0] < 0),
    }


def _rerun(rng):
    """Return the report's own run, from 100 starts within the rounding of the published one."""
    start = reported().start.estimate + rng.uniform(-5e-5, 5e-5, (100, 6))
    z = np.repeat(reported_record()[None], 100, axis=0)
    result = post_mortem(100, rng=None, z=z, start=start)
    return {
        "rerun-position-rmse": Draws(result.position_rmse),
        "rerun-velocity-rmse": Draws(result.velocity_rmse),
        "rerun-final-x": Draws(result.track.x[:, -1, 0]),
        "rerun-final-error": Draws(result.position_error[:, -1]),
    }


def _run(values, run, worst="large"):
    """Return a quantity of the run that stands for the report's, with its interval."""
    if run == "the median":
        return quantile_interval(values)
    return quantile_interval(values, 0.9 if worst == "large" else 0.1)


def summary(errors: np.ndarray, statistic: str) -> ConfidenceInterval:
    """Return the number that stands for the errors of many runs, with its interval.

    A mean square of few runs may be anything, since one more of them can be far off. But half of
    the errors are above the median, so its root is not below the median over the root of two, and
    an interval of twice the width, by which verdicts are found, ends there.
    """
    if statistic == "root mean square":
        rms, half = rms_interval(errors), quantile_interval(errors)
        least = (2 * half.low - half.value) / np.sqrt(2)
        return ConfidenceInterval(rms.value, max(rms.low, (rms.value + least) / 2), rms.high)
    return quantile_interval(errors, {"median": 0.5, "nine in ten": 0.9}[statistic])


def unexplained(misfit: np.ndarray) -> np.ndarray:
    """Return the residual that each search left over the noise of the average, both rms."""
    s, samples = reported().scenario, reported().start.samples
    return np.sqrt(misfit / len(s.array)) / (s.sigma_f / np.sqrt(samples))


def positivity(result: PostMortem) -> np.ndarray:
    """Return the least eigenvalue of the covariance of each run over what rounding can change.

    Rounding changes an eigenvalue by about the largest one times the machine's epsilon, or by what
    it made the matrix asymmetric. At every tenth sample.
    """
    P = result.track.P[:, ::10]
    values = np.linalg.eigvalsh((P + P.mT) / 2)
    rounding = np.finfo(float).eps * values[..., -1] + np.abs(P - P.mT).max(axis=(-2, -1))
    return (values[..., 0] / rounding).min(axis=1)


def initial_error(result: PostMortem, initial: str) -> np.ndarray:
    """Return the position error of each run at its beginning, in m."""
    if initial == "estimate of the start":
        return np.linalg.norm((result.start - result.true_start)[:, :3], axis=-1)
    if initial == "largest in the first 100 ms":
        return result.position_error[:, :100].max(axis=1)
    sample = {"first tracked sample": 0, "after 10 ms": 9, "after 50 ms": 49}[initial]
    return result.position_error[:, sample]


def settled_error(result: PostMortem, settled: str) -> np.ndarray:
    """Return the mean position error of each run over the part that has settled, in m."""
    K = len(result.time)
    part = {"second half": K // 2, "last quarter": K // 4, "last tenth": K // 10, "last sample": 1}
    return result.position_error[:, -part[settled] :].mean(axis=1)


def growth(result: PostMortem, share: float) -> np.ndarray:
    """Return the mean error of each run in the last part over that in the part before."""
    n = int(share * len(result.time))
    error = result.position_error
    return error[:, -n:].mean(axis=1) / error[:, -2 * n : -n].mean(axis=1)


def _consistent(result, consistent, confidence, windows, run):
    if consistent == "performance, throughout the record":
        return _run(growth(result, windows), run)
    n, K = result.track.innovation.shape[-1], len(result.time)
    upper = chi2_interval(n, K, confidence)[1]
    return _run(result.track.nis.mean(axis=-1) / upper, run)


def likeness(result: PostMortem, shape: str) -> np.ndarray:
    """Return the likeness of the estimated path of each run to the true one; 1 is the most."""
    path, truth = result.track.x[..., :3], result.truth[:, :3]
    if shape == "direction from beginning to end":
        way, true_way = path[:, -1] - path[:, 0], truth[-1] - truth[0]
        return way @ true_way / (np.linalg.norm(way, axis=-1) * np.linalg.norm(true_way))
    if shape == "direction of every tenth of a second":
        way, true_way = np.diff(path[:, ::100], axis=1), np.diff(truth[::100], axis=0)
        return (np.sum(way * true_way, axis=-1) > 0).mean(axis=1)
    offset = path - truth
    left = np.sum((offset - offset.mean(axis=1, keepdims=True)) ** 2, axis=(1, 2))
    return 1 - left / np.sum((truth - truth.mean(axis=0)) ** 2)


def x_error(result: PostMortem, when: str) -> np.ndarray:
    """Return the error of the distance x of each run, in m."""
    error = np.abs(result.track.x[..., 0] - result.truth[:, 0])
    return error[:, -1] if when == "at the end" else np.sqrt(np.mean(error**2, axis=1))
