"""What is written reads back the same; what is broken is refused with the reason."""

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest
from scipy.io import wavfile

from dopplerlib.signal.recording import Recording, read_sigmf, read_wav, write_sigmf, write_wav

NOON = datetime(2016, 9, 28, 12, 0, 0, 1500, tzinfo=UTC)


@pytest.fixture
def recording():
    x = np.random.default_rng(1).uniform(-0.99, 0.99, (3, 80)).view(complex)
    return Recording(x, 2000.0, 24.125e9, NOON)


def same(a, b):
    return np.array_equal(a.x, b.x) and (a.fs, a.carrier, a.start) == (b.fs, b.carrier, b.start)


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
    sensors = [replace(recording, x=row[None]) for row in recording.x]
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


def test_a_time_of_another_zone_is_the_same_moment(recording, tmp_path):
    east = NOON.astimezone(timezone(timedelta(hours=5)))
    meta = write_sigmf(tmp_path / "a", replace(recording, start=east))
    assert read_sigmf(meta).start == NOON


def test_a_stereo_file_from_elsewhere_has_i_left_and_q_right(tmp_path):
    wavfile.write(tmp_path / "a.wav", 8000, np.array([[0.25, 0.5], [0.0, -0.5]], dtype=np.float32))
    assert read_wav(tmp_path / "a.wav", 24e9).x.tolist() == [[0.25 + 0.5j, -0.5j]]


def edit(meta, change):
    content = json.loads(meta.read_text())
    change(content)
    meta.write_text(json.dumps(content))


@pytest.mark.parametrize("cut", [1, 16, 48, 480, 3 * 40 * 16])
def test_a_cut_sigmf_file_is_refused(recording, tmp_path, cut):
    """By its length, or where that could be right by its hash."""
    meta = write_sigmf(tmp_path / "a", recording)
    data = tmp_path / "a.sigmf-data"
    data.write_bytes(data.read_bytes()[:-cut])
    with pytest.raises(ValueError, match=r"a.sigmf-meta is no sound SigMF recording: "):
        read_sigmf(meta)


def test_a_changed_sigmf_file_is_refused(recording, tmp_path):
    meta = write_sigmf(tmp_path / "a", recording)
    data = tmp_path / "a.sigmf-data"
    content = bytearray(data.read_bytes())
    content[100] ^= 1
    data.write_bytes(content)
    with pytest.raises(ValueError, match=r"is no sound SigMF recording: .*hash"):
        read_sigmf(meta)


@pytest.mark.parametrize(
    "change, message",
    [
        (lambda c: c["global"].pop("core:sample_rate"), "positive sampling rate, got None"),
        (lambda c: c["captures"][0].pop("core:frequency"), "positive carrier frequency, got None"),
        (lambda c: c["captures"].append({"core:sample_start": 9}), "must have one capture, got 2"),
        (lambda c: c["captures"].clear(), "must have one capture, got 0"),
        (lambda c: c["global"].update({"core:datatype": "rf64_le"}), "must hold complex samples"),
        (lambda c: c["global"].update({"core:datatype": "cf63_le"}), "is no sound SigMF recording"),
        (lambda c: c["global"].update({"core:sample_rate": "fast"}), "is no sound SigMF recording"),
        (lambda c: c.pop("global"), "is no sound SigMF recording"),
    ],
)  # fmt: skip
def test_sigmf_that_leaves_something_open_is_refused(recording, tmp_path, change, message):
    meta = write_sigmf(tmp_path / "a", recording)
    edit(meta, change)
    with pytest.raises(ValueError, match=message):
        read_sigmf(meta)


def test_sigmf_that_is_no_json_or_has_no_data_is_refused(recording, tmp_path):
    meta = write_sigmf(tmp_path / "a", recording)
    (tmp_path / "a.sigmf-data").unlink()
    with pytest.raises(ValueError, match=r"a.sigmf-meta is no sound SigMF recording"):
        read_sigmf(meta)
    meta.write_text("{")
    with pytest.raises(ValueError, match=r"a.sigmf-meta is no sound SigMF recording"):
        read_sigmf(meta)


@pytest.mark.parametrize("cut", [1, 48, 480, 1900])
def test_a_cut_wav_file_is_refused(recording, tmp_path, cut):
    path = write_wav(tmp_path / "a.wav", recording)
    path.write_bytes(path.read_bytes()[:-cut])
    with pytest.raises(ValueError, match=r"a.wav is no sound WAV file: "):
        read_wav(path, 24e9)


def test_a_wav_file_with_an_odd_channel_is_refused(tmp_path):
    wavfile.write(tmp_path / "a.wav", 1000, np.zeros(10, dtype=np.float32))
    with pytest.raises(ValueError, match="must have two channels a sensor, I and Q, got 1"):
        read_wav(tmp_path / "a.wav", 24e9)


@pytest.mark.parametrize(
    "other, message",
    [
        ({"fs": 1000.0}, "the sampling rate of a.sigmf-meta, 2000.0, got 1000"),
        ({"carrier": 24e9}, "must have the carrier frequency of a.sigmf-meta"),
        ({"start": NOON + timedelta(seconds=1)}, "must have the start of a.sigmf-meta"),
        ({"start": None}, "must have the start of a.sigmf-meta, .*, got None"),
        ({"x": np.ones((1, 39), complex)}, "must have the number of samples of .*, 40, got 39"),
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
        (lambda r, d: read_sigmf([]), "paths must name at least one file, got none"),
        (lambda r, d: read_sigmf(d / "none.sigmf-meta"), "must be files .sigmf-meta that exist"),
        (lambda r, d: read_wav(d / "none.wav", 24e9), "paths must be files that exist, got"),
        (lambda r, d: read_wav(d / "none.wav", 0), "carrier must be .*positive.*0"),
        (lambda r, d: write_sigmf(d / "a", r.x), "recording must be a Recording, got"),
        (lambda r, d: write_sigmf(d / "a", r, "int8"), "samples must be one of .*, got 'int8'"),
        (lambda r, d: write_sigmf(d / "a", replace(r, x=2 * r.x), "int16"), "-1 and 1 .*, got 1.9"),
        (lambda r, d: write_sigmf(d / "a", replace(r, x=r.x[0])), r"recording.x must have shape"),
        (lambda r, d: write_sigmf(d / "a", replace(r, fs=-1.0)), "recording.fs must be .*positive"),
        (lambda r, d: write_wav(d / "a", replace(r, fs=1000.5)), r"number of Hz .*, got 1000.5"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_and_leaves_no_file(recording, tmp_path, call, message):
    with pytest.raises(ValueError, match=message):
        call(recording, tmp_path)
    assert list(tmp_path.iterdir()) == []
