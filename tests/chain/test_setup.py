"""A setup is read from a file, or refused with the entry and an example of its line."""

from dataclasses import fields

import numpy as np
import pytest
from scipy.io import wavfile

from dopplerlib import RadarArray, iq_from_geometry
from dopplerlib.chain.setup import EXAMPLE, Setup, example
from dopplerlib.signal.recording import Recording, write_sigmf, write_wav


@pytest.fixture
def parse(tmp_path):
    def parse(text):
        path = tmp_path / "room.toml"
        path.write_text(text, encoding="utf-8")
        return Setup.from_toml(path)

    return parse


def test_the_example_is_read_as_it_says(parse):
    setup = parse(EXAMPLE)
    assert setup == example()
    assert setup.carrier == pytest.approx(10.525e9)
    assert setup.array.positions.tolist()[0] == [0, 0.5, 1] and len(setup.array) == 5
    assert (setup.speed_limit, setup.window, setup.factor, setup.layout) == (2.5, 0.05, 4, "iq")
    assert [list(bound) for bound in setup.box] == [[0, 0, 1.2], [6, 5, 1.2]]


def test_every_setting_can_be_given_in_a_file(parse):
    """But the box, which is `lower` and `upper`, and the array."""
    text = EXAMPLE.replace(
        "[recording]",
        "remove_dc = false\nbalance = false\nleast_snr = 30.0\nvariance_inflation = 2.0\n"
        'search = "whole"\ndc_until = 1.0\n[recording]',
    )
    setup, plain = parse(text), example()
    names = [f.name for f in fields(Setup) if f.name not in ("box", "point", "lines")]
    changed = {name for name in names if getattr(setup, name) != getattr(plain, name)}
    assert changed == {
        "remove_dc",
        "balance",
        "least_snr",
        "variance_inflation",
        "search",
        "dc_until",
    }


def test_a_wavelength_will_do_for_a_carrier(parse):
    text = EXAMPLE.replace("carrier = 10.525e9 ", "wavelength = 0.0285 ")
    assert parse(text).array.wavelength == 0.0285


ENTRIES = ("positions", "lower", "upper", "speed_limit", "velocity_random_walk", "window", "start")


@pytest.mark.parametrize("entry", [*ENTRIES, "point", "distance"])
def test_a_missing_entry_is_named_with_its_table_and_a_line(parse, entry):
    lines = EXAMPLE.splitlines()
    (i,) = (i for i, line in enumerate(lines) if line.startswith(f"{entry} ="))
    stop = next(k for k in range(i, len(lines)) if entry != "positions" or lines[k] == "]") + 1
    with pytest.raises(
        ValueError, match=rf"room.toml: \[\w+\] must have {entry}, for example `{entry} ="
    ):
        parse("\n".join(lines[:i] + lines[stop:]))


@pytest.mark.parametrize("table", ["array", "target", "tracker"])
def test_a_missing_table_is_shown(parse, table):
    text = EXAMPLE.replace(f"[{table}]", "[alarm2]")
    with pytest.raises(
        ValueError, match=rf"must have a table \[{table}\](.|\n)*for example\n\[{table}\]"
    ):
        parse(text)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("window =", "windw =", r"\[tracker\] must have window"),
        ("hop =", "hopp =", r"\[tracker\] must have nothing but .*, got hopp"),
        ("[alarm]", "[alarms]", "the file must have nothing but .*, got alarms"),
        ("carrier =", "wavelength = 0.0285\ncarrier =", "must have either carrier or wavelength"),
        ("carrier = 10.525e9", "", "must have either carrier or wavelength, for example `carrier"),
        ("carrier = 10.525e9", 'carrier = "10 GHz"', "carrier must be"),
        ("carrier = 10.525e9", "carrier = 10.525", "carrier must be that of a radio wave in Hz"),
        (
            "upper = [6, 5, 1.2]",
            "upper = [6, 5]",
            r"upper must hold a position.*`upper = \[6, 5, 1",
        ),
        ("window = 0.05", "window = -1", "window must be positive"),
        ('layout = "iq"', 'layout = "stereo"', "layout must be one of None, 'iq', 'qi', 'real'"),
        ("upper = [6, 5, 1.2]", "upper = [6, -5, 1.2]", "box must not be empty"),
        ("[0, 1.5, 2]", "[0, 0.5, 1]", "positions must differ"),
        ("[0, 1.5, 2]", "[0, 1.5]", "positions must"),
        ("[array]", "[array", "room.toml: "),
    ],
)
def test_a_wrong_entry_is_named(parse, old, new, message):
    with pytest.raises(ValueError, match=message) as error:
        parse(EXAMPLE.replace(old, new, 1))
    assert "room.toml" in str(error.value)


