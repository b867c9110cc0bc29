"""Recordings as SigMF: samples and metadata in two files, or both in an archive."""

import hashlib
import pathlib
import re
import tarfile
import zipfile
from collections.abc import Iterable
from os.path import isfile

import numpy as np

from .. import _checks
from .._files import file_to_write, replacing
from .._lazy import require
from ._joining import Path, Source, existing, join
from ._recording import Recording, first_line, numbers_to_store, utc
from ._sigmf_metadata import INVALID, invalid_runs, parsed, segments, which_invalid

_META, _DATA = ".sigmf-meta", ".sigmf-data"
_ARCHIVES = (".sigmf", ".sigmf.gz", ".sigmf.xz", ".sigmf.zip")
# Kinds of samples that are written: their names in SigMF and the type of I and Q in NumPy.
_KINDS = {
    "complex128": ("cf64_le", "<f8"),
    "complex64": ("cf32_le", "<f4"),
    "int16": ("ci16_le", "<i2"),
}
_LARGEST = 1e12  # Hz: SigMF allows no sampling rate or frequency beyond
_BLOCK = 2**20  # values that are read at a time


def write_sigmf(
    path: Path, recording: Recording, samples: str = "complex128", description: str = ""
) -> pathlib.Path:
    """Write a recording as SigMF: one pair of files, with a channel for each sensor.

    Parameters
    ----------
    path : path-like
        Name of the pair, without ``.sigmf-meta`` and ``.sigmf-data``. Older files of that name
        are replaced once the new ones are complete.
    recording : Recording
        Recording to write.
    samples : {"complex128", "complex64", "int16"}
        How a sample is stored: without loss, in half the space, or as a converter of 16 bits
        would give it, with 1 as the largest value.
    description : str
        Description that is written to the metadata.

    Returns
    -------
    Path
        Of the file with the metadata.

    Raises
    ------
    ValueError
        If `path` leads to no files that may be written, or has one of the two endings; if
        `recording` is none, its samples are too large for their kind, or its rate or carrier is
        beyond 1e12 Hz; or if `description` is no text.
    ModuleNotFoundError
        If the package ``sigmf`` is not installed.

    Notes
    -----
    SigMF 1.2 (https://sigmf.org). The hash of the samples is stored too, so that `read_sigmf`
    notices a file that was cut or changed, and which samples are no measurements, in the field
    ``dopplerlib:invalid`` of an extension that others need not know: ``[sensor, first, count]``.
    """
    require("sigmf", extra="recordings")
    from sigmf import SigMFFile, keys

    path = file_to_write(path)
    _checks.instance("recording", recording, Recording)
    if path.name.endswith((_META, _DATA)):
        raise ValueError(f"path must be without {_META} and {_DATA}, got {str(path)!r}")
    kind, number = _KINDS[_checks.one_of("samples", samples, tuple(_KINDS))]
    _checks.instance("description", description, str)
    for name, value in (("fs", recording.fs), ("carrier", recording.carrier)):
        if value > _LARGEST:
            raise ValueError(f"recording.{name} must be at most 1e12 Hz for SigMF, got {value:g}")
    values = numbers_to_store(recording, np.dtype(number))
    info = {
        keys.DATATYPE_KEY: kind,
        keys.SAMPLE_RATE_KEY: float(recording.fs),
        keys.NUM_CHANNELS_KEY: len(recording.x),
    }
    if description:
        info[keys.DESCRIPTION_KEY] = description
    if not recording.valid.all():
        info[keys.EXTENSIONS_KEY] = [{"name": "dopplerlib", "version": "1.0.0", "optional": True}]
        info[INVALID] = invalid_runs(recording.valid)
    capture: dict[str, float | str] = {keys.FREQUENCY_KEY: float(recording.carrier)}
    start = utc("recording.start", recording.start)
    if start is not None:
        stamp = start.replace(tzinfo=None).isoformat(timespec="microseconds")
        capture[keys.DATETIME_KEY] = f"{stamp}Z"
    data, meta = (path.with_name(f"{path.name}{end}") for end in (_DATA, _META))
    with replacing(data, meta) as (new_data, new_meta):
        with new_data.open("wb") as file:  # tofile says of a full disk only how much went in
            file.write(values.data)
        file = SigMFFile(data_file=new_data, global_info=info)
        file.add_capture(0, metadata=capture)
        file.validate()
        new_meta.write_bytes((file.dumps(pretty=True) + "\n").encode())
    return meta


