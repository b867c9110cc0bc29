"""Receiver impairments of IQ samples, and their correction."""

from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Positive, Real, checked, up_to
from .._typing import ArrayLike, BoolArray, ComplexArray
from ._bins import about_mean, in_range
from .validity import known_samples

_DIFFERENT = 1e-12  # share of the powers' product: less than that is rounding


@checked
def add_dc(x: ArrayLike, offset: ArrayLike) -> ComplexArray:
    """Add a DC offset to IQ samples, as carrier leakage does.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    offset : complex or array_like of complex, broadcast to (..., n)
        The constant.

    Returns
    -------
    ndarray of complex, shape (..., n)

    Examples
    --------
    >>> add_dc([1 + 1j, -1j], 0.5).tolist()
    [(1.5+1j), (0.5-1j)]
    """
    x = _checks.finite_complex("x", x, (None,))
    offset = _checks.finite_complex("offset", offset)
    _checks.check_broadcast("offset", offset.shape, "x", x.shape)
    with np.errstate(all="ignore"):
        x = x + offset
    return _checks.estimates("x, offset", x, what="samples")


@checked
@_checks.quiet
def remove_mean(x: ArrayLike, valid: ArrayLike | None = None) -> ComplexArray:
    """Subtract the mean of IQ samples over the last axis.

    The mean of a tone is not zero unless the record holds whole cycles of it: this takes part of a
    slow tone away. See `ml_frequency_dc`, and for a constant that drifts `remove_lines`.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    valid : array_like of bool, broadcast to (..., n), optional
        Which samples are measurements, see `valid_samples`; all if None.

    Returns
    -------
    ndarray of complex, shape (..., n)
        The mean is that of the valid samples; the others become 0.

    Examples
    --------
    >>> remove_mean([1, 2, 3]).real.tolist()
    [-1.0, 0.0, 1.0]
    >>> remove_mean([1, 2, 9], [True, True, False]).real.tolist()
    [-0.5, 0.5, 0.0]
    """
    x, valid = known_samples("x", x, valid, (None,))
    if not x.size:
        return x
    if valid is None:
        x = about_mean(x)
        return _checks.estimates("x", x, what="mean")
    first = np.take_along_axis(x, valid.argmax(axis=-1, keepdims=True), axis=-1)
    x = np.where(valid, x - first, 0.0)
    mean = x.sum(axis=-1, keepdims=True) / np.maximum(valid.sum(axis=-1, keepdims=True), 1)
    _checks.estimates("x", mean, what="mean")
    return np.where(valid, x - mean, 0.0)


@checked
def add_iq_imbalance(x: ArrayLike, gain_db: float, phase_deg: Real) -> ComplexArray:
    """Add the I/Q imbalance of a mixer to IQ samples.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples of an ideal mixer.
    gain_db : float
        Gain of Q over that of I in dB.
    phase_deg : float
        By how much Q leads where it should not, in degrees.

    Returns
    -------
    ndarray of complex, shape (..., n)
        I and g (Q cos phi + I sin phi): a circle becomes an ellipse, and beside every tone a
        mirror image appears at the negative frequency.

    Examples
    --------
    >>> add_iq_imbalance([1, 1j], 0.0, 30.0).round(3).tolist()
    [(1+0.5j), 0.866j]
    """
    x = _checks.finite_complex("x", x, (None,))
    g = 10 ** (_checks.one_number("gain_db", gain_db, _checks.decibels) / 20)
    phi = np.radians(phase_deg)
    with np.errstate(all="ignore"):
        x = x.real + 1j * g * (x.imag * np.cos(phi) + x.real * np.sin(phi))
    return _checks.estimates("x, gain_db", x, what="samples")


