"""The matrix tries every Python that is found, goes on after a failure, and tells of it."""

import json
import sys

import pytest
import yaml

from tools import matrix as tool


@pytest.fixture
def python(tmp_path):
    """Return a function that makes a program which says that it is some Python."""

    def make(name, answer, code=0):
        path = tmp_path / name
        path.write_text(f"#!/bin/sh\necho '{json.dumps(answer)}'\nexit {code}\n")
        path.chmod(0o755)
        return str(path)

    return make


def test_of_each_version_the_newest_cpython_is_taken_and_what_does_not_run_is_left_out(python):
    programs = [
        python("a", ["CPython", 3, 12, 1]),
        python("b", ["CPython", 3, 12, 10]),
        python("c", ["CPython", 3, 11, 7]),
        python("d", ["PyPy", 3, 11, 9]),
        python("e", ["CPython", 3, 10, 13]),
        python("f", ["CPython", 3, 13, 0], code=127),  # as pyenv has them
    ]
    assert tool.interpreters(programs) == {
        (3, 11): ("3.11.7", programs[2]),
        (3, 12): ("3.12.10", programs[1]),
    }


def test_the_python_of_these_tests_is_one_that_is_tried():
    ((key, (version, program)),) = tool.interpreters([sys.executable]).items()
    assert key == sys.version_info[:2] and program == sys.executable
    assert sys.version.startswith(version)


@pytest.mark.parametrize("failing", [None, "3.11.7", "3.12.1"])
def test_a_failure_fails_the_whole_and_keeps_nothing_from_being_tried(
    monkeypatch, tmp_path, capsys, python, failing
):
    runs = []

    def tested(folder, program, lock):
        runs.append((program, lock.name))
        log = folder.with_suffix(".log")
        log.write_text("...\n2 passed in 1.0s\n", encoding="utf-8")
        return failing is None or failing not in program, log

    monkeypatch.setattr(tool, "tested", tested)
    monkeypatch.setattr(tool, "ROOT", tmp_path)
    monkeypatch.setattr(tool, "FOLDER", tmp_path / "matrix")
    programs = [python(v, ["CPython", *map(int, v.split("."))]) for v in ("3.12.1", "3.11.7")]
    assert tool.main(programs) == (failing is not None)
    assert runs == [
        (programs[1], "environment.lock"),
        (programs[0], "environment.lock"),
        (programs[1], "minimum.lock"),
    ]
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 3 and "CPython 3.11.7, minimum: " in out
    assert out.count("FAILS, see matrix/3_") == {None: 0, "3.11.7": 2, "3.12.1": 1}[failing]
    assert "not found: CPython 3.13, 3.14" in err


def test_where_no_python_is_found_nothing_has_passed(monkeypatch, tmp_path, python):
    monkeypatch.setattr(tool, "FOLDER", tmp_path / "matrix")
    assert tool.main([python("old", ["CPython", 3, 10, 13])]) == 1


def test_the_public_workflow_tries_the_same_pythons_and_the_oldest_packages():
    path = tool.ROOT / ".github" / "workflows" / "test.yml"
    jobs = yaml.safe_load(path.read_text(encoding="utf-8"))["jobs"]
    names = [f"{major}.{minor}" for major, minor in tool.TRIED]
    assert jobs["test"]["strategy"]["matrix"]["python"] == names
    steps = [step for step in jobs["oldest"]["steps"] if "with" in step]
    assert [step["with"]["python-version"] for step in steps] == names[:1]
