"""A recording, and what its two formats on disk have in common."""

from datetime import UTC, datetime
from os import PathLike
from pathlib import Path

import numpy as np

from .. import _checks
from .._records import record


@record
class Recording:
    """IQ samples of several sensors, with what is needed to make Doppler shifts of them.

    Attributes
    ----------
    x : ndarray of complex, shape (S, n)
        Samples of S sensors, taken at the same times.
    fs : float
        Sampling rate in Hz.
    carrier : float
        Carrier frequency in Hz.
    start : datetime, optional
        Time of the first sample, with a time zone; what is read is in UTC.
    """

    x: np.ndarray
    fs: float
    carrier: float
    start: datetime | None = None

    @property
    def time(self):
        """Time of each sample in s, counted from the first one, shape (n,)."""
        return np.arange(self.x.shape[-1]) / self.fs

    @property
    def wavelength(self):
        """Wavelength in vacuum in m."""
        from scipy.constants import speed_of_light

        return speed_of_light / self.carrier


def checked(recording):
    """Return a recording's samples (S, n), or raise unless it can be written."""
    _checks.instance("recording", recording, Recording)
    x = _checks.finite_complex("recording.x", recording.x, (None, None))
    if x.ndim != 2 or not x.size:
        raise ValueError(f"recording.x must have shape (S, n) with samples in it, got {x.shape}")
    _checks.positive_number("recording.fs", recording.fs)
    _checks.positive_number("recording.carrier", recording.carrier)
    utc("recording.start", recording.start)
    return x


def utc(name, start):
    """Return a moment in UTC, or None if that is what it is; raise if it is neither."""
    if start is None:
        return None
    if not isinstance(start, datetime) or start.utcoffset() is None:
        raise ValueError(f"{name} must be a datetime with a time zone or None, got {start!r}")
    return start.astimezone(UTC)


def read_together(paths, end, read):
    """Return one recording of the files `paths`, which must have the same clock.

    Parameters
    ----------
    paths : path-like or sequence of path-like
        Files whose names end in `end`.
    end : str
    read : callable
        Takes a path, returns a Recording with a sound carrier and start; the rest is checked here.
    """
    files = _existing(paths, end)
    recordings = [read(path) for path in files]
    for path, one in zip(files, recordings, strict=True):
        if not one.x.size:
            raise ValueError(f"{path.name} must hold samples, got none")
        _checks.finite_complex(f"the array of samples in {path.name}", one.x)
    first = recordings[0]
    for path, one in zip(files[1:], recordings[1:], strict=True):
        for name, ours, theirs in (
            ("sampling rate", first.fs, one.fs),
            ("carrier frequency", first.carrier, one.carrier),
            ("start", first.start, one.start),
            ("number of samples", first.x.shape[-1], one.x.shape[-1]),
        ):
            if ours != theirs:
                raise ValueError(
                    f"{path.name} must have the {name} of {files[0].name}, {ours}, got {theirs}"
                )
    x = np.concatenate([one.x for one in recordings])
    return Recording(x, first.fs, first.carrier, first.start)


def _existing(paths, end):
    """Return paths as a list of different files that exist."""
    given = paths
    if isinstance(paths, (str, PathLike)) or not hasattr(paths, "__iter__"):
        paths = [paths]
    paths = list(paths)
    for path in paths:
        if not isinstance(path, (str, PathLike)):
            raise ValueError(f"paths must be a path or a sequence of paths, got {given!r}")
        if not str(path).endswith(end) or not Path(path).is_file():
            wanted = f"files {end} that exist" if end else "files that exist"
            raise ValueError(f"paths must be {wanted}, got {str(path)!r}")
    if not paths:
        raise ValueError("paths must name at least one file, got none")
    paths = [Path(path) for path in paths]
    for i, path in enumerate(paths):
        if any(path.samefile(other) for other in paths[:i]):
            raise ValueError(f"paths must be different files, got {str(path)!r} twice")
    return paths


def first_line(error):
    """Return what an error says, in a line."""
    return str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