def read_sigmf(
    paths: Path | Iterable[Path],
    carrier: float | None = None,
    *,
    layout: str | None = None,
    first: int = 0,
    count: int | None = None,
) -> Recording:
    """Read a recording in SigMF.

    Parameters
    ----------
    paths : path-like or sequence of path-like
        A recording with a channel for each sensor, or one recording for each sensor, in their
        order. A recording is an archive or a pair of files, named by either of them or by what
        their names share. Those that start at different times are aligned, see `align`.
    carrier : float, optional
        Carrier frequency in Hz of a recording whose metadata have none.
    layout : {"iq", "qi", "real"}, optional
        Order of the numbers: I and Q of each sensor in turn, Q and I in turn, or one real channel
        a sensor. If None, what the metadata say: "iq" if the samples are complex, "real" if they
        are not, unless pairs of them turn together like I and Q.
    first, count : int, optional
        Which samples to read, of those that all recordings have in common: `count` samples from
        sample `first` on. By default all.

    Returns
    -------
    Recording
        Samples that are stored as whole numbers are scaled to -1 ... 1. With ``layout="real"`` the
        analytic signal, and `without_q` is set: `ml_frequency_real` estimates Doppler shifts, whose
        sign is not known.

    Raises
    ------
    ValueError
        If a file is missing, given twice, malformed, cut, changed after it was written or without
        samples; if it has no sampling rate, or no carrier and `carrier` is None; if it changes its
        carrier, or requires an extension; if recordings of several sensors do not belong together
        or have no time in common; if `carrier` is not positive or not that of the metadata; if
        `layout`, `first` or `count` do not fit; or if the recording does not fit into memory.
    ModuleNotFoundError
        If the package ``sigmf`` is not installed.

    Notes
    -----
    SigMF up to version 1.2. Captures that follow each other are one recording; if their global
    indices or times leave a gap of more than a sample, the samples in it are invalid. A time
    without a time zone is one in UTC, since SigMF knows no other. Data with something other than
    samples among them (a "non-conforming dataset") are refused. The hash is compared if all
    samples are read; of a part it would take longer than reading it.

    Examples
    --------
    >>> from dopplerlib import read_sigmf
    >>> from dopplerlib._data import on_disk, results
    >>> files = "simulated_recording.sigmf-meta", "simulated_recording.sigmf-data"
    >>> with on_disk(results(), *files) as folder:
    ...     recording = read_sigmf(folder / files[0])
    >>> recording.x.shape, recording.fs
    ((6, 2001), 2000.0)
    """
    require("sigmf", extra="recordings")
    if carrier is not None:
        carrier = _checks.positive_number("carrier", carrier)
    whole = first == 0 and count is None
    sources = [_source(path, carrier, whole) for path in existing(paths, _found)]
    return join(sources, layout, first, count)


def _found(path):
    """Return the file of metadata or the archive that a path means."""
    if not path.name or path.name.endswith(_ARCHIVES):
        return path
    base = path.name.removesuffix(_META).removesuffix(_DATA)
    pair, *archives = (path.with_name(base + end) for end in (_META, *_ARCHIVES))
    return next((one for one in (pair, *archives) if isfile(one)), pair)


