"""Correlated measurement errors under a filter that takes them for white: remedies and their loss.

The errors are AR(1): those of neighbors have the correlation rho, those of samples m apart rho^m.
Remedies are to keep every m-th sample, to raise R, or to estimate the error (`colored_errors`),
which is optimal.
"""

import warnings

import numpy as np

from .. import _checks
from .._hints import Count, Positive, Probability, Real, checked
from .._records import record
from .._typing import ArrayLike
from . import covariances
from .steady_state import steady_state_gain


@record
class Thinning:
    """Interval of the samples that are kept of a record with correlated errors, and its cost.

    Attributes
    ----------
    every : int
        Every which sample is kept.
    correlation : float
        Of the errors of neighbors that are kept.
    rejected : float
        Probability that a test of whiteness rejects the errors that are kept.
    efficiency : float
        Information about a constant in the samples kept, over that in all samples.
    variance_ratio : float
        Variance of the mean of the samples kept, over the one for white errors.
    """

    every: int
    correlation: float
    rejected: float
    efficiency: float
    variance_ratio: float


@record
class SteadyError:
    """Covariance of the error of a settled filter: the actual one, and the reported one.

    Attributes
    ----------
    actual : ndarray, shape (n, n)
        Covariance of the error, mean over the samples.
    reported : ndarray, shape (n, n)
        Covariance that the filter computes, mean over the samples.
    """

    actual: np.ndarray
    reported: np.ndarray


