"""`make` finds out whether an environment is the one that belongs here, and makes it if not.

Packages are not installed by these tests: the steps that would do so are replaced by one that
leaves a line in a file. That the real ones work is seen by whoever runs the tests by `make test`.
"""

import json
import os
import shutil
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tools import environment as tool

ROOT = Path(__file__).resolve().parents[2]
STUB = """#!/bin/sh
[ "$2" = tools.environment ] || exec {python} "$@"
shift 2
exec {python} - "$@" << 'END'
import sys
import tools.environment as tool
from tools.command import start

{before}
step = "mkdir -p .venv/bin; cp /bin/sh .venv/bin/python; sleep {seconds}; echo made >> log"
tool.steps = lambda folder, lock, temporary: dict(all=[["sh", "-c", step]])
start(tool.main)
END
"""


@pytest.fixture
def checkout(tmp_path):
    """Return a folder with all that `make` needs to make an environment."""
    folder = tmp_path / "checkout"
    shutil.copytree(ROOT / "tools", folder / "tools", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("Makefile", "pyproject.toml", "setup.py", "environment.lock"):
        shutil.copy(ROOT / name, folder)
    return folder


@pytest.fixture
def interpreter(tmp_path):
    """Return a function that makes a Python whose environments are quickly made."""

    def make(name, before="", seconds=0):
        path = tmp_path / name
        path.write_text(STUB.format(python=sys.executable, before=before, seconds=seconds))
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return path

    return make


def begin(folder, python):
    env = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
    return subprocess.Popen(
        ["make", "--silent", f"PYTHON={python}", ".venv/.ready"],
        cwd=folder,
        env=env,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def made(folder, python):
    """Run `make`; return whether it made the environment, and what it said."""
    before = made_before(folder)
    process = begin(folder, python)
    _, err = process.communicate()
    assert process.returncode == 0, err
    return made_before(folder) - before, err


def made_before(folder):
    log = folder / "log"
    return log.read_text().count("made") if log.exists() else 0


def test_an_environment_is_made_once_and_anew_for_another_place_python_or_lock(
    checkout, interpreter
):
    python = interpreter("python")
    assert made(checkout, python)[0] == 1
    assert made(checkout, python) == (0, "")

    copy = checkout.with_name("copy")
    shutil.copytree(checkout, copy, symlinks=True)
    found, err = made(copy, python)
    assert found == 1 and f"checkout was {checkout}, is {copy}" in err
    assert made(checkout, python) == (0, "")

    moved = copy.rename(checkout.with_name("moved"))
    assert made(moved, python)[0] == 1

    found, err = made(moved, interpreter("another", "sys.version = '3.99'"))
    assert found == 1 and "is 3.99" in err
    assert made(moved, interpreter("elsewhere", "sys.base_prefix = '/opt'"))[0] == 1

    assert made(moved, python)[0] == 1
    with (moved / "environment.lock").open("a") as file:
        file.write("# unpacked over\n")
    os.utime(moved / "environment.lock", (0, 0))  # as old as its commit
    assert made(moved, python)[0] == 1
    assert made(moved, python) == (0, "")


def test_two_at_once_make_one_environment(checkout, interpreter):
    python = interpreter("python", seconds=1)
    processes = [begin(checkout, python) for _ in range(2)]
    told = "".join(process.communicate()[1] for process in processes)
    assert [process.returncode for process in processes] == [0, 0]
    assert made_before(checkout) == 1
    assert "waiting for another process that is busy with .venv" in told


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_make_that_was_killed_is_repaired_by_the_next_one(checkout, interpreter, number):
    process = begin(checkout, interpreter("slow", seconds=0.7))
    while not (checkout / ".venv" / "bin" / "python").exists():
        time.sleep(0.02)
    os.killpg(process.pid, number)
    _, err = process.communicate()
    assert process.returncode != 0 and "Traceback" not in err
    assert not (checkout / ".venv" / ".ready").exists()
    assert made(checkout, interpreter("python"))[0] == 1


def test_a_step_that_fails_fails_make_and_leaves_no_ready_environment(checkout, interpreter):
    python = interpreter("python", before="sys.exit = None", seconds="none")
    python.write_text(python.read_text().replace("echo made >> log", "exit 3"))
    process = begin(checkout, python)
    process.communicate()
    assert process.returncode != 0
    assert not (checkout / ".venv" / ".ready").exists()


@pytest.fixture
def folder(tmp_path):
    """Return the folder of an environment that is what is wanted."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python").symlink_to(sys.executable)
    (tmp_path / tool.READY).write_text(json.dumps(wanted()))
    return tmp_path


def wanted():
    return tool.wanted(ROOT / "environment.lock")


def test_nothing_is_wrong_with_what_is_wanted(folder):
    assert tool.reasons(folder, wanted()) == []


@pytest.mark.parametrize("name", wanted())
def test_whatever_differs_is_named(folder, name):
    (reason,) = tool.reasons(folder, wanted() | {name: "another"})
    assert reason.startswith(name) and reason.endswith("is another")


@pytest.mark.parametrize("text", ["", "{", "[]", '{"checkout": 1}'])
def test_what_an_older_or_killed_make_has_left_is_not_ready(folder, text):
    (folder / tool.READY).write_text(text)
    assert tool.reasons(folder, wanted())


def test_an_environment_without_its_interpreter_is_not_ready(folder):
    (folder / "bin" / "python").unlink()
    (folder / "bin" / "python").symlink_to(folder / "removed")
    assert tool.reasons(folder, wanted()) == ["its Python is gone"]


def test_what_pyproject_says_of_the_library_counts_and_what_it_says_of_tests_does_not(tmp_path):
    def needs(change):
        text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
        changed = text.replace(*change)
        assert changed != text
        (tmp_path / "pyproject.toml").write_text(changed, encoding="utf-8")
        return tool.wanted(ROOT / "environment.lock", tmp_path)["needs"]

    shutil.copy(ROOT / "setup.py", tmp_path)
    now = wanted()["needs"]
    assert needs(("numpy>=", "numpy>")) != now
    assert needs(("line-length = 100", "line-length = 99")) == now
    (tmp_path / "setup.py").write_text("")
    assert needs(("line-length = 100", "line-length = 99")) != now


def entries(lock):
    """Return the entries of a lock, a line each, with all of their hashes."""
    found = lock.read_text(encoding="utf-8").replace("\n ", "\a").splitlines()
    assert all("==" in entry and "--hash=sha256:" in entry for entry in found)
    return found


@pytest.mark.parametrize("name", ["environment.lock", "benchmarks/requirements.lock"])
def test_the_parts_of_a_lock_are_an_installer_and_the_lock(tmp_path, name):
    installer, *halves = map(entries, tool.parts(ROOT / name, tmp_path))
    assert [entry.partition("==")[0] for entry in installer] == ["pip"]
    assert abs(len(halves[0]) - len(halves[1])) <= 1
    assert sorted(halves[0] + halves[1]) == sorted(entries(ROOT / name))


@pytest.mark.skipif(tool.bundled() is None, reason="Python came without pip")
def test_the_pip_that_comes_with_python_runs_from_its_file():
    command = [sys.executable, "-I", tool.bundled() / "pip", "--version"]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert str(tool.bundled()) in told


@pytest.mark.parametrize(
    ("found", "venv", "pip"),
    [(Path("/a/pip-1.whl"), "venv --without-pip", "/a/pip-1.whl/pip"), (None, "venv", "-m pip")],
)
def test_where_python_came_without_pip_venv_has_to_bring_one(
    tmp_path, monkeypatch, found, venv, pip
):
    monkeypatch.setattr(tool, "bundled", lambda: found)
    steps = tool.steps(tmp_path, ROOT / "environment.lock", tmp_path)
    empty, installer, *_ = (" ".join(map(str, commands[0])) for commands in steps.values())
    assert empty.endswith(f"{venv} {tmp_path}")
    assert f"{pip} install" in installer


def test_of_commands_side_by_side_all_run_and_one_that_fails_fails_the_step(tmp_path, monkeypatch):
    commands = [["sh", "-c", f"echo >{tmp_path / name}; exit {code}"] for name, code in
                (("a", 0), ("b", 3), ("c", 0))]  # fmt: skip
    monkeypatch.setattr(tool, "steps", lambda *_: {"all": commands, "never": [["false"]]})
    folder = tmp_path / "folder"
    folder.mkdir()
    with open(tmp_path / "held", "w") as held:
        assert tool.make(folder, tmp_path / "lock", held.fileno()) == 3
    assert all((tmp_path / name).exists() for name in "abc")
