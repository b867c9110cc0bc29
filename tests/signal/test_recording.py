"""What is written reads back the same; what is broken is refused with the reason."""

import errno
import io
import json
import pathlib
import struct
import sys
import tarfile
import wave
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest
from scipy.io import wavfile

from dopplerlib.signal.recording import Recording, read_sigmf, read_wav, write_sigmf, write_wav

NOON = datetime(2016, 9, 28, 12, 0, 0, 1500, tzinfo=UTC)
NAIVE = datetime(2016, 9, 28, 12)  # noon somewhere


@pytest.fixture
def recording():
    x = np.random.default_rng(1).uniform(-0.99, 0.99, (3, 80)).view(complex)
    return Recording(x, 2000.0, 24.125e9, NOON)


def same(a, b):
    return np.array_equal(a.x, b.x) and (a.fs, a.carrier, a.start) == (b.fs, b.carrier, b.start)


def with_x(recording, x):
    return replace(recording, x=np.asarray(x, complex), valid=None)


def test_a_recording_tells_times_and_wavelength(recording):
    assert recording.time[[0, 1, -1]].tolist() == [0, 0.0005, 39 / 2000]
    assert recording.wavelength == pytest.approx(299792458 / 24.125e9, rel=1e-15)


def test_sigmf_keeps_every_bit_and_all_that_is_told(recording, tmp_path):
    meta = write_sigmf(tmp_path / "six", recording, description="three sensors")
    assert same(read_sigmf(meta), recording)
    assert json.loads(meta.read_text())["global"]["core:description"] == "three sensors"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["six.sigmf-data", "six.sigmf-meta"]


@pytest.mark.parametrize(
    "samples, error", [("complex64", 2**-24), ("int16", 2**-16)]
)  # half a unit of the last binary digit of a part
def test_shorter_samples_are_rounded_and_no_more(recording, tmp_path, samples, error):
    x = read_sigmf(write_sigmf(tmp_path / "short", recording, samples)).x
    assert np.abs((x - recording.x).view(float)).max() <= error


def test_one_file_for_each_sensor_is_one_recording(recording, tmp_path):
    sensors = [with_x(recording, row[None]) for row in recording.x]
    sigmf = [write_sigmf(tmp_path / f"s{i}", one) for i, one in enumerate(sensors)]
    assert same(read_sigmf(sigmf), recording)
    wav = [write_wav(tmp_path / f"s{i}.wav", one) for i, one in enumerate(sensors)]
    assert same(read_wav(wav, recording.carrier, NOON), recording)


def test_wav_keeps_every_bit(recording, tmp_path):
    path = write_wav(tmp_path / "a.wav", recording)
    assert same(read_wav(path, recording.carrier, NOON), recording)


@pytest.mark.parametrize("kind", ["uint8", "int16", "int32"])
def test_whole_numbers_in_wav_are_scaled(tmp_path, kind):
    info = np.iinfo(kind)
    middle = 128 if kind == "uint8" else 0
    wavfile.write(tmp_path / "a.wav", 1000, np.array([[info.min, middle]], dtype=kind))
    assert read_wav(tmp_path / "a.wav", 24e9).x.tolist() == [[-1 + 0j]]


