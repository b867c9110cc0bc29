"""Initial estimates, and the test whether they explain their measurements."""

import numpy as np

from .. import _checks
from .._records import record
from .._typing import BoolArray, FloatArray

# Probability with which a fit that is right in every respect is called implausible.
FALSE_ALARM = 1e-6

# Deviations that are estimated from the residuals may be this many times the given ones. What is
# beyond has another reason than the deviations.
LARGEST_SCALE = 10.0


class ImplausibleStart(UserWarning):
    """Warning of an initial estimate that does not explain its measurements."""


@record
class InitialEstimate:
    """Maximum-likelihood initial estimates; leading axes are those of the measurements.

    Attributes
    ----------
    x : ndarray, shape (..., 6)
        Estimated states in m and m/s; NaN if there are fewer measurements than unknowns.
    P : ndarray, shape (..., 6, 6)
        Their covariance to first order, as if there were no box. A component that the box fixes
        has variance zero; one that the measurements do not determine has an infinite variance and
        NaN covariances. `chi_square_rise` tests whether first order is enough.
    cost : ndarray, shape (...)
        Chi-square of the estimate: the sum of the squared residuals over their variances, over all
        measurements whose weight is not zero.
    at_bound : ndarray of bool, shape (..., 6)
        Components on the box at the first sample, other than those that it fixes.
    identifiable : ndarray of bool, shape (...)
        Whether the information at the estimate is regular. If not, other states in the box
        explain the measurements just as well (to first order), and `x` is the one of them nearest
        to the center of the box.
    converged : ndarray of bool, shape (...)
        Whether the search ended in an optimum to rounding that is `plausible`; and, if a
        correlation of errors was given, whether the residuals can have it. The optimum may lie on
        the box, see `at_bound`: then the box decides.
    second_x : ndarray, shape (..., 6)
        The best optimum found elsewhere; NaN if none was found.
    second_cost : ndarray, shape (...)
        Its chi-square. A difference of a few from `cost` says that the choice is uncertain. With a
        loss, the difference is that of the bounded costs of all measurements.
    degrees : ndarray of int, shape (...)
        Degrees of freedom of the chi-square: measurements whose weight is not zero less unknowns.
    weights : ndarray, shape (..., K, N)
        Weights of the measurements: one with least squares, from one down to zero with a loss, for
        measurements that were taken as wrong; NaN where they are missing.
    scale : ndarray, shape (...)
        Factor on the given standard deviations with which the measurements were used: one, or
        estimated.
    """

    x: np.ndarray
    P: np.ndarray
    cost: np.ndarray
    at_bound: np.ndarray
    identifiable: np.ndarray
    converged: np.ndarray
    second_x: np.ndarray
    second_cost: np.ndarray
    degrees: np.ndarray
    weights: np.ndarray
    scale: np.ndarray

    @property
    @_checks.quiet
    def plausible(self) -> BoolArray:
        """Whether the estimate explains the measurements, shape (...).

        Chi-square is at most its quantile that the right model exceeds once in a million times,
        more than half of the measurements have a weight above zero, and `scale` is at most ten.

        If not, either the deviations are too small (ten percent are enough with thousands of
        measurements): then estimate them, see ``scale`` of `ml_initialize`. Or no straight flight
        in the box explains the measurements. Usual reasons: I and Q are exchanged, so that all
        Doppler shifts have the wrong sign; sensors are in another order than their positions; the
        true state is not in the box; measurements are wrong, see ``loss``. With the likelihood
        "stationary", a target that moves is a reason, too.
        """
        cost, degrees = _checks.real("cost", self.cost), _checks.real("degrees", self.degrees)
        scale = _checks.real("scale", self.scale)
        at_bound = _checks.booleans("at_bound", self.at_bound, (None,))
        weights = _checks.measured("weights", self.weights, (None, None))
        _checks.check_leading(
            cost=(cost, 0), degrees=(degrees, 0), scale=(scale, 0), weights=(weights, 2),
            at_bound=(at_bound, 1),
        )  # fmt: skip
        accepted = np.sum(weights > 0, axis=(-2, -1))
        most = 2 * accepted > np.sum(~np.isnan(weights), axis=(-2, -1))
        # A component on the box fits no noise: it is no unknown.
        limit = _chi_square_limit(degrees + at_bound.sum(axis=-1))
        return np.asarray((cost <= limit) & most & (scale <= LARGEST_SCALE))


def _chi_square_limit(degrees: FloatArray) -> FloatArray:
    """Return the chi-square that a right model exceeds with the probability `FALSE_ALARM`."""
    from scipy.special import chdtri

    return chdtri(np.maximum(degrees, 1), FALSE_ALARM)
