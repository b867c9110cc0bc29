"""Recordings of several files: the same clock, the time that they share, a part of it."""

import json
import tracemalloc
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from dopplerlib.signal.recording import (
    Recording,
    align,
    read_sigmf,
    read_wav,
    write_sigmf,
    write_wav,
)

NOON = datetime(2016, 9, 28, 12, tzinfo=UTC)
FS, CARRIER = 1000.0, 24e9


def clock(first, count, start=NOON, sensors=1):
    """Return a recording of samples that count from noon, beginning with sample `first`."""
    k = np.arange(first, first + count)
    noise = np.random.default_rng(3).integers(0, 64, first + count)[first:]
    k = (k + 1j * (64 * np.arange(1, sensors + 1)[:, None] + noise)) / 2**12
    start = None if start is None else start + timedelta(seconds=first / FS)
    return Recording(k, FS, CARRIER, start)


def counted(recording):
    """Return which samples of the clock a recording has, or raise unless all sensors agree."""
    k = recording.x.real * 2**12
    assert (k == k[0]).all()
    return k[0].tolist()


def write(kind, folder, recordings):
    """Write recordings, and return a function that reads them together."""
    if kind == "align":
        return lambda: align(recordings)
    names = [folder / f"s{i}" for i in range(len(recordings))]
    if kind == "sigmf":
        paths = [write_sigmf(name, one) for name, one in zip(names, recordings, strict=True)]
        return lambda **part: read_sigmf(paths, **part)
    paths = [write_wav(name, one) for name, one in zip(names, recordings, strict=True)]
    starts = [one.start for one in recordings]
    start = starts[0] if starts == [None] * len(starts) else starts
    return lambda **part: read_wav(paths, CARRIER, start, **part)


KINDS = pytest.mark.parametrize("kind", ["align", "sigmf", "wav"])


