"""Trackers compared on the same records, in four cases, and results of a saved study."""

from collections.abc import Iterable
from dataclasses import fields
from typing import Annotated, Any, Literal

import numpy as np

from .. import _checks
from .._data import read_json, results
from .._hints import Count, Index, Positive, between, checked
from .._typing import FloatArray
from ..evaluation.monte_carlo import skip_runs
from .errors import EVERY, WORST, ErrorSummary, TrackErrors, track_errors
from .targets import (
    PRIOR_COVARIANCE,
    PRIOR_MEAN,
    SIGMA_A,
    SIGMA_F,
    TABLE_2,
    draw_records,
    draw_targets,
)
from .trackers import track_targets

# Truths of the four cases: acceleration, and start if it is not drawn from the prior.
CASES = {"A": (SIGMA_A, None), "B": (0.0, None), "C": (SIGMA_A, TABLE_2), "D": (0.0, TABLE_2)}
PRIORS = {
    "own": (PRIOR_MEAN, PRIOR_COVARIANCE),
    "broad": ([0.8, 0, 0, -0.5, 0, 0], np.diag([0.35, 0.4, 0.4, 0.7, 0.7, 0.7]) ** 2),
}
# Settings of trackers: as the truths are, or otherwise in one respect.
ASSUMED = {
    "right": {},
    "sigma_f 0.32 Hz": {"sigma_f": 0.32},
    "sigma_f 0.5 Hz": {"sigma_f": 0.5},
    "sigma_a 0.2 m/s^2": {"sigma_a": 0.2},
    "sigma_a 0.4 m/s^2": {"sigma_a": 0.4},
    "sigma_a 0.8 m/s^2": {"sigma_a": 0.8},
    "broad prior": {"prior": "broad"},
}

# What is saved of the Gaussian sum alone, and its shape at a time.
OF_BANK = {"axes": (6,), "inside": (), "nees_worst": (WORST,), "position_worst": (WORST,)}


@checked
def case_errors(
    case: Literal["A", "B", "C", "D"],
    tracker: str,
    first: Index,
    runs: Count,
    *,
    seed: Index,
    sigma_a: Annotated[float, between(0, 1e60)] | None = None,
    sigma_f: Positive = SIGMA_F,
    prior: Literal["own", "broad"] = "own",
) -> TrackErrors:
    """Return the errors of a tracker in some runs of one of the four cases.

    Parameters
    ----------
    case : {"A", "B", "C", "D"}
        Truths: from the prior ("A", "B") or at Table 2 of the paper ("C", "D"), with acceleration
        noise ("A", "C") or at constant velocity ("B", "D").
    tracker : str
        See `track_targets`.
    first, runs : int
        The runs first, first + 1, ..., first + runs - 1: a study may be made in pieces.
    seed : int
        Source of all randomness. All trackers get the same records.
    sigma_a : float, optional
        Acceleration that the tracker assumes, in m/s^2; that of the truths if None.
    sigma_f : float
        Standard deviation of the shifts that the tracker assumes, in Hz.
    prior : {"own", "broad"}
        Prior that the tracker assumes: that of the truths, or one about twice as wide.

    Returns
    -------
    TrackErrors

    Examples
    --------
    >>> errors = case_errors("A", "ekf", 0, 2, seed=1)
    >>> errors.nees.shape
    (2, 50)
    """
    moved, x0 = CASES[case]
    streams = np.random.default_rng([seed, ord(case)]).spawn(3)
    truths, noise, own = (skip_runs(rng, first) for rng in streams)
    paths = draw_targets(runs, rng=truths, sigma_a=moved, x0=x0)
    z = draw_records(paths, rng=noise)
    assumed = moved if sigma_a is None else sigma_a
    x, P = track_targets(
        z, tracker, every=EVERY, sigma_a=assumed, sigma_f=sigma_f, prior=PRIORS[prior], rng=own
    )
    return track_errors(paths, x, P, sigma_a=moved, every=EVERY)


@checked
def tracker_study(
    settings: dict[str, Any], seed: Index, runs: Iterable[Index]
) -> dict[str, FloatArray]:
    """Compute the errors of a tracker in some runs, as a study for `run_study`.

    Parameters
    ----------
    settings : dict
        The `case` and `tracker` of `case_errors`, and what the tracker `assumed`: "right", or
        another of `ASSUMED`. Other entries are left alone.
    seed : int
        Source of all randomness.
    runs : iterable of int
        Numbers of the runs, one after the other.

    Returns
    -------
    dict of ndarray
        The fields of `TrackErrors`.

    Examples
    --------
    >>> settings = {"case": "A", "tracker": "ekf", "assumed": "right"}
    >>> tracker_study(settings, 1, range(2))["nees"].shape
    (2, 50)
    """
    case, tracker, assumed = (settings.get(name) for name in ("case", "tracker", "assumed"))
    given = ASSUMED[_checks.one_of("settings['assumed']", assumed, tuple(ASSUMED))]
    if not runs or runs != tuple(range(runs[0], runs[0] + len(runs))):
        raise ValueError(f"runs must be numbers one after the other, got {runs}")
    return dict(vars(case_errors(case, tracker, runs[0], len(runs), seed=seed, **given)))


def saved_comparison() -> dict[tuple[str, str, str], ErrorSummary]:
    """Return the statistics of the saved study, by case, tracker and assumption.

    Returns
    -------
    dict of ErrorSummary
        What is assumed is "right", or another of the settings of `ASSUMED`. Fractions `inside` and
        along `axes`, and the worst runs, are NaN but for the tracker "bank" with the right ones.

    Notes
    -----
    ``python -m studies consistent_tracker`` makes it; ``results/README.md`` says how.

    Examples
    --------
    >>> found = saved_comparison()["A", "bank", "right"]
    >>> bool(abs(found.nees[10] - 6) < 1)
    True
    """
    rows = read_json("consistent_tracker.json", folder=results)["rows"]
    found = {}
    for row in rows:
        n = len(row["runs"])
        row = {name: np.full((n, *more), np.nan) for name, more in OF_BANK.items()} | row
        found[row["case"], row["tracker"], row["assumed"]] = ErrorSummary(
            **{field.name: np.array(row[field.name], float) for field in fields(ErrorSummary)}
        )
    return found