@pytest.mark.parametrize("kind", ["f8", "f4", "i4", "i2", "u4", "u2", "i1", "u1"])
@pytest.mark.parametrize("order", ["<", ">"])
def test_every_kind_of_complex_samples_is_read(recording, tmp_path, kind, order):
    """From the least to the largest number of its kind: -1 and 1 less a unit of the last digit."""
    number, bits = np.dtype(order + kind), 8 * int(kind[1])
    if kind[0] == "f":
        values = np.array([-1.5, 0.25, 2.0**-20, 3.0, 0.0, -7.0])
        expected = values
    else:
        info = np.iinfo(number)
        values = np.array([info.min, info.max, (info.min + info.max + 1) // 2] * 2)
        expected = np.array([-1, 1 - 2.0 ** (1 - bits), 0] * 2)
    meta = write_sigmf(tmp_path / "a", with_x(recording, np.ones((1, 3))))
    (tmp_path / "a.sigmf-data").write_bytes(values.astype(number).tobytes())
    name = f"c{kind[0]}{bits}" + ("" if bits == 8 else {"<": "_le", ">": "_be"}[order])
    edit(meta, lambda c: c["global"].update({"core:datatype": name}), keep_hash=False)
    np.testing.assert_array_equal(read_sigmf(meta).x, expected.view(complex)[None])


def test_the_least_number_of_16_bits_is_written(recording, tmp_path):
    x = np.array([[-1, 1 - 2**-15, -1j, 0.5]])
    meta = write_sigmf(tmp_path / "a", with_x(recording, x), "int16")
    np.testing.assert_array_equal(read_sigmf(meta).x, x)


def test_a_time_of_another_zone_is_the_same_moment(recording, tmp_path):
    east = NOON.astimezone(timezone(timedelta(hours=5)))
    meta = write_sigmf(tmp_path / "a", replace(recording, start=east))
    assert read_sigmf(meta).start == NOON
    edit(meta, lambda c: c["captures"][0].update({"core:datetime": "2016-09-28T17:00:00.0015+05"}))
    assert read_sigmf(meta).start == NOON
    assert read_sigmf(meta).start.tzinfo is UTC


def test_what_nobody_has_to_understand_changes_nothing(recording, tmp_path):
    """An optional extension, and names of one that is not announced."""
    meta = write_sigmf(tmp_path / "a", recording)
    optional = {"name": "antenna", "version": "1.0.0", "optional": True}
    edit(meta, lambda c: c["global"].update({"core:extensions": [optional], "radar:range": 3}))
    assert same(read_sigmf(meta), recording)


def test_a_stereo_file_from_elsewhere_has_i_left_and_q_right(tmp_path):
    wavfile.write(tmp_path / "a.wav", 8000, np.array([[0.25, 0.5], [0.0, -0.5]], dtype=np.float32))
    assert read_wav(tmp_path / "a.wav", 24e9).x.tolist() == [[0.25 + 0.5j, -0.5j]]


def edit(meta, change, keep_hash=True):
    content = json.loads(meta.read_text())
    change(content)
    if not keep_hash:
        del content["global"]["core:sha512"]
    meta.write_text(json.dumps(content))


@pytest.mark.parametrize("cut", [1, 16, 48, 480, 3 * 40 * 16])
def test_a_cut_sigmf_file_is_refused(recording, tmp_path, cut):
    """By its length, or where that could be right by its hash."""
    meta = write_sigmf(tmp_path / "a", recording)
    data = tmp_path / "a.sigmf-data"
    data.write_bytes(data.read_bytes()[:-cut])
    with pytest.raises(ValueError, match=r"a.sigmf-meta is not a valid SigMF recording: "):
        read_sigmf(meta)


def test_a_changed_sigmf_file_is_refused(recording, tmp_path):
    meta = write_sigmf(tmp_path / "a", recording)
    data = tmp_path / "a.sigmf-data"
    content = bytearray(data.read_bytes())
    content[100] ^= 1
    data.write_bytes(content)
    with pytest.raises(ValueError, match=r"is not a valid SigMF recording: .*hash"):
        read_sigmf(meta)


def put(part, name, value):
    """Return a change of metadata."""
    return lambda c: (c["global"] if part == "global" else c["captures"][0]).update(
        {f"core:{name}": value}
    )


def add(row, frequency=None):
    """Return a change that adds a capture."""
    more = {} if frequency is None else {"core:frequency": frequency}
    return lambda c: c["captures"].append({"core:sample_start": row} | more)


WEIRD = {"name": "weird", "version": "1.0.0", "optional": False}


@pytest.mark.parametrize(
    "change, message",
    [
        (put("global", "sample_rate", np.nan), "numbers must be finite, got NaN"),
        (put("global", "sample_rate", -np.inf), "numbers must be finite, got -Infinity"),
        (put("global", "sample_rate", 0), "sample_rate: 0 is less than"),
        (put("global", "sample_rate", 1e13), "sample_rate: 1.*e.13|10000000000000"),
        (put("global", "sample_rate", True), "sample_rate: True is not of type 'number'"),
        (put("capture", "frequency", np.nan), "numbers must be finite, got NaN"),
        (put("capture", "frequency", 0), "positive carrier frequency, got 0"),
        (put("capture", "frequency", -24e9), "positive carrier frequency, got -24"),
        (put("capture", "frequency", "24 GHz"), "frequency: '24 GHz' is not of type 'number'"),
        (put("capture", "frequency", [24e9]), "frequency: .* is not of type 'number'"),
        (put("capture", "datetime", "yesterday"), "datetime: 'yesterday' does not match"),
        (put("capture", "datetime", 5), "datetime: 5 is not of type 'string'"),
        (put("capture", "datetime", "2016-02-30T12:00:00Z"), "is not a valid .*day"),
        (put("capture", "datetime", "0001-01-01T00:00:00+14:00"), "core:datetime .* years 1 to"),
        (put("capture", "datetime", "9999-12-31T23:59:59-14:00"), "core:datetime .* years 1 to"),
        (put("capture", "sample_start", 41), r"within 40 samples, .* \[41\], core:offset 0"),
        (put("capture", "header_bytes", 16), "must not have core:header_bytes, got 16"),
        (put("global", "trailing_bytes", 16), "must not have core:trailing_bytes, got 16"),
        (put("global", "dataset", "b.bin"), "must not have core:dataset, got 'b.bin'"),
        (put("global", "metadata_only", True), "must not have core:metadata_only, got True"),
        (put("global", "num_channels", 0), "num_channels: 0 is less than the minimum of 1"),
        (put("global", "num_channels", 1.5), "num_channels: 1.5 is not of type 'integer'"),
        (put("global", "num_channels", 3.0), "num_channels must be a whole number, got 3.0"),
        (put("global", "num_channels", "3"), "num_channels: '3' is not of type 'integer'"),
        (put("global", "num_channels", 7), "samples must be a multiple of 112 bytes, got 1920"),
        (put("global", "datatype", 5), "datatype: 5 is not of type 'string'"),
        (put("global", "datatype", "cf32"), "datatype must be one of SigMF, got 'cf32'"),
        (put("global", "datatype", "ci8_le"), "datatype must be one of SigMF, got 'ci8_le'"),
        (put("global", "datatype", "cf32_le,"), "datatype must be one of SigMF, got 'cf32_le,'"),
        (put("global", "version", "9.9.9"), "version must be one of SigMF 1, got 9.9.9"),
        (put("global", "extensions", [WEIRD]), "require an extension, got 'weird', which is not"),
        (lambda c: c.pop("captures"), "'captures' is a required property"),
        (lambda c: c.update({"captures": {}}), "captures: {} is not of type 'array'"),
        (lambda c: c["global"].pop("core:datatype"), "'core:datatype' is a required property"),
        (lambda c: c["global"].pop("core:sample_rate"), "positive sampling rate, got None"),
        (lambda c: c["captures"][0].pop("core:frequency"), "positive carrier frequency, got None"),
        (lambda c: c["captures"].clear(), "positive carrier frequency, got None"),
        (add(9, 5.8e9), "must have one core:frequency, got 24125000000.0 and 58"),
        (add(41), r"one after the other within 40 samples, .* \[0, 41\]"),
        (lambda c: c["global"].update({"dopplerlib:invalid": [[3, 0, 1]]}), "list of .sensor, fi"),
        (lambda c: c["global"].update({"dopplerlib:invalid": "all"}), "list of .sensor, fi"),
        (lambda c: c["global"].update({"core:datatype": "cf63_le"}), "is not a valid SigMF rec"),
        (lambda c: c["global"].update({"core:sample_rate": "fast"}), "is not a valid SigMF rec"),
        (lambda c: c.pop("global"), "is not a valid SigMF rec"),
    ],
)  # fmt: skip
def test_sigmf_that_leaves_something_open_is_refused(recording, tmp_path, change, message):
    meta = write_sigmf(tmp_path / "a", recording)
    edit(meta, change)
    with pytest.raises(ValueError, match=rf"^a.sigmf-meta .*{message}"):
        read_sigmf(meta)


@pytest.mark.parametrize(
    "text", [b"", b"[]", b"null", b"3", b'"a"', b"[" * 100_000, b"\xff\xfe", bytes(range(256))]
)  # fmt: skip
def test_metadata_that_are_none_are_refused(recording, tmp_path, text):
    meta = write_sigmf(tmp_path / "a", recording)
    meta.write_bytes(text)
    with pytest.raises(ValueError, match=r"^a.sigmf-meta is not a valid SigMF recording: ."):
        read_sigmf(meta)


@pytest.mark.parametrize(
    "change, message",
    [
        (lambda b: b"", "a.sigmf-meta must hold samples, got none"),
        (lambda b: b[:-7], "samples must be a multiple of 48 bytes, got 1913"),
        (lambda b: b[:-16], "samples must be a multiple of 48 bytes, got 1904"),
    ],
)  # fmt: skip
def test_samples_without_a_hash_are_looked_at_all_the_same(recording, tmp_path, change, message):
    meta = write_sigmf(tmp_path / "a", recording)
    edit(meta, lambda c: None, keep_hash=False)
    data = tmp_path / "a.sigmf-data"
    data.write_bytes(change(data.read_bytes()))
    with pytest.raises(ValueError, match=message):
        read_sigmf(meta)


def test_sigmf_that_is_no_json_or_has_no_data_is_refused(recording, tmp_path):
    meta = write_sigmf(tmp_path / "a", recording)
    (tmp_path / "a.sigmf-data").unlink()
    with pytest.raises(ValueError, match=r"a.sigmf-meta is not a valid SigMF recording"):
        read_sigmf(meta)
    meta.write_text("{")
    with pytest.raises(ValueError, match=r"a.sigmf-meta is not a valid SigMF recording"):
        read_sigmf(meta)


@pytest.mark.parametrize("cut", [1, 48, 480, 1900])
def test_a_cut_wav_file_is_refused(recording, tmp_path, cut):
    path = write_wav(tmp_path / "a.wav", recording)
    path.write_bytes(path.read_bytes()[:-cut])
    with pytest.raises(ValueError, match=r"a.wav is not a valid WAV file: "):
        read_wav(path, 24e9)


def header(place, kind, value):
    """Return a change of a number in the header, counted from the word "fmt "."""

    def change(content):
        at = content.index(b"fmt ") + place
        number = struct.pack(kind, value)
        return content[:at] + number + content[at + len(number) :]

    return change


@pytest.mark.parametrize(
    "change, message",
    [
        (lambda b: b"", "is not a valid WAV file: "),
        (lambda b: b[:12], "is not a valid WAV file: "),
        (lambda b: b[:44], "is not a valid WAV file: "),
        (lambda b: b"RIFFxxxxWAVE" + bytes(100), "is not a valid WAV file: "),
        (header(10, "<H", 0), "is not a valid WAV file: "),
        (header(10, "<H", 4), "is not a valid WAV file: "),
        (header(12, "<I", 0), "is not a valid .*: it must have channels and a .*got 6 and 0 Hz"),
        (header(8, "<H", 7), "is not a valid .*: it must hold PCM .* got format 7 of 64 bits"),
        (header(22, "<H", 32), "is not a valid WAV file: its frames must take 6 x 4 bytes, got 48"),
    ],
)  # fmt: skip
def test_a_malformed_wav_file_is_refused(recording, tmp_path, change, message):
    path = write_wav(tmp_path / "a.wav", recording)
    path.write_bytes(change(path.read_bytes()))
    with pytest.raises(ValueError, match=f"^a.wav {message}"):
        read_wav(path, 24e9)


@pytest.mark.parametrize(
    "values, message",
    [
        (np.zeros((0, 2), np.int16), "a.wav must hold samples, got none"),
        (np.zeros((5, 3), np.int16), "must have two channels a sensor, I and Q, .*'real', got 3"),
    ],
)  # fmt: skip
def test_wav_without_samples_or_with_strange_ones_is_refused(tmp_path, values, message):
    wavfile.write(tmp_path / "a.wav", 1000, values)
    with pytest.raises(ValueError, match=message):
        read_wav(tmp_path / "a.wav", 24e9)


def test_a_wav_file_with_an_odd_channel_is_refused(tmp_path):
    wavfile.write(tmp_path / "a.wav", 1000, np.zeros(10, dtype=np.float32))
    with pytest.raises(ValueError, match=r"two channels a sensor, I and Q, .*, got 1"):
        read_wav(tmp_path / "a.wav", 24e9)


@pytest.mark.parametrize(
    "other, message",
    [
        ({"fs": 1000.0}, "the sampling rate of a.sigmf-meta, 2000.0, got 1000"),
        ({"carrier": 24e9}, "must have the carrier frequency of a.sigmf-meta"),
        ({"start": NOON + timedelta(seconds=1)}, "a.sigmf-meta must have samples when .* starts"),
        ({"start": NOON - timedelta(seconds=1)}, "b.sigmf-meta must have samples when .* starts"),
        ({"start": None}, "must have a start if and only if a.sigmf-meta .*, got None"),
    ],
)  # fmt: skip
def test_files_that_do_not_belong_together_are_refused(recording, tmp_path, other, message):
    paths = [
        write_sigmf(tmp_path / "a", recording),
        write_sigmf(tmp_path / "b", replace(recording, **other)),
    ]
    with pytest.raises(ValueError, match=message):
        read_sigmf(paths)


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda r, d: read_sigmf(None), "paths must be a path or .* of paths, got None"),
        (lambda r, d: read_sigmf(5), "paths must be a path or a sequence of paths, got 5"),
        (lambda r, d: read_sigmf(b"a"), "paths must be a path or a sequence of paths, got b'a'"),
        (lambda r, d: read_wav([None], 24e9), r"paths must be .*, got \[None\]"),
        (lambda r, d: read_wav(d, 24e9), "paths must be files that exist, got"),
        (lambda r, d: read_wav(d / "a", np.nan), "carrier must be finite, got nan"),
        (lambda r, d: read_wav(d / "a", "24 GHz"), "carrier must be .*got '24 GHz'"),
        (lambda r, d: read_wav(d / "a", 24e9, "noon"), "start must be a datetime .*got 'noon'"),
        (lambda r, d: read_wav(d / "a", 24e9, 5.0), "start must be a datetime .*got 5.0"),
        (lambda r, d: read_wav(d / "a", 24e9, NAIVE), "start must be .* a time zone .*, got "),
        (lambda r, d: write_sigmf(5, r), "path must be the path of a file, got 5"),
        (lambda r, d: write_wav(d, r), "path must be that of a file in a folder that exists, got"),
        (lambda r, d: write_wav("", r), "path must be that of a file .*, got ''|got '.'"),
        (lambda r, d: write_wav(None, r), "path must be the path of a file, got None"),
        (lambda r, d: write_sigmf(d / "no" / "a", r), "in a folder that exists, got '.*no.a'"),
        (lambda r, d: write_wav(d / "no" / "a", r), "in a folder that exists, got '.*no.a'"),
        (lambda r, d: write_sigmf(d / "a.sigmf-meta", r), "must be without .sigmf-meta and"),
        (lambda r, d: write_sigmf(d / "a", r, description=5), "description must be a str, got 5"),
        (lambda r, d: write_sigmf(d / "a", replace(r, fs=2e12)), "fs must be at most .*got 2e.12"),
        (lambda r, d: write_sigmf(d / "a", replace(r, carrier=2e13)), "carrier .* most .*2e.13"),
        (lambda r, d: write_sigmf(d / "a", with_x(r, r.x * 1e39), "complex64"), "most 3.4e.38"),
        (lambda r, d: write_sigmf(d / "a", with_x(r, np.ones((1, 1))), "int16"), "got 1 *$"),
        (lambda r, d: write_wav(d / "a", replace(r, fs=5e9)), "fs must be less than 8.9.*e.07"),
        (lambda r, d: write_wav(d / "a", with_x(r, np.ones((4096, 1)))), "at most 4095 sensors"),
        (lambda r, d: read_sigmf([]), "paths must name at least one file, got none"),
        (lambda r, d: read_sigmf(d / "none.sigmf-meta"), "paths must be files that exist, got"),
        (lambda r, d: read_wav(d / "none.wav", 24e9), "paths must be files that exist, got"),
        (lambda r, d: read_wav(d / "none.wav", 0), "carrier must be .*positive.*0"),
        (lambda r, d: write_sigmf(d / "a", r.x), "recording must be a Recording, got"),
        (lambda r, d: write_sigmf(d / "a", r, "int8"), "samples must be one of .*, got 'int8'"),
        (lambda r, d: write_sigmf(d / "a", with_x(r, 2 * r.x), "int16"), "-1 and 1 .*, got 1.9"),
        (lambda r, d: write_wav(d / "a", replace(r, fs=1000.5)), r"number of Hz .*, got 1000.5"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_and_leaves_no_file(recording, tmp_path, call, message):
    with pytest.raises(ValueError, match=message):
        call(recording, tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["validate", "dumps"])
def test_what_fails_half_way_leaves_the_older_files_as_they_were(
    recording, tmp_path, monkeypatch, name
):
    write_sigmf(tmp_path / "a", recording)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def fail(*args, **kwargs):
        raise OSError("no space left")

    monkeypatch.setattr(f"sigmf.SigMFFile.{name}", fail)
    with pytest.raises(OSError, match="no space left"):
        write_sigmf(tmp_path / "a", with_x(recording, 2 * recording.x))
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_the_same_file_is_no_second_sensor(recording, tmp_path):
    meta, wav = write_sigmf(tmp_path / "a", recording), write_wav(tmp_path / "a.wav", recording)
    again = tmp_path / "b.wav"
    again.symlink_to(wav)
    for call in (lambda: read_sigmf([meta, str(meta)]), lambda: read_wav([wav, again], 24e9)):
        with pytest.raises(ValueError, match=r"paths must be different files, got .* twice"):
            call()


# ------------------------------------------------------------------- what a recording has to be


def test_what_is_not_finite_is_invalid_and_zero():
    x = np.random.default_rng(2).standard_normal((2, 100)) + 0.5j
    x = x + 1j * np.random.default_rng(3).standard_normal((2, 100))
    bad = x.copy()
    bad[0, 3], bad[1, [5, 6]] = np.nan, np.inf
    one = Recording(bad, 1e3, 24e9)
    assert np.argwhere(~one.valid).tolist() == [[0, 3], [1, 5], [1, 6]]
    assert not one.x[~one.valid].any()
    np.testing.assert_array_equal(one.x[one.valid], x[one.valid])
    assert np.isnan(bad[0, 3])  # the array of the caller is his


def test_a_stuck_sensor_is_invalid_and_keeps_its_values():
    x = np.random.default_rng(4).standard_normal((2, 400)).view(complex)
    x[1, 50:150] = x[1, 50]
    one = Recording(x, 1e3, 24e9)
    assert not one.valid[1, 50:150].any() and one.valid[0].all()
    np.testing.assert_array_equal(one.x, x)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"x": np.ones(5) + 0j}, r"x must have shape \(S, n\) with samples in it, got \(5,\)"),
        ({"x": np.ones((2, 0)) + 0j}, r"x must have shape \(S, n\) with samples .*, got \(2, 0\)"),
        ({"x": "IQ"}, "x must be an array of numbers, got 'IQ'"),
        ({"x": np.ones((2, 5))}, "x must be complex, I .* got real numbers"),
        ({"x": [[1, 2]]}, "x must be complex, I .* got real numbers"),
        ({"x": None}, "x must be an array of numbers, got None"),
        ({"x": np.ma.masked_array([[1.0]], [[True]])}, "x must not be a masked array"),
        ({"fs": 0.0}, "fs must be positive, got 0.0"),
        ({"fs": -1}, "fs must be positive, got -1"),
        ({"fs": np.nan}, "fs must be finite, got nan"),
        ({"fs": None}, "fs must be an array of real numbers, got None"),
        ({"carrier": 0}, "carrier must be positive, got 0"),
        ({"carrier": [1.0, 2.0]}, "carrier must be one number"),
        ({"start": "noon"}, "start must be a datetime with a time zone or None, got 'noon'"),
        ({"start": NAIVE}, "start must be a datetime with a time zone or None, got"),
        ({"start": datetime.max.replace(tzinfo=timezone(-timedelta(hours=9)))}, "the years 1 to 9"),
        ({"valid": np.ones((3, 40))}, "valid must be an array of booleans"),
        ({"valid": np.ones((3, 39), bool)}, r"valid must have shape \(3, 40\) of x, got \(3, 39\)"),
        (
            {"x": np.full((3, 40), np.nan + 0j), "valid": np.ones((3, 40), bool)},
            r"x must be finite where valid, got \(?nan.* at index \(0, 0\)",
        ),
    ],
)
def test_a_recording_is_checked_when_it_is_made(recording, change, message):
    with pytest.raises(ValueError, match=message):
        replace(recording, **({"valid": None} | change))


