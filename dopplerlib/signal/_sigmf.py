"""Recordings as SigMF: samples in one file, what they are in another."""

import hashlib
import json
import re
from datetime import datetime

import numpy as np

from .. import _checks
from .._files import file_to_write, replacing
from ._recording import Recording, checked, first_line, read_together, utc

_META, _DATA = ".sigmf-meta", ".sigmf-data"
_FULL_SCALE = 2**15
# Kinds of samples that are written: their names in SigMF and in NumPy.
_KINDS = {
    "complex128": ("cf64_le", "<f8"),
    "complex64": ("cf32_le", "<f4"),
    "int16": ("ci16_le", "<i2"),
}
_LARGEST = 1e12  # Hz: SigMF allows no sampling rate or frequency beyond
# What says that the samples are elsewhere, or something else among them.
_ELSEWHERE = ("core:dataset", "core:metadata_only", "core:trailing_bytes", "core:header_bytes")


def write_sigmf(path, recording, samples="complex128", description=""):
    """Write a recording as SigMF: one pair of files, with a channel for each sensor.

    Parameters
    ----------
    path : path-like
        Name of the pair, without ``.sigmf-meta`` and ``.sigmf-data``. Older files of that name
        are replaced once the new ones are complete.
    recording : Recording
        What to write.
    samples : {"complex128", "complex64", "int16"}
        How a sample is stored: without loss, in half the space, or as a converter of 16 bits
        would give it, with 1 as the largest value.
    description : str
        A sentence for whoever finds the file.

    Returns
    -------
    Path
        Of the file with the metadata.

    Raises
    ------
    ValueError
        If the folder does not exist, or `path` has one of the two endings; if `recording` is none,
        its samples are not finite or too large for their kind, its rate or carrier is not positive
        or beyond 1e12 Hz, or its start has no time zone; or if `description` is no text.
    ModuleNotFoundError
        If the package ``sigmf`` is not installed.

    Notes
    -----
    SigMF 1.2 (https://sigmf.org). The hash of the samples is stored too, so that `read_sigmf`
    notices a file that was cut or changed.
    """
    from sigmf import SigMFFile, keys

    path, x = file_to_write(path), checked(recording)
    if path.name.endswith((_META, _DATA)):
        raise ValueError(f"path must be without {_META} and {_DATA}, got {str(path)!r}")
    kind, number = _KINDS[_checks.one_of("samples", samples, tuple(_KINDS))]
    _checks.instance("description", description, str)
    for name, value in (("fs", recording.fs), ("carrier", recording.carrier)):
        if value > _LARGEST:
            raise ValueError(f"recording.{name} must be at most 1e12 Hz for SigMF, got {value:g}")
    values = _rounded(np.ascontiguousarray(x.T).view(float), samples).astype(number)
    info = {
        keys.DATATYPE_KEY: kind,
        keys.SAMPLE_RATE_KEY: float(recording.fs),
        keys.NUM_CHANNELS_KEY: len(x),
    }
    if description:
        info[keys.DESCRIPTION_KEY] = description
    capture = {keys.FREQUENCY_KEY: float(recording.carrier)}
    start = utc("recording.start", recording.start)
    if start is not None:
        stamp = start.replace(tzinfo=None).isoformat(timespec="microseconds")
        capture[keys.DATETIME_KEY] = f"{stamp}Z"
    data, meta = (path.with_name(f"{path.name}{end}") for end in (_DATA, _META))
    for one in (data, meta):
        file_to_write(one)
    with replacing(data, meta) as (new_data, new_meta):
        with new_data.open("wb") as file:  # tofile says of a full disk only how much went in
            file.write(values.data)
        file = SigMFFile(data_file=new_data, global_info=info)
        file.add_capture(0, metadata=capture)
        file.validate()
        new_meta.write_bytes((file.dumps(pretty=True) + "\n").encode())
    return meta


def read_sigmf(paths):
    """Read a recording in SigMF.

    Parameters
    ----------
    paths : path-like or sequence of path-like
        A file ``.sigmf-meta`` with a channel for each sensor, or one file for each sensor, in
        their order.

    Returns
    -------
    Recording
        Samples that are stored as whole numbers are scaled to -1 ... 1.

    Raises
    ------
    ValueError
        If a file is missing, given twice, malformed, cut, changed after it was written, without
        samples, with a sample that is not finite, or has no sampling rate or carrier; if it asks
        for more than SigMF 1, or for an extension; or if files for several sensors do not belong
        together.
    ModuleNotFoundError
        If the package ``sigmf`` is not installed.

    Notes
    -----
    SigMF 1.2. A file of several captures has gaps or changes its carrier, so it is refused. So is
    one whose first sample is not that of its start, one with something other than samples in its
    data (a "non-conforming dataset"), and one whose start has no time zone.
    """
    return read_together(paths, _META, _read)


