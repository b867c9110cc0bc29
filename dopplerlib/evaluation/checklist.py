"""Acceptance tests of a Doppler filter: eight checks against known answers."""

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from scipy.special import chdtr, chdtrc

from .. import _checks
from .._hints import Count, Number, checked
from .._records import record
from .._typing import ArrayLike, FloatArray
from ..estimation.linear_kalman import kf
from ..estimation.track import Track
from ..kernels.doppler import doppler_shift as shift_kernel
from ..model.doppler import check_clear_of_sensors, doppler_jacobian, doppler_shift
from ..model.motion import constant_velocity
from ..model.radar_array import RadarArray
from ..model.scenario import Scenario
from .consistency import nees

_STEP = 1e-30  # of the complex step: it cancels no digits, so it may be as small as one likes
_LAGS = 5  # of the test for memory
_SMALL = 1e-6  # shrinks noise and start until the filter is linear to as many digits


@checked
@record
class Check:
    """One check of a filter and its outcome.

    Attributes
    ----------
    name : str
        Name of the check.
    kind : {"exact", "statistical"}
        Whether `value` is a difference that should be at most `limit`, or a p-value that should
        be at least that: the probability with which the check fails a filter that is right.
    value : float
        Difference, or p-value.
    limit : float
        Bound on `value`.

    Examples
    --------
    >>> Check("Jacobian equals a complex step", "exact", 1e-15, 1e-12).passed
    True
    """

    name: str
    kind: Literal["exact", "statistical"]
    value: Number
    limit: float

    @property
    def passed(self) -> bool:
        """Whether the filter passes the check; never if `value` is NaN."""
        good = self.value <= self.limit if self.kind == "exact" else self.value >= self.limit
        return bool(good)


@checked
def complex_step_jacobian(x: ArrayLike, array: RadarArray) -> FloatArray:
    """Return the Jacobian of the Doppler shifts by the complex-step method.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States in m and m/s.
    array : RadarArray
        The N sensors.

    Returns
    -------
    ndarray, shape (..., N, 6)
        Exact to rounding.

    Notes
    -----
    h(x + i e) = h(x) + i e h'(x) - ..., so the imaginary part over e is the derivative; no
    difference of nearly equal numbers is taken (Squire and Trapp 1998). This holds for h as the
    library has it, of ``+ - * /`` and roots. An h with ``norm``, ``abs`` or ``conj`` in it gives a
    wrong derivative without an error.

    Examples
    --------
    >>> complex_step_jacobian([1, 0, 0, -1, 0, 0], RadarArray([[0, 0, 0]])).round(9)[0, 3:].tolist()
    [-160.0, 0.0, 0.0]
    """
    x = _checks.moderate("x", x, (6,))
    check_clear_of_sensors("x", x, _checks.instance("array", array, RadarArray))
    x = x[..., None, None, :] + 1j * _STEP * np.eye(6)
    return shift_kernel(  # type: ignore[call-arg]  # four columns of the state and the sensors
        *np.moveaxis(x, -1, 0), *array.positions.T[:, :, None], array.doppler_per_speed
    ).imag / _STEP  # fmt: skip


@checked
def filter_checklist(
    tracker: Callable[..., Any],
    jacobian: Callable[..., Any],
    scenario: Scenario,
    *,
    rng: np.random.Generator,
    runs: Count = 200,
    samples: int = 100,
    deviation: float = 0.01,
) -> tuple[Check, ...]:
    """Run eight acceptance tests of a filter on simulations that match its model.

    Parameters
    ----------
    tracker : callable
        ``tracker(z, array, x0, P0, T, sigma_a, sigma_f)`` gives a `Track`, like `dopplerlib.ekf`;
        `z` has the shape (runs, K, N), and `x0` (runs, 6) belongs to one interval before.
    jacobian : callable
        ``jacobian(x, array)`` gives the derivative that the filter uses, shape (N, 6).
    scenario : Scenario
        Array, place, interval and noise.
    rng : numpy.random.Generator
        Source of randomness.
    runs : int
        Number of records for the statistical checks.
    samples : int
        Their length.
    deviation : float
        Standard deviation of the start in m and m/s: small, so that the filter is nearly linear.

    Returns
    -------
    tuple of Check
        The exact ones first. Each statistical one fails a filter that is right with a
        probability of 0.001. A value that cannot be computed from what the filter returns, such
        as NEES with a P that is no covariance, is NaN, and fails.

    Raises
    ------
    ValueError
        If an argument is of the wrong kind, or what `tracker` or `jacobian` returns has the wrong
        shape.

    Examples
    --------
    >>> from dopplerlib import doppler_jacobian, ekf
    >>> scenario = Scenario(
    ...     RadarArray.ring(6, 0.2), x0=[0.8, 0.1, 0.1, -0.7, 0, 0],
    ...     T=0.001, samples=100, sigma_f=0.4, sigma_a=0.4, P0=0.1 * np.eye(6),
    ... )
    >>> rng = np.random.default_rng(1)
    >>> checks = filter_checklist(ekf, doppler_jacobian, scenario, rng=rng, runs=20, samples=20)
    >>> [check.name for check in checks if not check.passed]
    []
    """
    samples = _checks.whole_number("samples", samples, least=_LAGS + 1)
    deviation = _checks.one_number("deviation", deviation, _checks.deviation)
    s, tracker = scenario, _checked(tracker)
    F, Q = constant_velocity(s.T, s.sigma_a)
    P0 = deviation**2 * np.eye(6)
    settings = P0, s.T, s.sigma_a, s.sigma_f
    path, z, start = _world(s, F, P0, runs, samples, rng)
    track = tracker(z, s.array, start, *settings)
    calm = np.array([s.x0 + k * s.T * np.r_[s.x0[3:], 0, 0, 0] for k in range(samples)])
    before = s.x0 - s.T * np.r_[s.x0[3:], 0, 0, 0]

    true_H = complex_step_jacobian(calm, s.array)
    H = np.stack([_checks.real("jacobian(x, array)", jacobian(x, s.array)) for x in calm])
    if H.shape != true_H.shape:
        raise ValueError(
            f"jacobian must return an array of shape {true_H.shape[1:]}, got {H.shape[1:]}"
        )
    quiet = tracker(doppler_shift(calm, s.array)[None], s.array, before[None], *settings)
    last = Track(track.x[:, -1:], track.P[:, -1:], None, None, None, None)
    dof = track.innovation.size
    return (
        Check("Jacobian equals a complex step", "exact", _relative(H, true_H), 1e-12),
        Check("linear limit equals the Kalman filter", "exact",
              _linear_limit(tracker, s, calm, before, P0, F, Q, rng), 1e-3),
        Check("P symmetric and positive", "exact", _of(_asymmetry, track.P), 1e-10),
        Check("axes renamed, same track", "exact", _renamed(tracker, s, z, start, track, settings),
              1e-6),
        Check("stays on the truth without noise", "exact", np.abs(quiet.x - calm).max(), 1e-9),
        Check("NIS average", "statistical", _two_sided(track.nis.sum(), dof), 1e-3),
        Check("innovations white", "statistical", _of(_memory, track), 1e-3),
        Check("NEES average", "statistical",
              _two_sided(_of(lambda: nees(last, path[:, -1:]).sum()), 6 * runs), 1e-3),
    )  # fmt: skip