def test_what_is_valid_is_kept_by_sigmf(recording, tmp_path):
    """Also if nothing but the user knows it; samples keep their values."""
    valid = np.ones(recording.x.shape, dtype=bool)
    valid[1, 3:9] = valid[2, 39] = valid[0, 0] = False
    one = replace(recording, valid=valid)
    meta = write_sigmf(tmp_path / "a", one)
    assert json.loads(meta.read_text())["global"]["dopplerlib:invalid"] == [
        [0, 0, 1],
        [1, 3, 6],
        [2, 39, 1],
    ]
    assert read_sigmf(meta) == one
    part = read_sigmf(meta, first=5, count=10)
    np.testing.assert_array_equal(part.valid, valid[:, 5:15])


# ---------------------------------------------------------------------------- what others can open


@pytest.mark.parametrize(
    "samples, error", [("float32", 2**-24), ("int32", 2**-32), ("int16", 2**-16)]
)
def test_shorter_values_in_wav_are_rounded_and_no_more(recording, tmp_path, samples, error):
    x = read_wav(write_wav(tmp_path / "a.wav", recording, samples), 24e9).x
    assert np.abs((x - recording.x).view(float)).max() <= error


def test_a_wav_file_of_16_bits_is_opened_by_python_s_own_reader(recording, tmp_path):
    path = write_wav(tmp_path / "a.wav", recording, "int16")
    with wave.open(str(path)) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (6, 2, 2000)
        values = np.frombuffer(file.readframes(40), "<i2").reshape(40, 6)
    np.testing.assert_array_equal(values[:, ::2].T, np.round(recording.x.real * 2**15))


