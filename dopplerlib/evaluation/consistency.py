"""Filter consistency: NEES and NIS."""

import numpy as np

from .. import _checks
from .._hints import Count, Probability, checked
from .._typing import ArrayLike, FloatArray
from ..estimation import densities
from ..estimation.imm import ImmTrack
from ..estimation.track import Track
from ._innovations import estimates, measured, whiten


def nees(track: Track | ImmTrack, truth: ArrayLike) -> FloatArray:
    """Return the normalized estimation error squared.

    Parameters
    ----------
    track : Track or ImmTrack
        Estimates `x` and covariances `P`; any record that has them will do.
    truth : array_like, shape (..., K, n)
        True states; broadcasts against ``track.x``.

    Returns
    -------
    ndarray, shape (..., K)
        Chi-square distributed with n degrees of freedom if the filter is consistent; where `P` is
        singular, with as many as its rank.

    Raises
    ------
    ValueError
        If the shapes do not fit, a value is not finite, the track was made without `P`, a `P` is no
        covariance, or it is singular and the state errs where it has no spread.

    Notes
    -----
    Mittermaier et al. (2016), Eq 12. A component that is known, such as the height of a target in
    a plane, has the variance zero, and takes no part if its error is zero as well: the inverse of P
    is then that of the others, in general the pseudo-inverse after scaling to a diagonal of ones.

    Examples
    --------
    Three deviations off in one axis, four in the other, at the second of two samples:

    >>> from dopplerlib import Track
    >>> x, P = np.array([[0.0, 0.0], [3.0, 4.0]]), np.stack([np.eye(2)] * 2)
    >>> track = Track(x, P, innovation=None, S=None, nis=None, updated=None)
    >>> nees(track, truth=np.zeros((2, 2))).tolist()
    [0.0, 25.0]
    """
    x, P, factor = estimates(track)
    truth = _checks.finite("truth", truth, x.shape[-2:])
    _checks.check_broadcast("truth", truth.shape[:-2], "track.x", x.shape[:-2])
    with np.errstate(over="ignore"):
        error = truth - x
    _checks.estimates("track, truth", error, what="errors")
    if factor is None:
        return _form_of_singular(error, P, np.maximum(np.abs(truth), np.abs(x)))
    return np.sum(whiten(error, P, "track, truth", factor) ** 2, axis=-1)


def nis(innovation: ArrayLike, S: ArrayLike) -> FloatArray:
    """Return the normalized innovation squared.

    Parameters
    ----------
    innovation : array_like, shape (..., m)
        Measurement minus predicted measurement; NaN where it is missing.
    S : array_like, shape (..., m, m)
        Its covariance.

    Returns
    -------
    ndarray, shape (...)
        Chi-square distributed if the filter is consistent, with as many degrees of freedom as there
        are components that are not NaN; NaN where all are.

    Raises
    ------
    ValueError
        If the shapes do not fit, an innovation is infinite, or `S` is not a covariance (symmetric
        and positive definite) of the components that are there.

    Notes
    -----
    Mittermaier et al. (2016), Eq 14. The components that are there are Gaussian with their own part
    of `S`, whatever the others would have been.

    Examples
    --------
    >>> float(nis([3.0, 4.0], np.eye(2)))
    25.0
    """
    innovation, S, there = measured(innovation, S)
    value = densities.quadratic_form(innovation, S)
    _checks.estimates("innovation, S", value, what="NIS")
    return np.where(there.any(axis=-1), value, np.nan)[()]


@checked
def chi2_interval(
    dof: Count, runs: Count = 1, confidence: Probability = 0.95
) -> tuple[float, float]:
    """Return the interval for the average NEES or NIS of a consistent filter.

    Parameters
    ----------
    dof : int
        Degrees of freedom of one value: the length of the state (NEES) or measurement (NIS).
    runs : int
        Number of *independent* values that were averaged.
    confidence : float
        Probability that the average lies inside.

    Returns
    -------
    lower, upper : float
        Bounds of the central interval.

    Notes
    -----
    Mittermaier et al. (2016), Section 3.5: [1.237, 14.449] for six degrees of freedom and one
    run. The sum of M independent values has M times the degrees of freedom.

    Examples
    --------
    >>> [round(bound, 3) for bound in chi2_interval(6)]
    [1.237, 14.449]
    """
    from scipy.special import chdtri, gammaincinv  # scipy.stats takes far longer to load

    tail = (1 - confidence) / 2
    low, high = 2 * gammaincinv(dof * runs / 2, tail), chdtri(dof * runs, tail)
    return float(low / runs), float(high / runs)


def _form_of_singular(error, P, size):
    """Return the quadratic form with the pseudo-inverse, or raise if an error has no variance."""
    deviation = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    known = deviation == 0
    scale = np.where(known, 1.0, deviation)
    value, vector = np.linalg.eigh(P / (scale[..., :, None] * scale[..., None, :]))
    along = (vector.mT @ np.where(known, 0.0, error / scale)[..., None])[..., 0]
    null = value <= P.shape[-1] ** 2 * np.finfo(float).eps  # as in `covariances.solve`
    # A direction whose variance is rounding is known to a millionth of a deviation, and no state
    # better than to 1e-9 of its size.
    rounding = 1e-9 * size
    wrong = np.where(known, np.abs(error), 0.0) > rounding
    limit = 1e-6 + np.linalg.norm(np.where(known, 0.0, rounding / scale), axis=-1, keepdims=True)
    if wrong.any() or (null & (np.abs(along) > limit)).any():
        raise ValueError(
            "track.P must be positive definite, or the estimate right where it has no spread, got "
            f"a singular matrix and errors of up to {np.abs(error).max():.3g}"
        )
    return np.sum(np.where(null, 0.0, along**2 / np.where(null, 1.0, value)), axis=-1)
