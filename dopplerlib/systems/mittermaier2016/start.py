"""The initial estimate of the simulation example, in any number of runs (Table 2)."""

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from scipy.optimize import lsq_linear

from ..._hints import Count, Positive, Runs, State, between, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...estimation.maximum_likelihood import InitialEstimate, ml_initialize
from ...evaluation.bounds import crlb
from ...model.doppler import doppler_jacobian, doppler_shift
from ...model.radar_array import RadarArray
from ...model.simulation import simulate
from .published import reported

Likelihood = Literal["constant_velocity", "stationary"]


@checked
@record
class Starts:
    """Estimates of the first state of the simulation example from short records.

    start: What `ml_initialize` returns, leading axis ``runs``.
    position (runs,): Distance in m between estimate and truth.
    velocity (runs,): The same of the velocity in m/s.
    """

    start: InitialEstimate
    position: Annotated[FloatArray, exactly(None)]
    velocity: Annotated[FloatArray, exactly(None)]


@checked
def start_box(
    reach: Positive = 1.5, side: Positive = 0.75, near: Positive = 0.1
) -> tuple[FloatArray, FloatArray]:
    """Return a room before the ring, and the drives' velocities, as a box for `ml_initialize`.

    reach, near: Largest and least x in m.
    side: Largest y and z in m, either way.
    Returns lower, upper (6,): In m and m/s. The paper says that position and velocity were
        restricted, and gives the speed of the drives; the room is our assumption.
    Raises ValueError if a number is not finite and positive, or `near` is not below `reach`.

    Examples
    --------
    >>> start_box()[1].tolist()
    [1.5, 0.75, 0.75, 2.0, 2.0, 2.0]
    """
    if near >= reach:
        raise ValueError(f"near must be below reach, {reach}, got {near}")
    v = reported().figure3.top_speed
    return np.array([near, -side, -side, -v, -v, -v]), np.array([reach, side, side, v, v, v])


@checked
def table2_starts(
    runs: Runs,
    *,
    rng: np.random.Generator,
    samples: Count | None = None,
    likelihood: Likelihood = "constant_velocity",
    box: tuple[State, State] | None = None,
    array: RadarArray | None = None,
) -> Starts:
    """Estimate the start of Table 2 from new noise.

    runs: Number of independent records.
    rng: Source of the noise, see `simulate`.
    samples: Length of a record; that of the paper, ten, if None.
    likelihood: What the estimator assumes, see `ml_initialize`. The target moves in any case.
    box (6,): Where to search; `start_box()` if None.
    array: Other sensors than those of the paper.
    Raises ValueError if an argument is refused by `simulate` or `ml_initialize`.

    Examples
    --------
    >>> table2_starts(1, rng=np.random.default_rng(1)).position.shape
    (1,)
    """
    s = _record(samples, array)
    _, z = simulate(s, runs, rng=rng)
    box = start_box() if box is None else box
    start = ml_initialize(z, s.array, s.sigma_f, s.T, box, likelihood)
    error = start.x - s.x0
    position, velocity = (np.linalg.norm(error[:, i], axis=-1) for i in (np.s_[:3], np.s_[3:]))
    return Starts(start, position, velocity)


@checked
def start_misfit(
    x: State,
    *,
    samples: Count | None = None,
    likelihood: Likelihood = "constant_velocity",
    rounding: Annotated[float, between(0, 1)] = 0.0,
) -> float:
    """Return the distance of a state's shifts from those of the true start of Table 2.

    x (6,): State at the first sample in m and m/s.
    samples: Length of the record; that of the paper, ten, if None.
    likelihood: Whether the states move on during the record.
    rounding: By how much each component of both states may be off, in m and m/s: half a unit of the
        last printed digit.
    Returns: Root of the summed squared differences over the variance of the noise: the states'
        distance in standard deviations. With rounding it is the least one, to first order.
    Raises ValueError if `x` is not one finite state, or another argument is refused.

    Notes
    -----
    Noise makes `x` more likely than the truth with the probability Phi(-distance / 2): the two
    chi-squares differ by distance^2 - 2 distance n, where n is one standard normal number.

    Examples
    --------
    >>> round(start_misfit(reported().table2.x_ml, rounding=0.0005))
    18
    """
    s = _record(samples)
    difference, slopes = [], []
    for t in s.time:
        F = np.eye(6)
        F[:3, 3:] = (t if likelihood == "constant_velocity" else 0.0) * np.eye(3)
        difference.append(doppler_shift(F @ x, s.array) - doppler_shift(F @ s.x0, s.array))
        H, H0 = (doppler_jacobian(F @ state, s.array) @ F for state in (x, s.x0))
        slopes.append(np.hstack([H, -H0]))
    difference, slopes = np.concatenate(difference), np.concatenate(slopes)
    if rounding:
        moved = lsq_linear(slopes * rounding, -difference, (-1, 1)).x
        difference = difference + slopes @ (rounding * moved)
    return float(np.linalg.norm(difference) / s.sigma_f)


@checked
def samples_needed(error: Positive | None = None, *, array: RadarArray | None = None) -> int:
    """Return the number of samples at which the bound on the position falls to an error.

    error: Root mean square position error in m; the error that Table 2 prints if None.
    array: Other sensors than those of the paper.
    Returns: Least number of samples of the moving target.
    Raises ValueError if an argument is refused, or a record as long as the example does not
        suffice.

    Examples
    --------
    >>> samples_needed(0.5) < samples_needed()
    True
    """
    error = reported().quoted.position_error_norm_m if error is None else error
    longest = reported().scenario.samples
    low, high = 1, longest  # the bound falls with every sample: bisection
    while low < high:
        middle = (low + high) // 2
        if _bound(_record(middle, array)) <= error:
            high = middle
        else:
            low = middle + 1
    if low == longest and _bound(_record(low, array)) > error:
        raise ValueError(f"error must be within reach of {longest} samples, got {error}")
    return low


def _bound(s):
    """Return the root mean square position error that the bound allows, in m."""
    P = crlb(s.x0, s.array, s.sigma_f, s.samples, s.T, "constant_velocity")
    return np.sqrt(np.trace(P[:3, :3]))


def _record(samples=None, array=None):
    """Return the simulation example, cut to the record of the start."""
    s = reported().scenario
    samples = round(reported().quoted.mle_integration_time_s / s.T) if samples is None else samples
    return replace(s, samples=samples, array=s.array if array is None else array)
