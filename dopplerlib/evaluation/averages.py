"""Averages of NIS and NEES: intervals and effective sample sizes."""

import numpy as np

from .. import _checks
from .._hints import AboveZero, Count, Probability, checked
from .._typing import ArrayLike, FloatArray


@checked
def average_interval(
    dof: Count, samples: AboveZero, confidence: Probability = 0.95
) -> tuple[float, float]:
    """Interval for the mean of chi-square values with a given effective sample size.

    Parameters
    ----------
    dof : int
        Degrees of freedom of one value.
    samples : float
        Effective number of independent values, which needs not be whole; see `effective_samples`
        and `nees_samples`.
    confidence : float
        Probability that the average lies inside.

    Returns
    -------
    lower, upper : float
        Bounds of the central interval.

    Notes
    -----
    For a whole number of independent values it is `chi2_interval`, and exact. Otherwise the average
    is taken for a multiple of a chi-square variable with the same mean and variance
    (Satterthwaite 1946).

    Examples
    --------
    A thousand values in a row that are worth only ten:

    >>> [round(bound, 2) for bound in average_interval(6, 1000)]
    [5.79, 6.22]
    >>> [round(bound, 2) for bound in average_interval(6, 10)]
    [4.05, 8.33]
    """
    from scipy.special import chdtri, gammaincinv

    tail = (1 - confidence) / 2
    total = dof * samples
    low, high = 2 * gammaincinv(total / 2, tail), chdtri(total, tail)  # quantiles of chi-square
    return float(low / samples), float(high / samples)


def effective_samples(autocorrelation: ArrayLike, samples: int) -> FloatArray:
    """Return the effective sample size of correlated values.

    Parameters
    ----------
    autocorrelation : array_like, shape (..., L)
        Of the values, at lags 1 to L; zero beyond.
    samples : int
        Number of values averaged, K, more than L.

    Returns
    -------
    ndarray, shape (...)
        Variance of one value divided by the variance of the average.

    Raises
    ------
    ValueError
        If the autocorrelation is not finite or does not fit `samples`, or the variance that it
        gives is not positive.

    Notes
    -----
    K / (1 + 2 sum (1 - l/K) rho_l): the variance of a sum is the sum of all covariances, and lag l
    occurs K - l times on either side.

    Examples
    --------
    If neighbors are correlated by 0.9, and those m apart by 0.9^m, then 1000 values are worth
    about 1000 (1 - 0.9) / (1 + 0.9):

    >>> round(float(effective_samples(0.9 ** np.arange(1, 1000), 1000)))
    53
    """
    autocorrelation = _checks.moderate("autocorrelation", autocorrelation, (None,))
    samples = _checks.whole_number("samples", samples)
    lags = autocorrelation.shape[-1]
    if lags >= samples:
        raise ValueError(f"autocorrelation must have fewer lags than samples {samples}, got {lags}")
    weight = 1 - np.arange(1, lags + 1) / samples
    inflation = 1 + 2 * np.sum(weight * autocorrelation, axis=-1)
    if not (inflation > 0).all():
        raise ValueError(
            "autocorrelation must give an average of positive variance, got "
            f"{inflation.min():.3g} times that of independent values"
        )
    return samples / inflation


def nees_samples(P: ArrayLike, F: ArrayLike, Q: ArrayLike) -> float:
    """Return the effective sample size of the time-averaged NEES of a consistent filter.

    Parameters
    ----------
    P : array_like, shape (K, n, n)
        Covariances after the updates, such as those of a `Track`.
    F, Q : array_like, shape (n, n) or (K, n, n)
        Transition matrix and covariance of the process noise; of each sample from the one before
        to it, if times are uneven.

    Returns
    -------
    float
        Between 1 and K: variance of one value, 2 n, divided by that of the average. Components
        that are known, with a variance of zero at all times, do not count.

    Raises
    ------
    ValueError
        If the shapes do not fit, a matrix is not finite or no covariance, `P` is singular in
        another way than by components that are known, or `F` and `Q` predict a covariance that is
        singular to rounding.

    Notes
    -----
    The error of a right linear filter follows e_k = Phi_k e_(k-1) + noise that is new, with
    Phi_k = (I - K_k H_k) F = P_k (F P_(k-1) F' + Q)^-1 F. Divided by the factors of the
    covariances, P = L L', errors at two times have the covariance
    C = L_k^-1 Phi_k ... Phi_(j+1) L_j, and being Gaussian, their squared lengths have as
    covariance twice the sum of the squares of all entries of C.

    Examples
    --------
    A constant with no noise of its own is averaged from measurements: all its errors are nearly
    the same one.

    >>> P = 1 / np.arange(1.0, 101)[:, None, None]
    >>> round(nees_samples(P, [[1]], [[0]]), 1)
    2.0
    """
    P = _checks.finite("P", P, (None, None, None))
    if P.ndim != 3 or not P.size:
        raise ValueError(f"P must have shape (K, n, n), got {P.shape}")
    samples, n = P.shape[:2]
    unknown = np.diagonal(P, axis1=-2, axis2=-1).any(axis=0)
    F = _checks.each_sample("F", _checks.finite("F", F, (n, n)), samples, (n, n))
    Q = _checks.covariance("Q", Q, n, definite=False)
    Q = _checks.each_sample("Q", Q, samples, (n, n))
    if not unknown.all():
        _checks.covariance("P", P, n, definite=False)
        if not unknown.any():
            raise ValueError("P must have a positive variance, got a state that is known exactly")
        block = np.ix_(range(samples), unknown, unknown)
        P, F, Q, n = P[block], F[block], Q[block], int(unknown.sum())
    P = _checks.covariance("P", P, n)
    L = np.linalg.cholesky(P)
    with np.errstate(all="ignore"):
        predicted = F[1:] @ P[:-1] @ F[1:].mT + Q[1:]
        # C of neighbors: L_k^-1 P_k = L_k', so that only the prediction has to be solved for.
        try:
            step = L[1:].mT @ np.linalg.solve(predicted, F[1:] @ L[:-1])
        except np.linalg.LinAlgError:
            raise ValueError(
                "F and Q must make F P F' + Q nonsingular, got one that is singular to rounding"
            ) from None
        C, total = step, 0.0
        for lag in range(1, len(P)):
            total += np.sum(C**2)
            C = step[lag:] @ C[:-1]
    _checks.estimates("P, F, Q", np.asarray(total), what="correlations")
    return float(n * len(P) ** 2 / (n * len(P) + 2 * total))
