"""Probabilistic data association (PDA)."""

import numpy as np

from .. import _checks
from .._hints import AboveZero, Probability, checked
from .._records import record
from .._typing import ArrayLike
from ..estimation import covariances, densities, gaussian


@record
class PdaUpdate:
    """Result of an update by probabilistic data association.

    Attributes
    ----------
    x : ndarray, shape (..., n)
        State estimates.
    P : ndarray, shape (..., n, n)
        Covariances, with the spread between the possible associations.
    missed : ndarray, shape (...)
        Chance that no detection is of the target.
    weight : ndarray, shape (..., M)
        Chance of each detection to be of the target; zero outside the gate.
    """

    x: np.ndarray
    P: np.ndarray
    missed: np.ndarray
    weight: np.ndarray


@checked
@_checks.quiet
def pda_update(
    x: ArrayLike,
    P: ArrayLike,
    z: ArrayLike,
    H: ArrayLike,
    R: ArrayLike,
    *,
    detection: Probability,
    density: AboveZero,
    gate: Probability = 0.999,
) -> PdaUpdate:
    """Measurement update by probabilistic data association.

    Parameters
    ----------
    x : array_like, shape (..., n)
        Predicted states.
    P : array_like, shape (..., n, n)
        Predicted covariances; they may be singular.
    z : array_like, shape (..., M, m)
        Detections; there may be none. One with a NaN in it is not there: densities of detections
        with other components cannot be compared.
    H : array_like, shape (..., m, n)
        Measurement matrix.
    R : array_like, shape (..., m, m)
        Covariance of the measurement noise. Leading axes of all arguments broadcast against one
        another.
    detection : float
        Chance that the target is detected.
    density : float
        Expected number of false detections per unit of volume of measurements.
    gate : float
        Chance that a detection of the target is inside the gate.

    Returns
    -------
    PdaUpdate

    Notes
    -----
    Bar-Shalom, Daum and Huang (2009), the parametric form: false detections are a Poisson process.
    The result is the Gaussian with the mean and the covariance of the mixture over all
    associations.

    Examples
    --------
    Two detections, as far on the one side as on the other: the state stays, and is less certain
    than if it had taken either.

    >>> step = pda_update([0.0], [[1.0]], [[1.0], [-1.0]], [[1]], [[1]], detection=0.9, density=0.1)
    >>> step.x.tolist(), step.weight.round(2).tolist(), bool(step.P[0, 0] > 0.5)
    ([0.0], [0.49, 0.49], True)
    """
    from scipy.special import gammaincinv  # here: it takes longer to load than all the rest

    x = _checks.finite("x", x, (None,))
    n = x.shape[-1]
    P = _checks.covariance("P", P, n, definite=False)
    H = _checks.finite("H", H, (None, n))
    m = H.shape[-2]
    z = _checks.detections("z", z, m)
    R = _checks.covariance("R", R, m)
    _checks.check_leading(x=(x, 1), P=(P, 2), z=(z, 2), H=(H, 2), R=(R, 2))

    K, updated, S = gaussian.gain(P, H, R)
    nu = gaussian.innovation(x[..., None, :], z, H[..., None, :, :])
    there = ~np.isnan(nu).any(axis=-1)
    nu = np.where(there[..., None], nu, 0.0)
    inside = there & (densities.quadratic_forms(nu, S) <= 2 * gammaincinv(m / 2, gate))
    nu = np.where(inside[..., None], nu, 0.0)
    odds = np.log(detection) - np.log(density) + densities.log_density(nu, S[..., None, :, :])
    weight, missed = _shares(np.where(inside, odds, -np.inf), np.log1p(-detection * gate))

    # The mixture of the prediction and the updates with each detection: all move by K, and what
    # is updated has one covariance.
    mean = np.sum(weight[..., None] * nu, axis=-2)
    off = np.sqrt(weight)[..., None] * (nu - mean[..., None, :])
    stay = np.sqrt(missed)[..., None] * mean
    spread = covariances.squared(K @ np.concatenate([off, stay[..., None, :]], axis=-2).mT)
    share = missed[..., None, None]
    x, P = gaussian.moved(x, K, mean), share * P + (1 - share) * updated + spread
    _checks.estimates("x, P, z, H, R", x, P, weight)
    return PdaUpdate(x, P, missed, weight)


def _shares(odds, none):
    """Return the probabilities of all detections and of none from the logarithms of their odds."""
    most = np.maximum(odds.max(axis=-1, initial=-np.inf), none)
    with np.errstate(under="ignore"):  # a probability of zero is what it should be
        odds, none = np.exp(odds - most[..., None]), np.exp(none - most)
        total = none + odds.sum(axis=-1)
        return odds / total[..., None], none / total
