"""Every record compares, hashes, copies, pickles and stays as it is."""

import copy
import dataclasses
import importlib
import inspect
import pickle
import pkgutil
import timeit
from collections.abc import Hashable

import numpy as np
import pytest

import dopplerlib
from dopplerlib import RadarArray, Track, kf
from dopplerlib._records import record
from tests.together import each


def dataclasses_of_the_library():
    """Return every dataclass that a module of the library defines."""
    found = {}
    for module in pkgutil.walk_packages(dopplerlib.__path__, "dopplerlib."):
        if module.name.endswith("__main__"):
            continue
        for value in vars(importlib.import_module(module.name)).values():
            # The attribute itself: a package of lazy names would be asked for it.
            if inspect.isclass(value) and "__dataclass_fields__" in vars(value):
                found[f"{value.__module__}.{value.__qualname__}"] = value
    return found


RECORDS = dataclasses_of_the_library()


def values(shift=0.0):
    """Return a value of each kind that a field may hold, in turn, with its arrays writable."""
    while True:
        yield np.array([[1.0 + shift, np.nan], [0.0, 3.0]])
        yield {"a": np.array([1 + 2j, shift]), "b": [np.nan, 2]}
        yield np.nan
        yield np.arange(3)
        yield [1.0, np.array([True, False]), "text"]
        yield "text"


def filled(cls, shift=0.0):
    """Return an instance whose fields hold `values`, past the checks of its constructor."""
    made = object.__new__(cls)
    names = [field.name for field in dataclasses.fields(cls)]
    made.__setstate__(dict(zip(names, values(shift), strict=False)))
    return made


