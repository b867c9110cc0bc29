"""The lock files belong together: `make lock` renews all of them, and may be killed in between."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HINT = "run `make lock`"


def pinned(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    return dict(re.findall(r"^([\w.-]+)==([^\s;]+)", text, flags=re.MULTILINE))


def floors():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    needs = [*project["dependencies"], *(need for extra in extras for need in extra)]
    return [need.split(">=") for need in needs]


@pytest.mark.parametrize("lock", ["benchmarks/requirements.lock", ".binder/requirements.txt"])
def test_benchmarks_and_notebooks_run_with_the_versions_of_the_environment(lock):
    here, there = pinned("environment.lock"), pinned(lock)
    common = here.keys() & there.keys()
    assert {"numba", "numpy", "scipy"} <= common
    assert {name: here[name] for name in common} == {name: there[name] for name in common}, HINT


def test_notebooks_that_are_opened_have_all_that_the_library_may_need():
    there = pinned(".binder/requirements.txt")
    assert {name for name, _ in floors()} | {
        "ipykernel",
        "jupyterlab",
        "setuptools",
    } <= there.keys()


@pytest.mark.parametrize(("name", "floor"), floors())
def test_the_oldest_packages_are_those_that_the_project_allows(name, floor):
    oldest = pinned("tests/minimum.lock")[name]
    assert [int(n) for n in oldest.split(".")] == [int(n) for n in (floor + ".0.0").split(".")][:3]


def test_the_oldest_packages_are_tested_with_the_tests_of_today():
    here, oldest = pinned("environment.lock"), pinned("tests/minimum.lock")
    for name in ("hypothesis", "nbval", "pytest", "pytest-xdist"):
        assert here[name] == oldest[name], HINT
