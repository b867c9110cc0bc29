"""The chunks of a WAV file, checked before a library reads it: truncated files are refused."""

import io
import struct
from typing import NamedTuple

# What writers put for a length that they do not know yet and never come back to: nothing at all,
# SoX, arecord, the largest number with a sign, arecord again, the largest one, that less a header.
_UNKNOWN = (0, 0x7FFFF000, 0x7FFFFF00, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFFFFDB)
_LARGEST = 0xFFFFFFFF
_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE
_WIDTHS = {_PCM: (1, 2, 3, 4), _FLOAT: (4, 8)}  # bytes of a value
_MOST = 10_000  # chunks


class Header(NamedTuple):
    """The header of a WAV file."""

    fs: int
    channels: int
    frames: int
    head: bytes  # of the same file without any other chunk
    place: int  # of the samples
    length: int  # of the samples in bytes


def header(file):
    """Return the header of an open WAV file, or raise if samples that it states are missing.

    A length that the writer did not know means "until the end of the file".
    """
    size = file.seek(0, 2)
    magic, form = struct.unpack("4s4x4s", _bytes(file, 0, 12))
    if magic not in (b"RIFF", b"RIFX", b"RF64", b"BW64") or form != b"WAVE":
        raise ValueError(f"it must begin with RIFF, 4 bytes and WAVE, got {magic + b' ' + form}")
    order = ">" if magic == b"RIFX" else "<"
    (riff,) = struct.unpack(f"{order}I", _bytes(file, 4, 4))
    chunks = _chunks(file, order, size)
    for name in (b"fmt ", b"data"):
        if name not in chunks:
            raise ValueError(f"it must have a chunk {name.decode()!r}, got none")
    form = _format(_bytes(file, *chunks[b"fmt "]), order)
    _, channels, fs, _, frame, _ = form
    place, length = chunks[b"data"]
    if length == _LARGEST and b"ds64" in chunks:
        (length,) = struct.unpack("<8xQ", _bytes(file, chunks[b"ds64"][0], 16))
    rest = size - place
    if (length == 0 and riff + 8 != size) or (length in _UNKNOWN and length > rest):
        length = rest - rest % frame
    if length > rest:
        raise ValueError(f"its samples must take {length} bytes, got {rest}: it was cut")
    if length % frame:
        raise ValueError(f"its samples must take a multiple of {frame} bytes, got {length}")
    return Header(fs, channels, length // frame, _head(form, length, order), place, length)


class Plain(io.RawIOBase):
    """A WAV file as if it had no other chunks than those of its format and its samples.

    So it does not matter which chunks and which placeholders of a length a library knows.
    """

    def __init__(self, file, header):
        self._file, self._head = file, header.head
        self._shift = header.place - len(header.head)
        self._size, self._at = len(header.head) + header.length, 0

    def seekable(self):
        return True

    def readable(self):
        return True

    def tell(self):
        return self._at

    def seek(self, offset, whence=io.SEEK_SET):
        self._at = offset + (0, self._at, self._size)[whence]
        return self._at

    def readinto(self, buffer):
        if self._at < len(self._head):
            part = self._head[self._at : self._at + len(buffer)]
        else:
            self._file.seek(self._at + self._shift)
            part = self._file.read(max(min(len(buffer), self._size - self._at), 0))
        buffer[: len(part)] = part
        self._at += len(part)
        return len(part)


def _bytes(file, place, length):
    file.seek(place)
    found = file.read(length)
    if len(found) < length:
        raise ValueError(
            f"its header must be whole, got the end of the file at {place + len(found)}"
        )
    return found


def _chunks(file, order, size):
    """Return place and length of the chunks up to the end, or to samples of unknown length."""
    chunks, place = {}, 12
    for _ in range(_MOST):
        if place + 8 > size:
            return chunks
        name, length = struct.unpack(f"{order}4sI", _bytes(file, place, 8))
        if name in (b"data", b"fmt ") and name in chunks:
            raise ValueError(f"it must have one chunk {name.decode()!r}, got two")
        chunks.setdefault(name, (place + 8, length))
        if name == b"data" and length in _UNKNOWN:
            return chunks
        place += 8 + length
        if length % 2 and place < size and _bytes(file, place, 1) == b"\0":
            place += 1  # some writers leave this byte out
    raise ValueError(f"it must have at most {_MOST} chunks, got more")


def _format(told, order):
    """Return the fields of a plain chunk of the format, or raise if libsndfile misreads it."""
    if len(told) < 16:
        raise ValueError(f"its chunk 'fmt ' must have at least 16 bytes, got {len(told)}")
    tag, channels, fs, _, frame, bits = struct.unpack(f"{order}HHIIHH", told[:16])
    if tag == _EXTENSIBLE and len(told) >= 28:
        # The tag is in the first two bytes of four; with RIFX, libsndfile has it in the others.
        tag = sum(struct.unpack(f"{order}HH", told[24:28]))
    width = -(-bits // 8)
    if width not in _WIDTHS.get(tag, ()):
        raise ValueError(
            f"it must hold PCM of 8 to 32 bits or floating-point numbers, got format {tag} of "
            f"{bits} bits"
        )
    if not channels or not fs:
        raise ValueError(f"it must have channels and a sampling rate, got {channels} and {fs} Hz")
    if frame != channels * width:
        raise ValueError(f"its frames must take {channels} x {width} bytes, got {frame}")
    return tag, channels, fs, fs * frame % 2**32, frame, 8 * width


def _head(form, length, order):
    """Return the first bytes of a file that has the chunks of format and samples only."""
    form = struct.pack(f"{order}HHIIHH", *form)
    whole = 4 + 8 + len(form) + 8 + length
    if whole <= _LARGEST:
        first = (b"RIFF" if order == "<" else b"RIFX") + struct.pack(f"{order}I", whole) + b"WAVE"
    else:
        long = struct.pack("<4sIQQQI", b"ds64", 28, whole + 36, length, 0, 0)
        first, length = b"RF64" + struct.pack("<I", _LARGEST) + b"WAVE" + long, _LARGEST
    size = struct.Struct(f"{order}I").pack
    return first + b"fmt " + size(len(form)) + form + b"data" + size(length)
