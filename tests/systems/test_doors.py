"""Every room of the systems has the same doors."""

import inspect
import pkgutil
from dataclasses import fields, is_dataclass
from importlib import import_module

import pytest

from dopplerlib.replication.documents import documents
from dopplerlib.replication.published import Published


def modules(room):
    """Yield (name within the room, module) of its public modules but those of the evidence."""
    package = import_module(f"dopplerlib.systems.{room}")
    for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        name = found.name.removeprefix(f"{package.__name__}.")
        if "._" not in found.name and not found.ispkg and name.split(".")[0] != "evidence":
            yield name, import_module(found.name)


def offered(module):
    """Return what a module makes that has a name without an underscore: functions and records."""
    return {
        name
        for name, value in vars(module).items()
        if getattr(value, "__module__", "") == module.__name__ and not name.startswith("_")
        if inspect.isfunction(inspect.unwrap(value)) or inspect.isclass(value)
    }


@pytest.fixture(params=documents())
def room(request):
    """Return each room."""
    return request.param


def test_a_room_gives_every_public_function_and_record_of_its_modules(room):
    home = import_module(f"dopplerlib.systems.{room}")._HOME
    for name, module in modules(room):
        assert {key for key, where in home.items() if where == name} >= offered(module), name
    assert import_module(f"dopplerlib.systems.{room}").__all__ == sorted(home)


def test_no_module_of_a_room_has_the_name_of_something_that_it_gives(room):
    package = import_module(f"dopplerlib.systems.{room}")
    assert not {name.split(".")[0] for name, _ in modules(room)} & set(package.__all__)


def test_what_the_document_states_is_one_record_whose_parts_have_a_source(room):
    reported = import_module(f"dopplerlib.systems.{room}.published").reported
    found = reported()
    assert reported() is found and is_dataclass(found)
    parts = {field.name: getattr(found, field.name) for field in fields(found)}
    # A part that is a `Published` says itself where it stands; it may be told here as well.
    others = {name for name, part in parts.items() if not isinstance(part, Published)}
    assert others - {"sources"} <= found.sources.keys() <= parts.keys()
    assert all(found.sources.values())


def test_the_evidence_is_one_function_of_a_generator(room):
    module = import_module(f"dopplerlib.systems.{room}.evidence")
    assert {name for name in offered(module) if name != "evidence"} == set()
    rng = inspect.signature(module.evidence).parameters["rng"]
    assert rng.kind is rng.KEYWORD_ONLY and rng.default is rng.empty


def test_no_two_rooms_give_different_things_under_one_name():
    doors = {"Reported", "reported"}
    homes = [
        set(import_module(f"dopplerlib.systems.{room}").__all__) - doors for room in documents()
    ]
    assert sum(map(len, homes)) == len(set().union(*homes))
