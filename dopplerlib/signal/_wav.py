"""Recordings as WAV: the channels are I and Q of each sensor in turn."""

import warnings

import numpy as np

from .. import _checks
from .._files import file_to_write, replacing
from ._recording import Recording, checked, first_line, read_together, utc

_DOUBLE = 8  # bytes of a value


def write_wav(path, recording):
    """Write a recording as WAV without loss: the channels are I and Q of each sensor in turn.

    Parameters
    ----------
    path : path-like
        Name of the file. An older one is replaced once the new one is complete.
    recording : Recording
        What to write. WAV has no place for the carrier and the start: keep them elsewhere.

    Returns
    -------
    Path

    Raises
    ------
    ValueError
        If the folder does not exist; if `recording` is none, its samples are not finite, or its
        start has no time zone; or if its sampling rate is not a whole number of Hz, or rate and
        sensors are more than WAV has numbers for: 2^32 bytes in a second, 2^16 in a sample.
    """
    from scipy.io import wavfile

    path, x = file_to_write(path), checked(recording)
    fs, size = recording.fs, 2 * _DOUBLE * len(x)
    if fs != int(fs):
        raise ValueError(f"recording.fs must be a whole number of Hz for WAV, got {fs}")
    if size >= 2**16:
        most = (2**16 - 1) // (2 * _DOUBLE)
        raise ValueError(f"recording.x must have at most {most} sensors for WAV, got {len(x)}")
    if fs * size >= 2**32:
        raise ValueError(
            f"recording.fs must be less than {2**32 / size:g} Hz for {len(x)} sensors in WAV, "
            f"got {fs}"
        )
    with replacing(path) as (temporary,):
        wavfile.write(temporary, int(fs), np.ascontiguousarray(x.T).view(float))
    return path


def read_wav(paths, carrier, start=None):
    """Read a recording from WAV files in which I and Q are a pair of channels.

    Parameters
    ----------
    paths : path-like or sequence of path-like
        A file with two channels for each sensor, or one stereo file for each, in their order.
    carrier : float
        Carrier frequency in Hz, for which WAV has no place.
    start : datetime, optional
        Time of the first sample, with a time zone.

    Returns
    -------
    Recording
        Samples that are stored as whole numbers are scaled to -1 ... 1.

    Raises
    ------
    ValueError
        If a file is missing, given twice, malformed, cut, without samples, with an odd number of
        channels, or with a sample that is not finite; if files for several sensors do not belong
        together; if `carrier` is not positive, or `start` is no datetime with a time zone.
    """
    carrier = _checks.positive_number("carrier", carrier)
    start = utc("start", start)
    return read_together(paths, "", lambda path: _read(path, carrier, start))


def _read(path, carrier, start):
    from scipy.io import wavfile

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            fs, values = wavfile.read(path)
    except Exception as error:  # SciPy reads the header unguarded: struct.error and the like
        raise ValueError(f"{path.name} is no sound WAV file: {first_line(error)}") from None
    if not fs > 0:
        raise ValueError(f"{path.name} must tell a positive sampling rate, got {fs}")
    channels = 1 if values.ndim == 1 else values.shape[1]
    if channels % 2:
        raise ValueError(f"{path.name} must have two channels a sensor, I and Q, got {channels}")
    if values.dtype.kind == "u":  # eight bits are stored without a sign
        values = values / 2**7 - 1
    elif values.dtype.kind == "i":
        values = values / -float(np.iinfo(values.dtype).min)
    x = np.ascontiguousarray(values, dtype=float).view(complex).T
    return Recording(x, float(fs), carrier, start)
