"""Errors of trackers in many runs, beside their bounds, and statistics over the runs."""

from dataclasses import fields
from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Count, between, checked, exactly
from .._records import record
from .._typing import FloatArray
from ..estimation import covariances
from ..evaluation.directions import principal_axis_errors
from ..evaluation.path_bounds import path_crlb
from .targets import ARRAY, INTERVAL, PRIOR_COVARIANCE, SIGMA_A, SIGMA_F

EVERY = 20  # samples from one output to the next
FAR, BOUNDS = 0.05, 4.0  # a run is lost if it is off by more than this in m, and this many bounds
WORST = 3  # runs that are kept one by one
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
    nees_worst, position_worst : ndarray, shape (O, 3)
        The three largest NEES and position errors in m of one run each, falling: what a mean owes
        to them.
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
    nees_worst: np.ndarray
    position_worst: np.ndarray

    def __post_init__(self):
        """Check the fields."""
        return _like_nees(self, ndim=1)

    @property
    def time(self) -> FloatArray:
        """Times in s, shape (O,)."""
        return EVERY * INTERVAL * np.arange(1, len(self.runs) + 1)


def _like_nees(self, ndim):
    """Return the fields of a record as arrays of the shape that NEES has, some with one more."""
    values = {
        field.name: _checks.real(field.name, getattr(self, field.name)) for field in fields(self)
    }
    shape = values["nees"].shape
    if len(shape) != ndim or not values["nees"].size:
        raise ValueError(f"nees must have {ndim} axes and something in it, got shape {shape}")
    for name, value in values.items():
        more = {"axes": (6,), "nees_worst": (WORST,), "position_worst": (WORST,)}.get(name, ())
        _checks.exact_shape(name, value, (*shape, *more))
    return values


@checked
def track_errors(
    paths: Annotated[FloatArray, exactly(None, None, 6, check=_checks.bounded)],
    x: Annotated[FloatArray, exactly(None, None, 6, check=_checks.measured)],
    P: Annotated[FloatArray, exactly(None, None, 6, 6, check=_checks.measured)],
    *,
    sigma_a: Annotated[float, between(0, 1e60)] = SIGMA_A,
    every: Count = EVERY,
) -> TrackErrors:
    """Return the errors of estimates along true paths.

    Parameters
    ----------
    paths : array_like, shape (runs, K, 6)
        True states in m and m/s, NaN from the end of a path on.
    x : array_like, shape (runs, K // every, 6)
        Estimates at the samples every - 1, 2 every - 1, ...; NaN where there is none.
    P : array_like, shape (runs, K // every, 6, 6)
        Covariances.
    sigma_a : float
        Standard deviation in m/s^2 of the acceleration of the truths, for their bound.
    every : int
        Samples from one estimate to the next.

    Returns
    -------
    TrackErrors
        Where a path goes on without an estimate, the tracker has given up: errors are infinite.

    Examples
    --------
    >>> from dopplerlib.workspace.targets import draw_targets
    >>> paths = draw_targets(2, rng=np.random.default_rng(1), samples=40)
    >>> x = paths[:, 19::20] + 0.1
    >>> errors = track_errors(paths, x, np.broadcast_to(0.01 * np.eye(6), (2, 2, 6, 6)))
    >>> errors.nees.round(9).tolist()
    [[6.0, 6.0], [6.0, 6.0]]
    """
    truth = paths[:, every - 1 :: every]
    for name, value, more in (("x", x, (6,)), ("P", P, (6, 6))):
        _checks.exact_shape(name, value, (*truth.shape[:2], *more))
    bound = path_crlb(paths, ARRAY, SIGMA_F, PRIOR_COVARIANCE, INTERVAL, sigma_a, every=every)
    error = x - truth
    error[np.isnan(x) & np.isfinite(truth)] = np.inf
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
    >>> from dopplerlib.workspace.comparison import case_errors
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

    def worst(values):
        rising = np.sort(np.where(there, values, np.nan), axis=0)  # NaN comes last
        few = np.full((WORST, len(n)), np.nan)
        for o, count in enumerate(n):
            last = rising[max(count - WORST, 0) : count, o][::-1]
            few[: len(last), o] = last
        return few.T

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
        nees_worst=worst(nees),
        position_worst=worst(errors.position),
        **{name: np.sqrt(mean(square)) for name, square in squares.items()},
    )
