"""Files as other programs write them, one of each."""

import struct
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import hilbert

from dopplerlib.signal.recording import read_sigmf, read_wav

HERE = Path(__file__).parent / "writers"
CARRIER, FS = 24.125e9, 8000.0
NOON = datetime(2016, 9, 28, 12, tzinfo=UTC)
WAV = sorted(path.name for path in HERE.iterdir() if path.suffix in (".wav", ".flac"))


def expected():
    values = np.frombuffer((HERE / "sigmf_python.sigmf-data").read_bytes(), "<i2") / 2**15
    return values.view(complex).reshape(-1, 2).T


def test_there_are_files_of_many_writers():
    assert len(WAV) == 29


@pytest.mark.parametrize("name", WAV)
def test_a_sound_file_of_any_writer_is_read(name):
    recording = read_wav(HERE / name, CARRIER)
    assert recording.fs == FS and recording.valid.all()
    np.testing.assert_array_equal(recording.x, expected())


@pytest.mark.parametrize("name", WAV)
def test_of_a_sound_file_of_any_writer_a_part_is_read(name):
    np.testing.assert_array_equal(
        read_wav(HERE / name, CARRIER, first=31, count=70).x, expected()[:, 31:101]
    )


def lengths(name):
    """Return the places in a WAV file up to which its samples are not complete."""
    content = (HERE / name).read_bytes()
    at = content.index(b"data") + 8
    samples = expected().size * 2
    width = {"24": 3, "32": 4, "float": 4, "double": 8, "float64": 8}
    width = width.get(Path(name).stem.split("_")[-1], 2)
    return content, at, at + samples * width


