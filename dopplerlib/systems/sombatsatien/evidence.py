"""Evidence for every claim of the report that can be checked."""

import numpy as np

from ..._hints import Runs, checked
from ...evaluation.consistency import chi2_interval
from ...evaluation.intervals import proportion_interval, quantile_interval
from ...model.doppler import doppler_jacobian
from ...replication.evidence import Draws, Readings
from .. import mittermaier2016
from .diagnosis import final_bound
from .published import reported
from .student_filter import student_jacobian
from .variants import post_mortem, reported_record

AXES = "xyz"


@checked
def evidence(*, rng: np.random.Generator, runs: Runs = 400) -> dict[str, object]:
    """Collect the evidence for ``data/sombatsatien/claims.toml``.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    runs : int
        Number of records. With 300 or fewer not even a number outside all of them is decided.

    Returns
    -------
    dict
        By the id of the claim; see `judge_all`.

    Raises
    ------
    ValueError
        If `rng` is not a generator, or `runs` is not a positive whole number.
    """
    paper, s = mittermaier2016.reported().scenario, reported().scenario
    as_reported = post_mortem(runs, rng=rng)
    sign = post_mortem(100, rng=rng, jacobian="derived")
    repaired = post_mortem(runs, rng=rng, jacobian="derived", plane="x", start="long")
    return {
        **_setting(paper, s, as_reported),
        **_outcome(as_reported),
        **_rerun(rng),
        **_conclusions(s, as_reported, sign, repaired),
    }


def _setting(paper, s, result):
    H, true_H = student_jacobian(s.x0, s.array), doppler_jacobian(s.x0, s.array)
    ratio = np.sum(H * true_H, axis=0) / np.sum(true_H**2, axis=0)
    normal = np.linalg.svd(s.array.positions)[2][2]
    return {
        "sigma-p": paper.sigma_a,
        "sigma-f": paper.sigma_f,
        "interval": paper.T,
        "ring-plane": np.abs(normal),
        "jacobian": ratio,
        "tracked": len(result.time),
        "final-true-x": s.truth[-1, 0],
        "nearest": float(s.truth[-1, 0]),
    }


def _outcome(result):
    final = result.track.x[:, -1]
    start_error = np.linalg.norm((result.start - result.true_start)[:, :3], axis=-1)
    late = quantile_interval(result.position_error[:, len(result.time) // 2 :].mean(axis=-1))
    return {
        **{f"start-{c}": Draws(result.start[:, i]) for i, c in enumerate(AXES)},
        **{f"start-v{c}": Draws(result.start[:, 3 + i]) for i, c in enumerate(AXES)},
        "position-rmse": Draws(result.position_rmse),
        "velocity-rmse": Draws(result.velocity_rmse),
        "final-x": Draws(final[:, 0]),
        "final-error": Draws(result.position_error[:, -1]),
        **{f"final-v{c}": Draws(final[:, 3 + i]) for i, c in enumerate(AXES)},
        "initial-error": Readings(
            {
                "error of the start": Draws(start_error),
                "error after 50 samples": Draws(result.position_error[:, 49]),
            }
        ),
        "settled-above": late,
        "settled-below": late,
        "behind": proportion_interval(final[:, 0] < 0),
    }


def _rerun(rng):
    """Return the report's own run, from 100 starts within the rounding of the printed one."""
    start = reported().start.estimate + rng.uniform(-5e-5, 5e-5, (100, 6))
    z = np.repeat(reported_record()[None], 100, axis=0)
    result = post_mortem(100, rng=None, z=z, start=start)
    return {
        "rerun-position-rmse": Draws(result.position_rmse),
        "rerun-velocity-rmse": Draws(result.velocity_rmse),
        "rerun-final-x": Draws(result.track.x[:, -1, 0]),
        "rerun-final-error": Draws(result.position_error[:, -1]),
    }


def _conclusions(s, result, sign, repaired):
    start_error = np.linalg.norm((result.start - result.true_start)[:, :3], axis=-1)
    final_error = quantile_interval(repaired.position_error[:, -1])
    upper = chi2_interval(len(s.array), len(result.time), 0.999)[1]
    return {
        "ambiguity": proportion_interval(np.sign(result.start[:, 2]) != np.sign(s.x0[2])),
        "start-sufficient": proportion_interval(sign.position_error[:, -1] < 0.01),
        "stable": quantile_interval(result.position_error[:, -1] / start_error),
        "consistent": quantile_interval(result.track.nis.mean(axis=-1) / upper),
        "centimeter": quantile_interval(np.abs(result.track.x[:, -1, 0] - result.truth[-1, 0])),
        "limit": final_error,
        "limit-bound": final_bound("x"),
        "approaching": proportion_interval(repaired.track.x[:, -1, 3] < 0),
    }
