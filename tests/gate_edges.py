"""Innovations at the edge of a gate on NIS, for the tests of all that use one."""

import numpy as np
from scipy.stats import chi2


def beside_the_gate(S, probability):
    """Return innovations whose NIS is a thousandth below and above the quantile for their number.

    Parameters
    ----------
    S : array_like, shape (m, m)
        Their covariance.
    probability : float
        Gate probability.

    Returns
    -------
    list of (ndarray of shape (m,), bool)
        Each innovation, and whether it is inside.
    """
    m = len(S)
    # Oblique, so that every entry of S counts.
    along = np.linalg.cholesky(S) @ (np.arange(1.0, m + 1) / np.linalg.norm(np.arange(1.0, m + 1)))
    edge = np.sqrt(chi2.ppf(probability, m)) * along
    return [(np.sqrt(0.999) * edge, True), (np.sqrt(1.001) * edge, False)]
