"""The Cramér-Rao lower bound."""

from typing import Literal

from .._hints import checked
from .._typing import ArrayLike, FloatArray
from ..model.information import fisher_information, inverse_information
from ..model.links import DopplerLinks
from ..model.radar_array import RadarArray


@checked
def crlb(
    x: ArrayLike,
    array: RadarArray | DopplerLinks,
    sigma_f: ArrayLike,
    K: int | None = None,
    T: ArrayLike = 0.001,
    likelihood: Literal["stationary", "constant_velocity"] = "stationary",
    *,
    free: ArrayLike | None = None,
) -> FloatArray:
    """Return the Cramér-Rao lower bound of the state from K Doppler samples.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        True states [x, y, z, v_x, v_y, v_z] at the first sample, in m and m/s; for links (..., n).
    array : RadarArray or DopplerLinks
        The N sensors or links.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz; NaN where one is missing.
    K : int, optional
        Number of samples, see `fisher_information`.
    T : array_like, scalar or shape (K,)
        Sampling interval in s, or the interval before each sample.
    likelihood : {"stationary", "constant_velocity"}
        Whether the state is constant during the samples, or moves at constant velocity; see
        `fisher_information`.
    free : array_like of bool, shape (6,) or (n,), optional
        Components that are unknown, such as x, y, v_x, v_y in a plane. The others are known:
        their variances are zero. All are unknown if None.

    Returns
    -------
    ndarray, shape (..., 6, 6) or (..., n, n)
        Covariances. Where the information is singular no unbiased estimate exists: the variance
        of every component that takes part in an unobservable direction is infinite, and its
        covariances are NaN.

    Notes
    -----
    The inverse of `fisher_information`; Bar-Shalom, Li and Kirubarajan (2001), Section 2.7. It
    bounds errors that are small against the curvature of the Doppler shift, and knows neither of
    a box nor of a second basin.

    Examples
    --------
    In a plane a line of five sensors sees all four components; out of it, it does not see on
    which side the target is:

    >>> from dopplerlib import RadarArray
    >>> plane = [True, True, False, True, True, False]
    >>> array, x = RadarArray.linear(5, 0.4), [0.5, 0.2, 0, -1, 0.5, 0]
    >>> [round(float(crlb(x, array, 0.1, free=f)[2, 2]), 3) for f in (plane, None)]
    [0.0, inf]
    """
    return inverse_information(fisher_information(x, array, sigma_f, K, T, likelihood), free)[0]
