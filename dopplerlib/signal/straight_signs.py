"""Signs of Doppler shifts that modules without Q do not tell, by the law of straight flight."""

import numpy as np

from .. import _checks
from .._hints import Probability, checked
from .._typing import ArrayLike, IntArray


@checked
@_checks.quiet
def straight_signs(f: ArrayLike, sigma_f: ArrayLike, confidence: Probability = 0.999) -> IntArray:
    """Return the signs of the Doppler shifts of a target that goes straight.

    Parameters
    ----------
    f : array_like, shape (..., K, S)
        Absolute values of Doppler shifts in Hz at K times in order; NaN where missing.
    sigma_f : array_like, broadcast to (..., K, S)
        Their standard deviations in Hz.
    confidence : float
        How sure a sign has to be.

    Returns
    -------
    ndarray of int, shape (..., K, S)
        1 for a target that approaches, -1 for one that recedes, 0 where neither is sure.

    Notes
    -----
    On a straight path of constant speed v the range has ``r'' = (v^2 - r'^2) / r``, which is never
    negative: Doppler shifts fall, whatever the sensor and the direction. So an absolute value falls
    while the target approaches and grows afterwards. Among all moments of the change, signs follow
    from that at which the best falling curve (isotonic regression) has the least chi-square; they
    are sure where every moment with the other sign costs more by a limit. A target that flies head
    on shows no change, and no sign. One that brakes or turns needs not follow the law.

    A curve that pools K values of mere noise to L levels takes a chi-square of L - 1 degrees of
    freedom off, and the generating function of L is the product of (z + i - 1) / i for i up to K
    (Robertson, Wright and Dykstra 1988). Chernoff's bound on two such curves, before and after,
    for any of K moments, gives the limit.

    Examples
    --------
    A shift of 5 Hz between 15 and -25 Hz may have either sign:

    >>> shift = np.array([40.0, 30, 15, -5, -25, -38])
    >>> straight_signs(np.abs(shift)[:, None], 0.5)[:, 0].tolist()
    [1, 1, 1, 0, -1, -1]
    >>> straight_signs(np.full((6, 1), 40.0), 0.5)[:, 0].tolist()
    [0, 0, 0, 0, 0, 0]
    """
    f = np.abs(_checks.bounded("f", f, (None, None)))
    sigma_f = _checks.bounded("sigma_f", _checks.positive("sigma_f", sigma_f))
    try:
        sigma_f = np.broadcast_to(sigma_f, f.shape)
    except ValueError:
        raise ValueError(
            f"sigma_f must have a shape that broadcasts to {f.shape} of f, got {sigma_f.shape}"
        ) from None
    limit = _limit(f.shape[-2], 1 - confidence)
    signs = np.zeros(f.shape, dtype=int)
    for place in np.ndindex(*f.shape[:-2], f.shape[-1]):
        row = (*place[:-1], slice(None), place[-1])
        signs[row] = _signs(f[row], sigma_f[row], limit)
    return signs


def _limit(samples, chance):
    """Return the chi-square that noise takes off with less than this probability."""
    from scipy.special import gammaln

    s = np.linspace(0.01, 0.49, 97)
    z = (1 - 2 * s) ** -0.5
    parts = np.array([samples // 2, samples - samples // 2])[:, None]
    log = gammaln(z + parts) - gammaln(parts + 1) - gammaln(z + 1)
    return float(np.min((log.sum(axis=0) + np.log(max(samples, 1) / chance)) / s))


def _signs(f, sigma, limit):
    """Return the signs (K,) of absolute values (K,) of one sensor."""
    # With j of them positive, those are fitted by a falling curve and the others, counted from the
    # last one, as well: zero is between the two.
    cost = _falling(f, sigma) + _falling(f[::-1], sigma[::-1])[::-1]
    positive = np.minimum.accumulate(cost[::-1])[::-1][1:]  # sample k is, if j > k
    negative = np.minimum.accumulate(cost)[:-1]
    return np.where(np.abs(positive - negative) > limit, np.sign(negative - positive), 0).astype(
        int
    )


def _falling(f, sigma):
    """Return chi-square of the best falling curve through the first j values, for j from 0 to K.

    Neighbors that rise are pooled to their mean, as often as it takes.
    """
    cost, total, pools = np.zeros(len(f) + 1), 0.0, []  # weight, mean of each pool
    for k, (value, deviation) in enumerate(zip(f, sigma, strict=True)):
        if not np.isnan(value):
            weight = 1 / deviation**2
            while pools and pools[-1][1] < value:
                w, mean = pools.pop()
                total += (value - mean) ** 2 * w * weight / (w + weight)
                weight, value = w + weight, (w * mean + weight * value) / (w + weight)
            pools.append((weight, value))
        cost[k + 1] = total
    return cost
