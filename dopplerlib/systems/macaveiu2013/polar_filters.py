"""Range, azimuth and range rate as the radar of Section III measures them, and two filters."""

from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Positive, Runs, checked, exactly, shaped
from ..._typing import FloatArray
from ...estimation import densities, gaussian, recursion
from ...estimation.extended_update import linearized
from ...estimation.track import Track
from ...model.motion import ncv_transition
from ...model.polar_radar import polar_position, polar_radar_h, polar_radar_jacobian
from .published import reported
from .settings import AutomotiveSettings, automotive_settings
from .truth import Truth

SIDEWAYS = 3.0  # m/s: deviation of the velocity across the line of sight before it is known; ours
Covariance = Literal["as along", "document", "open"]
Record = Annotated[FloatArray, exactly(None, None, 3, check=_checks.bounded)]


@checked
def polar_noise(sigma_phi: Positive | None = None) -> FloatArray:
    """Return the covariance of range, azimuth and range rate.

    sigma_phi: Standard deviation of the azimuth in rad; that of the data file if None.
    Returns (3, 3)

    Examples
    --------
    >>> np.sqrt(np.diag(polar_noise())).tolist()
    [0.25, 0.0175, 0.1]
    """
    radar = reported().scenario.polar
    sigma_phi = radar.sigma_phi if sigma_phi is None else sigma_phi
    return np.diag([radar.sigma_r, sigma_phi, radar.sigma_rate]) ** 2


@checked
def measure_polar(truth: Truth, runs: Runs, *, rng: np.random.Generator) -> FloatArray:
    """Return polar measurements of a path, with noise.

    truth (K, 4): True states [x, v_x, y, v_y].
    runs: Number of independent records.
    rng: Source of the noise.
    Returns (runs, K, 3): Range in m, azimuth in rad, range rate in m/s.
    Raises ValueError if an argument is not of the kind described, a target is on the radar, or the
        records would have more than ten million samples.

    Examples
    --------
    >>> measure_polar([[0.0, 0.0, 5.0, 0.0]] * 4, 2, rng=np.random.default_rng(1)).shape
    (2, 4, 3)
    """
    _checks.count("runs times samples", runs * len(truth), 10**7)
    seen = polar_radar_h(truth)
    draws = np.stack([child.standard_normal(seen.shape) for child in rng.spawn(runs)])
    return seen + draws * np.sqrt(np.diag(polar_noise()))


@checked
def start_polar(
    z: Annotated[FloatArray, shaped(3)],
    R: Annotated[FloatArray, exactly(3, 3)] | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Return state and covariance from one polar measurement.

    z (..., 3): Range, azimuth and range rate.
    R (3, 3): Covariance of the measurement; `polar_noise` if None.
    Returns x (..., 4): The velocity across the line of sight is zero, for lack of knowledge.
        P (..., 4, 4)

    Examples
    --------
    >>> x, P = start_polar([5.0, 0.0, 1.0])
    >>> x.tolist()
    [0.0, 0.0, 5.0, 1.0]
    """
    R = polar_noise() if R is None else R
    r, azimuth, rate = np.moveaxis(z, -1, 0)
    along = np.stack([np.sin(azimuth), np.cos(azimuth)], axis=-1)
    across = np.stack([np.cos(azimuth), -np.sin(azimuth)], axis=-1)

    def spread(deviation_along, deviation_across):
        return (
            deviation_along**2 * along[..., :, None] * along[..., None, :]
            + np.square(deviation_across)[..., None, None]
            * across[..., :, None]
            * across[..., None, :]
        )

    x = np.zeros((*z.shape[:-1], 4))
    x[..., ::2] = r[..., None] * along
    x[..., 1::2] = rate[..., None] * along
    P = np.zeros((*z.shape[:-1], 4, 4))
    P[..., ::2, ::2] = spread(R[0, 0] ** 0.5, r * R[1, 1] ** 0.5)
    P[..., 1::2, 1::2] = spread(R[2, 2] ** 0.5, np.full(r.shape, SIDEWAYS))
    return x, P


@checked
def track_polar(z: Record, s: AutomotiveSettings | None = None) -> Track:
    """Track with range, azimuth and range rate as they are: an extended Kalman filter.

    z (runs, K, 3): Polar measurements; NaN where a scan has none, but for the first one, which is
        the start.
    s: Motion model; those of the data file if None.
    Raises ValueError if an argument is not of the kind described, or a first measurement is not
        finite.

    Examples
    --------
    >>> z = [[[5.0, 0.0, 1.0], [5.04, 0.0, 1.0], [np.nan, np.nan, np.nan]]]
    >>> track_polar(z).updated.tolist()
    [[False, True, False]]
    """
    s = automotive_settings() if s is None else s
    _checks.finite("z[:, 0], where the track starts,", z[:, 0], (3,))
    R = polar_noise()

    def model(x, z):
        innovation, J = linearized(x, z, polar_radar_h, polar_radar_jacobian, wrap=(1,))
        return innovation, J, R

    return _track(z, s, start_polar(z[:, 0]), model)


@checked
def track_polar_naive(
    z: Record, s: AutomotiveSettings | None = None, covariance: Covariance = "as along"
) -> Track:
    """Track with the range rate taken for the velocity: the filter of Eqs 4 to 6 fed by a radar.

    z (runs, K, 3): Polar measurements, none missing.
    s: Those of the data file if None.
    covariance: E_z: the polar noise at the place of the target, turned into x and y, with a
        velocity that is as good across the line of sight as along it; the diagonal matrix of the
        document, that of `s`; or the first one with a velocity that is open across the line of
        sight.
    Raises ValueError if an argument is not of the kind described, or a measurement is not finite.

    Notes
    -----
    H = I asks for v_x and v_y. A radar has the range rate only; here it is turned into a vector
    along the line of sight.

    Examples
    --------
    >>> track_polar_naive([[[5.0, 0.0, 1.0], [5.04, 0.0, 1.0]]]).x.shape
    (1, 2, 4)
    """
    s = automotive_settings() if s is None else s
    z = _checks.finite("z", z, (None, 3))
    if not z[..., 0].all():
        raise ValueError("z must keep clear of the radar, got a range of 0")
    along = polar_position(z) / z[..., :1]
    full = np.zeros((*z.shape[:-1], 4))
    full[..., ::2] = polar_position(z)
    full[..., 1::2] = z[..., 2:] * along
    radar = reported().scenario.polar

    def model(x, both):
        cartesian, seen = both[..., :4], both[..., 4:]
        _, E_z = start_polar(seen)
        if covariance == "as along":
            E_z[..., 1::2, 1::2] = radar.sigma_rate**2 * np.eye(2)
        elif covariance == "document":
            E_z = s.E_z
        return cartesian - x, np.eye(4), E_z

    return _track(np.concatenate([full, z], axis=-1), s, start_polar(z[:, 0]), model)


def _track(z, s, begin, model):
    """Filter with a function that returns innovation, H and R of predicted states and a scan."""
    F, Q = ncv_transition(s.T), s.E_x

    def step(k, state):
        x, P = gaussian.predict(*state, F, Q)
        innovation, H, R = model(x, z[:, k])
        x, P, S = gaussian.update(x, P, innovation, H, R)
        return (x, P), (x, P, densities.quadratic_form(innovation, S))

    first = (*begin, np.full(len(z), np.nan))
    x, P, score = recursion.scan(step, begin, range(1, z.shape[1]), axis=1, first=first)
    _checks.estimates("z, s", x, P)
    return Track(x, P, None, None, score, np.isfinite(score))
