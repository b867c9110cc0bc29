"""Probabilistic data association: use every detection, each by its chance of being the target."""

import numpy as np

from .. import _checks
from .._records import record
from ..estimation.linear_kalman import _check_leading


@record
class PdaUpdate:
    """What a step of probabilistic data association returns.

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


def pda_update(x, P, z, H, R, *, detection, density, gate=0.999):
    """Update a state with several detections, of which at most one is of the target.

    Parameters
    ----------
    x : array_like, shape (..., n)
        Predicted states.
    P : array_like, shape (..., n, n)
        Predicted covariances, positive definite.
    z : array_like, shape (..., M, m)
        Detections; a detection with a NaN in it is not there.
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

    Raises
    ------
    ValueError
        If a shape does not fit, a value is not finite (but for a NaN in `z`), `P` or `R` is not
        positive definite, a probability is not between 0 and 1, or `density` is not positive.

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
    from scipy.stats import chi2  # here: it takes longer to load than all the rest

    x = _checks.finite("x", x, (None,))
    n = x.shape[-1]
    P = _checks.covariance("P", P, n)
    z = _checks.real("z", z)
    _checks.check_shape("z", z, (None, None))
    if np.isinf(z).any():
        raise ValueError("z must be finite, or NaN where it is missing, got an infinite value")
    m = z.shape[-1]
    H = _checks.finite("H", H, (m, n))
    R = _checks.covariance("R", R, m)
    _check_leading({"x": (x, 1), "P": (P, 2), "z": (z, 2), "H": (H, 2), "R": (R, 2)})
    detection, gate = _checks.probability("detection", detection), _checks.probability("gate", gate)
    density = _checks.positive_number("density", density)

    Ht = np.swapaxes(H, -1, -2)
    S = H @ P @ Ht + R
    K = np.swapaxes(np.linalg.solve(S, H @ P), -1, -2)
    nu = z - (H @ x[..., None])[..., None, :, 0]
    there = ~np.isnan(nu).any(axis=-1)
    nu = np.where(there[..., None], nu, 0.0)
    nis = np.sum(nu * np.linalg.solve(S[..., None, :, :], nu[..., None])[..., 0], axis=-1)
    inside = there & (nis <= chi2.ppf(gate, m))
    volume = np.sqrt(np.linalg.det(2 * np.pi * S))[..., None]
    odds = np.where(inside, detection / density * np.exp(-nis / 2) / volume, 0.0)
    none = 1 - detection * gate
    total = none + odds.sum(axis=-1)
    weight, missed = odds / total[..., None], none / total
    mean = np.einsum("...j,...ji->...i", weight, nu)
    second = np.einsum("...j,...ji,...jk->...ik", weight, nu, nu)
    spread = second - mean[..., :, None] * mean[..., None, :] - (1 - missed)[..., None, None] * S
    x = x + (K @ mean[..., None])[..., 0]
    P = P + K @ spread @ np.swapaxes(K, -1, -2)
    return PdaUpdate(x, (P + np.swapaxes(P, -1, -2)) / 2, missed, weight)
