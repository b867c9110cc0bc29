"""Trackers compared on the same records: errors of runs, their statistics, and a saved study."""

from dataclasses import fields
from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Count, Index, Positive, between, checked
from .._records import record
from .._typing import FloatArray
from ..estimation import covariances
from ..evaluation.directions import principal_axis_errors
from ..evaluation.path_bounds import path_crlb
from .targets import (
    ARRAY,
    INTERVAL,
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
EVERY = 20  # samples from one output to the next
FAR, BOUNDS = 0.05, 4.0  # a run is lost if it is off by more than this in m, and this many bounds
NEES_95, AXIS_95 = 12.591587243743977, 1.959963984540054  # chi-square of six, normal: 95 %

_P, _V = slice(3), slice(3, 6)


@record
class TrackErrors:
    """Errors of a tracker in many runs, at O times; NaN before a start and after a record's end.

    Attributes
    ----------
    nees : ndarray, shape (runs, O)
        Normalized estimation errors squared; infinite where a tracker has given up.
    axes : ndarray, shape (runs, O, 6)
        Errors along the principal axes of the covariance, in its standard deviations, the widest
        axis first.
    position, velocity : ndarray, shape (runs, O)
        Sizes of the errors in m and m/s.
    position_bound, velocity_bound : ndarray, shape (runs, O)
        Roots of the traces of the Cramér-Rao bound with prior along the true path.
    """

    nees: np.ndarray
    axes: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    position_bound: np.ndarray
    velocity_bound: np.ndarray

    def __post_init__(self):
        """Check the fields."""
        values = _like_nees(self, ndim=2)
        ended = np.isnan(values["nees"])
        for name, value in values.items():
            missing = np.isnan(value) if name != "axes" else np.isnan(value).any(axis=-1)
            if (missing != ended).any():
                raise ValueError(f"{name} must be NaN where nees is, got it elsewhere or not there")
        return values


@record
class ErrorSummary:
    """Statistics over runs at O times.

    Attributes
    ----------
    runs : ndarray, shape (O,)
        Runs that have an estimate.
    nees, nees_error, nees_median : ndarray, shape (O,)
        Mean of NEES, its standard error from the scatter of the runs, and the median.
    inside : ndarray, shape (O,)
        Fraction of the runs whose NEES is below the 95 % quantile of chi-square.
    axes : ndarray, shape (O, 6)
        Fraction whose error along each principal axis is within 95 % of a normal distribution.
    position, velocity : ndarray, shape (O,)
        Root mean square errors in m and m/s.
    position_error, velocity_error : ndarray, shape (O,)
        Their standard errors, as fractions of them.
    position_bound, velocity_bound : ndarray, shape (O,)
        Roots of the mean squared bounds of the same runs.
    lost : ndarray, shape (O,)
        Fraction of runs whose position is off by more than 5 cm and by more than four bounds.
    """

    runs: np.ndarray
    nees: np.ndarray
    nees_error: np.ndarray
    nees_median: np.ndarray
    inside: np.ndarray
    axes: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    position_error: np.ndarray
    velocity_error: np.ndarray
    position_bound: np.ndarray
    velocity_bound: np.ndarray
    lost: np.ndarray

    def __post_init__(self):
        """Check the fields."""
        return _like_nees(self, ndim=1)

    @property
    def time(self) -> FloatArray:
        """Times in s, shape (O,)."""
        return EVERY * INTERVAL * np.arange(1, len(self.runs) + 1)


def _like_nees(self, ndim):
    """Return the fields of a record as arrays of the shape that NEES has, `axes` with one more."""
    values = {
        field.name: _checks.real(field.name, getattr(self, field.name)) for field in fields(self)
    }
    shape = values["nees"].shape
    if len(shape) != ndim or not values["nees"].size:
        raise ValueError(f"nees must have {ndim} axes and something in it, got shape {shape}")
    for name, value in values.items():
        _checks.exact_shape(name, value, (*shape, 6) if name == "axes" else shape)
    return values


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
    truths, noise, own = np.random.default_rng([seed, ord(case)]).spawn(3)
    for rng in (truths, noise, own):
        rng.spawn(first)
    paths = draw_targets(runs, rng=truths, sigma_a=moved, x0=x0)
    z = draw_records(paths, rng=noise)
    assumed = moved if sigma_a is None else sigma_a
    x, P = track_targets(
        z, tracker, every=EVERY, sigma_a=assumed, sigma_f=sigma_f, prior=PRIORS[prior], rng=own
    )
    bound = path_crlb(paths, ARRAY, SIGMA_F, PRIOR_COVARIANCE, INTERVAL, moved, every=EVERY)
    error = x - paths[:, EVERY - 1 :: EVERY]
    # A tracker that has given up is as far off as can be.
    error[np.isnan(x) & np.isfinite(bound[..., 0])] = np.inf
    good = np.isfinite(error).all(axis=-1)
    nees, axes = error[..., 0] ** 2, error.copy()
    solved = covariances.solve(P[good], error[good][..., None])[..., 0]
    nees[good] = np.sum(error[good] * solved, axis=-1)
    axes[good] = principal_axis_errors(error[good], P[good])
    sizes = (np.linalg.norm(error[..., i], axis=-1) for i in (_P, _V))
    bounds = (np.sqrt(np.trace(bound[..., i, i], axis1=-2, axis2=-1)) for i in (_P, _V))
    return TrackErrors(nees, axes, *sizes, *bounds)


@checked
@_checks.quiet
def error_summary(errors: TrackErrors) -> ErrorSummary:
    """Return statistics over the runs at each time.

    Parameters
    ----------
    errors : TrackErrors
        Errors of two runs at least.

    Returns
    -------
    ErrorSummary
        NaN where no run is left, or a ratio is none; infinite where a tracker has given up a run.

    Examples
    --------
    >>> found = error_summary(case_errors("A", "ekf", 0, 3, seed=1))
    >>> int(found.runs[0]), bool(found.position[0] > found.position_bound[0])
    (3, True)
    """
    nees = errors.nees
    there = ~np.isnan(nees)
    n = there.sum(axis=0)
    far = (errors.position > FAR) & (errors.position > BOUNDS * errors.position_bound)
    squares = {
        name: getattr(errors, name) ** 2
        for name in ("position", "velocity", "position_bound", "velocity_bound")
    }

    def mean(values):
        values = np.where(there.reshape(there.shape + (1,) * (values.ndim - 2)), values, 0)
        return np.moveaxis(values.sum(axis=0), 0, -1) / n

    def median(values, there):
        return np.median(values[there]) if there.any() else np.nan

    def error(values):
        return np.sqrt(mean((values - mean(values)) ** 2) / (n - 1))

    return ErrorSummary(
        runs=n,
        nees=mean(nees),
        nees_error=error(nees),
        nees_median=[median(*column) for column in zip(nees.T, there.T, strict=True)],
        inside=mean(nees < NEES_95),
        axes=mean(np.abs(errors.axes) < AXIS_95).T,
        position_error=error(squares["position"]) / mean(squares["position"]) / 2,
        velocity_error=error(squares["velocity"]) / mean(squares["velocity"]) / 2,
        lost=mean(far),
        **{name: np.sqrt(mean(square)) for name, square in squares.items()},
    )
