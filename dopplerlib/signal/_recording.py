"""A recording: IQ samples of several sensors, with the mask of valid samples."""

from datetime import UTC, datetime, timedelta

import numpy as np

from .. import _checks
from .._records import record
from .._typing import FloatArray
from .validity import valid_samples


@record
class Recording:
    """IQ samples of several sensors, with sampling rate, carrier, start and validity.

    Attributes
    ----------
    x : ndarray of complex, shape (S, n)
        Samples of S sensors, taken at the same times. Samples that are no measurements are as they
        came; those that are not even finite are 0.
    fs : float
        Sampling rate in Hz.
    carrier : float
        Carrier frequency in Hz.
    start : datetime, optional
        Time of the first sample, with a time zone; what is read is in UTC.
    valid : ndarray of bool, shape (S, n), optional
        False where there is no measurement. If None, `valid_samples` tells it by the samples.
    without_q : bool
        Whether the modules have no Q: samples are their analytic signals then, whose real parts
        they measured, and the sign of a Doppler shift is not known. See `ml_frequency_real`.

    Raises
    ------
    ValueError
        If `x` is no complex array (S, n) with samples in it, or not finite where `valid` is
        True; if `fs` or `carrier` is not positive; if `start` has no time zone; or if `valid` is
        no array of booleans with the shape of `x`.

    Notes
    -----
    Without the samples that `valid` was decided from it says little: to exchange them, write
    ``dataclasses.replace(recording, x=x, valid=None)``.

    Examples
    --------
    >>> from dopplerlib.signal.recording import Recording
    >>> one = Recording([[1 + 1j, float("nan"), 2 - 1j]], fs=1000.0, carrier=24e9)
    >>> one.valid
    array([[ True, False,  True]])
    >>> one.x
    array([[1.+1.j, 0.+0.j, 2.-1.j]])
    """

    x: np.ndarray
    fs: float
    carrier: float
    start: datetime | None = None
    valid: np.ndarray | None = None
    without_q: bool = False

    def __post_init__(self):
        x = _checks.numbers("x", self.x)
        if x.dtype.kind != "c":
            raise ValueError(
                "x must be complex, I + 1j Q, got real numbers: of modules without Q it is "
                "scipy.signal.hilbert of them, with without_q=True, as the readers' layout='real'"
            )
        if x.ndim != 2 or not x.size:
            raise ValueError(f"x must have shape (S, n) with samples in it, got {x.shape}")
        finite = np.isfinite(x)
        if self.valid is None:
            valid = valid_samples(x)
        else:
            valid = _checks.booleans("valid", self.valid)
            if valid.shape != x.shape:
                raise ValueError(f"valid must have shape {x.shape} of x, got {valid.shape}")
            wrong = np.argwhere(valid & ~finite)
            if len(wrong):
                place = tuple(map(int, wrong[0]))
                raise ValueError(f"x must be finite where valid, got {x[place]} at index {place}")
        if not finite.all():
            x = np.where(finite, x, 0)
        utc("start", self.start)
        fs = _checks.one_number("fs", self.fs, _checks.deviation)
        carrier = _checks.one_number("carrier", self.carrier, _checks.deviation)
        x = x.astype(complex, copy=False)
        without_q = _checks.one_boolean("without_q", self.without_q)
        return {"x": x, "fs": fs, "carrier": carrier, "valid": valid, "without_q": without_q}

    @property
    def time(self) -> FloatArray:
        """Time of each sample in s, counted from the first one, shape (n,)."""
        return np.arange(self.x.shape[-1]) / self.fs

    @property
    def wavelength(self) -> float:
        """Wavelength in vacuum in m."""
        from scipy.constants import speed_of_light

        return speed_of_light / self.carrier


def utc(name, start):
    """Return a datetime in UTC, or None for None; raise for anything else."""
    if start is None:
        return None
    if not isinstance(start, datetime) or start.utcoffset() is None:
        raise ValueError(f"{name} must be a datetime with a time zone or None, got {start!r}")
    return _moment(name, start, lambda: start.astimezone(UTC))


def later(start, seconds):
    """Return the time a number of seconds after `start`, or None if `start` is."""
    if start is None:
        return None
    return _moment("start", start, lambda: start + timedelta(seconds=seconds))


def _moment(name, start, shifted):
    try:
        return shifted()
    except OverflowError:
        raise ValueError(
            f"{name} must be a time in the years 1 to 9999 of UTC, got {start}"
        ) from None


def numbers_to_store(recording, kind):
    """Return the values (n, 2 S) of a recording as numbers of a type, or raise if they don't fit.

    Whole numbers have 1 as their full scale.
    """
    values = np.ascontiguousarray(recording.x.T).view(float)
    largest = np.abs(values).max()
    if kind.kind == "f":
        if largest > np.finfo(kind).max:
            raise ValueError(
                f"recording.x must be at most {np.finfo(kind).max:.3g} in both parts to be "
                f"stored as {kind.name}, got {largest:.3g}"
            )
    else:
        info = np.iinfo(kind)
        values = np.round(values * -float(info.min))
        if values.min() < info.min or values.max() > info.max:
            raise ValueError(
                f"recording.x must lie between -1 and 1 - 2^-{info.bits - 1} in both parts to be "
                f"stored as {kind.name}, got {largest:.3g}"
            )
    return values.astype(kind)


def first_line(error):
    """Return the first line of the text of an error."""
    return str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