@pytest.mark.parametrize(
    "samples, factor, message",
    [
        ("int16", 2, "between -1 and 1 - 2.-15 in both parts to be stored as int16, got 1.9"),
        ("int32", 2, "between -1 and 1 - 2.-31 in both parts to be stored as int32, got 1.9"),
        ("float32", 1e39, "at most 3.4e.38 in both parts to be stored as float32"),
        ("int8", 1, "samples must be one of 'float64', 'float32', 'int32', 'int16', got 'int8'"),
    ],
)
def test_values_that_do_not_fit_into_wav_are_refused(recording, tmp_path, samples, factor, message):
    with pytest.raises(ValueError, match=message):
        write_wav(tmp_path / "a.wav", with_x(recording, recording.x * factor), samples)
    assert list(tmp_path.iterdir()) == []


def test_what_wav_has_no_length_for_is_refused(recording, tmp_path, monkeypatch):
    monkeypatch.setattr("dopplerlib.signal._wav._LARGEST", 100 + 39 * 48)
    with pytest.raises(ValueError, match=r"at most 39 samples for 3 sensors .* 40: write_sigmf"):
        write_wav(tmp_path / "a.wav", recording)


def test_a_disk_that_is_full_is_named(recording, tmp_path, monkeypatch):
    """Whoever writes: SciPy, NumPy or the library."""

    class Full(io.RawIOBase):
        def writable(self):
            return True

        def write(self, content):
            raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(pathlib.Path, "open", lambda *args, **kwargs: Full())
    monkeypatch.setattr("builtins.open", lambda *args, **kwargs: Full())
    for write, name in ((write_wav, "a.wav"), (write_sigmf, "a.sigmf-data")):
        with pytest.raises(OSError, match=f"No space left on device: .*{name}"):
            write(tmp_path / name.removesuffix(".sigmf-data"), recording)
    monkeypatch.undo()
    assert list(tmp_path.iterdir()) == []