@KINDS
def test_what_starts_and_ends_at_different_times_is_cut_to_what_is_shared(kind, tmp_path):
    read = write(kind, tmp_path, [clock(0, 50), clock(7, 60, sensors=2), clock(3, 40)])
    recording = read()
    assert recording.x.shape == (4, 36) and recording.start == NOON + timedelta(milliseconds=7)
    assert counted(recording) == list(range(7, 43))
    assert (recording.x.imag[:, 0] * 2**12 // 64).tolist() == [1, 1, 2, 1]
    assert recording.valid.all()


@KINDS
def test_what_shares_no_time_is_refused(kind, tmp_path):
    read = write(kind, tmp_path, [clock(0, 50), clock(50, 50)])
    with pytest.raises(ValueError, match=r"\b(s0|recordings.0.)\S* must have samples when the la"):
        read()


@KINDS
def test_without_a_start_the_lengths_must_agree(kind, tmp_path):
    read = write(kind, tmp_path, [clock(0, 50, None), clock(0, 37, None)])
    with pytest.raises(ValueError, match=r"must have the number of samples of .*, 50, .*count=37"):
        read()
    if kind != "align":
        assert counted(read(count=37)) == list(range(37))


@KINDS
@pytest.mark.parametrize("change", [{"fs": 500.0}, {"carrier": 5.8e9}, {"start": None}])
def test_what_does_not_belong_together_is_refused(kind, tmp_path, change):
    recordings = [clock(0, 50), replace(clock(0, 50), **change)]
    if kind == "wav" and "carrier" in change:
        return  # it has no place for a carrier
    with pytest.raises(ValueError, match=r"(start|must have the .* of|if and only if)"):
        write(kind, tmp_path, recordings)()


@pytest.mark.parametrize("kind", ["sigmf", "wav"])
@pytest.mark.parametrize("first, count", [(0, 50), (0, 1), (5, 20), (49, 1), (5, None)])
def test_a_part_is_read_with_its_time(kind, tmp_path, first, count):
    recording = write(kind, tmp_path, [clock(0, 50)])(first=first, count=count)
    assert counted(recording) == list(range(first, 50 if count is None else first + count))
    assert recording.start == NOON + timedelta(milliseconds=first)


@pytest.mark.parametrize("kind", ["sigmf", "wav"])
def test_a_part_counts_from_what_is_shared(kind, tmp_path):
    read = write(kind, tmp_path, [clock(0, 50), clock(7, 60)])
    recording = read(first=2, count=10)
    assert counted(recording) == list(range(9, 19))
    assert recording.start == NOON + timedelta(milliseconds=9)


@pytest.mark.parametrize("kind", ["sigmf", "wav"])
@pytest.mark.parametrize(
    "part, message",
    [
        ({"first": 50}, "first must be less than the number of samples, 50, got 50"),
        ({"first": 45, "count": 6}, "count must be at most 5 after sample 45, got 6"),
        ({"first": -1}, "first must be a whole number of at least 0, got -1"),
        ({"first": 1.5}, "first must be a whole number of at least 0, got 1.5"),
        ({"count": 0}, "count must be a whole number of at least 1, got 0"),
        ({"count": "all"}, "count must be a whole number of at least 1, got 'all'"),
    ],
)
def test_a_part_that_is_not_there_is_refused(kind, tmp_path, part, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        write(kind, tmp_path, [clock(0, 50)])(**part)


@KINDS
def test_a_start_counts_to_the_nearest_sample(kind, tmp_path):
    late = replace(clock(0, 50), start=NOON + timedelta(microseconds=1400))
    assert write(kind, tmp_path, [clock(0, 50), late])().x[0, 0].real * 2**12 == 1


def test_as_many_starts_as_files(tmp_path):
    path = write_wav(tmp_path / "a.wav", clock(0, 50))
    with pytest.raises(ValueError, match="start must be one for each of 1 files, got 2"):
        read_wav(path, CARRIER, [NOON, NOON])


@pytest.mark.parametrize("what", [None, 5, [], [1], clock(0, 3).x])
def test_only_recordings_are_aligned(what):
    with pytest.raises(ValueError, match=r"^recordings must be a sequence of recordings, got"):
        align(what)


def test_any_iterable_of_recordings_is_aligned():
    recordings = [clock(0, 50), clock(7, 60)]
    assert align(iter(recordings)) == align(recordings)


def test_what_is_invalid_stays_so_when_recordings_are_aligned():
    valid = np.ones((1, 50), dtype=bool)
    valid[0, 10] = False
    recording = align([replace(clock(0, 50), valid=valid), clock(7, 60)])
    assert np.argwhere(~recording.valid).tolist() == [[0, 3]]


def captures(folder, more, datatype="cf64_le"):
    """Write 50 samples of a clock, whose second capture begins at sample 20."""
    meta = write_sigmf(folder / "a", clock(0, 50))
    content = json.loads(meta.read_text())
    content["captures"].append({"core:sample_start": 20, "core:frequency": CARRIER} | more)
    content["captures"][0]["core:global_index"] = 0
    meta.write_text(json.dumps(content))
    return meta


@pytest.mark.parametrize(
    "more, gap",
    [
        ({}, 0),
        ({"core:global_index": 20}, 0),
        ({"core:global_index": 25}, 5),
        ({"core:datetime": "2016-09-28T12:00:00.020Z"}, 0),
        ({"core:datetime": "2016-09-28T12:00:00.025Z"}, 5),
        ({"core:datetime": "2016-09-28T12:00:00.021000Z"}, 0),  # a sample: the clock of a computer
        ({"core:datetime": "2016-09-28T12:00:00Z"}, 0),  # in whole seconds
        ({"core:datetime": "2016-09-28T12:00:05Z"}, 4980),
        ({"core:datetime": "2016-09-28T12:00:05Z", "core:global_index": 23}, 3),
    ],
)
def test_what_is_missing_between_captures_is_invalid(tmp_path, more, gap):
    recording = read_sigmf(captures(tmp_path, more))
    assert recording.x.shape == (1, 50 + gap)
    assert np.flatnonzero(~recording.valid[0]).tolist() == list(range(20, 20 + gap))
    assert not recording.x[0, 20 : 20 + gap].any()
    np.testing.assert_array_equal(recording.x[recording.valid], clock(0, 50).x[0])
    part = read_sigmf(tmp_path / "a", first=15, count=20)
    np.testing.assert_array_equal(part.x, recording.x[:, 15:35])
    np.testing.assert_array_equal(part.valid, recording.valid[:, 15:35])


@pytest.mark.parametrize(
    "more", [{"core:global_index": 19}, {"core:datetime": "2016-09-28T12:00:00.010Z"}]
)
def test_captures_that_overlap_are_refused(tmp_path, more):
    with pytest.raises(ValueError, match="its captures must not overlap in time, got"):
        read_sigmf(captures(tmp_path, more))


def test_a_file_begins_with_its_first_capture(tmp_path):
    meta = write_sigmf(tmp_path / "a", clock(0, 50))
    content = json.loads(meta.read_text())
    content["captures"][0]["core:sample_start"] = 10
    meta.write_text(json.dumps(content))
    assert counted(read_sigmf(meta)) == list(range(10, 50))
    content["global"]["core:offset"] = 25  # the file is a later part of a recording
    meta.write_text(json.dumps(content))
    assert counted(read_sigmf(meta)) == list(range(50))
    assert read_sigmf(meta).start == NOON + timedelta(milliseconds=15)


def test_a_part_of_a_long_file_takes_the_memory_of_the_part(tmp_path):
    """A file of 1 GB, of which nothing but a megabyte is on the disk."""
    wav, meta = tmp_path / "a.wav", write_sigmf(tmp_path / "a", clock(0, 50), "int16")
    write_wav(wav, clock(0, 50), samples="int16")
    frames = 2**28
    with wav.open("r+b") as file:
        file.seek(-204, 2)  # the length of the samples, before 50 of 4 bytes
        file.write((4 * frames).to_bytes(4, "little"))
    content = json.loads(meta.read_text())
    del content["global"]["core:sha512"]
    meta.write_text(json.dumps(content))
    for path, head in ((wav, wav.stat().st_size - 200), (tmp_path / "a.sigmf-data", 0)):
        with path.open("r+b") as file:
            file.truncate(head + 4 * frames)
    for read in (
        lambda: read_wav(wav, CARRIER, first=frames - 10**5, count=10**5),
        lambda: read_sigmf(meta, first=frames - 10**5, count=10**5),
    ):
        tracemalloc.start()
        recording = read()
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert recording.x.shape == (1, 10**5)
        assert peak < 25 * recording.x.nbytes


@pytest.mark.parametrize("kind", ["wav", "sigmf"])
def test_what_does_not_fit_into_memory_is_refused_with_its_size(tmp_path, monkeypatch, kind):
    read = write(kind, tmp_path, [clock(0, 50)])

    def full(*args):
        raise MemoryError

    monkeypatch.setattr("dopplerlib.signal._joining.np.empty", full)
    with pytest.raises(
        ValueError, match=r"must fit into memory, got 50 samples of 1 sensors, .*GiB"
    ):
        read()
