"""Trackers of targets in front of the ring, all called in the same way.

None of them knows more than the records, the noise and the prior. Those that begin with an estimate
make it from the first ten samples.
"""

from collections.abc import Callable
from typing import Annotated, Any, NamedTuple

import numpy as np

from .. import _checks
from .._hints import Count, Covariance, Positive, State, between, checked, exactly
from .._typing import FloatArray
from ..model.radar_array import RadarArray
from . import _filters as f
from . import _robust_filters as r
from .targets import ARRAY, PRIOR_COVARIANCE, PRIOR_MEAN, SIGMA_A, SIGMA_F

_STILL = 1e-6  # in m/s^2: an acceleration that moves nothing, for filters that ask for one


class _Tracker(NamedTuple):
    """Label of a tracker in figures, and the functions it is made of."""

    label: str
    filter: Callable[..., Any]
    start: Callable[..., Any] | None = None  # without one the filter does all


TRACKERS = {
    "paper": _Tracker("EKF, ML start, P = 0.1 I", f.extended, f.from_paper),
    "own_covariance": _Tracker("EKF, ML start, own covariance", f.extended, f.from_likelihood),
    "ekf": _Tracker("EKF", f.extended, f.from_prior),
    "ekf_bayes": _Tracker("EKF, Bayes start", f.extended, f.from_bayes),
    "iekf": _Tracker("IEKF", f.iterated, f.from_prior),
    "iekf_bayes": _Tracker("IEKF, Bayes start", f.iterated, f.from_bayes),
    "ukf": _Tracker("UKF", f.cubature, f.from_prior),
    "iplf": _Tracker("posterior linearization", f.posterior_linearization, f.from_prior),
    "ring_ekf": _Tracker("EKF, ring", f.ring_extended, f.from_prior),
    "ring_iekf": _Tracker("IEKF, ring", f.ring_iterated, f.from_prior),
    "ring_iekf_bayes": _Tracker("IEKF, ring, Bayes start", f.ring_iterated, f.from_bayes),
    "ring_ukf": _Tracker("UKF, ring", f.ring_cubature, f.from_prior),
    "ring_iplf": _Tracker(
        "posterior linearization, ring", f.ring_posterior_linearization, f.from_prior
    ),
    "batch": _Tracker("maximum likelihood of all samples", f.batch),
    "particles": _Tracker("particle filter", f.particles),
    "bank": _Tracker("Gaussian sum", f.bank),
    "learning_bank": _Tracker("Gaussian sums, three process noises", f.learning_bank),
    "gated_bank": _Tracker("Gaussian sum, gate", r.gated_bank),
    "moving_bank": _Tracker("Gaussian sums, gate, three motions", r.moving_bank),
    "gated_start": _Tracker("EKF, gated start", f.extended, r.from_gated_bayes),
    "gated_start_ukf": _Tracker("UKF, gated start", f.cubature, r.from_gated_bayes),
    "gate_paper": _Tracker(
        "EKF, gate, two-sided, 95 %", r.gated("two-sided", r.PAPER), r.from_gated_bayes
    ),
    "gate_upper": _Tracker("EKF, gate, 99.9 %", r.gated("upper"), r.from_gated_bayes),
    "gate_soft": _Tracker("EKF, soft gate", r.gated("soft"), r.from_gated_bayes),
    "gate_each": _Tracker("EKF, gate, each sensor", r.robust("gate"), r.from_gated_bayes),
    "huber": _Tracker("EKF, Huber", r.robust("huber"), r.from_gated_bayes),
    "student_t": _Tracker("EKF, Student t", r.robust("student-t"), r.from_gated_bayes),
    "adaptive": _Tracker("EKF, adaptive R", r.robust("adaptive"), r.from_gated_bayes),
}


def _known(name, value):
    return _checks.one_of(name, value, tuple(TRACKERS))


_States = Annotated[FloatArray, exactly(None, 6, check=_checks.bounded)]
_Covariances = Annotated[FloatArray, exactly(None, 6, 6, check=_checks.bounded)]


