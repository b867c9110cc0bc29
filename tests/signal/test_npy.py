"""Arrays of NumPy are read as other recordings are, and what is none is refused by its name."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dopplerlib.signal.recording import read_npy

FS, CARRIER = 1000.0, 24e9
IQ = np.array([[1 + 2j, 3 - 4j, 5j, 1], [-1, 0.5j, 2, 1 - 1j]])
CHANNELS = np.array([IQ[0].real, IQ[0].imag, IQ[1].real, IQ[1].imag])


@pytest.fixture
def read(tmp_path):
    def read(*arrays, **settings):
        paths = [tmp_path / f"{i}.npy" for i in range(len(arrays))]
        for path, array in zip(paths, arrays, strict=True):
            np.save(path, array)
        return read_npy(paths, FS, CARRIER, **settings)

    return read


@pytest.mark.parametrize("kind", [complex, "complex64"])
def test_complex_samples_come_as_they_are(read, kind):
    recording = read(IQ.astype(kind))
    assert_array_equal(recording.x, IQ)
    assert (recording.fs, recording.carrier) == (FS, CARRIER)
    assert_array_equal(read(*IQ.astype(kind)).x, IQ)  # a file for each sensor


def test_real_channels_are_i_and_q_in_turn_or_the_other_way(read):
    assert_array_equal(read(CHANNELS, layout="iq").x, IQ)
    assert_array_equal(read(CHANNELS, layout="qi").x, IQ.imag + 1j * IQ.real)


@pytest.mark.parametrize(
    ("kind", "low", "high"),
    [("int16", -(2**15), 2**14), ("uint8", 0, 192), ("int32", -(2**31), 2**30)],
)
def test_whole_numbers_are_scaled_to_one(read, kind, low, high):
    x = read(np.array([[low, high], [high, low]], kind), layout="iq").x
    assert_array_equal(x, [[-1 + 0.5j, 0.5 - 1j]])


def test_a_part_is_read(read):
    assert_array_equal(read(IQ, first=1, count=2).x, IQ[:, 1:3])


def test_real_modules_have_one_channel_each(read):
    t = np.arange(400) / FS
    recording = read(np.cos(2 * np.pi * 50 * t), layout="real")
    np.testing.assert_allclose(recording.x[0], np.exp(2j * np.pi * 50 * t), atol=1e-9)


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (
            IQ.T[:, :1].repeat(2, 1),
            r"0.npy must have the shape \(channels, samples\), got \(4, 2\)",
        ),
        (np.zeros((2, 2, 2)), "0.npy is not a valid .npy recording: its shape must be"),
        (np.array(["a"]), "0.npy is not a valid .npy recording: its samples must be numbers"),
        (np.array([{}]), "0.npy is not a valid .npy recording"),
        (np.zeros((3, 9)), "0.npy must have two channels a sensor, I and Q, unless layout"),
        (np.zeros((0, 0)), "0.npy must hold samples, got none"),
    ],
)
def test_other_arrays_are_refused(read, array, message):
    with pytest.raises(ValueError, match=message):
        read(array)


def test_what_is_no_array_is_refused(tmp_path):
    for name, content in (("a.npy", b"text"), ("b.npy", b""), ("c.npy", b"\x93NUMPY")):
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(ValueError, match=f"{name} is not a valid .npy recording"):
            read_npy(path, FS, CARRIER)
    np.savez(tmp_path / "d.npz", IQ)
    with pytest.raises(ValueError, match="it must hold one array, got an archive"):
        read_npy(tmp_path / "d.npz", FS, CARRIER)
    for fs, carrier in ((0, 1e9), (1e3, -1)):
        with pytest.raises(ValueError, match="must be positive"):
            read_npy(tmp_path / "d.npz", fs, carrier)