def arrays(value):
    """Yield every array inside a value."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, dict):
        for one in value.values():
            yield from arrays(one)
    elif isinstance(value, tuple):
        for one in value:
            yield from arrays(one)


def test_the_search_finds_records_of_every_package():
    packages = {name.split(".")[1] for name in RECORDS}
    wanted = {"model", "signal", "estimation", "tracking", "chain", "evaluation", "replication"}
    assert wanted | {"systems", "derive"} <= packages
    assert len(RECORDS) >= 65


@pytest.mark.parametrize("name", RECORDS)
def test_every_dataclass_is_a_record(name):
    cls = RECORDS[name]
    assert cls.__eq__.__module__ == cls.__hash__.__module__ == record.__module__
    assert cls.__dataclass_params__.frozen


@pytest.mark.parametrize("name", RECORDS)
def test_equal_records_are_equal_and_have_one_hash(name):
    one, two, other = filled(RECORDS[name]), filled(RECORDS[name]), filled(RECORDS[name], 0.5)
    assert (one == two) is True
    assert (one != two) is False
    assert one in [two]
    assert hash(one) == hash(two)
    assert len({one, two, other}) == 2
    assert (one == other) is False
    assert (one == "a text") is False


@pytest.mark.parametrize("name", RECORDS)
def test_a_copy_and_a_pickle_are_equal_and_stay_frozen(name):
    one = filled(RECORDS[name])
    if "<locals>" in name:
        pytest.skip("what a function defines cannot be pickled")

    def check(made):
        assert made == one
        for field in dataclasses.fields(made):
            with pytest.raises(dataclasses.FrozenInstanceError, match=field.name):
                setattr(made, field.name, 1)
            for array in arrays(getattr(made, field.name)):
                with pytest.raises(ValueError, match="read-only"):
                    array[...] = 0

    pickled = [pickle.loads(pickle.dumps(one, protocol)) for protocol in (2, 5)]
    each([(one,), (copy.copy(one),), (copy.deepcopy(one),), *((two,) for two in pickled)], check)


def test_a_record_is_hashable_and_another_class_with_the_same_fields_is_another_record():
    @record
    class One:
        x: float

    @record
    class Two:
        x: float

    assert isinstance(One(1.0), Hashable)
    assert One(1.0) != Two(1.0)


@record
class Box:
    """Holds anything."""

    value: object


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (np.array([1, 2]), np.array([1.0, 2.0])),
        (np.array([1, 0]), np.array([True, False])),
        (np.array([0.0]), np.array([-0.0])),
        (np.array([0.5, 2.0], np.float32), np.array([0.5, 2.0])),
        (np.array([1.0 + 0j]), np.array([1])),
        (np.array([np.nan, 1.0]), np.array([-np.nan, 1.0 + 0j])),
        (np.array(["2020", "NaT"], "M8[s]"), np.array(["2020", "NaT"], "M8[ms]")),
        (np.array(["a"]), np.array(["a"], "U9")),
        (np.array([None, np.nan]), np.array([None, np.nan])),
        (np.arange(1e6), np.arange(10**6)[::-1].copy()[::-1]),
        ([1, np.nan], (1.0, float("nan"))),
        (1, 1.0),
        ({1, 2}, {2, 1}),
        (np.longdouble("1e4000") * np.ones(2), np.longdouble("1e4000") * np.ones(2)),
    ],
)
def test_values_decide_and_not_their_type(one, two):
    assert Box(one) == Box(two)
    assert hash(Box(one)) == hash(Box(two))


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (np.zeros(3), np.zeros((1, 3))),
        (np.zeros(3), np.zeros(4)),
        (np.zeros(1), 0.0),
        (np.zeros(2), [0.0, 0.0]),
        (np.array([np.nan]), np.array([0.0])),
        (np.array(["1"]), np.array([1])),
        (np.array([1], object), np.array([1])),
        (np.array([1], "m8[s]"), np.array([1])),
        ({"a": 1}, {"a": 2}),
        ({"a": 1}, {"b": 1}),
        ((1, 2), (1, 2, 3)),
        (None, np.nan),
    ],
)
def test_values_that_differ_make_records_that_differ(one, two):
    assert Box(one) != Box(two)
    assert Box(two) != Box(one)


def test_a_record_leaves_the_caller_s_array_writable_and_takes_no_copy():
    mine = np.zeros(3)
    held = Box(mine).value
    assert mine.flags.writeable
    assert not held.flags.writeable
    assert np.shares_memory(mine, held)
    again = pickle.loads(pickle.dumps(Box(mine))).value
    assert not np.shares_memory(mine, again)


def test_what_checks_its_arguments_copies_them():
    mine = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    array = RadarArray(mine)
    mine[1, 1] = 5.0
    assert array.positions[1, 1] == 1.0


def test_a_dict_in_a_record_cannot_be_written_to_and_is_no_longer_the_caller_s():
    mine = {"a": 1}
    held = Box(mine).value
    mine["a"] = 2
    assert held == {"a": 1}
    for write in (
        lambda: held.update(a=2), lambda: held.__setitem__("a", 2), lambda: held.pop("a"),
        held.clear, held.popitem, lambda: held.setdefault("b", 1), lambda: held.__delitem__("a"),
        lambda: held.__ior__({"a": 3}),
    ):  # fmt: skip
        with pytest.raises(TypeError, match="frozen"):
            write()
    assert dict(held) == {"a": 1}


def test_a_track_is_made_in_microseconds():
    track = kf([[1.0], [2.0]], [[1]], [[1]], [[1]], [[1]], [0.0], [[1.0]])
    fields = [np.array(getattr(track, field.name)) for field in dataclasses.fields(Track)]
    # 3 us here; the bound is for a machine that is busy with something else.
    assert min(timeit.repeat(lambda: Track(*fields), number=1000, repeat=5)) < 0.05


def test_what_a_check_returns_takes_the_place_of_fields():
    @record
    class Rounded:
        """A number and a list."""

        number: float
        others: list

        def __post_init__(self):
            return {"number": round(self.number)}

    rounded = Rounded(1.2, [1])
    assert (rounded.number, rounded.others) == (1, (1,))
