"""Gates: ellipsoidal (chi-square) and box-shaped."""

import numpy as np

from .. import _checks
from .._hints import Count, Probability, checked
from .._typing import ArrayLike, BoolArray


@checked
@_checks.quiet
def chi2_gate(nis: ArrayLike, m: Count, gate_probability: Probability) -> BoolArray:
    """Return whether measurements are inside the chi-square gate of a probability.

    Parameters
    ----------
    nis : array_like, shape (...)
        Normalized innovation squared; NaN where nothing was measured.
    m : int
        Number of components of the measurement.
    gate_probability : float
        Probability with which the measurement of the target itself is inside.

    Returns
    -------
    ndarray of bool, shape (...)
        False where `nis` is NaN.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001): the gate is an ellipsoid, the quantile of the
    chi-square distribution with `m` degrees of freedom its size.

    Examples
    --------
    >>> chi2_gate([5.9, 6.0, np.nan], m=2, gate_probability=0.95).tolist()
    [True, False, False]
    """
    from scipy.special import chdtri  # here: it takes longer to load than all the rest

    nis = _checks.real("nis", nis)
    return nis <= chdtri(m, 1 - gate_probability)


@checked
@_checks.quiet
def fixed_box_gate(innovation: ArrayLike, half_widths: ArrayLike) -> BoolArray:
    """Return whether innovations are inside a box of fixed size.

    Parameters
    ----------
    innovation : array_like, shape (..., m)
        Measurement minus predicted measurement; NaN where nothing was measured.
    half_widths : array_like, shape (m,)
        Half the size of the box along each component, in the units of the measurement.

    Returns
    -------
    ndarray of bool, shape (...)
        False where a component is NaN.

    Notes
    -----
    The box knows nothing of how sure the track is: what it lets through is a design choice, not a
    probability.

    Examples
    --------
    >>> fixed_box_gate([[0.5, 0.1], [0.5, 0.3]], [1.0, 0.2]).tolist()
    [True, False]
    """
    half_widths = _checks.positive("half_widths", half_widths, (None,))
    innovation = _checks.real("innovation", innovation)
    _checks.check_shape("innovation", innovation, half_widths.shape)
    return (np.abs(innovation) <= half_widths).all(axis=-1)