@pytest.mark.parametrize("name", [n for n in WAV if n.endswith(".wav") and "stream" not in n])
def test_a_cut_file_of_any_writer_is_refused(name, tmp_path):
    content, at, end = lengths(name)
    path = tmp_path / "a.wav"
    for cut in (0, 3, 11, 12, 30, at - 4, at, at + 16, (at + end) // 2, end - 16, end - 1):
        path.write_bytes(content[:cut])
        with pytest.raises(ValueError, match=r"^a.wav is not a valid WAV file: "):
            read_wav(path, CARRIER)
    path.write_bytes(content[:end])  # what follows the samples matters to nobody
    np.testing.assert_array_equal(read_wav(path, CARRIER).x, expected())


@pytest.mark.parametrize("name", [n for n in WAV if "stream" in n])
def test_a_stream_goes_on_until_its_file_ends(name, tmp_path):
    """Also in the middle of a sample, of which the rest is not used."""
    content, at, end = lengths(name)
    assert end == len(content)
    path = tmp_path / "a.wav"
    for cut, samples in ((at + 8, 1), (at + 15, 1), (at + 800, 100), (end - 1, 159)):
        path.write_bytes(content[:cut])
        np.testing.assert_array_equal(read_wav(path, CARRIER).x, expected()[:, :samples])
    path.write_bytes(content[: at + 7])
    with pytest.raises(ValueError, match=r"^a.wav must hold samples, got none"):
        read_wav(path, CARRIER)


@pytest.mark.parametrize("name", [n for n in WAV if n.endswith(".flac")])
def test_a_cut_flac_file_is_refused(name, tmp_path):
    content = (HERE / name).read_bytes()
    path = tmp_path / "a.flac"
    for cut in (4, 20, 100, len(content) // 2, len(content) - 20, len(content) - 1):
        path.write_bytes(content[:cut])
        with pytest.raises(ValueError, match=r"^a.flac is not a valid FLAC file: "):
            read_wav(path, CARRIER)


def test_chunks_of_any_name_in_any_place_are_passed_over(tmp_path):
    form, data = (HERE / "python.wav").read_bytes()[12:36], (HERE / "python.wav").read_bytes()[36:]
    path = tmp_path / "a.wav"
    for name in (b"\0\0\0\0", b"data"[::-1], b"RIFF", b"\xff\xfe\x01\x80", b"fmt\0", b"ds64"):
        for length in (0, 1, 2, 7, 300):
            other = name + struct.pack("<I", length) + bytes(length + length % 2)
            for body in (other + form + data, form + other + data, form + data + other):
                path.write_bytes(b"RIFF" + struct.pack("<I", 4 + len(body)) + b"WAVE" + body)
                np.testing.assert_array_equal(read_wav(path, CARRIER).x, expected())


@pytest.mark.parametrize(
    "change, message",
    [
        (lambda f, d: f + d + d, "one chunk 'data', got two"),
        (lambda f, d: f + f + d, "one chunk 'fmt ', got two"),
        (lambda f, d: d, "a chunk 'fmt ', got none"),
        (lambda f, d: f, "a chunk 'data', got none"),
        (lambda f, d: bytes(8) * 10_001 + f + d, "at most 10000 chunks, got more"),
        (lambda f, d: f[:4] + struct.pack("<I", 14) + f[8:22] + d, "at least 16 bytes, got 14"),
    ],
)
def test_what_is_not_one_sound_file_is_refused(tmp_path, change, message):
    content = (HERE / "python.wav").read_bytes()
    body = change(content[12:36], content[36:])
    (tmp_path / "a.wav").write_bytes(b"RIFF" + struct.pack("<I", 4 + len(body)) + b"WAVE" + body)
    with pytest.raises(ValueError, match=f"^a.wav is not a valid WAV file: it.*{message}"):
        read_wav(tmp_path / "a.wav", CARRIER)


def test_an_empty_file_with_more_chunks_has_no_samples(tmp_path):
    body = (HERE / "python.wav").read_bytes()[12:36] + b"data" + bytes(4) + b"LIST\4\0\0\0INFO"
    (tmp_path / "a.wav").write_bytes(b"RIFF" + struct.pack("<I", 4 + len(body)) + b"WAVE" + body)
    with pytest.raises(ValueError, match=r"^a.wav must hold samples, got none"):
        read_wav(tmp_path / "a.wav", CARRIER)


@pytest.mark.parametrize(
    "name",
    [
        "sigmf_python.sigmf-meta",
        "sigmf_python.sigmf-data",
        "sigmf_python",
        "sigmf_python_archive.sigmf",
        "sigmf_python_archive",
        "sigmf_python_archive.sigmf.gz",
        "sigmf_python_archive.sigmf.zip",
        "captures",
    ],
)
def test_sigmf_is_read_by_whatever_name_it_has(name):
    recording = read_sigmf(HERE / name)
    np.testing.assert_array_equal(recording.x, expected())
    assert (recording.fs, recording.carrier, recording.start) == (FS, CARRIER, NOON)
    part = read_sigmf(HERE / name, first=50, count=60)  # over a border of captures
    np.testing.assert_array_equal(part.x, expected()[:, 50:110])
    assert part.start == NOON + timedelta(seconds=50 / FS)


@pytest.mark.parametrize("name, start", [("gnuradio", NOON), ("gnuradio_old", None)])
def test_sigmf_of_gnu_radio_is_read(name, start):
    recording = read_sigmf(HERE / name)
    np.testing.assert_array_equal(recording.x, expected()[:1])
    assert (recording.carrier, recording.start) == (CARRIER, start)


def test_a_file_that_is_the_second_part_of_a_recording_is_read():
    with pytest.raises(ValueError, match="positive carrier frequency, got None"):
        read_sigmf(HERE / "second_part")
    recording = read_sigmf(HERE / "second_part", CARRIER)
    np.testing.assert_array_equal(recording.x, expected())
    assert recording.carrier == CARRIER


@pytest.mark.parametrize("name", ["sigmf_from_wav", "real"])
def test_real_numbers_in_sigmf_are_sensors_or_what_is_told(name):
    carrier = CARRIER if name == "sigmf_from_wav" else None
    np.testing.assert_array_equal(read_sigmf(HERE / name, carrier, layout="iq").x, expected())
    channels = np.ascontiguousarray(expected().T).view(float).T
    for layout in (None, "real"):
        x = read_sigmf(HERE / name, carrier, layout=layout).x
        np.testing.assert_allclose(x, hilbert(channels), rtol=0, atol=1e-14)


def test_flac_that_does_not_tell_its_length_is_refused(tmp_path):
    """As an encoder writes it to a pipe: 36 bits of the header are zero."""
    content = bytearray((HERE / "sox.flac").read_bytes())
    content[21] &= 0xF0
    content[22:26] = bytes(4)
    (tmp_path / "a.flac").write_bytes(content)
    with pytest.raises(
        ValueError, match=r"^a.flac is not a valid FLAC file: its header must state the"
    ):
        read_wav(tmp_path / "a.flac", CARRIER)