def correct_iq_imbalance(x: ArrayLike, valid: ArrayLike | None = None) -> ComplexArray:
    """Correct the I/Q imbalance of IQ samples: branches of equal power, and uncorrelated.

    Gain and angle are found from the samples themselves: in those of an ideal mixer I and Q have
    equal power and no correlation, over whole cycles or in the long run. A constant has to be
    removed before.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples with mean zero.
    valid : array_like of bool, broadcast to (..., n), optional
        Which samples are measurements, see `valid_samples`; all if None. Powers and correlation are
        those of the valid samples; the others become 0.

    Returns
    -------
    ndarray of complex, shape (..., n)
        I is kept. A record of zeros, from a module that is dead, stays one.

    Raises
    ------
    ValueError
        If a valid sample is not finite, or if in a record with a signal I and Q are proportional:
        then nothing tells them apart.

    Examples
    --------
    >>> x = np.exp(2j * np.pi * np.arange(8) / 8)
    >>> bool(np.allclose(correct_iq_imbalance(add_iq_imbalance(x, 1.0, 5.0)), x))
    True
    """
    x, valid = known_samples("x", x, valid, (None,))
    ii, iq, qq, left = _moments(x, valid)
    dead = (ii == 0) & (qq == 0)
    good = (left > _DIFFERENT * ii * qq) | dead
    if not good.all():
        place = tuple(int(i) for i in np.argwhere(~good[..., 0])[0])
        where = f" at index {place}" if place else ""
        raise ValueError(
            "x must have an I and a Q that are not proportional to each other, got powers "
            f"{ii[place][0]:.3g} and {qq[place][0]:.3g} with a mean product of "
            f"{iq[place][0]:.3g}{where}"
        )
    return x.real + 1j * (ii * x.imag - iq * x.real) / np.sqrt(np.where(dead, 1.0, left))


@checked
def branches_differ(x: ArrayLike, valid: ArrayLike | None = None) -> BoolArray:
    """Return the records whose I and Q are not proportional, so that the sign of Doppler is known.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples with mean zero.
    valid : array_like of bool, broadcast to (..., n), optional
        Which samples are measurements; all if None.

    Returns
    -------
    ndarray of bool, shape (...)
        False for a module without Q, or with twice the same branch; there `correct_iq_imbalance`
        refuses. True for one that is dead.

    Examples
    --------
    >>> branches_differ([[1, -1, 1j, -1j], [1, -1, 2, -2], [0, 0, 0, 0]]).tolist()
    [True, False, True]
    """
    ii, _, qq, left = _moments(*known_samples("x", x, valid, (None,)))
    return ((left > _DIFFERENT * ii * qq) | ((ii == 0) & (qq == 0)))[..., 0]


@checked
def quantize(x: ArrayLike, bits: Annotated[int, up_to(52)], full_scale: Positive) -> ComplexArray:
    """Quantize IQ samples to the resolution of an analog-to-digital converter.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples.
    bits : int
        Bits for each of I and Q, at most 52: beyond, a float has no steps of its own.
    full_scale : float
        Largest amplitude of I and Q; what lies beyond is clipped to the last step.

    Returns
    -------
    ndarray of complex, shape (..., n)
        The middles of 2^bits equal steps from -full_scale to full_scale.

    Notes
    -----
    The error is at most half a step. As noise it has the variance of step^2 / 12 in each of I and
    Q, as long as the signal moves over several steps.

    Examples
    --------
    >>> quantize([0.1 - 0.9j, 5.0], bits=2, full_scale=1.0).tolist()
    [(0.25-0.75j), (0.75+0.25j)]
    """
    x = _checks.finite_complex("x", x, (None,))
    levels = 2**bits
    step = 2 * full_scale / levels

    def steps(part):
        with np.errstate(over="ignore"):  # what is far outside is clipped
            place = np.floor(part / step)
        return (np.clip(place, -levels // 2, levels // 2 - 1) + 0.5) * step

    return steps(x.real) + 1j * steps(x.imag)


def _moments(x, valid):
    """Return mean squares and product of I and Q, and the part of Q orthogonal to I (..., 1)."""
    x = in_range(x)
    count = x.shape[-1] if valid is None else valid.sum(axis=-1, keepdims=True)
    ii, iq, qq = (
        np.sum(product, axis=-1, keepdims=True) / np.maximum(count, 1)
        for product in (x.real**2, x.real * x.imag, x.imag**2)
    )
    return ii, iq, qq, ii * qq - iq**2
