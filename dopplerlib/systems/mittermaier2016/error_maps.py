"""The error maps of Section 3.4, from any number of draws (Fig 3)."""

from collections.abc import Iterable
from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Count, Positive, checked, exactly, shaped, up_to
from ..._records import record
from ..._typing import BoolArray, FloatArray
from ...estimation.maximum_likelihood import ml_initialize
from ...evaluation.bounds import crlb
from ...model.doppler import doppler_shift
from .published import PublishedFigure3, reported

Likelihood = Literal["constant_velocity", "stationary"]
Velocity = Annotated[FloatArray, exactly(3)]

_IN_PLANE = np.array([True, True, False, True, True, False])


@checked
@record
class ErrorMap:
    """Errors of maximum-likelihood starts all over the plane of Fig 3.

    position (39, 39, draws): Distance in m between estimate and truth, by x and y of the true
        place; NaN on a sensor.
    velocity (39, 39, draws): The same of the velocity in m/s.
    """

    position: Annotated[FloatArray, exactly(None, None, None, check=_checks.measured)]
    velocity: Annotated[FloatArray, exactly(None, None, None, check=_checks.measured)]

    def __post_init__(self):
        """Check that both maps are of the same places and draws."""
        _checks.exact_shape("velocity", self.velocity, self.position.shape)

    @property
    def state(self) -> FloatArray:
        """Norm of the error of the whole state, meters and meters per second added as numbers."""
        return np.hypot(self.position, self.velocity)


@checked
def error_map(
    draws: Count,
    *,
    rng: np.random.Generator,
    samples: Count = 1,
    likelihood: Likelihood = "stationary",
    room: Positive = 2.0,
    velocity: Velocity | None = None,
) -> ErrorMap:
    """Estimate the state of a target at every place of Fig 3.

    draws: How often each place gets new noise.
    rng: Source of the noise; every draw has a child of its own.
    samples: Number of Doppler samples of the moving target.
    likelihood: What the estimator assumes, see `ml_initialize`; without effect for one sample.
    room: Half the side in m of the square that is searched. Not stated in the paper.
    velocity (3,): Velocity of the target in m/s, in the plane; that of the paper if None.
    Returns: Sensors and velocity are as the paper prints them: a line along y.
    Raises ValueError if an argument has the wrong shape, is not finite and positive where it has to
        be, or is refused by `ml_initialize`.

    Notes
    -----
    A line cannot tell a target from its reflection, so only the half of the square is searched in
    which the target is, x >= 0 for a target on the line itself; z and v_z are known to be zero. The
    speed is restricted to that of the drives, along each axis.

    Examples
    --------
    >>> error_map(1, rng=np.random.default_rng(1)).position.shape
    (39, 39, 1)
    """
    p = reported().figure3
    states = _states(p, velocity)
    path = np.repeat(states[:, None], samples, axis=1)
    path[..., :3] += p.T * np.arange(samples)[:, None] * path[..., 3:]
    clear = _clear(states, p.array)
    z = np.full((len(states), draws, samples, len(p.array)), np.nan)
    noise = [
        child.standard_normal((len(states), samples, len(p.array))) for child in rng.spawn(draws)
    ]
    z[clear] = doppler_shift(path[clear], p.array)[:, None]
    z += p.sigma_f * np.stack(noise, axis=1)
    error = np.full((len(states), draws, 6), np.nan)
    high = np.array([room, room, 0, p.top_speed, p.top_speed, 0])
    low = -high
    for ahead in (True, False):
        here = clear & ((states[:, 0] >= 0) == ahead)
        side = np.where(np.arange(6) == 0, 0, low if ahead else high)
        box = (side, high) if ahead else (low, side)
        found = ml_initialize(z[here], p.array, p.sigma_f, p.T, box, likelihood).x
        error[here] = found - states[here, None]
    shape = (len(p.x), len(p.y), draws)
    return ErrorMap(
        *(
            np.linalg.norm(error[..., part], axis=-1).reshape(shape)
            for part in (np.s_[:3], np.s_[3:])
        )
    )


@checked
def error_map_bound(
    *, samples: Count = 1, likelihood: Likelihood = "stationary", velocity: Velocity | None = None
) -> FloatArray:
    """Return the least root mean square position error at every place of Fig 3.

    samples, likelihood, velocity: See `figure3`.
    Returns (39, 39): Cramér-Rao bound in m by x and y; infinite where the information is singular,
        NaN on a sensor.

    Examples
    --------
    >>> error_map_bound().shape
    (39, 39)
    """
    p = reported().figure3
    states = _states(p, velocity)
    clear = _clear(states, p.array)
    bound = np.full(len(states), np.nan)
    P = crlb(states[clear], p.array, p.sigma_f, samples, p.T, likelihood, free=_IN_PLANE)
    bound[clear] = np.sqrt(P[:, 0, 0] + P[:, 1, 1])
    if samples == 1 or likelihood == "stationary":
        # Exactly singular on the line of the sensors, where rounding leaves 1e-16 of two columns.
        bound[clear & (states[:, 0] == 0)] = np.inf
    return bound.reshape(len(p.x), len(p.y))


@checked
def fraction_above(
    error: Annotated[FloatArray, shaped(None, None, check=_checks.measured)],
    limits: Iterable[float],
    where: Annotated[BoolArray, exactly(None, None, check=_checks.booleans)],
) -> FloatArray:
    """Return the fraction of places at which an error is above a limit.

    error (A, B, ...): Errors by place.
    limits (L,): In the unit of the errors.
    where (A, B): Places that count. They stand for squares of one size: it is a fraction of the
        area.
    Returns (L, ...): A place without a number is not above anything: an error that is only known to
        be small.
    Raises ValueError if a shape does not fit, or no place or no limit is left.

    Examples
    --------
    >>> fraction_above([[0.1, 0.3]], [0.2], [[True, True]]).tolist()
    [0.5]
    """
    if error.shape[:2] != where.shape or not where.any() or not limits:
        raise ValueError(f"where must choose some of {error.shape[:2]}, got {where.shape}")
    return np.stack([(error[where] > limit).mean(axis=0) for limit in limits])


@checked
def comparable(published: PublishedFigure3, panel: Annotated[int, up_to(1, least=0)]) -> BoolArray:
    """Return the places of Fig 3 at which errors can be compared in every orientation.

    published: The digitized figure.
    panel: 0 for the left map, 1 for the right one.
    Returns (39, 39): Where the published error is known, or known to be small, and no sensor is:
        neither along y, as published, nor along x.

    Examples
    --------
    >>> comparable(reported().figure3, 0).shape
    (39, 39)
    """
    clear = _clear(_states(published, None), published.array).reshape(published.below.shape[1:])
    known = ~np.isnan(published.error[panel]) | published.below[panel]
    return known & clear & clear.T


def _states(p, velocity):
    """Return the target at all places, shape (39 * 39, 6); y runs fastest."""
    v = p.velocity if velocity is None else velocity
    if v[2]:
        raise ValueError(f"velocity must be one vector in the plane z = 0, got {v.tolist()}")
    states = np.zeros((len(p.x), len(p.y), 6))
    states[..., 0], states[..., 1] = p.x[:, None], p.y
    states[..., 3:] = v
    return states.reshape(-1, 6)


def _clear(states, array):
    """Return whether a place is none of a sensor, whose coordinates have rounding errors."""
    apart = np.linalg.norm(states[:, None, :3] - array.positions, axis=-1)
    return apart.min(axis=1) > 1e-9
