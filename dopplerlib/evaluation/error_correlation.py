"""Correlation of measurement errors, estimated from residuals with gaps and outliers."""

import numpy as np

from .. import _checks
from .._hints import Count, Probability, checked
from .._records import record
from .._typing import ArrayLike
from ._robust import deviations, information, log_density, scores
from .intervals import ConfidenceInterval

_FEWEST = 5  # blocks: with fewer, the interval of a variance says nothing


@record
class ErrorCorrelation:
    """First-order Gauss-Markov errors as they fit residuals, with confidence intervals.

    Attributes
    ----------
    mean : ConfidenceInterval
        Bias, in the unit of the residuals.
    sigma : ConfidenceInterval
        Standard deviation, of the colored and the white part together.
    rho : ConfidenceInterval
        Correlation of the colored part over one interval `T`: the AR(1) coefficient.
    colored : ConfidenceInterval
        Fraction of the variance that is colored; 1 without a white part.
    sigma_colored, sigma_white : float
        Standard deviations of both parts, as `augment_linear` takes them: `sigma`, and the root of
        `R`.
    tau : float
        Time constant of the colored part in s; zero if `rho` is not positive.
    T : float
        The interval in s to which `rho` belongs, the median one.
    blocks : int
        Number of blocks, taken for independent, from which the intervals come.
    """

    mean: ConfidenceInterval
    sigma: ConfidenceInterval
    rho: ConfidenceInterval
    colored: ConfidenceInterval
    sigma_colored: float
    sigma_white: float
    tau: float
    T: float
    blocks: int


