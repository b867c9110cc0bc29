"""Consistency of a filter: its errors should have the size that it claims."""

import numpy as np

from .. import _checks


def nees(track, truth):
    """Return the normalized estimation error squared.

    Parameters
    ----------
    track : Track
        Estimates `x` and covariances `P`.
    truth : array_like, shape (..., K, n)
        True states; broadcasts against ``track.x``.

    Returns
    -------
    ndarray, shape (..., K)
        Chi-square distributed with n degrees of freedom if the filter is consistent.

    Raises
    ------
    ValueError
        If the shapes do not fit, `truth` is not finite, the track was made without `P`, or a `P`
        is singular or gives a negative value, which no covariance does.

    Notes
    -----
    Mittermaier et al. (2016), Eq 12.

    Examples
    --------
    Three deviations off in one axis, four in the other, at the second of two samples:

    >>> from dopplerlib import Track
    >>> x, P = np.array([[0.0, 0.0], [3.0, 4.0]]), np.stack([np.eye(2)] * 2)
    >>> track = Track(x, P, innovation=None, S=None, nis=None, updated=None)
    >>> nees(track, truth=np.zeros((2, 2))).tolist()
    [0.0, 25.0]
    """
    if track.P is None:
        raise ValueError('track must hold P, got None: ask ekf for it with keep=("P",)')
    truth = _checks.finite("truth", truth, track.x.shape[-2:])
    _checks.check_broadcast("truth", truth.shape[:-2], "track.x", track.x.shape[:-2])
    # Definiteness is not checked beforehand: it would take longer than all the rest.
    try:
        values = _quadratic_form(truth - track.x, track.P)
    except np.linalg.LinAlgError:
        raise ValueError("track.P must be positive definite, got a singular matrix") from None
    if (values < 0).any():
        raise ValueError(f"track.P must be positive definite, got a NEES of {values.min():.3g}")
    return values


def nis(innovation, S):
    """Return the normalized innovation squared.

    Parameters
    ----------
    innovation : array_like, shape (..., m)
        Measurement minus predicted measurement.
    S : array_like, shape (..., m, m)
        Its covariance.

    Returns
    -------
    ndarray, shape (...)
        Chi-square distributed with m degrees of freedom if the filter is consistent.

    Raises
    ------
    ValueError
        If the shapes do not fit, a value is not finite, or `S` is not a covariance (symmetric and
        positive definite).

    Notes
    -----
    Mittermaier et al. (2016), Eq 14.

    Examples
    --------
    >>> float(nis([3.0, 4.0], np.eye(2)))
    25.0
    """
    innovation = _checks.finite("innovation", innovation, (None,))
    m = innovation.shape[-1]
    S = _checks.covariance("S", S, m)
    _checks.check_broadcast("innovation", innovation.shape[:-1], "S", S.shape[:-2])
    return _quadratic_form(innovation, S)


def chi2_interval(dof, runs=1, confidence=0.95):
    """Return the interval in which a consistent filter's average NEES or NIS lies.

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

    Raises
    ------
    ValueError
        If `dof` or `runs` is not a positive whole number, or `confidence` not between 0 and 1.

    Notes
    -----
    Mittermaier et al. (2016), Section 3.5: [1.237, 14.449] for six degrees of freedom and one
    run. The sum of M independent values has M times the degrees of freedom.

    Examples
    --------
    >>> [round(bound, 3) for bound in chi2_interval(6)]
    [1.237, 14.449]
    """
    from scipy.stats import chi2  # here: it takes longer to load than all the rest

    dof = _checks.whole_number("dof", dof)
    runs = _checks.whole_number("runs", runs)
    tail = (1 - _checks.probability("confidence", confidence)) / 2
    return float(chi2.ppf(tail, dof * runs) / runs), float(chi2.isf(tail, dof * runs) / runs)


def _quadratic_form(error, covariance):
    return np.sum(error * np.linalg.solve(covariance, error[..., None])[..., 0], axis=-1)
