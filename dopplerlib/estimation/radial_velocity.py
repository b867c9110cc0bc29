"""Sequential update of a position filter by a radial velocity (pseudo-measurement)."""

from typing import Literal

import numpy as np

from .. import _checks
from .._hints import checked
from .._records import record
from .._typing import ArrayLike, FloatArray
from . import covariances, gaussian


@record
class RadialVelocity:
    """Terms of a radial-velocity update.

    Attributes
    ----------
    H : ndarray, shape (..., 1, 2 n)
        Measurement matrix [(A v)', Lambda].
    C : ndarray, shape (..., 2 n, 2 n)
        B P, from which bias and extra variance come.
    R : ndarray, shape (..., 1, 1)
        Variance of the measurement and of the neglected second order together.
    predicted : ndarray, shape (..., 1)
        Expected measurement, u.v plus the trace of C.
    """

    H: np.ndarray
    C: np.ndarray
    R: np.ndarray
    predicted: np.ndarray


@checked
@_checks.quiet
def radial_velocity_terms(
    x: ArrayLike,
    P: ArrayLike,
    sigma: ArrayLike,
    variance: Literal["corrected", "published"] = "corrected",
) -> RadialVelocity:
    """Return matrix, bias and variance of the pseudo-measurement of a radial velocity.

    Parameters
    ----------
    x : array_like, shape (..., 2 n)
        Position, then velocity, in n dimensions and relative to the radar, in m and m/s. The
        position must not be zero.
    P : array_like, shape (..., 2 n, 2 n)
        Covariance.
    sigma : float or array_like, shape (...)
        Standard deviation of the measured velocity in m/s. Leading axes of all arguments broadcast
        against one another.
    variance : {"corrected", "published"}
        How the variance of the second order is computed: twice the trace of C C, which is
        2 sum c_ij c_ji, or 2 sum c_ij^2 as Eq 3.22 prints it.

    Returns
    -------
    RadialVelocity

    Notes
    -----
    Åsheim (2015), Eqs 3.20 to 3.22, after Wang, He and Long (2003), with the published square root
    of Y'Y inverted: only then is Lambda a unit vector and H the derivative of u.v. B is that of
    the text: half the second derivative between position and velocity, without the one in the
    position twice. For a single radar in one dimension A, B and C vanish, and what is left is the
    measurement of a component of the state.

    Examples
    --------
    On a line the matrix picks the velocity, and nothing is neglected:

    >>> terms = radial_velocity_terms([2.0, 0.1], np.eye(2), 0.1)
    >>> terms.H.tolist(), terms.C.tolist(), terms.R.round(3).tolist()
    ([[0.0, 1.0]], [[0.0, 0.0], [0.0, 0.0]], [[0.01]])
    """
    x = _checks.finite("x", x, (None,))
    if x.shape[-1] % 2 or not x.shape[-1]:
        raise ValueError(f"x must hold positions and velocities, got {x.shape[-1]} components")
    P = _checks.covariance("P", P, x.shape[-1], definite=False)
    sigma = _checks.deviation("sigma", sigma)
    _checks.check_leading(x=(x, 1), P=(P, 2), sigma=(sigma, 0))
    terms = _terms(x, P, sigma, variance)
    _checks.estimates("x, P, sigma", *vars(terms).values(), what="terms")
    return terms


@checked
@_checks.quiet
def radial_velocity_update(
    x: ArrayLike,
    P: ArrayLike,
    z: ArrayLike,
    sigma: ArrayLike,
    variance: Literal["corrected", "published"] = "corrected",
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Measurement update by a radial velocity.

    Parameters
    ----------
    x : array_like, shape (..., 2 n)
        State after the position update: position, then velocity, relative to the radar.
    P : array_like, shape (..., 2 n, 2 n)
        Its covariance.
    z : array_like, shape (...)
        Measured radial velocity in m/s, positive when receding; NaN where it is missing. Leading
        axes of all arguments broadcast against one another.
    sigma : float or array_like, shape (...)
        Its standard deviation in m/s.
    variance : {"corrected", "published"}
        See `radial_velocity_terms`.

    Returns
    -------
    x : ndarray, shape (..., 2 n)
    P : ndarray, shape (..., 2 n, 2 n)
    innovation : ndarray, shape (..., 1)
    S : ndarray, shape (..., 1, 1)

    Notes
    -----
    Åsheim (2015), Eqs 3.23 to 3.27, with the innovation z - trace(C) - h(x), as the code of the
    thesis has it up to the first order, and the covariance in Joseph form.

    Examples
    --------
    >>> x, P, innovation, S = radial_velocity_update([2.0, 0.0], np.eye(2), 0.2, 1.0)
    >>> x.tolist(), innovation.tolist(), S.tolist()
    ([2.0, 0.1], [0.2], [[2.0]])
    """
    z = _checks.measured("z", z, ())
    x, P = _checks.finite("x", x, (None,)), _checks.finite("P", P, (None, None))
    sigma = _checks.deviation("sigma", sigma)
    _checks.check_leading(x=(x, 1), P=(P, 2), z=(z, 0), sigma=(sigma, 0))
    terms = radial_velocity_terms(x, P, sigma, variance)
    innovation = z[..., None] - terms.predicted
    x, P, S = gaussian.update(x, P, innovation, terms.H, terms.R)
    _checks.estimates("x, P, z, sigma", x, P, S)
    return x, P, innovation, S


def _terms(x, P, sigma, variance):
    n = x.shape[-1] // 2
    Y, v = x[..., :n], x[..., n:]
    d = np.linalg.norm(Y, axis=-1)
    if not d.all():
        raise ValueError(
            "x must have a position whose square is positive, where a direction is radial, got "
            f"{Y[d == 0][0].tolist()}"
        )
    u = Y / d[..., None]
    A = (np.eye(n) - u[..., :, None] * u[..., None, :]) / d[..., None, None]
    B = np.zeros((*d.shape, 2 * n, 2 * n))
    B[..., :n, n:] = B[..., n:, :n] = A / 2
    C = B @ P
    H = np.concatenate([(A @ v[..., None])[..., 0], u], axis=-1)[..., None, :]
    if variance == "corrected":  # The trace of C C, as a sum of squares: that of L' B L squared.
        L = covariances.square_root(P)
        extra = 2 * np.sum((L.mT @ B @ L) ** 2, axis=(-2, -1))
    else:
        extra = 2 * np.sum(C**2, axis=(-2, -1))
    R = (sigma**2 + extra)[..., None, None]
    predicted = np.einsum("...i,...i->...", u, v) + np.trace(C, axis1=-2, axis2=-1)
    return RadialVelocity(H, C, R, predicted[..., None])
