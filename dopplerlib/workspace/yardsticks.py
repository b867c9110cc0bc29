"""Yardsticks of trackers in front of the ring: the exact posterior, and bounds."""

from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._data import read_lines, results
from .._hints import Count, Index, checked, exactly, shaped, up_to
from .._records import record
from .._typing import FloatArray
from ..estimation import covariances
from ..estimation.importance_sampling import importance_posterior
from ..evaluation.bootstrap import bootstrap_interval
from ..evaluation.intervals import ConfidenceInterval
from ..evaluation.monte_carlo import skip_runs
from .comparison import CASES, EVERY, case_errors
from .targets import (
    ARRAY,
    INTERVAL,
    PRIOR_COVARIANCE,
    PRIOR_MEAN,
    SIGMA_F,
    draw_records,
    draw_targets,
)

SAMPLES = (20, 60, 100, 200, 300)  # of the records, when the posterior is computed

_Case = Literal["A", "B", "C", "D"]
_Errors = Annotated[FloatArray, _checks.numbers]
_Squared = Annotated[FloatArray, _checks.bounded]  # so that squares are finite


@checked
def posterior_errors(
    case: _Case,
    first: Index,
    runs: Count,
    *,
    seed: Index,
    draws: Annotated[int, up_to(10**6, least=100)] = 1000,
) -> FloatArray:
    """Return the errors of the exact posterior in some runs of one of the four cases.

    Parameters
    ----------
    case, first, runs, seed
        See `case_errors`, which gives the same records to trackers.
    draws : int
        Of the importance sampling.

    Returns
    -------
    ndarray, shape (4, runs, 5)
        Effective sample size as a fraction of the draws, NEES, sizes of the errors of position and
        velocity of the mean, in m and m/s; after the first 20, 60, 100, 200 and 300 samples. NaN
        where the record has ended.

    Examples
    --------
    >>> posterior_errors("D", 0, 1, seed=1, draws=200).shape
    (4, 1, 5)
    """
    sigma_a, x0 = CASES[case]
    streams = np.random.default_rng([seed, ord(case)]).spawn(2)  # as in `case_errors`
    truths, noise = (skip_runs(rng, first) for rng in streams)
    paths = draw_targets(runs, rng=truths, sigma_a=sigma_a, x0=x0, samples=SAMPLES[-1])
    z = draw_records(paths, rng=noise)
    found = np.full((4, runs, len(SAMPLES)), np.nan)
    for o, k in enumerate(SAMPLES):
        rng = skip_runs(np.random.default_rng([seed, ord(case), k]), first)
        posterior = importance_posterior(
            z[:, :k], ARRAY, PRIOR_MEAN, PRIOR_COVARIANCE, INTERVAL, sigma_a, SIGMA_F,
            rng=rng, draws=draws,
        )  # fmt: skip
        error = paths[:, k - 1] - posterior.x
        there = ~np.isnan(error[:, 0])
        error, claimed = error[there], posterior.P[there]
        found[:, there, o] = (
            posterior.efficiency[there],
            np.sum(error * covariances.solve(claimed, error[..., None])[..., 0], axis=-1),
            np.linalg.norm(error[:, :3], axis=-1),
            np.linalg.norm(error[:, 3:], axis=-1),
        )
    return found


@checked
def bank_errors(case: _Case, first: Index, runs: Count, *, seed: Index) -> FloatArray:
    """Return the errors of the Gaussian sum, and bounds, in the runs of `posterior_errors`.

    Parameters
    ----------
    case, first, runs, seed
        See `case_errors`.

    Returns
    -------
    ndarray, shape (5, runs, 5)
        NEES, sizes of the errors of position and velocity, and the roots of the traces of their
        bounds along the true path, in m and m/s; at the times of `posterior_errors`.

    Examples
    --------
    >>> bank_errors("B", 0, 2, seed=1).shape
    (5, 2, 5)
    """
    errors = case_errors(case, "bank", first, runs, seed=seed)
    at = np.array(SAMPLES) // EVERY - 1
    names = "nees", "position", "velocity", "position_bound", "velocity_bound"
    return np.array([getattr(errors, name)[:, at] for name in names])