def test_of_a_part_the_hash_is_not_compared(recording, tmp_path):
    """It would take longer than the part; that samples are missing is noticed all the same."""
    meta = write_sigmf(tmp_path / "a", recording)
    data = tmp_path / "a.sigmf-data"
    data.write_bytes(data.read_bytes()[::-1])
    with pytest.raises(ValueError, match="hash"):
        read_sigmf(meta)
    assert read_sigmf(meta, first=1, count=5).x.shape == (3, 5)


def test_an_archive_of_two_recordings_is_refused(recording, tmp_path):
    for name in "ab":
        write_sigmf(tmp_path / name, recording)
    with tarfile.open(tmp_path / "two.sigmf", "w") as archive:
        for path in sorted(tmp_path.glob("?.sigmf-*")):
            archive.add(path, f"two/{path.name}")
    with pytest.raises(
        ValueError, match=r"two.sigmf is not a valid .*: it must hold one rec.*, got 2"
    ):
        read_sigmf(tmp_path / "two.sigmf")


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", bytes(10_240), b"x" * 600])
@pytest.mark.parametrize("end", ["", ".gz", ".xz", ".zip"])
def test_an_archive_that_is_none_is_refused(tmp_path, content, end):
    (tmp_path / f"a.sigmf{end}").write_bytes(content)
    with pytest.raises(ValueError, match=r"^a.sigmf\S* is not a valid SigMF recording: ."):
        read_sigmf(tmp_path / f"a.sigmf{end}")