@checked
def error_correlation(
    residual: ArrayLike,
    T: ArrayLike,
    *,
    white: bool = False,
    lags: Count = 3,
    confidence: Probability = 0.95,
) -> ErrorCorrelation:
    """Estimate the autocorrelation of measurement errors, robust to outliers.

    Parameters
    ----------
    residual : array_like, shape (..., K)
        Measurements minus the truth, or minus a fit that is stiff against the memory of the errors;
        NaN where one is missing. Leading axes are records with the same statistics.
    T : array_like, scalar or shape (K,)
        Interval before each sample in s.
    white : bool
        Whether the errors have a white part beside the colored one.
    lags : int
        Pairs of up to so many samples apart are compared.
    confidence : float
        Probability of each interval.

    Returns
    -------
    ErrorCorrelation

    Raises
    ------
    ValueError
        If a residual is infinite, they do not vary, `lags` is not below K, or there are too few for
        five blocks of four times the memory (1 + rho) / (1 - rho).

    Notes
    -----
    Composite likelihood of the pairs (Varin, Reid, Firth 2011): errors t apart are Gaussian with
    the correlation c rho^(t / T), c the fraction that is colored, but for a fraction of outliers
    with the tails of Cauchy's law, which is estimated as well. Uneven times need nothing else. The
    intervals are of the sandwich form, from the sums of the scores over blocks, with Student's
    quantile; `colored` may come out above 1, where a white part cannot be told from none.

    Innovations of a filter that takes the errors for white are not the errors: what it learns of
    them is gone. From innovations use `fit_noise`.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> error = rng.standard_normal(2000)
    >>> for k in range(1, 2000):
    ...     error[k] = 0.8 * error[k - 1] + 0.6 * error[k]
    >>> error[::50] += 30.0
    >>> found = error_correlation(error, 0.1)
    >>> found.rho.low < 0.8 < found.rho.high, found.sigma.low < 1 < found.sigma.high
    (True, True)
    """
    from scipy.special import stdtrit

    y = _checks.bounded("residual", residual, (None,))
    K = y.shape[-1]
    if lags >= K:
        raise ValueError(f"lags must be less than the number of samples {K}, got {lags}")
    T = _checks.deviation("T", T)
    if T.shape not in ((), (K,)):
        raise ValueError(f"T must be one number or have shape ({K},), got shape {T.shape}")
    T = np.broadcast_to(T, (K,))
    y, step = y.reshape(-1, K), float(np.median(T))
    first, second, apart, lag, place = _pairs(y, np.cumsum(T) / step, lags)
    middle, spread, z = _start(y, first, second, lag)

    def values(theta):
        """Return mean, sigma, rho and the colored fraction."""
        colored = np.exp(theta[3]) if white else 1.0
        return middle + theta[0] * spread, spread * np.exp(theta[1]), np.tanh(theta[2]), colored

    def terms(theta, outliers):
        mean, sigma, rho, colored = values(theta)
        r = colored * np.sign(rho) ** lag * np.abs(rho) ** apart
        u, w, rest = (first - mean) / sigma, (second - mean) / sigma, 1 - r * r
        if not (rest > 0).all():
            return np.full(first.shape, -1e3)
        form, scale = (u * u - 2 * r * u * w + w * w) / rest, 4 * np.log(sigma)
        return log_density(form, np.log(rest) + scale, 2, outliers, u * u + w * w, scale)

    theta = np.array([0.0, 0.0, z, np.log(0.9)][: 3 + white])
    theta, outliers = _maximum(terms, theta)
    rho = float(values(theta)[2])
    length = int(np.ceil(4 * (1 + abs(rho)) / (1 - abs(rho)))) + lags
    each = max(K // length, 1)
    blocks = len(y) * each
    if blocks < _FEWEST:
        raise ValueError(
            f"residual must hold {_FEWEST} blocks of {length} samples, four times its memory, "
            f"got {blocks}"
        )
    at = (lambda v: terms(v, outliers)), theta, 1e-3
    block = place[0] * each + place[1] * each // K
    sums = np.stack([np.bincount(block, one, blocks) for one in scores(*at)])
    off = deviations(sums, information(*at)) * stdtrit(blocks - 1, (1 + confidence) / 2)
    ends = np.array([values(at) for at in (theta, theta - off, theta + off)])
    mean, sigma, rhos, colored = (ConfidenceInterval(*map(float, v)) for v in ends.T)
    tau = -step / np.log(rho) if rho > 0 else 0.0
    share = min(colored.value, 1.0)
    own, white_part = (float(sigma.value * np.sqrt(part)) for part in (share, 1 - share))
    return ErrorCorrelation(mean, sigma, rhos, colored, own, white_part, float(tau), step, blocks)


def _maximum(terms, theta):
    """Return the parameters of the greatest likelihood, and the fraction of outliers."""
    from scipy.optimize import minimize
    from scipy.special import expit

    def cost(v):
        return -np.mean(terms(v[:-1], expit(v[-1])))

    best = minimize(cost, [*theta, -4.0], method="BFGS", options={"gtol": 1e-4, "eps": 1e-5}).x
    return best[:-1], expit(best[-1])


def _pairs(y, time, lags):
    """Return both values of all pairs, their times and samples apart, and record and sample."""
    found = []
    for lag in range(1, lags + 1):
        row, k = np.nonzero(~np.isnan(y[:, lag:] + y[:, :-lag]))
        found.append((y[row, k], y[row, k + lag], time[k + lag] - time[k], 0 * k + lag, row, k))
    first, second, apart, lag, row, k = map(np.concatenate, zip(*found, strict=True))
    return first, second, apart, lag, (row, k)


def _start(y, first, second, lag):
    """Return median, standard deviation and Fisher's z of the correlation, by medians and signs."""
    middle = np.nanmedian(y) if first.size else 0.0
    spread = 1.4826 * np.nanmedian(np.abs(y - middle)) if first.size else 0.0
    if not spread > 0:
        raise ValueError("residual must vary, and hold pairs of values, got a constant or none")
    agree = np.mean((np.sign(first - middle) * np.sign(second - middle))[lag == lag.min()])
    return middle, spread, np.arctanh(0.99 * np.sin(np.pi / 2 * agree))
