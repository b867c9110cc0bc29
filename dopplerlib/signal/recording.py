"""IQ records on disk: SigMF and WAV, as one file for all sensors or one for each."""

import json
import warnings
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from .. import _checks

_FULL_SCALE = 2**15
# Kinds of samples that are written: their names in SigMF and in NumPy.
_KINDS = {
    "complex128": ("cf64_le", "<f8"),
    "complex64": ("cf32_le", "<f4"),
    "int16": ("ci16_le", "<i2"),
}
_DOUBLE = {"cf64_le": "<c16", "cf64_be": ">c16"}


@dataclass(frozen=True)
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
        Time of the first sample, in UTC.
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
        If `recording` is none, its samples are not finite, or they exceed 1 as "int16".
    ModuleNotFoundError
        If the package ``sigmf`` is not installed.

    Notes
    -----
    SigMF 1.2 (https://sigmf.org). The hash of the samples is stored too, so that `read_sigmf`
    notices a file that was cut or changed.
    """
    from sigmf import SigMFFile, keys

    x = _samples(recording)
    kind, number = _KINDS[_checks.one_of("samples", samples, tuple(_KINDS))]
    path = Path(path)
    values = np.ascontiguousarray(x.T).view(float)
    if samples == "int16":
        largest = np.abs(values).max()
        if largest > 1 - 1 / _FULL_SCALE:
            raise ValueError(
                "recording.x must lie between -1 and 1 in both parts to be stored as int16, "
                f"got {largest:.3g}"
            )
        values = np.round(values * _FULL_SCALE)
    data, meta = (path.with_name(f"{path.name}.sigmf-{part}") for part in ("data", "meta"))
    temporary = path.with_name(f"{path.name}.tmp.sigmf-data")
    values.astype(number).tofile(temporary)
    info = {
        keys.DATATYPE_KEY: kind,
        keys.SAMPLE_RATE_KEY: recording.fs,
        keys.NUM_CHANNELS_KEY: len(x),
    }
    if description:
        info[keys.DESCRIPTION_KEY] = description
    file = SigMFFile(data_file=temporary, global_info=info)
    capture = {keys.FREQUENCY_KEY: recording.carrier}
    if recording.start is not None:
        utc = recording.start.astimezone(UTC)
        capture[keys.DATETIME_KEY] = utc.strftime("%Y-%m-%dT%H:%M:%S.%fZ")
    file.add_capture(0, metadata=capture)
    file.validate()
    text = file.dumps(pretty=True)
    temporary.replace(data)
    _replace(meta, (text + "\n").encode())
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

    Raises
    ------
    ValueError
        If a file is missing, malformed, cut, changed after it was written, or has no sampling
        rate or carrier; or if files for several sensors do not belong together.
    ModuleNotFoundError
        If the package ``sigmf`` is not installed.

    Notes
    -----
    SigMF 1.2. A file of several captures has gaps or changes its carrier, so it is refused.
    """
    return _together([(path, _read_sigmf(Path(path))) for path in _paths(paths)])


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
        If `recording` is none, its samples are not finite, or its sampling rate is not a whole
        number of Hz, as WAV wants it.
    """
    from scipy.io import wavfile

    x = _samples(recording)
    if recording.fs != int(recording.fs):
        raise ValueError(f"recording.fs must be a whole number of Hz for WAV, got {recording.fs}")
    path = Path(path)
    temporary = path.with_name(f"{path.name}.tmp")
    wavfile.write(temporary, int(recording.fs), np.ascontiguousarray(x.T).view(float))
    temporary.replace(path)
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
        Time of the first sample.

    Returns
    -------
    Recording
        Samples that are stored as whole numbers are scaled to -1 ... 1.

    Raises
    ------
    ValueError
        If a file is missing, malformed, cut, or has an odd number of channels; if files for
        several sensors do not belong together; or if `carrier` is not positive.
    """
    carrier = _checks.positive_number("carrier", carrier)
    return _together([(path, _read_wav(Path(path), carrier, start)) for path in _paths(paths)])


def _read_sigmf(path):
    from jsonschema.exceptions import ValidationError
    from sigmf import keys
    from sigmf.error import SigMFError
    from sigmf.sigmffile import fromfile

    if not path.name.endswith(".sigmf-meta") or not path.is_file():
        raise ValueError(f"paths must be files .sigmf-meta that exist, got {str(path)!r}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            json.loads(path.read_bytes())  # else the package would leave the file open
            file = fromfile(path)
            file.validate()
            values = _decoded(file)
    except (SigMFError, ValidationError, ValueError, KeyError, OSError, UserWarning) as error:
        raise ValueError(f"{path.name} is no sound SigMF recording: {_first_line(error)}") from None
    captures = file.get_captures()
    if len(captures) != 1:
        raise ValueError(f"{path.name} must have one capture, got {len(captures)}")
    kind = file.get_global_field(keys.DATATYPE_KEY)
    if not kind.startswith("c"):
        raise ValueError(f"{path.name} must hold complex samples, got {kind}")
    fs = file.get_global_field(keys.SAMPLE_RATE_KEY)
    carrier = captures[0].get(keys.FREQUENCY_KEY)
    for name, value in (("sampling rate", fs), ("carrier frequency", carrier)):
        if value is None or value <= 0:
            raise ValueError(f"{path.name} must tell a positive {name}, got {value}")
    stamp = captures[0].get(keys.DATETIME_KEY)
    start = None if stamp is None else datetime.fromisoformat(stamp)
    return Recording(values.astype(complex), float(fs), float(carrier), start)


def _decoded(file):
    """Return the samples of a SigMF file, shape (S, n)."""
    from sigmf import keys

    if file.data_file is None:
        raise ValueError("its samples are missing")
    kind = file.get_global_field(keys.DATATYPE_KEY)
    if kind in _DOUBLE:  # the package would round these to single precision
        values = np.fromfile(file.data_file, _DOUBLE[kind]).reshape(-1, file.num_channels)
    else:
        values = file.read_samples()
    return np.atleast_2d(values.T)


def _read_wav(path, carrier, start):
    from scipy.io import wavfile

    if not path.is_file():
        raise ValueError(f"paths must be files that exist, got {str(path)!r}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            fs, values = wavfile.read(path)
    except Exception as error:  # SciPy reads the header unguarded: struct.error and the like
        raise ValueError(f"{path.name} is no sound WAV file: {_first_line(error)}") from None
    channels = 1 if values.ndim == 1 else values.shape[1]
    if channels % 2:
        raise ValueError(f"{path.name} must have two channels a sensor, I and Q, got {channels}")
    if values.dtype.kind == "u":  # eight bits are stored without a sign
        values = values / 2**7 - 1
    elif values.dtype.kind == "i":
        values = values / -float(np.iinfo(values.dtype).min)
    x = np.ascontiguousarray(values, dtype=float).view(complex).T
    return Recording(x, float(fs), carrier, start)


def _paths(paths):
    if isinstance(paths, (str, Path)):
        return [paths]
    paths = list(paths)
    if not paths:
        raise ValueError("paths must name at least one file, got none")
    return paths


def _together(read):
    """Return one recording from (path, recording) of files that must have the same clock."""
    (first_path, first), *others = read
    for path, one in others:
        for name, ours, theirs in (
            ("sampling rate", first.fs, one.fs),
            ("carrier frequency", first.carrier, one.carrier),
            ("start", first.start, one.start),
            ("number of samples", first.x.shape[-1], one.x.shape[-1]),
        ):
            if ours != theirs:
                raise ValueError(
                    f"{Path(path).name} must have the {name} of {Path(first_path).name}, "
                    f"{ours}, got {theirs}"
                )
    return Recording(
        np.concatenate([one.x for _, one in read]), first.fs, first.carrier, first.start
    )


def _samples(recording):
    _checks.instance("recording", recording, Recording)
    x = _checks.finite_complex("recording.x", recording.x, (None, None))
    if x.ndim != 2 or not x.size:
        raise ValueError(f"recording.x must have shape (S, n) with samples in it, got {x.shape}")
    _checks.positive_number("recording.fs", recording.fs)
    _checks.positive_number("recording.carrier", recording.carrier)
    return x.astype(complex, copy=False)


def _replace(path, content):
    temporary = path.with_name(f"{path.name}.tmp")
    temporary.write_bytes(content)
    temporary.replace(path)


def _first_line(error):
    return str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
