"""One command runs every study, and every result says how it was made.

That the numbers come out again is tested beside the system that each study is about.
"""

import json
import sys
import tomllib
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from importlib import import_module
from types import ModuleType, NoneType

import numpy as np
import pytest

from dopplerlib.replication.documents import documents
from studies import __main__ as command

NAMES = command.names()


def stored(name):
    """Return the text of the file that says how the results of a study were made."""
    return (command.RESULTS / f"{name}.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", NAMES)
def test_the_parameters_beside_a_result_are_those_of_its_study(name):
    """Else the study has changed since: run it again."""
    told = tomllib.loads(stored(name))
    made_now = command.provenance(import_module(f"studies.{name}"), name)
    assert told["parameters"] == tomllib.loads(made_now)["parameters"]
    assert told["versions"].keys() == {"python", "dopplerlib", "numba", "numpy", "scipy"}
    assert stored(name).splitlines()[:2] == made_now.splitlines()[:2]


def test_every_result_has_a_study_and_every_study_its_results():
    made = {f"{name}.toml" for name in NAMES}
    for name in NAMES:
        study = import_module(f"studies.{name}")
        made |= {path.name for path in command.files(study, name)}
    there = {path.name for path in command.RESULTS.iterdir() if path.suffix != ".part"}
    judged = {f"{name}.verdicts.json" for name in documents()}  # by `make judge`, of every document
    assert there == made | judged | {"README.md"}


def test_without_a_name_all_studies_are_listed(capsys):
    command.main([])
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_the_help_says_what_a_study_computes_and_what_it_costs(name, capsys):
    command.main([name, "--help"])
    first, empty, second = capsys.readouterr().out.splitlines()[:3]
    assert first.endswith(".") and not empty
    assert any(unit in second.lower() for unit in ("second", "minute")), second


def test_an_unknown_study_is_named_with_those_that_there_are(capsys):
    with pytest.raises(SystemExit):
        command.main(["guess"])
    told = capsys.readouterr().err
    assert "invalid choice: 'guess'" in told and all(name in told for name in NAMES)


@pytest.fixture
def squares(monkeypatch):
    """Return a study of squares that is interrupted at the run `stop`, and what it worked on."""
    study = ModuleType("studies.squares")
    study.PARAMETERS, study.FILES = {"seed": 1, "levels": [0, 1, 2]}, (".a.json", ".b.bin")
    study.worked, study.stop = [], None

    def compute(settings, seed, runs):
        if study.stop in runs:
            raise KeyboardInterrupt
        study.worked += runs
        return {"square": [settings["levels"][run] ** 2 + settings["more"] for run in runs]}

    study.parts = lambda: [({"more": 0}, 3, 1), ({"more": 10}, 2, 2)]
    study.compute = compute
    study.contents = lambda found: [
        json.dumps(found[0]["square"].tolist()),
        bytes(found[1]["square"]),
    ]
    monkeypatch.setitem(sys.modules, "studies.squares", study)
    monkeypatch.setattr(command, "about", lambda name: "Squares.\n\nA second.")
    return study


def test_a_study_writes_all_its_files_and_what_made_them(squares, tmp_path):
    command.run("squares", tmp_path)
    assert (tmp_path / "squares.a.json").read_text() == "[0, 1, 4]"
    assert (tmp_path / "squares.b.bin").read_bytes()[::8] == bytes([10, 11])
    told = tomllib.loads((tmp_path / "squares.toml").read_text())
    assert told["parameters"] == squares.PARAMETERS
    assert len(list(tmp_path.iterdir())) == 3


def test_an_interrupted_study_writes_nothing_and_goes_on(squares, tmp_path, capsys):
    squares.stop = 2
    with pytest.raises(KeyboardInterrupt):
        command.run("squares", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["squares.part"]
    squares.stop = None
    command.run("squares", tmp_path)
    assert squares.worked == [0, 1, 2, 0, 1]
    assert (tmp_path / "squares.a.json").read_text() == "[0, 1, 4]"
    assert "squares 1/2 [" in capsys.readouterr().err


def test_a_failure_while_the_files_are_written_loses_no_run(squares, tmp_path):
    (tmp_path / "squares.b.bin").mkdir()  # cannot be written to
    with pytest.raises(ValueError, match="path must be"):
        command.run("squares", tmp_path)
    (tmp_path / "squares.b.bin").rmdir()
    command.run("squares", tmp_path)
    assert squares.worked == [0, 1, 2, 0, 1]


def test_other_parameters_are_refused_with_the_folder_that_is_in_the_way(squares, tmp_path):
    squares.stop = 2
    with pytest.raises(KeyboardInterrupt):
        command.run("squares", tmp_path)
    squares.PARAMETERS["seed"] = 2
    with pytest.raises(ValueError, match="seed differ; remove it to begin anew") as error:
        command.run("squares", tmp_path)
    assert str(tmp_path / "squares.part") in str(error.value)


def test_of_two_at_once_one_waits_for_the_other(squares, tmp_path):
    with ThreadPoolExecutor(2) as two:
        for one in [two.submit(command.run, "squares", tmp_path) for _ in range(2)]:
            one.result()
    assert squares.worked == 2 * [0, 1, 2, 0, 1]
    assert len(list(tmp_path.iterdir())) == 3


@pytest.mark.parametrize(
    ("arguments", "kind"),
    [([], NoneType), (["--workers", "1"], NoneType), (["--workers", "2"], ProcessPoolExecutor)],
)
def test_workers_are_processes(arguments, kind, monkeypatch):
    ran = []
    monkeypatch.setattr(command, "run", lambda name, executor: ran.append((name, type(executor))))
    command.main(["stopping", *arguments])
    assert ran == [("stopping", kind)]


def test_a_cluster_without_dask_names_the_command_that_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ModuleNotFoundError, match=r'pip install "dopplerlib\[cluster\]"'):
        command.main(["stopping", "--scheduler", "tcp://localhost:1"])


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("consistent_tracker", {"case": "A", "tracker": "ekf", "assumed": "right"}),
        ("turned_ring", {"gate": "none", "start": "as drawn", "runs": 2}),
        ("yardsticks", {"case": "D"}),
    ],
)
def test_a_run_has_the_same_bits_alone_and_among_others(name, settings):
    """So that a study may be divided in any way."""
    study = import_module(f"studies.{name}")
    seed, runs = study.PARAMETERS["seed"], range(2, 5)
    together = study.compute(settings, seed, runs)
    for place, run in enumerate(runs):
        alone = study.compute(settings, seed, range(run, run + 1))
        for key, values in together.items():
            np.testing.assert_array_equal(alone[key][0], values[place])
