"""What an array can see of a state: how many directions, how well, and what it mistakes it for."""

from typing import Literal

import numpy as np
from scipy.stats import norm

from .._typing import ArrayLike, FloatArray, IntArray
from ..estimation.maximum_likelihood import ml_start
from ..model.doppler import doppler_shift
from ..model.information import SINGULAR, fisher_information
from ..model.radar_array import RadarArray


def seen_directions(
    x: ArrayLike,
    array: RadarArray,
    K: int = 1,
    T: float = 0.001,
    likelihood: Literal["static", "moving"] = "static",
    *,
    free: ArrayLike | None = None,
) -> IntArray:
    """Return the rank of the Fisher information: how many components are seen to first order.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States [x, y, z, v_x, v_y, v_z] at the first sample, in m and m/s.
    array : RadarArray
        The N sensors.
    K : int
        Number of samples.
    T : float
        Sampling interval in s.
    likelihood : {"static", "moving"}
        See `fisher_information`.
    free : array_like of bool, shape (6,), optional
        Components that are unknown; all if None.

    Returns
    -------
    ndarray of int, shape (...)
        Number of eigenvalues, of the information scaled to a diagonal of ones, that are not
        rounding.

    Raises
    ------
    ValueError
        If an argument is refused by `fisher_information`.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> int(seen_directions([0.8, 0.1, 0.1, -0.7, 0, 0], RadarArray.ring(12, 0.2)))
    5
    """
    J = fisher_information(x, array, 1.0, K, T, likelihood)
    if free is not None:
        J = J[..., *np.ix_(np.asarray(free, bool), np.asarray(free, bool))]
    scale = np.sqrt(np.diagonal(J, axis1=-2, axis2=-1))
    scale = np.where(scale > 0, scale, 1.0)
    eigenvalue = np.linalg.eigvalsh(J / (scale[..., :, None] * scale[..., None, :]))
    return np.sum(eigenvalue > SINGULAR, axis=-1)


def rms_bounds(
    P: ArrayLike, x: ArrayLike | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the root mean square errors of position, velocity and range that `P` stands for.

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
    """
    variance = np.diagonal(P, axis1=-2, axis2=-1)
    bounds = tuple(np.sqrt(variance[..., part].sum(axis=-1)) for part in (np.s_[:3], np.s_[3:]))
    if x is None:
        return bounds
    p = np.asarray(x, float)[..., :3]
    along = p / np.linalg.norm(p, axis=-1, keepdims=True)
    # An infinite variance has NaN covariances; it reaches every range that is not across it.
    lost = np.isinf(variance[..., :3])
    reached = (lost & (along != 0)).any(axis=-1)
    known = ~(lost[..., :, None] | lost[..., None, :])
    square = np.where(known, np.asarray(P, float)[..., :3, :3], 0.0)
    square = np.einsum("...i,...ij,...j->...", along, square, along)
    return *bounds, np.sqrt(np.where(reached, np.inf, square))


def confusion(
    x: ArrayLike,
    array: RadarArray,
    sigma_f: float,
    K: int,
    T: float,
    box: tuple[ArrayLike, ArrayLike],
    likelihood: Literal["static", "moving"] = "moving",
) -> tuple[FloatArray, float]:
    """Return the second-best explanation of noise-free measurements, and how often it wins.

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
        Lower and upper bounds of the state, see `ml_start`.
    likelihood : {"static", "moving"}
        See `ml_start`.

    Returns
    -------
    second_x : ndarray, shape (6,)
        The best other optimum of the likelihood; NaN if none was found.
    chance : float
        Probability that noise makes it more likely than the truth; 0 if none was found.

    Raises
    ------
    ValueError
        If an argument is refused by `ml_start`.

    Notes
    -----
    The log-likelihood ratio of two given states is normal with mean D^2 / 2 and variance D^2,
    where D^2 is the chi-square by which the states' measurements differ. So the chance is the
    normal distribution at -D / 2. It leaves out that both optima move with the noise.
    """
    path = np.tile(np.asarray(x, float), (K, 1))
    if likelihood == "moving":
        path[:, :3] += T * np.arange(K)[:, None] * path[:, 3:]
    start = ml_start(doppler_shift(path, array), array, sigma_f, T, box, likelihood)
    distance = np.sqrt(np.maximum(start.second_cost - start.cost, 0.0))
    return start.second_x, float(np.nan_to_num(norm.cdf(-distance / 2), nan=0.0))
