"""Thresholds at a constant false-alarm rate (CFAR)."""

from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Index, Probability, checked, up_to

_MOST = 2**24


@checked
@_checks.quiet
def cfar_factor(
    false_alarm: Probability, cells: Annotated[int, up_to(_MOST)], rank: Index | None = None
) -> float:
    """Return the threshold of a CFAR detector over the level of its reference cells.

    Parameters
    ----------
    false_alarm : float
        Probability of a false alarm in a cell.
    cells : int
        Number of reference cells, whose powers are exponential and independent.
    rank : int, optional
        The level is the power of this rank, from 1 for the least to `cells` (ordered statistic);
        if None it is the mean (cell averaging).

    Returns
    -------
    float

    Notes
    -----
    Cell averaging with N cells has the false alarm ``(1 + a / N)^-N``; rank r of N has the product
    of ``(N - i) / (N - i + a)`` for i from 0 to r - 1 (Rohling 1983). Both hold whatever the power
    of the noise.

    Examples
    --------
    Noise that is known would need ln(1000); the rest is the price of measuring it:

    >>> round(cfar_factor(1e-3, cells=24), 2), round(cfar_factor(1e-3, cells=10**6), 2)
    (8.0, 6.91)
    """
    from scipy.optimize import brentq

    if rank is None:
        return float(cells * np.expm1(-np.log(false_alarm) / cells))
    if not 1 <= rank <= cells:
        raise ValueError(f"rank must be from 1 to cells = {cells}, got {rank}")
    left = cells - np.arange(rank)

    def excess(log_factor):
        return np.sum(np.log1p(np.exp(log_factor) / left)) + np.log(false_alarm)

    low, high = -50.0, 700.0
    if excess(high) < 0:
        raise ValueError(
            f"rank must be larger for a false alarm of {false_alarm:g}: the factor leaves the "
            f"range of a float, got {rank}"
        )
    return float(np.exp(brentq(excess, low, high, xtol=1e-12)))
