"""Alignment of recordings over the time that they have in common."""

import pathlib
from collections.abc import Callable, Iterable, Iterator
from datetime import UTC, datetime
from os import PathLike
from os.path import isfile
from typing import NamedTuple

import numpy as np

from .. import _checks
from .._typing import ArrayLike
from ._layout import LAYOUTS, analytic, samples, turning
from ._recording import Recording, later
from .validity import valid_samples

Path = str | PathLike[str]
_ANY = datetime(2000, 1, 1, tzinfo=UTC)  # for recordings that tell no start
_LIKELY = 0.6  # share of strong windows whose lines turn: 1 for I and Q, 0 to 0.5 for real channels


class Source(NamedTuple):
    """Metadata of a file, known before its samples are read."""

    name: str  # of the file
    fs: float
    carrier: float
    start: datetime | None
    length: int  # samples
    channels: int  # I and Q are two
    real: bool | None  # whether a channel is a sensor; None: not told
    blocks: Callable[[int, int], Iterator[np.ndarray]]  # (first, count): (n_i, channels) each
    lost: Callable[[int, int], np.ndarray] | None = None  # (first, count): bool (sensors, count)


def align(recordings: Iterable[Recording], delays: ArrayLike | None = None) -> Recording:
    """Align recordings over the time that they have in common.

    Parameters
    ----------
    recordings : sequence of Recording
        Of one sensor or more each, with the same sampling rate and carrier. Unless there are
        `delays`, either all or none of them tell their start; those that do not must have the same
        length.
    delays : array_like, shape (R,), optional
        By how many seconds each of R recordings began after a moment, such as the start of the
        first one; see `clock_offset`. The starts that recordings tell do not count then, except for
        the first one's.

    Returns
    -------
    Recording
        The sensors of all of them in their order.

    Raises
    ------
    ValueError
        If `recordings` is no sequence of recordings, if their sampling rates or carriers differ,
        if they have no time in common, or if their lengths differ and nothing tells their start;
        if `delays` are not as many finite numbers; or if some modules have a Q and others do not.

    Notes
    -----
    Samples are not interpolated: a start counts to the nearest sample, so that sensors may be half
    a sample apart. Doppler shifts do not notice, which come from windows of many samples.

    Examples
    --------
    >>> from datetime import UTC, datetime, timedelta
    >>> from dopplerlib.signal.recording import Recording, align
    >>> noon = datetime(2016, 9, 28, 12, tzinfo=UTC)
    >>> one = Recording([[0j, 1, 2, 3]], 1000.0, 24e9, noon)
    >>> two = Recording([[4 + 0j, 5, 6]], 1000.0, 24e9, noon + timedelta(milliseconds=2))
    >>> align([one, two]).x.real
    array([[2., 3.],
           [4., 5.]])
    """
    given = list(recordings) if isinstance(recordings, Iterable) else []
    if not given or not all(isinstance(one, Recording) for one in given):
        raise ValueError(f"recordings must be a sequence of recordings, got {recordings!r:.80}")
    if len({r.without_q for r in given}) > 1:
        raise ValueError("recordings must all have a Q, or none of them, got both")
    starts = [r.start for r in given]
    if delays is not None:
        delays = _checks.exact_shape("delays", _checks.finite("delays", delays), (len(given),))
        moment = starts[0] or _ANY
        starts = [later(moment, float(d - delays[0])) for d in delays]
    sources = [
        Source(f"recordings[{i}]", r.fs, r.carrier, start, r.x.shape[1], 2 * len(r.x), None, None)
        for i, (r, start) in enumerate(zip(given, starts, strict=True))
    ]
    firsts, count, start = overlap(sources)
    if given[0].start is None:
        start = None
    parts = [slice(first, first + count) for first in firsts]
    x = np.concatenate([r.x[:, part] for r, part in zip(given, parts, strict=True)])
    valid = np.concatenate([r.valid[:, part] for r, part in zip(given, parts, strict=True)])
    return Recording(x, sources[0].fs, sources[0].carrier, start, valid, given[0].without_q)


def existing(paths, found=lambda path: path):
    """Return paths as a list of different files that exist.

    `found` returns the file that a path means, which may have another name.
    """
    given = paths
    try:
        paths = [paths] if isinstance(paths, (str, PathLike)) else list(paths)
    except TypeError:
        paths = [paths]
    if not all(isinstance(path, (str, PathLike)) for path in paths):
        raise ValueError(f"paths must be a path or a sequence of paths, got {given!r}")
    if not paths:
        raise ValueError("paths must name at least one file, got none")
    files = [found(pathlib.Path(path)) for path in paths]
    for i, (path, file) in enumerate(zip(paths, files, strict=True)):
        if not isfile(file):  # Path.is_file raises if a name is too long
            raise ValueError(f"paths must be files that exist, got {str(path)!r}")
        if any(file.samefile(other) for other in files[:i]):
            raise ValueError(f"paths must be different files, got {str(path)!r} twice")
    return files