def _rounded(values, samples):
    """Return the numbers to store, or raise if their kind has no such large ones."""
    largest = np.abs(values).max()
    if samples == "int16":
        values = np.round(values * _FULL_SCALE)
        if values.min() < -_FULL_SCALE or values.max() > _FULL_SCALE - 1:
            raise ValueError(
                "recording.x must lie between -1 and 1 - 2^-15 in both parts to be stored as "
                f"int16, got {largest:.3g}"
            )
    elif samples == "complex64" and largest > np.finfo(np.float32).max:
        raise ValueError(
            f"recording.x must be at most {np.finfo(np.float32).max:.3g} in both parts to be "
            f"stored as complex64, got {largest:.3g}"
        )
    return values


def _read(path):
    try:
        content = _metadata(path)
        info, capture = content["global"], content["captures"][0]
        values = _samples(path.with_name(path.name.removesuffix(_META) + _DATA), info)
        stamp = capture.get("core:datetime")
        start = utc("its core:datetime", None if stamp is None else datetime.fromisoformat(stamp))
    except (ValueError, OSError, RecursionError) as error:
        raise ValueError(f"{path.name} is no sound SigMF recording: {first_line(error)}") from None
    rate, carrier = info.get("core:sample_rate"), capture.get("core:frequency")
    for name, value in (("sampling rate", rate), ("carrier frequency", carrier)):
        if value is None or not value > 0:
            raise ValueError(f"{path.name} must tell a positive {name}, got {value}")
    return Recording(values, float(rate), float(carrier), start)


def _metadata(path):
    """Return the content of a file of metadata, or raise unless all of it can be obeyed."""
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import best_match
    from sigmf.schema import get_schema

    def refuse(word):
        raise ValueError(f"its numbers must be finite, got {word}")

    content = json.loads(path.read_bytes(), parse_constant=refuse)
    error = best_match(Draft202012Validator(get_schema()).iter_errors(content))
    if error is not None:
        where = ".".join(map(str, error.absolute_path)) or "its content"
        raise ValueError(f"{where}: {first_line(error.message)}")
    info, captures = content["global"], content["captures"]
    if not info["core:version"].startswith("1."):
        raise ValueError(f"its core:version must be one of SigMF 1, got {info['core:version']}")
    for extension in info.get("core:extensions", []):
        if not extension["optional"]:
            raise ValueError(f"it must do without extensions, got {extension['name']!r}")
    if len(captures) != 1:
        raise ValueError(f"it must have one capture, got {len(captures)}")
    for name in _ELSEWHERE:
        for part in (info, captures[0]):
            if part.get(name):
                raise ValueError(f"it must not have {name}, got {part[name]!r}")
    for name, part in (("core:offset", info), ("core:sample_start", captures[0])):
        if part.get(name, 0) != 0:
            raise ValueError(f"its {name} must be 0, got {part[name]}")
    return content


def _samples(path, info):
    """Return the samples in a file, shape (S, n)."""
    datatype, channels = info["core:datatype"], info.get("core:num_channels", 1)
    found = re.fullmatch(r"([cr])([fiu])(8|16|32|64)(_[lb]e)?", datatype)
    if not found or (found[4] is None) != (found[3] == "8"):
        raise ValueError(f"its core:datatype must be one of SigMF, got {datatype!r}")
    if found[1] != "c":
        raise ValueError(f"it must hold complex samples, got {datatype}")
    if not isinstance(channels, int):  # a schema takes 3.0 for a whole number
        raise ValueError(f"its core:num_channels must be a whole number, got {channels}")
    if not path.is_file():
        raise ValueError(f"its samples must be in {path.name}, got no such file")
    data = path.read_bytes()
    if "core:sha512" in info and hashlib.sha512(data).hexdigest() != info["core:sha512"].lower():
        raise ValueError("the hash of its samples must be core:sha512, got another one")
    kind, bits = found[2], int(found[3])
    number = np.dtype(f"{'>' if found[4] == '_be' else '<'}{kind}{bits // 8}")
    frame = 2 * channels * number.itemsize
    if len(data) % frame:
        raise ValueError(f"its samples must be a multiple of {frame} bytes, got {len(data)}")
    values = np.frombuffer(data, number).astype(float)
    if kind != "f":
        half = 2.0 ** (bits - 1)
        values = values / half - (kind == "u")
    return np.ascontiguousarray(values).view(complex).reshape(-1, channels).T