@checked
@_checks.quiet
def thinning(
    rho: Real,
    samples: Count,
    *,
    level: Probability = 0.05,
    rejected: Probability = 0.1,
    lags: Count = 10,
) -> Thinning:
    """Return the fewest AR(1) errors to leave out so that those kept pass as white.

    Parameters
    ----------
    rho : float
        Correlation of neighbors, above -1 and below 1.
    samples : int
        Length of the record.
    level : float
        Probability with which the test rejects errors that are white.
    rejected : float
        Largest probability, above `level`, with which it may reject those that are kept.
    lags : int
        Number of lags of the test; all lags if fewer samples are kept.

    Returns
    -------
    Thinning
        Keep ``z[..., ::every, :]``, and filter it with the interval `every` T.

    Notes
    -----
    Errors m apart have the correlation rho^m. The Ljung-Box statistic of n of them is nearly a
    noncentral chi-square variable of noncentrality n sum_l rho^(2 m l) over its lags l, if n is
    several times their number. The longer the record, the more is left out: a long record shows
    small correlations. The loss is that for a constant in a long record, where all samples are
    worth (1 - rho) / (1 + rho) independent ones each, and those kept (1 - rho^m) / (1 + rho^m); for
    a target that moves see `remedy_errors`.

    Examples
    --------
    Errors of 0.8 in a thousand samples: every tenth is kept, and a quarter of the information lost.

    >>> kept = thinning(0.8, 1000)
    >>> kept.every, round(kept.efficiency, 2), round(kept.variance_ratio, 2)
    (10, 0.73, 1.24)
    """
    from scipy.special import chdtri, chndtr  # here: it takes longer to load than all the rest

    _correlation(rho)
    if not level < rejected:
        raise ValueError(f"rejected must be above level = {level}, got {rejected}")
    for every in range(1, samples + 1):
        kept, r = -(-samples // every), rho**every
        dof = min(lags, kept - 1)
        excess = kept * float(np.sum(r ** (2 * np.arange(1, dof + 1))))
        share = 1 - float(chndtr(chdtri(dof, level), dof, excess)) if dof else level
        if share <= rejected:
            break
    ratio = (1 + r) / (1 - r)
    return Thinning(every, r, share, (1 + rho) / (1 - rho) / ratio / every, ratio)


@checked
@_checks.quiet
def remedy_errors(
    F: ArrayLike,
    Q: ArrayLike,
    H: ArrayLike,
    rho: Real,
    every: Count = 1,
    *,
    sigma: Positive = 1.0,
) -> dict[str, SteadyError]:
    """Return the errors of settled filters with four treatments of AR(1) measurement errors.

    Parameters
    ----------
    F, Q : array_like, shape (n, n)
        Transition matrix; covariance of the process noise.
    H : array_like, shape (m, n)
        Measurement matrix.
    rho : float
        Correlation of the errors of neighbors in each component, above -1 and below 1.
    every : int
        Every which sample is kept for "thinned".
    sigma : float
        Standard deviation of the errors.

    Returns
    -------
    dict of str to SteadyError
        "white": the errors are taken for white. "inflated": R is multiplied by
        (1 + rho) / (1 - rho). "thinned": every m-th sample is used, and the state predicted in
        between. "colored": the errors are estimated, which is optimal.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, `Q` is no covariance, `rho` is not inside
        (-1, 1), `sigma` or `every` is not positive, or a filter does not settle.

    Notes
    -----
    For a gain that is not optimal, the error of the state and that of the measurement obey one
    linear equation, and their covariance a Lyapunov equation. The optimum is that of the
    measurements z_k - rho z_(k-1), whose errors are white (Bryson and Henrikson 1968). The factor
    of R is the spectral density of the errors at frequency zero over that of white ones: right for
    a filter that averages over many samples, too careful for one that follows quick changes.

    Examples
    --------
    Position and velocity under errors of 0.8. First the actual variance of the position over the
    optimal one, then over the reported one:

    >>> from dopplerlib.model.motion import cwna_process_noise, ncv_transition
    >>> F, Q = ncv_transition(1.0, dim=1), cwna_process_noise(1.0, 1e-4, dim=1)
    >>> errors = remedy_errors(F, Q, [[1.0, 0.0]], 0.8, every=9)
    >>> best = errors["colored"].actual[0, 0]
    >>> for name, error in errors.items():
    ...     actual, reported = error.actual[0, 0], error.reported[0, 0]
    ...     print(f"{name:8} {actual / best:.2f} {actual / reported:.2f}")
    white    1.23 4.85
    inflated 1.14 0.84
    thinned  1.59 1.12
    colored  1.00 1.00
    """
    H = _checks.matrix("H", H, (None, None))
    m, n = H.shape
    F = _checks.matrix("F", F, (n, n))
    Q = _checks.matrix("Q", _checks.covariance("Q", Q, n, definite=False), (n, n))
    Q = (Q + Q.T) / 2  # SciPy takes no rounding across the diagonal
    _correlation(rho)
    R = sigma**2 * np.eye(m)
    powers = [np.eye(n)]
    noises = [np.zeros((n, n))]  # of 0, 1, ... steps
    for _ in range(every):
        powers.append(F @ powers[-1])
        noises.append(covariances.squared(F @ covariances.square_root(noises[-1]), Q))

    def white(scale, step):
        actual, reported = _settled(powers[step], noises[step], H, R, scale, rho**step)
        A, B = np.stack(powers[:step]), np.stack(noises[:step])  # updated, and predicted after that
        return SteadyError(*(np.mean(A @ P @ A.mT + B, axis=0) for P in (actual, reported)))

    best = _optimum(F, Q, H, R, rho)
    errors = {
        "white": white(1.0, 1),
        "inflated": white((1 + rho) / (1 - rho), 1),
        "thinned": white(1.0, every),
        "colored": SteadyError(best, best),
    }
    _checks.estimates("F, Q, H, rho", *(v for e in errors.values() for v in (e.actual, e.reported)))
    return errors


def _correlation(rho):
    if not -1 < rho < 1:
        raise ValueError(f"rho must be inside (-1, 1), got {rho}")


def _settled(F, Q, H, R, scale, rho):
    """Return the actual and the reported covariance of a filter that takes the errors for white."""
    from scipy.linalg import solve_discrete_lyapunov

    m, n = H.shape
    K, reported = steady_state_gain(F, Q, H, scale * R)
    A = np.eye(n) - K @ H
    # The error of the state before the update and that of the measurement give the one after it.
    after = np.block([[A, -K], [np.zeros((m, n)), np.eye(m)]])
    move = np.block([[F, np.zeros((n, m))], [np.zeros((m, n)), rho * np.eye(m)]])
    drive = np.block([[Q, np.zeros((n, m))], [np.zeros((m, n)), (1 - rho * rho) * R]])
    drive = covariances.squared(after @ covariances.square_root(drive))
    return solve_discrete_lyapunov(after @ move, drive)[:n, :n], reported


def _optimum(F, Q, H, R, rho):
    """Return the covariance of the optimal filter, from the differences z_k - rho z_(k-1)."""
    from scipy.linalg import LinAlgWarning, solve_discrete_are

    noise = covariances.squared(H @ covariances.square_root(Q), (1 - rho * rho) * R)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", LinAlgWarning)
            return solve_discrete_are(F.T, (H @ F - rho * H).T, Q, noise, s=Q @ H.T)
    except (np.linalg.LinAlgError, LinAlgWarning, ValueError):
        raise ValueError(
            f"rho must leave the state detectable, got {rho} and no solution of the Riccati "
            "equation"
        ) from None
