"""Editors and type checkers see what there is: hints on the public edge, stubs of what is lazy."""

import ast
import inspect
from importlib import import_module
from pathlib import Path
from typing import get_overloads

import pytest

import dopplerlib
from tools.stubs import LIBRARY, stubs

PACKAGES = ("model", "signal", "estimation", "tracking", "chain", "evaluation", "replication")
MODULES = sorted(
    f"dopplerlib.{package}.{path.stem}"
    for package in PACKAGES
    for path in (LIBRARY / package).glob("*.py")
    if not path.stem.startswith("_")
)


def edge(module):
    """Return {name: function} of the public functions of a module and of its records."""
    own = {
        name: value
        for name, value in vars(module).items()
        if name in vars(module).get("__all__", ())
        or (getattr(value, "__module__", "") == module.__name__ and not name.startswith("_"))
    }
    found = {name: value for name, value in own.items() if inspect.isfunction(value)}
    for owner, cls in own.items():
        for name, value in vars(cls).items() if inspect.isclass(cls) else ():
            function = value.fget if isinstance(value, property) else inspect.unwrap(value)
            function = getattr(function, "__func__", function)
            if inspect.isfunction(function) and not name.startswith("_"):
                found[f"{owner}.{name}"] = function
    return found


@pytest.mark.parametrize("name", MODULES)
def test_every_argument_and_result_of_the_public_edge_has_a_hint(name):
    for function, value in edge(import_module(name)).items():
        for signature in map(inspect.signature, get_overloads(value) or [value]):
            check_hints(function, signature)


def check_hints(function, signature):
    hints = {p.name: p.annotation for p in signature.parameters.values()}
    hints["return"] = signature.return_annotation
    bare = {one for one, hint in hints.items() if hint is inspect.Signature.empty}
    assert bare <= {"self", "cls"}, function


def test_what_the_library_gives_at_its_top_is_of_these_modules():
    assert {f"dopplerlib.{home}" for home in dopplerlib._HOME.values()} <= set(MODULES)


def test_methods_and_properties_are_of_the_edge():
    scenario = edge(import_module("dopplerlib.model.scenario"))
    assert {"Scenario.from_toml", "Scenario.time"} <= scenario.keys()
    assert "simulate" in edge(import_module("dopplerlib.model.simulation"))


def test_the_stubs_are_those_of_the_packages():
    found = stubs()
    assert set(LIBRARY.rglob("*.pyi")) == found.keys()
    for path, text in found.items():
        assert path.read_text(encoding="utf-8") == text, "run: make format"


def test_a_constructor_for_type_checkers_takes_the_fields():
    seen = []
    for path in LIBRARY.rglob("*.py"):
        tree = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        for cls in (node for node in tree if isinstance(node, ast.ClassDef)):
            fields = [node for node in cls.body if isinstance(node, ast.AnnAssign)]
            for node in (node for node in cls.body if isinstance(node, ast.If)):
                (init,) = node.body
                assert [one.arg for one in init.args.args[1:]] == [one.target.id for one in fields]
                defaults = [ast.dump(one.value) for one in fields if one.value]
                assert list(map(ast.dump, init.args.defaults)) == defaults
                seen.append(cls.name)
    assert {"RadarArray", "Scenario"} <= set(seen)


def test_the_library_says_that_it_is_typed():
    assert (Path(dopplerlib.__file__).parent / "py.typed").is_file()
