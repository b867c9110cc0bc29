"""Noise parameters of a filter, estimated from its own innovations."""

from collections.abc import Callable
from functools import partial

import numpy as np

from .. import _checks
from .._hints import Positive, Probability, checked
from .._records import record
from ..estimation.track import Track
from ._innovations import of_track
from ._robust import derivatives, deviations, log_density, outlier_fraction
from .intervals import ConfidenceInterval


@record
class NoiseFit:
    """Parameters for which a filter predicts its measurements best.

    Attributes
    ----------
    parameters : dict of str to ConfidenceInterval
        Estimates, by name, with their intervals.
    outliers : float
        Fraction of the measurements that follows Cauchy's law. Most outliers do, and some that are
        none; a density for all kinds of outliers does not count them.
    log_likelihood : float
        Of all measurements.
    converged : bool
        Whether a maximum was found. If not, or if the likelihood is flat, intervals are NaN.
    """

    parameters: dict[str, ConfidenceInterval]
    outliers: float
    log_likelihood: float
    converged: bool


@checked
def fit_noise(
    tracker: Callable[..., Track],
    start: dict[str, Positive],
    *,
    confidence: Probability = 0.95,
) -> NoiseFit:
    """Estimate noise parameters of a filter by the likelihood of its innovations.

    Parameters
    ----------
    tracker : callable
        Takes the parameters by their names, and returns the `Track` that a filter with them makes
        of the measurements. It is smooth in them: a gate, if there is one, is "soft".
    start : dict of str to float
        Values at which the search starts: deviations, variances, time constants; all are positive.
    confidence : float
        Probability of each interval.

    Returns
    -------
    NoiseFit

    Raises
    ------
    ValueError
        If a value of `start` is not positive, or `tracker` returns no track with innovations.

    Notes
    -----
    The density of a record is the product of those of its innovations (Schweppe 1965), whatever is
    missing. Here it is Gaussian but for a fraction of outliers with the tails of Cauchy's law; its
    maximum over the logarithms of the parameters is found by BFGS. The intervals are of the
    sandwich form, from the scores of single samples, which are uncorrelated where the model is
    right. Parameters that act alike, such as a white and a quickly decaying error, have wide
    intervals.

    Examples
    --------
    The process noise and the measurement noise of random walks from zero:

    >>> from dopplerlib import kf
    >>> rng = np.random.default_rng(1)
    >>> walk = np.cumsum(0.1 * rng.standard_normal((40, 50, 1)), axis=1)
    >>> z = walk + rng.standard_normal(walk.shape)
    >>> def tracker(q, r):
    ...     return kf(z, [[1]], [[q]], [[1]], [[r]], [0], [[0]])
    >>> found = fit_noise(tracker, {"q": 0.1, "r": 0.3}).parameters
    >>> [found[name].low < value < found[name].high for name, value in (("q", 0.01), ("r", 1.0))]
    [True, True]
    """
    from scipy.optimize import minimize
    from scipy.special import ndtri

    if not start:
        raise ValueError(f"start must hold a parameter, got {start}")

    def named(theta):
        return dict(zip(start, np.exp(theta).tolist(), strict=True))

    def densities(theta):
        """Return the log density of each sample as a function of the fraction of outliers."""
        found = _checks.called("tracker", partial(tracker, **named(theta)))
        innovation, S, there = of_track(found)
        size = there.sum(axis=-1)
        form = np.sum(innovation * np.linalg.solve(S, innovation[..., None])[..., 0], axis=-1)
        used = size > 0
        form, size, log_det = form[used], size[used], np.linalg.slogdet(S)[1]
        log_det = np.broadcast_to(log_det, used.shape)[used]
        return lambda outliers: log_density(form, log_det, size, outliers)

    def cost(theta):
        terms = densities(theta)
        return -float(np.mean(terms(outlier_fraction(terms))))

    found = minimize(
        cost, np.log(list(start.values())), method="BFGS", options={"gtol": 1e-4, "eps": 1e-5}
    )
    theta = found.x
    outliers = outlier_fraction(densities(theta))
    score, information = derivatives(lambda v: densities(v)(outliers), theta, 1e-3)
    off = ndtri((1 + confidence) / 2) * deviations(score, information)
    ends = np.exp(theta + np.outer((0, -1, 1), off))
    return NoiseFit(
        {name: ConfidenceInterval(*map(float, v)) for name, v in zip(start, ends.T, strict=True)},
        outliers,
        -found.fun * score.shape[1],
        bool(np.isfinite(off).all()),
    )
