"""The library outside its checkout: what is in sdist and wheel, and where an installation runs."""

import compileall
import fnmatch
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import numpy as np
import pytest

import dopplerlib
from tests.wheel.calls import EXTRAS, part_calls

ROOT = Path(__file__).resolve().parents[2]
# What a build adds: an unpacked sdist has it, too.
GENERATED = {"PKG-INFO", "setup.cfg"}
LEFTOVERS = (
    "book/_build/html/index.html",
    "results/.partial-0.csv",
    "dopplerlib/figures/__pycache__/style.cpython-311.pyc",
    "tests/.ruff_cache/CACHEDIR.TAG",
)
SDIST = "import sys; from setuptools import build_meta; build_meta.build_sdist(sys.argv[1])"
WHEEL = SDIST.replace("sdist", "wheel")
# Nothing compiled can be kept: it is compiled sooner still.
NOWHERE = {"HOME": "/dev/null", "PYTHONDONTWRITEBYTECODE": "1", "NUMBA_OPT": "0"}


def ignored(path):
    """Return whether .gitignore leaves out a path, given relative to the root of the project."""
    patterns = (ROOT / ".gitignore").read_text(encoding="utf-8").split()
    return any(
        path.as_posix().startswith(pattern)
        if "/" in pattern.rstrip("/")
        else any(fnmatch.fnmatch(part, pattern.rstrip("/")) for part in path.parts)
        for pattern in patterns
    )


def project_files():
    """Return the files of the project, and which of them are tracked: all, where there is no git.

    In a checkout a new file is of the project before it is tracked.
    """
    tracked, new = (listed(*options) for options in ((), ("--others", "--exclude-standard")))
    if tracked is not None:
        return tracked | new, tracked
    files = set()
    for folder, folders, names in os.walk(ROOT):
        here = Path(folder).relative_to(ROOT)
        folders[:] = [name for name in folders if name != ".git" and not ignored(here / name)]
        files |= {(here / name).as_posix() for name in names if not ignored(here / name)}
    return (files - {".git"} - GENERATED,) * 2


def listed(*options):
    """Return the files that git lists, or None where it cannot."""
    if shutil.which("git") is None:
        return None
    git = ["git", "-C", str(ROOT), "ls-files", "-z", *options]
    done = subprocess.run(git, capture_output=True, check=False)
    names = set(done.stdout.decode().split("\0")) - {""}
    return None if done.returncode else {name for name in names if (ROOT / name).is_file()}


@pytest.fixture(scope="module")
def sdist(tmp_path_factory):
    """Return the sdist, made from a copy of the project with leftovers of all kinds in it."""
    folder = tmp_path_factory.mktemp("sdist")
    for name in (*project_files()[0], *LEFTOVERS):
        target = folder / "project" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(b"" if name in LEFTOVERS else (ROOT / name).read_bytes())
    run([sys.executable, "-c", SDIST, str(folder)], cwd=folder / "project")
    (made,) = folder.glob("*.tar.gz")
    return made


@pytest.fixture(scope="module")
def wheel(sdist):
    """Return the wheel that the sdist builds, without a network."""
    shutil.unpack_archive(sdist, sdist.parent / "unpacked", filter="data")
    (project,) = (sdist.parent / "unpacked").iterdir()
    run([sys.executable, "-c", WHEEL, str(sdist.parent)], cwd=project)
    (made,) = sdist.parent.glob("*.whl")
    return made


@pytest.fixture(scope="module")
def installed(wheel):
    """Return the folder in which the wheel is installed."""
    folder = wheel.parent / "installed"
    pip("install", "--no-compile", "--target", folder, wheel)
    return folder


@pytest.fixture(scope="module")
def elsewhere(installed, tmp_path_factory):
    """Return what was told of the library in each of three other places, used side by side.

    Nothing compiled can be kept in any of them.
    """
    folder = tmp_path_factory.mktemp("elsewhere")
    roots = {name: folder / name for name in ("read-only", "sourceless")}
    for root in roots.values():
        ignore = shutil.ignore_patterns("__pycache__")
        shutil.copytree(installed / "dopplerlib", root / "dopplerlib", ignore=ignore)
    archive = shutil.make_archive(str(folder / "library"), "zip", roots["read-only"])
    # So that no folder can be made, by root neither.
    for path in [*roots["read-only"].rglob("*")]:
        if path.is_dir():
            (path / "__pycache__").write_bytes(b"")
    # Compiled as by -OO, which would compile all of NumPy, SciPy and SymPy so, too.
    assert compileall.compile_dir(roots["sourceless"], quiet=1, legacy=True, optimize=2)
    for path in roots["sourceless"].rglob("*.py"):
        path.unlink()
    roots["zip"] = Path(archive)
    told = used([*roots.values()], "quick", **NOWHERE)
    return {name: told[str(root)] for name, root in roots.items()}