def _world(s, F, P0, runs, samples, rng):
    """Return paths with process noise, measurements, and starts that err as `P0` says."""
    x = np.broadcast_to(s.x0 - s.T * np.r_[s.x0[3:], 0, 0, 0], (runs, 6))
    start = x + rng.multivariate_normal(np.zeros(6), P0, runs)
    path = np.empty((runs, samples, 6))
    push = np.r_[np.full(3, s.T**2 / 2), np.full(3, s.T)]  # the one acceleration of Eq 17
    for k in range(samples):
        x = x @ F.T + s.sigma_a * rng.standard_normal((runs, 1)) * push
        path[:, k] = x
    z = doppler_shift(path, s.array)
    return path, z + s.sigma_f * rng.standard_normal(z.shape), start


def _linear_limit(tracker, s, path, before, P0, F, Q, rng):
    """Return the distance of the filter from a Kalman filter when all errors are tiny."""
    e = _SMALL
    offset = rng.multivariate_normal(np.zeros(6), P0)
    noise = s.sigma_f * rng.standard_normal((len(path), len(s.array)))
    z = doppler_shift(path, s.array) + e * noise
    track = tracker(
        z[None], s.array, (before + e * offset)[None], e**2 * P0, s.T, e * s.sigma_a, e * s.sigma_f
    )
    R = s.sigma_f**2 * np.eye(len(s.array))
    linear = kf(noise, F, Q, doppler_jacobian(path, s.array), R, offset, P0)
    return _relative((track.x[0] - path) / e, linear.x)


def _renamed(tracker, s, z, start, track, settings):
    """Return the change of the track if x, y, z are called y, z, x."""
    array = RadarArray(np.roll(s.array.positions, 1, axis=-1), s.array.wavelength)

    def renamed(x):
        return np.roll(x.reshape(*x.shape[:-1], 2, 3), 1, axis=-1).reshape(x.shape)

    other = tracker(z, array, renamed(start), *settings)
    return float(np.abs(other.x - renamed(track.x)).max())


def _checked(tracker):
    """Return the filter as one that raises if it returns no track, or one of wrong shapes."""

    def checked(z, array, x0, *settings):
        track = _checks.instance("tracker(...)", tracker(z, array, x0, *settings), Track)
        for name, own in {"x": (6,), "P": (6, 6), "innovation": z.shape[2:], "S": z.shape[2:] * 2,
                          "nis": ()}.items():  # fmt: skip
            value = np.asarray(getattr(track, name))
            _checks.exact_shape(f"{name} of tracker(...)", value, (*z.shape[:2], *own))
        return track

    return checked


def _of(function, *arguments):
    """Return a number, or NaN if a broken filter returned none."""
    try:
        return function(*arguments)
    except (ValueError, np.linalg.LinAlgError):
        return np.nan


def _asymmetry(P):
    """Return the largest asymmetry relative to the largest entry; infinite if not definite."""
    spread = np.linalg.eigvalsh((P + P.mT) / 2)[..., 0].min()
    return np.abs(P - P.mT).max() / np.abs(P).max() if spread > 0 else np.inf


def _memory(track):
    """Return the p-value of the correlation of innovations with those of the samples before.

    The innovations of a right filter have the variance S, so unlike in `innovation_whiteness`
    nothing is estimated: with many runs the error of that would show.
    """
    white = np.linalg.solve(np.linalg.cholesky(track.S), track.innovation[..., None])
    products = [white[:, lag:] * white[:, :-lag] for lag in range(1, _LAGS + 1)]
    return float(chdtrc(_LAGS, sum(one.sum() ** 2 / one.size for one in products)))


def _relative(value, expected):
    return float(np.abs(value - expected).max() / np.abs(expected).max())


def _two_sided(total, dof):
    return float(2 * min(chdtr(dof, total), chdtrc(dof, total)))