def _source(path, carrier, whole):
    try:
        content, raw = _opened(path)
        info = content["global"]
        number, real = _datatype(info["core:datatype"])
        channels = info.get("core:num_channels", 1) * (1 if real else 2)
        frame = channels * number.itemsize
        if len(raw) % frame:
            raise ValueError(f"its samples must be a multiple of {frame} bytes, got {len(raw)}")
        start, pieces = segments(content, len(raw) // frame)
        invalid = None if real else which_invalid(content, channels // 2)
        if whole and "core:sha512" in info:
            if hashlib.sha512(raw).hexdigest() != info["core:sha512"].lower():
                raise ValueError("the hash of its samples must be core:sha512, got another one")
    except (ValueError, OSError, RecursionError) as error:
        raise ValueError(
            f"{path.name} is not a valid SigMF recording: {first_line(error)}"
        ) from None
    rate = info.get("core:sample_rate")
    told = content["captures"][0].get("core:frequency") if content["captures"] else None
    if None not in (carrier, told) and carrier != told:
        raise ValueError(f"carrier must be that of {path.name}, {told}, got {carrier}")
    carrier = carrier if told is None else told
    for name, value in (("sampling rate", rate), ("carrier frequency", carrier)):
        if value is None or not value > 0:
            raise ValueError(f"{path.name} must state a positive {name}, got {value}")
    values = raw.view(number).reshape(-1, channels)

    def blocks(first, count):
        for at, row, many in pieces:
            a, b = max(first, at), min(first + count, at + many)
            for i in range(a, b, step := max(_BLOCK // channels, 1)):
                j = min(i + step, b)
                if row is None:
                    yield np.full((j - i, channels), np.nan)
                else:
                    yield _scaled(values[row + i - at : row + j - at])

    length = pieces[-1].at + pieces[-1].count
    return Source(
        path.name,
        float(rate),
        float(carrier or told),
        start,
        length,
        channels,
        real,
        blocks,
        invalid,
    )


def _opened(path):
    """Return the metadata of a recording, and the bytes of its samples."""
    if path.name.endswith(_ARCHIVES):
        file = _archive(path)
        content = parsed(file.dumps())
        if file.data_file is None:
            return content, np.frombuffer(file.data_buffer.getbuffer(), np.uint8)
        data, place, length = file.data_file, file.data_offset, file.data_size_bytes
    else:
        content = parsed(path.read_bytes())
        data = path.with_name(path.name.removesuffix(_META) + _DATA)
        if not data.is_file():
            raise ValueError(f"its samples must be in {data.name}, got no such file")
        place, length = 0, data.stat().st_size
    if not length:  # nothing cannot be mapped
        return content, np.empty(0, np.uint8)
    return content, np.memmap(data, np.uint8, "r", place, (length,))


def _archive(path):
    """Return an archive as `sigmf` opens it, or raise unless it holds one recording."""
    from sigmf import fromfile

    try:
        if zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as archive:
                names = archive.namelist()
        else:
            with tarfile.open(path) as archive:
                names = archive.getnames()
        metadata = [name for name in names if name.endswith(_META)]
        if len(metadata) != 1:  # sigmf would take the samples of one for those of another
            raise ValueError(f"it must hold one recording, got {len(metadata)}")
        return fromfile(path, skip_checksum=True)
    except Exception as error:  # of tarfile, zipfile, lzma, zlib, jsonschema and sigmf
        raise ValueError(first_line(error)) from None


def _scaled(values):
    """Return numbers as floats; whole ones are scaled to -1 ... 1."""
    kind, bits = values.dtype.kind, 8 * values.dtype.itemsize
    values = values.astype(float)
    if kind != "f":
        values /= 2.0 ** (bits - 1)
        values -= kind == "u"
    return values


def _datatype(name):
    """Return the type of a number, and whether a sample is one of them instead of two."""
    found = re.fullmatch(r"([cr])([fiu])(8|16|32|64)(_[lb]e)?", name)
    if not found or (found[4] is None) != (found[3] == "8"):
        raise ValueError(f"its core:datatype must be one of SigMF, got {name!r}")
    order = ">" if found[4] == "_be" else "<"
    return np.dtype(f"{order}{found[2]}{int(found[3]) // 8}"), found[1] == "r"