RECORDING = Recording(
    np.random.default_rng(1).normal(size=(2, 100, 2)) @ [0.1, 0.1j], 1000.0, 10.525e9
)


def test_a_file_is_read_by_the_end_of_its_name(tmp_path):
    array = RadarArray([[0, 0, 0], [0, 1, 0]], RECORDING.wavelength)
    setup = Setup(array, ([1, 0, 0], [2, 1, 0]), 2, 0.1, 0.01, 0.05, layout="iq", fs=1000)
    np.save(tmp_path / "a.npy", RECORDING.x)
    paths = (
        tmp_path / "a.npy",
        write_wav(tmp_path / "a.wav", RECORDING),
        write_sigmf(tmp_path / "a", RECORDING),
    )
    for path in paths:
        read = setup.read(path)
        np.testing.assert_array_equal(read.x, RECORDING.x)
        assert read.carrier == pytest.approx(RECORDING.carrier)
    np.testing.assert_array_equal(setup.read(paths[1], first=10, count=5).x, RECORDING.x[:, 10:15])
    with pytest.raises(ValueError, match="paths must be files of one format"):
        setup.read(paths)
    with pytest.raises(ValueError, match=r"paths must end in .wav, .* got '.*a.mat'"):
        setup.read(tmp_path / "a.mat")
    with pytest.raises(ValueError, match="paths must be a path or a sequence"):
        setup.read([1])
    bare = Setup(array, setup.box, 2, 0.1, 0.01, 0.05)
    with pytest.raises(ValueError, match=r"fs must be given for .npy.*`fs = 4000`"):
        bare.read(tmp_path / "a.npy")


def test_a_delay_before_the_converter_is_added():
    setup = example()
    x = np.random.default_rng(2).normal(size=(5, 2000, 2)) @ [1, 1j]
    recording = Recording(x, 4000.0, setup.carrier)
    late = Setup(**{f.name: getattr(setup, f.name) for f in fields(Setup)} | {"delay": 0.25})
    assert late.baseband(recording).delay == setup.baseband(recording).delay + 0.25


def test_real_channels_of_a_file_are_tracked_with_the_signs_of_straight_flight(tmp_path):
    """A WAV file of five modules without Q: a centimeter is more than five deviations."""
    places = [[0, 0, 2], [6, 0, 2.2], [6, 5, 2], [0, 5, 2.2], [3, 0, 1.8]]
    array = RadarArray(places, wavelength=0.0125)
    path = [1.5, 2.5, 1] + np.arange(2000)[:, None] / 1e3 * [1, 0.3, 0]
    x = iq_from_geometry(path, array, 20, rng=np.random.default_rng(1)).real
    wavfile.write(tmp_path / "room.wav", 1000, (0.2 * x.T).astype(np.float32))
    box = [0, 0, 1], [6, 5, 1]
    setup = Setup(array, box, 2, 0.05, 0.05, 0.7, layout="real", noise="horizontal")
    found = setup.track(setup.baseband(setup.read(tmp_path / "room.wav")))
    state, P, _ = found.at(1.999)
    assert np.linalg.norm(state[:3] - path[-1]) < 0.01
    assert 5 * np.sqrt(np.trace(P[:3, :3])) < 0.01
