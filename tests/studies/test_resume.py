"""A study goes on where it stopped, and never from what was made with anything else."""

import json

import pytest

from dopplerlib._progress import progress_bar
from studies import _resume as tool


def squares(path, items, stop_at=None, **settings):
    """Write squares, one for each item; return the items that were worked on."""
    worked = []
    with tool.started(path, items, **settings) as study:
        for item in progress_bar(study.left, "items", wanted=False):
            if item == stop_at:
                raise KeyboardInterrupt
            worked.append(item)
            study.keep(item**2)
        path.write_text(json.dumps(study.rows), encoding="utf-8")
    return worked


def interrupted(path, items, stop_at, **settings):
    with pytest.raises(KeyboardInterrupt):
        squares(path, items, stop_at, **settings)
    return path.with_name(f"{path.name}.part")


@pytest.fixture
def path(tmp_path):
    return tmp_path / "squares.json"


def test_an_interrupted_study_goes_on_and_leaves_what_an_undisturbed_one_leaves(path, capsys):
    interrupted(path, range(5), 3, seed=1)
    assert not path.exists()
    assert squares(path, range(5), seed=1) == [3, 4]
    assert "3 of 5 are done" in capsys.readouterr().err
    assert json.loads(path.read_text()) == [0, 1, 4, 9, 16]
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize(
    ("items", "settings"),
    [(range(1, 6), {"seed": 1}), (range(6), {"seed": 1}), (range(5), {"seed": 2}), (range(5), {})],
)
def test_other_items_or_settings_start_over(path, capsys, items, settings):
    interrupted(path, range(5), 3, seed=1)
    assert squares(path, items, **settings) == list(items)
    assert "starts over" in capsys.readouterr().err


@pytest.mark.parametrize("what", ["code", "python", "numpy", "scipy", "numba"])
def test_other_code_data_or_versions_start_over(path, monkeypatch, what):
    interrupted(path, range(5), 3)
    other = tool.made_with() | {what: "another"}
    monkeypatch.setattr(tool, "made_with", lambda: other)
    assert squares(path, range(5)) == [0, 1, 2, 3, 4]


def test_the_code_of_a_study_is_that_of_library_studies_and_data(monkeypatch, tmp_path):
    """A changed byte of each counts, and what a study itself leaves there does not."""
    files = {}
    for folder, name in (("dopplerlib", "a.py"), ("studies", "b.py"), ("data", "paper/c.toml")):
        files[folder] = tmp_path / folder / name
        files[folder].parent.mkdir(parents=True)
        files[folder].write_text("1")
    monkeypatch.setattr(tool.dopplerlib, "__file__", str(tmp_path / "dopplerlib" / "__init__.py"))
    monkeypatch.setattr(tool, "__file__", str(tmp_path / "studies" / "_resume.py"))
    monkeypatch.setattr(tool, "ROOT", tmp_path)
    found = {tool.made_with()["code"]}
    for number, path in enumerate(files.values(), start=2):
        path.write_text("2")
        found.add(tool.made_with()["code"])
        assert len(found) == number
    (tmp_path / "data" / "paper" / "d.csv.part").write_text("3")
    (tmp_path / "data" / ".partial-1.csv").write_text("3")
    assert tool.made_with()["code"] in found


@pytest.mark.parametrize("cut", [1, 2, 4])
def test_a_row_that_a_kill_has_cut_short_is_made_again(path, cut):
    part = interrupted(path, [1, 100], 100)
    with part.open("a") as file:
        file.write(f"{100**2}\n"[:cut])
    assert squares(path, [1, 100]) == [100]
    assert json.loads(path.read_text()) == [1, 10_000]


def test_a_part_without_a_whole_first_line_is_begun_anew(path):
    part = interrupted(path, range(5), 3)
    part.write_text(part.read_text()[:20])
    assert squares(path, range(5)) == [0, 1, 2, 3, 4]


def test_a_failure_while_the_file_is_written_loses_no_row(path):
    path.mkdir()  # cannot be written to
    with pytest.raises(IsADirectoryError):
        squares(path, range(5))
    path.rmdir()
    assert squares(path, range(5)) == []
    assert json.loads(path.read_text()) == [0, 1, 4, 9, 16]
