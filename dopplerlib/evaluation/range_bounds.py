"""The Cramér-Rao lower bound of a position from ranges."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from ..model.information import inverse_information
from ..model.range_rate import range_rate_jacobian


@checked
def range_crlb(p: ArrayLike, sensors: ArrayLike, sigma: ArrayLike) -> FloatArray:
    """Return the Cramér-Rao lower bound of a position from one range per radar.

    Parameters
    ----------
    p : array_like, shape (..., 2)
        True positions in m.
    sensors : array_like, shape (N, 2)
        Positions of the radars in m.
    sigma : array_like, broadcast to shape (..., N)
        Standard deviations of the ranges in m.

    Returns
    -------
    ndarray, shape (..., 2, 2)
        Covariances in m^2. Where the ranges cannot tell the position (all radars in line with
        it), the variance of each component that takes part is infinite.

    Notes
    -----
    The inverse of the Fisher information, the sum of u u' / sigma^2 with the unit vectors u from
    radar to target; Kay (1993), Section 3.9. The change of sigma with the range carries further
    information, which is not counted.

    Examples
    --------
    Far away in front of two radars: good along the line of sight, bad across it.

    >>> P = range_crlb([0, 4], [[-0.5, 0], [0.5, 0]], 0.03)
    >>> np.sqrt(np.diagonal(P)).round(3).tolist()
    [0.171, 0.021]
    """
    p = _checks.moderate("p", p, (2,))
    sigma = _checks.deviation("sigma", sigma)
    state = np.concatenate([p, np.zeros_like(p)], axis=-1)
    u = range_rate_jacobian(state, sensors)[..., 0, :2]
    _checks.check_broadcast("sigma", sigma.shape, "p and sensors", u.shape[:-1])
    with np.errstate(all="ignore"):
        w = u / sigma[..., None]
        information = np.swapaxes(w, -1, -2) @ w
    _checks.estimates("p, sensors, sigma", information, what="information")
    return inverse_information(information)[0]