def overlap(sources, first=0, count=None):
    """Return the first sample of each source, the number to read, and the time of the first.

    `first` and `count` are samples of what all of them have in common.
    """
    one = sources[0]
    for other in sources[1:]:
        for what, ours, theirs in (
            ("sampling rate", one.fs, other.fs),
            ("carrier frequency", one.carrier, other.carrier),
        ):
            if ours != theirs:
                raise ValueError(
                    f"{other.name} must have the {what} of {one.name}, {ours}, got {theirs}"
                )
        if (one.start is None) != (other.start is None):
            raise ValueError(
                f"{other.name} must have a start if and only if {one.name} has one, "
                f"{one.start}, got {other.start}"
            )
    start = one.start
    if start is None:
        firsts = [0] * len(sources)
        lengths = [source.length for source in sources]
        if count is None and len(set(lengths)) > 1:
            other = next(source for source in sources if source.length != one.length)
            raise ValueError(
                f"{other.name} must have the number of samples of {one.name}, {one.length}, if "
                f"they state no start, got {other.length}; with a start for each they are "
                f"aligned, and if they started together, count={min(lengths)} reads all of them"
            )
    else:
        start = max(source.start for source in sources)
        firsts = [round((start - source.start).total_seconds() * one.fs) for source in sources]
        lengths = [source.length - a for source, a in zip(sources, firsts, strict=True)]
        for source, length in zip(sources, lengths, strict=True):
            if length <= 0:
                raise ValueError(
                    f"{source.name} must have samples when the last one starts, at {start}, got "
                    f"{source.length} from {source.start} on"
                )
    left = min(lengths) - first
    if left <= 0:
        raise ValueError(
            f"first must be less than the number of samples, {min(lengths)}, got {first}"
        )
    if count is not None and count > left:
        raise ValueError(f"count must be at most {left} after sample {first}, got {count}")
    firsts = [a + first for a in firsts]
    return firsts, left if count is None else count, later(start, first / one.fs)


def join(sources, layout, first, count):
    """Read samples `first` to `first` + `count` of sources as one recording."""
    _checks.whole_number("first", first, least=0)
    if count is not None:
        _checks.whole_number("count", count)
    for source in sources:
        if not source.length:
            raise ValueError(f"{source.name} must hold samples, got none")
    kind = _kind(sources, layout)
    firsts, count, start = overlap(sources, first, count)
    sensors = [source.channels // (1 if kind == "real" else 2) for source in sources]
    try:
        x = np.empty((sum(sensors), count), float if kind == "real" else complex)
        rows = np.split(np.arange(len(x)), np.cumsum(sensors)[:-1])
        for source, own, a in zip(sources, rows, firsts, strict=True):
            _fill(x[own[0] : own[-1] + 1], source, a, kind)
        valid = valid_samples(x)
        without_q = np.zeros(len(x), dtype=bool) if kind == "real" else ~x.imag.any(axis=1)
        if not without_q.all():
            valid[without_q] = False  # beside others that have one, this Q is dead
        for source, own, a in zip(sources, rows, firsts, strict=True):
            if source.lost is not None:
                valid[own] &= ~source.lost(a, count)
        if layout is None:
            _check_kind(sources, x, valid, kind)
        if kind == "real":
            x = analytic(np.where(np.isfinite(x), x, 0))
    except MemoryError:
        size = sum(sensors) * count * np.dtype(complex).itemsize / 2**30
        raise ValueError(
            f"{sources[0].name} must fit into memory, got {count} samples of {sum(sensors)} "
            f"sensors, several times {size:.3g} GiB: read a part with first and count"
        ) from None
    return Recording(x, sources[0].fs, sources[0].carrier, start, valid, kind == "real")


def _fill(rows, source, first, kind):
    done = 0
    for block in source.blocks(first, rows.shape[1]):
        part = samples(block, kind)
        rows[:, done : done + part.shape[1]] = part
        done += part.shape[1]


def _kind(sources, layout):
    """Return the layout of the channels of files: the given one, or the usual one."""
    if layout is not None:
        _checks.one_of("layout", layout, LAYOUTS)
    kind = layout or ("real" if sources[0].real else "iq")
    for source in sources:
        if source.real is False and kind == "real":
            raise ValueError(
                f"layout must be 'iq' or 'qi' for {source.name}, which is complex, got {layout!r}"
            )
        if source.channels % 2 and kind != "real":
            raise ValueError(
                f"{source.name} must have two channels a sensor, I and Q, unless layout is 'real', "
                f"got {source.channels}"
            )
    return kind


def _check_kind(sources, x, valid, kind):
    """Raise if the samples say that the usual layout of their files is not theirs."""
    names = ", ".join(source.name for source in sources)
    if kind == "iq" and sources[0].real is None:
        turns = turning(x, valid, sources[0].fs)
        still = np.flatnonzero(turns < _LIKELY)
        if len(still):
            raise ValueError(
                f"layout must be given for {names}, since I and Q of sensor {still[0]} do not turn "
                f"together (in {turns[still[0]]:.0%} of the windows with a strong line): 'real' if "
                "each channel is a sensor of its own, 'iq' if they are I and Q all the same, "
                "got None"
            )
    elif kind == "real" and len(x) % 2 == 0:
        turns = turning(x[::2] + 1j * x[1::2], valid[::2] & valid[1::2], sources[0].fs)
        if np.nanmin(turns, initial=np.inf) >= _LIKELY and np.isfinite(turns).any():
            raise ValueError(
                f"layout must be given for {names}, since pairs of channels turn together: 'iq' if "
                "they are I and Q, 'real' if each is a sensor of its own, got None"
            )