@checked
@record
class Yardsticks:
    """Errors of the exact posterior and of the Gaussian sum in the same runs, beside bounds.

    All are NaN where a record has ended.

    Attributes
    ----------
    efficiency : ndarray, shape (runs, O)
        Effective sample size of the importance sampling, as a fraction of its draws.
    nees, position, velocity : ndarray, shape (runs, O)
        NEES of the exact posterior, and sizes of the errors of its mean in m and m/s.
    bank_nees, bank_position, bank_velocity : ndarray, shape (runs, O)
        The same of the Gaussian sum.
    position_bound, velocity_bound : ndarray, shape (runs, O)
        Roots of the traces of the Cramér-Rao bound with prior along each true path.
    """

    efficiency: _Errors
    nees: _Errors
    position: _Errors
    velocity: _Errors
    bank_nees: _Errors
    bank_position: _Errors
    bank_velocity: _Errors
    position_bound: _Errors
    velocity_bound: _Errors


@checked
def saved_yardsticks(case: _Case) -> Yardsticks:
    """Return the yardsticks of one case from the studies that are saved in ``results``.

    Parameters
    ----------
    case : {"A", "B", "C", "D"}
        See `case_errors`.

    Returns
    -------
    Yardsticks
        O = 5, after `SAMPLES` samples.

    Notes
    -----
    Made by ``make study NAME=exact_posterior`` and ``make study NAME=yardsticks``; see the README
    of ``results``.

    Examples
    --------
    >>> saved_yardsticks("B").nees.shape[1]
    5
    """
    exact, bank = (_table(name, case) for name in ("exact_posterior", "yardsticks"))
    exact[2:] /= 1e3
    bank[1:] /= 1e3
    return Yardsticks(*exact, *bank)


@checked
def rms_ratio(one: _Squared, other: _Squared, *, rng: np.random.Generator) -> ConfidenceInterval:
    """Return the ratio of the root mean squares of two errors of the same runs.

    Parameters
    ----------
    one, other : array_like, shape (runs,)
        Errors; a run in which either of them is NaN does not count.
    rng : numpy.random.Generator
        Source of the bootstrap of the interval.

    Returns
    -------
    ConfidenceInterval
        Of 95 %.

    Examples
    --------
    >>> rms_ratio([1.0, 3.0, 4.0], [2.0, 6.0, 8.0], rng=np.random.default_rng(1)).value
    0.5
    """
    if one.ndim != 1 or one.shape != other.shape:
        raise ValueError(
            f"other must have the shape (runs,) of one, {one.shape}, got {other.shape}"
        )
    there = ~(np.isnan(one) | np.isnan(other))
    squares = one[there] ** 2, other[there] ** 2
    return bootstrap_interval(lambda a, b: np.sqrt(a / b), squares, rng=rng)


@checked
def shell_bounds(
    distance: Annotated[FloatArray, exactly(None)],
    P: Annotated[FloatArray, shaped(6, 6)],
    edges: Annotated[FloatArray, exactly(None)],
) -> FloatArray:
    """Return the two means of bounds over the truths in each range of distance.

    Parameters
    ----------
    distance : array_like, shape (runs,)
        Distances of the truths in m.
    P : array_like, shape (runs, 6, 6)
        Bounds along their paths.
    edges : array_like, shape (M + 1,)
        Ends of the ranges in m.

    Returns
    -------
    ndarray, shape (2, M)
        Root mean square position errors in m at the arithmetic mean of the bounds, and at their
        harmonic mean, the inverse of the mean information; NaN in a range without truths.

    Examples
    --------
    Two targets, one seen along x and one along y:

    >>> P = np.array([np.diag([1.0, 100, 1, 1, 1, 1]), np.diag([100.0, 1, 1, 1, 1, 1])])
    >>> shell_bounds([0.3, 0.4], P, [0, 1]).round(1).tolist()
    [[10.1], [2.2]]
    """
    P = _checks.covariance("P", P, 6)
    _checks.exact_shape("P", P, (len(distance), 6, 6))
    found = np.full((2, len(edges) - 1), np.nan)
    place = np.digitize(distance, edges) - 1
    for m in range(len(edges) - 1):
        shell = P[place == m]
        if len(shell):
            means = shell.mean(axis=0), np.linalg.inv(np.linalg.inv(shell).mean(axis=0))
            found[:, m] = [np.trace(mean[:3, :3]) ** 0.5 for mean in means]
    return found


def _table(name, case):
    """Return columns (C, runs, O) of one case; NaN where a line is missing."""
    rows = np.loadtxt(read_lines(f"{name}.csv", folder=results), delimiter=",", skiprows=1)
    rows = rows[rows[:, 0] == list(CASES).index(case)]
    run, sample = rows[:, 1].astype(int), rows[:, 2].astype(int)
    table = np.full((rows.shape[1] - 3, run.max() + 1, len(SAMPLES)), np.nan)
    table[:, run, [SAMPLES.index(k) for k in sample]] = rows[:, 3:].T
    return table