def pip(command, *arguments):
    options = ["-q", "--no-deps", "--no-index", "--no-cache-dir", "--disable-pip-version-check"]
    run([sys.executable, "-m", "pip", command, *options, *map(str, arguments)], cwd=ROOT.parent)


def run(command, **settings):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **settings)
    assert done.returncode == 0, done.stderr
    return done.stdout


def used(roots, *options, flags=(), **environment):
    """Import and call all that is at each root, from an empty folder; return what was told of it.

    One process imports what they depend on, which takes longer than the library itself, and its
    copies use one of them each.
    """
    empty = Path(environment.setdefault("MPLCONFIGDIR", str(roots[0].parent / "matplotlib")))
    empty.mkdir(exist_ok=True)
    told = ("NUMBA", "XDG", "PYTHON")
    inherited = {key: value for key, value in os.environ.items() if not key.startswith(told)}
    inherited["NUMBA_OPT"] = "1"  # compiles sooner; what the bits are is no question here
    command = [sys.executable, *flags, "-I", "-S", str(ROOT / "tests" / "wheel" / "calls.py")]
    libraries = sysconfig.get_path("purelib")
    where = os.pathsep.join(map(str, roots))
    told = run([*command, libraries, where, *options], cwd=empty, env=inherited | environment)
    lines = [json.loads(line) for line in told.splitlines() if line.startswith("{")]
    assert [line["packages"] for line in lines] == [[True] * 3] * len(roots)
    return {line["root"]: line for line in lines}


def test_every_part_of_the_library_is_called():
    """The files of all documents are read by one of the calls."""
    packages = {path.parent.name for path in (ROOT / "dopplerlib").glob("*/__init__.py")}
    assert packages - {"derive", "figures"} <= {
        name.split(",")[0] for name in part_calls(dopplerlib, np)
    }


@pytest.mark.skipif(listed() is None, reason="git is not here, or has no project here")
def test_the_files_of_the_project_are_known_without_git(monkeypatch):
    files, _ = project_files()
    monkeypatch.setattr("shutil.which", lambda name: None)
    assert project_files() == (files, files)


def test_the_sdist_holds_what_is_tracked_and_no_leftovers(sdist):
    with tarfile.open(sdist) as archive:
        files = [member.name for member in archive.getmembers() if member.isfile()]
    held = {name.partition("/")[2] for name in files if ".egg-info/" not in name} - GENERATED
    files, tracked = project_files()
    assert tracked - held == set()
    assert held - files == set()


def test_the_wheel_holds_the_library_and_its_data(wheel):
    library = {name for name in project_files()[0] if name.startswith("dopplerlib/")}
    data = {
        f"dopplerlib/{name}"
        for name in project_files()[0]
        if name.startswith(("data/", "results/"))
    }
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert names == library | data
    assert {f"dopplerlib/{name}" for name in ("py.typed", "figures/style.mplstyle")} <= names
    assert wheel.stat().st_size < 3.5e6  # two thirds of it what the studies found, run by run


def test_everything_works_where_it_is_installed_with_warnings_as_errors_and_a_strict_numpy(
    installed,
):
    told = used([installed], "strict", flags=("-W", "error"))[str(installed)]
    assert told["errors"] == [] and "spawn" in told["calls"]
    modules = {
        path.relative_to(installed).with_suffix("").as_posix().replace("/", ".")
        for path in (installed / "dopplerlib").rglob("*.py")
        if path.stem not in ("__init__", "__main__")
    }
    assert modules <= set(told["imports"])


def test_without_extras_all_else_works_and_they_are_named_with_their_command(installed):
    told = used([installed], "core", NUMBA_DISABLE_JIT="1")[str(installed)]
    assert len(told["errors"]) == len(EXTRAS)
    for name, extra in EXTRAS.items():
        (error,) = (error for error in told["errors"] if f"{name} is needed here" in error)
        assert f'pip install "dopplerlib[{extra}]"' in error


def test_it_runs_where_nothing_can_be_written(elsewhere):
    assert elsewhere["read-only"]["errors"] == []


def test_it_runs_from_a_zip_file_without_a_home(elsewhere):
    assert elsewhere["zip"]["errors"] == []


def test_it_runs_without_its_sources_docstrings_and_assertions(elsewhere):
    assert elsewhere["sourceless"]["errors"] == []