@checked
def track_targets(
    z: Annotated[FloatArray, exactly(None, None, None, check=_checks.bounded)],
    tracker: Annotated[str, _known],
    *,
    every: Count = 1,
    sigma_a: Annotated[float, between(0, 1e60)] = SIGMA_A,
    sigma_f: Positive = SIGMA_F,
    prior: tuple[State, Covariance] = (PRIOR_MEAN, PRIOR_COVARIANCE),
    array: RadarArray = ARRAY,
    start: tuple[_States, _Covariances] | None = None,
    rng: np.random.Generator | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Track targets by one of the trackers that are compared.

    Parameters
    ----------
    z : array_like, shape (runs, K, N)
        Doppler measurements in Hz at `INTERVAL`, 2 `INTERVAL`, ...; NaN where one is missing, and
        from the end of a record on.
    tracker : str
        Name in `TRACKERS`, which has a label for each.

        "paper": extended Kalman filter from the likeliest state of ten samples and the paper's
        covariance; "own_covariance": from that of the estimate. "ekf": from the prior;
        "ekf_bayes": from mean and covariance of the posterior of ten samples, by the Gaussian
        sum. "iekf", "iekf_bayes": iterated thrice. "ukf": cubature points. "iplf": posterior
        linearization, thrice. With ``ring_`` before it: the same in ring coordinates. "batch": at
        each output the likeliest straight path of all samples, without a prior. "particles":
        regularized particle filter, 3000 particles. "bank": `gaussian_sum`; "gated_bank": with a
        gate of 99.9 %; "moving_bank": three of these for accelerations of 0.4, 4 and 40 m/s^2,
        weighed by their evidence, whatever `sigma_a` is; "learning_bank": the same without a gate
        for 0, 0.1 and 0.4 m/s^2. "gated_start": "ekf_bayes" with that
        gate at the start, "gated_start_ukf" the same with cubature points; from the same start
        the gates of `ekf`, "gate_paper" (two-sided, 95 %), "gate_upper" and "gate_soft" (99.9 %),
        and the methods of `robust_ekf`, "gate_each" (99.9 %), "huber", "student_t" and
        "adaptive".
    every : int
        Estimates are returned at the samples every - 1, 2 every - 1, ...
    sigma_a : float
        Standard deviation in m/s^2 of the acceleration of each axis that the tracker assumes; zero
        is uniform motion.
    sigma_f : float
        Standard deviation in Hz of a shift that the tracker assumes.
    prior : pair of array_like, shapes (6,) and (6, 6)
        Mean and covariance of the state at time zero that the tracker assumes.
    array : RadarArray
        The N sensors.
    start : pair of array_like, shapes (runs, 6) and (runs, 6, 6), optional
        Estimates after the first ten samples and their covariances, which a tracker begins with
        instead of its own start. One that has no start does without.
    rng : numpy.random.Generator, optional
        Source of randomness of the particle filter, a child for each run.

    Returns
    -------
    ndarray, shape (runs, K // every, 6)
        Estimates in m and m/s; NaN before a start, after the end of a record, and where the sum of
        Gaussians has lost all of them.
    ndarray, shape (runs, K // every, 6, 6)
        Covariances.

    Raises
    ------
    ValueError
        If an argument has the wrong shape or value, `tracker` needs a start and the record is too
        short for it, or needs `rng` and has none.

    Examples
    --------
    >>> from dopplerlib.workspace.targets import draw_records, draw_targets
    >>> truths, noise = np.random.default_rng(1).spawn(2)
    >>> paths = draw_targets(2, rng=truths, samples=40)
    >>> x, P = track_targets(draw_records(paths, rng=noise), "ekf", every=20)
    >>> x.shape, P.shape
    ((2, 2, 6), (2, 2, 6, 6))
    """
    one = TRACKERS[tracker]
    if rng is None and tracker == "particles":
        raise ValueError("rng must be a numpy.random.Generator for tracker 'particles', got None")
    P0 = _checks.covariance("prior", prior[1], 6)
    if start is not None:
        for each in start:
            _checks.exact_shape("start", each, (len(z), *each.shape[1:]))
    if one.start is not None:
        sigma_a = max(sigma_a, _STILL)
    s = f.Setting(array, sigma_a, sigma_f, prior[0], P0, every, rng)
    x, P = one.filter(z, s) if one.start is None else _started(one, z, s, start)
    ended = np.isnan(z).all(axis=-1)  # at this sample and all that follow
    ended = np.logical_and.accumulate(ended[:, ::-1], axis=1)[:, ::-1]
    ended = ended[:, every - 1 :: every]
    return np.where(ended[..., None], np.nan, x), np.where(ended[..., None, None], np.nan, P)


def _started(tracker, z, s, start):
    """Return the estimates of a tracker that has a start, NaN before that."""
    first, x, P = tracker.start(z, s) if start is None else (f.FIRST, *start)
    if z.shape[1] <= first:
        raise ValueError(f"z must have more than {first} samples for this tracker, got {z.shape}")
    begun = np.isfinite(x).all(axis=-1)  # the others have lost the target before
    outputs = [np.full((len(z), z.shape[1], *start.shape[1:]), np.nan) for start in (x, P)]
    if begun.any():
        found = tracker.filter(z[begun, first:], s, x[begun], P[begun])
        for output, start, after in zip(outputs, (x, P), found, strict=True):
            if first:
                output[:, first - 1] = start
            output[begun, first:] = after
    return [output[:, s.every - 1 :: s.every] for output in outputs]
