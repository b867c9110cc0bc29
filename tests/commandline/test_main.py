"""The command line writes what it says, and names what is missing or wrong."""

import csv

import numpy as np
import pytest

from dopplerlib.chain.setup import EXAMPLE, example
from dopplerlib.commandline.main import main

FILES = {
    "spectrogram.png", "shifts.png", "residuals.png", "track.png",
    "shifts.csv", "track.csv", "summary.txt",
}  # fmt: skip


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    """Return a folder with the example, and its track."""
    folder = tmp_path_factory.mktemp("command")
    assert main(["--example", str(folder / "trial")]) == 0
    room = folder / "trial" / "room"
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main([f"{room}.npy", "--array", f"{room}.toml"]) == 0
    return folder


@pytest.fixture
def array(trial):
    return "--array", str(trial / "trial" / "room.toml")


@pytest.fixture
def recording(trial):
    return str(trial / "trial" / "room.npy")


def refused(capsys, *arguments):
    """Return the line that a refused command writes."""
    capsys.readouterr()
    assert main([str(one) for one in arguments]) == 2
    *_, line = capsys.readouterr().err.splitlines()
    return line


def table(path):
    with path.open() as file:
        head, *rows = csv.reader(file)
    return head, np.array([[float(v) if v else np.nan for v in row] for row in rows])


def test_the_example_runs_and_everything_is_written(trial):
    written = trial / "room-track"
    assert {path.name for path in written.iterdir()} == FILES
    for name in FILES:
        if name.endswith(".png"):
            assert (written / name).read_bytes()[:4] == b"\x89PNG"
    text = (written / "summary.txt").read_text()
    assert text.startswith("Written by python -m dopplerlib: room.npy with room.toml")
    assert "cause       none found" in text and "FAILED" not in text


def test_the_tables_hold_shifts_and_track_with_units(trial):
    """The target is at 4.8 - 1.4 t, 1.5 + 0.4 t; the stated errors at the end are some mm."""
    head, shifts = table(trial / "room-track" / "shifts.csv")
    assert len(head) == 2 + 2 * 5 and all("(" in name for name in head)
    assert np.isfinite(shifts).all()
    head, track = table(trial / "room-track" / "track.csv")
    t, x, y = track[-1, :3]
    assert abs(x - 4.8 + 1.4 * t) < 0.01 and abs(y - 1.5 - 0.4 * t) < 0.01
    distance, alarm = (track[:, head.index(name)] for name in ("distance (m)", "alarm (1)"))
    assert set(alarm) == {0, 1} and (distance[alarm == 0] > example().distance).all()


def test_a_recording_without_a_target_has_no_track_and_says_so(array, tmp_path, capsys):
    noise = np.random.default_rng(1).standard_normal((5, 8000, 2)) @ [0.1, 0.1j]
    np.save(tmp_path / "empty.npy", noise)
    out = tmp_path / "out"
    assert main([f"{tmp_path}/empty.npy", *array, "--out", f"{out}", "--count", "3000"]) == 1
    assert "cause       no target" in capsys.readouterr().out
    assert {path.name for path in out.iterdir()} == {"spectrogram.png", "shifts.csv", "summary.txt"}


def test_exchanged_branches_are_named(recording, array, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("dopplerlib.commandline.main._drawings", lambda *shown: {})
    x = np.load(recording)
    np.save(tmp_path / "qi.npy", x.imag + 1j * x.real)
    out = "--out", str(tmp_path / "out"), "--count", "4000"
    assert main([f"{tmp_path}/qi.npy", *array, *out]) == 1
    told = capsys.readouterr().out
    assert "start       FAILED" in told and "cause       I and Q exchanged" in told
    assert main([f"{tmp_path}/qi.npy", *array, *out, "--layout", "qi"]) == 0


def test_what_is_missing_or_wrong_is_named(recording, array, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "RECORDING must be at least one file" in refused(capsys, *array)
    assert "--array must be given" in refused(capsys, recording)
    assert "--array must be a file that exists, got 'none.toml'" in refused(
        capsys, recording, "--array", "none.toml"
    )
    assert "paths must be files that exist, got 'none.npy'" in refused(capsys, "none.npy", *array)
    assert "paths must end in .wav" in refused(capsys, "none.mat", *array)
    (tmp_path / "bad.toml").write_text(EXAMPLE.replace("speed_limit", "speed"))
    assert "[target] must have speed_limit, for example `speed_limit = 2.5` (m/s)" in refused(
        capsys, recording, "--array", "bad.toml"
    )
    np.save("three.npy", np.ones((3, 100), complex))
    assert "array must have the 3 sensors of recording, got 5" in refused(
        capsys, "three.npy", *array
    )
    assert "start must be at most 0.2 s, the end of the record, got 0.5" in refused(
        capsys, recording, *array, "--count", "800"
    )
    assert list(tmp_path.glob("*-track")) == []


def test_a_folder_of_something_else_is_left_alone(recording, array, tmp_path, capsys):
    thesis = tmp_path / "thesis.tex"
    thesis.write_text("years of work")
    line = refused(capsys, recording, *array, "--out", tmp_path)
    assert "--out must be a new folder or one that this command made" in line and "--force" in line
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]
    assert "which is a file" in refused(capsys, recording, *array, "--out", thesis)


def test_without_matplotlib_the_tables_are_written(recording, array, tmp_path, capsys, monkeypatch):
    def missing(*shown):
        raise ModuleNotFoundError('matplotlib is needed here: pip install "dopplerlib[figures]"')

    monkeypatch.setattr("dopplerlib.commandline.main._drawings", missing)
    out = tmp_path / "out"
    assert main([recording, *array, "--out", str(out), "--count", "4000"]) == 0
    assert 'no pictures: matplotlib is needed here: pip install "dopplerlib[figures]"' in (
        capsys.readouterr().err
    )
    assert {path.name for path in out.iterdir()} == {"shifts.csv", "track.csv", "summary.txt"}
