"""Observability of a state by an array: rank, bounds, ambiguities."""

from typing import Literal

import numpy as np
from scipy.special import ndtr

from .. import _checks
from .._hints import Count, Positive, checked
from .._typing import ArrayLike, FloatArray, IntArray
from ..estimation.maximum_likelihood import ml_initialize
from ..model.doppler import doppler_shift
from ..model.information import SINGULAR, fisher_information, free_components
from ..model.links import DopplerLinks, state_size
from ..model.radar_array import RadarArray


@checked
def observable_rank(
    x: ArrayLike,
    array: RadarArray | DopplerLinks,
    K: int | None = None,
    T: ArrayLike = 0.001,
    likelihood: Literal["stationary", "constant_velocity"] = "stationary",
    *,
    free: ArrayLike | None = None,
) -> IntArray:
    """Return the rank of the Fisher information, the number of observable components.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] at the first sample, in m and m/s; for links (..., n).
    array : RadarArray or DopplerLinks
        The N sensors or links.
    K, T, likelihood
        See `fisher_information`.
    free : array_like of bool, shape (6,) or (n,), optional
        Components that are unknown; all if None.

    Returns
    -------
    ndarray of int, shape (...)
        Number of eigenvalues, of the information scaled to a diagonal of ones, that are not
        rounding.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> int(observable_rank([0.8, 0.1, 0.1, -0.7, 0, 0], RadarArray.ring(12, 0.2)))
    5
    """
    free = free_components(free, state_size(array))
    J = fisher_information(x, array, 1.0, K, T, likelihood)[..., *np.ix_(free, free)]
    scale = np.sqrt(np.diagonal(J, axis1=-2, axis2=-1))
    scale = np.where(scale > 0, scale, 1.0)
    eigenvalue = np.linalg.eigvalsh(J / (scale[..., :, None] * scale[..., None, :]))
    return np.sum(eigenvalue > SINGULAR, axis=-1)


@checked
def rms_bounds(
    P: ArrayLike, x: ArrayLike | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the RMS errors of position, velocity and range of a covariance.

    Parameters
    ----------
    P : array_like, shape (..., 6, 6)
        Covariances, such as those of `crlb`; an infinite variance gives an infinite error.
    x : array_like, shape (..., 6), optional
        States, to which the range belongs; without them the range is left out.

    Returns
    -------
    position, velocity : ndarray, shape (...)
        In m and m/s.
    range : ndarray, shape (...)
        Along the line from the origin to the target, in m. Only with `x`.

    Examples
    --------
    >>> position, velocity = rms_bounds(np.diag([1.0, 4.0, 4.0, 0.0, 9.0, 16.0]))
    >>> float(position), float(velocity)
    (3.0, 5.0)
    """
    P = _checks.real("P", P)
    _checks.check_shape("P", P, (6, 6))
    variance = np.diagonal(P, axis1=-2, axis2=-1)
    if not (variance >= 0).all():
        raise ValueError(f"P must have no variance below zero and none missing, got {variance}")
    # An infinite variance has NaN covariances.
    lost = np.isinf(variance)
    known = ~(lost[..., :, None] | lost[..., None, :])
    P = _checks.moderate("P", np.where(known, P, np.eye(6)))
    _checks.covariance("P", P, 6, definite=False)
    bounds = tuple(np.sqrt(variance[..., part].sum(axis=-1)) for part in (np.s_[:3], np.s_[3:]))
    if x is None:
        return bounds
    x = _checks.moderate("x", x, (6,))
    _checks.check_broadcast("x", x.shape[:-1], "P", P.shape[:-2])
    p = x[..., :3]
    distance = np.hypot(np.hypot(p[..., 0], p[..., 1]), p[..., 2])[..., None]
    if not distance.all():
        raise ValueError("x must not lie at the origin, got a range of 0")
    along = p / distance
    # An infinite variance reaches every range that is not across it.
    reached = (lost[..., :3] & (along != 0)).any(axis=-1)
    square = np.where(known, P, 0.0)[..., :3, :3]
    square = np.einsum("...i,...ij,...j->...", along, square, along)
    return *bounds, np.sqrt(np.where(reached, np.inf, square))


@checked
def nearest_ambiguity(
    x: ArrayLike,
    array: RadarArray,
    sigma_f: float,
    K: Count,
    T: Positive,
    box: tuple[ArrayLike, ArrayLike],
    likelihood: Literal["stationary", "constant_velocity"] = "constant_velocity",
) -> tuple[FloatArray, float]:
    """Return the second-best fit to noise-free measurements, and its probability of winning.

    Parameters
    ----------
    x : array_like, shape (6,)
        True state at the first sample, in m and m/s.
    array : RadarArray
        The N sensors.
    sigma_f : float
        Standard deviation of the measurements in Hz.
    K : int
        Number of samples.
    T : float
        Sampling interval in s.
    box : pair of array_like, shape (6,)
        Lower and upper bounds of the state, see `ml_initialize`.
    likelihood : {"stationary", "constant_velocity"}
        See `ml_initialize`.

    Returns
    -------
    second_x : ndarray, shape (6,)
        The best other optimum of the likelihood; NaN if none was found.
    chance : float
        Probability that noise makes it more likely than the truth; 0 if none was found.

    Raises
    ------
    ValueError
        If `x` is not one state, or an argument is refused by `ml_initialize`.

    Notes
    -----
    The log-likelihood ratio of two given states is normal with mean D^2 / 2 and variance D^2,
    where D^2 is the chi-square by which the states' measurements differ. So the chance is the
    normal distribution at -D / 2. It leaves out that both optima move with the noise.

    Examples
    --------
    A flight past the ring and its best rival in the box, after five samples:

    >>> from dopplerlib import RadarArray
    >>> box = [0.5, -0.3, -0.3, -1.0, -0.5, -0.5], [1.2, 0.3, 0.3, -0.3, 0.5, 0.5]
    >>> x = [0.8, 0.1, 0.1, -0.7, 0.0, 0.0]
    >>> rival, share = nearest_ambiguity(x, RadarArray.ring(6, 0.2), 0.4, 5, 0.01, box)
    >>> round(share, 2)
    0.43
    """
    x = _checks.moderate("x", x, (6,))
    if x.ndim != 1:
        raise ValueError(f"x must be one state of shape (6,), got shape {x.shape}")
    sigma_f = _checks.one_number("sigma_f", sigma_f, _checks.deviation)
    path = np.tile(x, (K, 1))
    if likelihood == "constant_velocity":
        path[:, :3] += T * np.arange(K)[:, None] * path[:, 3:]
    start = ml_initialize(doppler_shift(path, array), array, sigma_f, T, box, likelihood)
    distance = np.sqrt(np.maximum(start.second_cost - start.cost, 0.0))
    return start.second_x, float(np.nan_to_num(ndtr(-distance / 2), nan=0.0))