def test_the_carrier_of_the_metadata_counts(recording, tmp_path):
    meta = write_sigmf(tmp_path / "a", recording)
    assert read_sigmf(meta, recording.carrier) == recording
    with pytest.raises(
        ValueError, match=r"^carrier must be that of a.sigmf-meta, 24125000000.0, go"
    ):
        read_sigmf(meta, 10.5e9)
    edit(meta, lambda c: c["captures"][0].pop("core:frequency"))
    assert read_sigmf(meta, 10.5e9).carrier == 10.5e9
    for carrier in (0, "10 GHz"):
        with pytest.raises(ValueError, match=r"^carrier must be"):
            read_sigmf(meta, carrier)


@pytest.mark.parametrize("library, extra, call", [
    ("soundfile", "wav", lambda r, d: read_wav(write_wav(d / "a.wav", r), 24e9)),
    ("sigmf", "recordings", lambda r, d: write_sigmf(d / "a", r)),
    ("sigmf", "recordings", lambda r, d: read_sigmf(d / "a")),
])  # fmt: skip
def test_a_library_that_is_missing_is_named(recording, tmp_path, monkeypatch, library, extra, call):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ModuleNotFoundError, match=rf'pip install "dopplerlib\[{extra}\]"'):
        call(recording, tmp_path)
