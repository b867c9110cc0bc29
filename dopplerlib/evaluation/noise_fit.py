"""Noise parameters of a filter, estimated from its own innovations."""

from collections.abc import Callable
from functools import partial

import numpy as np

from .. import _checks
from .._hints import Positive, Probability, checked
from .._records import record
from ..estimation.track import Track
from ._innovations import of_track
from ._robust import deviations, information, log_density, outlier_fraction, scores
from .intervals import ConfidenceInterval

_STEP = 0.02  # of differences: a gate makes a likelihood rough on a smaller scale
_GAIN = 0.01  # of the log likelihood: less is a tenth of a standard deviation
_SMALLEST = 1e-6
_MOST = 50


@record
class NoiseFit:
    """Parameters for which a filter predicts its measurements best.

    Attributes
    ----------
    parameters : dict of str to ConfidenceInterval
        Estimates, by name, with their intervals.
    outliers : float
        Fraction of the samples that follows Cauchy's law. Most outliers do, and some that are
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
    outliers: bool = True,
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
    outliers : bool
        Whether some innovations may be outliers. A target that maneuvers now and then makes
        innovations that look like them: False counts them in, and makes the process noise larger.
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
    maximum over the logarithms of the parameters is found by scoring. The intervals are of the
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
    from scipy.special import ndtri  # here: it takes longer to load than all the rest

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
        return lambda fraction: log_density(form, log_det, size, fraction)

    theta = np.log(list(start.values()))
    theta, fraction, total, converged = _climb(densities, theta, outliers)
    terms = _given(densities, fraction), theta, _STEP
    off = deviations(scores(*terms), information(*terms)) * ndtri((1 + confidence) / 2)
    ends = np.exp([theta, theta - off, theta + off])
    return NoiseFit(
        {name: ConfidenceInterval(*map(float, v)) for name, v in zip(start, ends.T, strict=True)},
        fraction,
        total,
        bool(converged and np.isfinite(off).all()),
    )


def _climb(densities, theta, outliers):
    """Return the parameters of the greatest likelihood, the outliers, its value, and whether found.

    Fisher's scoring with the outer product of the scores (Berndt, Hall, Hall, Hausman 1974). A step
    is doubled while that leads further up, as it does where the model is wrong, up to about one
    unit, and halved until it leads up at all.
    """

    def value(at):
        terms = densities(at)
        fraction = outlier_fraction(terms) if outliers else 0.0
        return fraction, float(np.sum(terms(fraction)))

    fraction, total = value(theta)
    for _ in range(_MOST):
        score = scores(_given(densities, fraction), theta, _STEP)
        slope = score.sum(axis=1)
        step = np.linalg.lstsq(score @ score.T, slope)[0]
        if slope @ step < _GAIN:
            return theta, fraction, total, True
        step /= max(1.0, np.abs(step).max())
        found, far = value(theta + step), value(theta + 2 * step)
        while far[1] > found[1] and np.abs(step).max() < 1:
            step, found = 2 * step, far
            far = value(theta + 2 * step)
        while not found[1] > total and np.abs(step).max() > _SMALLEST:
            step = step / 2
            found = value(theta + step)
        if not found[1] > total:
            return theta, fraction, total, False
        theta, (fraction, total) = theta + step, found
    return theta, fraction, total, False


def _given(densities, fraction):
    return lambda theta: densities(theta)(fraction)
