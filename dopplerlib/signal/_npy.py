"""Recordings as arrays of NumPy: one file for all sensors, or one for each."""

from collections.abc import Iterable

import numpy as np

from .. import _checks
from ._joining import Path, Source, existing, join
from ._recording import Recording, first_line

_BLOCK = 2**20  # values that are read at a time


def read_npy(
    paths: Path | Iterable[Path],
    fs: float,
    carrier: float,
    *,
    layout: str | None = None,
    first: int = 0,
    count: int | None = None,
) -> Recording:
    """Read a recording from arrays that `numpy.save` wrote.

    Parameters
    ----------
    paths : path-like or sequence of path-like
        A file with the samples of all sensors, or one for each, in their order. A file holds an
        array (S, n) of complex samples of S sensors, or (C, n) of C real channels; of one sensor or
        channel, (n,) will do.
    fs : float
        Sampling rate in Hz, for which the file has no place.
    carrier : float
        Carrier frequency in Hz.
    layout : {"iq", "qi", "real"}, optional
        Order of real channels, see `read_wav`. Complex samples are I + 1j Q, or with "qi" Q + 1j I.
    first, count : int, optional
        Which samples to read, of those that all files have in common: `count` samples from sample
        `first` on. By default all.

    Returns
    -------
    Recording
        Whole numbers are scaled to -1 ... 1 by the range of their type. With ``layout="real"`` the
        analytic signal, and `without_q` is set: `ml_frequency_real` estimates Doppler shifts, whose
        sign is not known.

    Raises
    ------
    ValueError
        If a file is missing, given twice, not an array of numbers in the format of NumPy, or has
        more channels than samples, which is an array that lies the other way; if files do not
        belong together; if `fs` or `carrier` is not positive; or if `layout`, `first` or `count` do
        not fit.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> from dopplerlib.signal.recording import read_npy
    >>> path = Path(mkdtemp()) / "one.npy"
    >>> np.save(path, np.array([[0.5, 0.5j, -0.5]]))
    >>> read_npy(path, fs=1000.0, carrier=24e9).x
    array([[ 0.5+0.j ,  0. +0.5j, -0.5+0.j ]])
    """
    fs, carrier = (_checks.positive_number(*one) for one in (("fs", fs), ("carrier", carrier)))
    sources = [_source(path, fs, carrier) for path in existing(paths)]
    return join(sources, layout, first, count)


def _source(path, fs, carrier):
    try:
        values = np.load(path, mmap_mode="r", allow_pickle=False)
        if not isinstance(values, np.ndarray):
            values.close()
            raise ValueError("it must hold one array, got an archive of several")
        if values.dtype.kind not in "iufc":
            raise ValueError(f"its samples must be numbers, got {values.dtype}")
        if values.ndim not in (1, 2):
            raise ValueError(f"its shape must be (channels, samples), got {values.shape}")
    except (ValueError, OSError, EOFError) as error:
        raise ValueError(
            f"{path.name} is not a valid .npy recording: {first_line(error)}"
        ) from None
    values = np.atleast_2d(values)
    if len(values) > values.shape[1] > 0:
        raise ValueError(
            f"{path.name} must have the shape (channels, samples), got {values.shape}: save its "
            "transpose"
        )
    plain = values.dtype.kind != "c"
    channels = len(values) * (1 if plain else 2)

    def blocks(first, count):
        step = max(_BLOCK // channels, 1)
        for a in range(first, first + count, step):
            yield _numbers(values[:, a : min(a + step, first + count)])

    real = None if plain else False
    return Source(path.name, fs, carrier, None, values.shape[1], channels, real, blocks)


def _numbers(part):
    """Return samples (C, n) as numbers (n, C), those of I and Q in turn."""
    kind = part.dtype.kind
    if kind == "c":
        return np.ascontiguousarray(part.T, complex).view(float)
    if kind == "f":
        return part.T.astype(float)
    scale = 2.0 ** (8 * part.dtype.itemsize - 1)
    return part.T / scale - (kind == "u")
