"""Bilateration: a position in the plane from two ranges."""

import numpy as np

from .. import _checks
from .._hints import AboveZero, checked
from .._typing import ArrayLike, BoolArray, FloatArray


@checked
@_checks.quiet
def bilaterate(
    d1: ArrayLike, d2: ArrayLike, baseline: AboveZero
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return the position with y > 0 at given ranges from two radars on the x axis.

    Parameters
    ----------
    d1, d2 : array_like, shape (...)
        Ranges in m to the radars at (-baseline/2, 0) and (baseline/2, 0); they broadcast against
        each other. NaN stands for a range that is missing.
    baseline : float
        Distance between the radars in m.

    Returns
    -------
    x : ndarray, shape (...)
        In m. It is the place of the radical axis, which exists even if the circles do not meet;
        NaN only where a range is missing.
    y : ndarray, shape (...)
        In m, not negative; NaN where the circles do not meet.
    valid : ndarray of bool, shape (...)
        Whether the circles meet.

    Notes
    -----
    Åsheim (2015), Eq 5.8. It is called triangulation there; the word means angles, and two
    ranges are bilateration. The circles meet if the ranges and the baseline can be the sides of a
    triangle. The sum of the ranges then is at least the baseline, and their difference at most.

    Examples
    --------
    >>> x, y, valid = bilaterate([np.hypot(1.5, 2), 4], [np.hypot(0.5, 2), 1], baseline=1)
    >>> x.round(3).tolist(), y.round(3).tolist(), valid.tolist()
    ([1.0, 7.5], [2.0, nan], [True, False])
    """
    d1, d2 = _checks.real("d1", d1), _checks.real("d2", d2)
    _checks.check_broadcast("d1", d1.shape, "d2", d2.shape)
    x = (d1**2 - d2**2) / (2 * baseline)
    with np.errstate(invalid="ignore"):
        # d2^2 - (x - b/2)^2 in factors: near the baseline the squares cancel, the factors do not.
        square = (d2 - x + baseline / 2) * (d2 + x - baseline / 2)
        valid = (square >= 0) & (np.minimum(d1, d2) >= 0)
        return x, np.where(valid, np.sqrt(np.where(valid, square, np.nan)), np.nan), valid
