"""Arguments are checked by their hints."""

import copy
import inspect
import pickle
from collections.abc import Callable, Iterable
from typing import Annotated, Any, Literal

import numpy as np
import pytest

from dopplerlib._hints import (
    Booleans,
    Count,
    Covariance,
    Index,
    Measurements,
    Positive,
    Probability,
    Real,
    Reals,
    Runs,
    State,
    States,
    checked,
    exactly,
    shaped,
)
from dopplerlib._records import record
from dopplerlib._typing import ArrayLike, FloatArray

RNG = np.random.default_rng(1)


@checked
@record
class Pair:
    """Two numbers."""

    low: Real
    high: Real = 1.0


@checked
def function(a: Count, *, rng: np.random.Generator, kind: Literal["x", "y"] = "x") -> tuple:
    """Return its arguments."""
    return a, rng, kind


def refusal(hint, value):
    """Return how an argument with this hint is refused, or what the function gets."""

    def inner(argument):
        return argument

    inner.__annotations__ = {"argument": hint}
    try:
        return checked(inner)(value)
    except ValueError as error:
        return str(error)


def test_name_docstring_signature_and_pickle_stay():
    assert function.__name__ == "function" and function.__doc__ == "Return its arguments."
    assert list(inspect.signature(function).parameters) == ["a", "rng", "kind"]
    assert pickle.loads(pickle.dumps(function)) is function
    assert copy.deepcopy(function) is function


def test_what_is_right_comes_through():
    assert function(np.int64(3), rng=RNG, kind="y") == (3, RNG, "y")
    assert function(3, rng=RNG) == (3, RNG, "x")


def test_a_wrong_argument_is_named_by_position_and_by_keyword():
    for call in (lambda: function(0, rng=RNG), lambda: function(a=0, rng=RNG)):
        with pytest.raises(ValueError, match=r"^a must be a whole number of at least 1, got 0$"):
            call()
    with pytest.raises(ValueError, match=r"^rng must be a numpy\.random\.Generator, .*got 5$"):
        function(1, rng=5)
    with pytest.raises(ValueError, match=r"^kind must be one of 'x', 'y', got 'z'$"):
        function(1, rng=RNG, kind="z")


def test_the_first_wrong_argument_is_named():
    with pytest.raises(ValueError, match=r"^a must"):
        function(rng=None, kind="z", a="a")


@pytest.mark.parametrize("call", [{}, {"a": 1}, {"a": 1, "rng": RNG, "b": 2}])
def test_a_call_that_does_not_fit_says_so_with_the_name_of_the_function(call):
    with pytest.raises(TypeError, match=r"^function\(\) "):
        function(**call)


def test_a_default_is_not_checked():
    @checked
    def inner(a: Count = None):
        return a

    assert inner() is None
    with pytest.raises(ValueError, match=r"^a must"):
        inner(None)


def test_what_is_collected_is_left_to_the_function():
    @checked
    def inner(*args: Count, **kwargs: Count):
        return args, kwargs

    assert inner("x", y="z") == (("x",), {"y": "z"})


def test_a_keyword_is_not_taken_for_what_is_collected_before_it():
    @checked
    def inner(a: Count, *args, b: Count = 1):
        return a, args, b

    assert inner(1, "x", b=2) == (1, ("x",), 2)
    with pytest.raises(ValueError, match=r"^b must"):
        inner(1, "x", b=0)


@pytest.mark.parametrize("hint", [ArrayLike, ArrayLike | None, Literal["auto"] | ArrayLike])
@pytest.mark.parametrize("value", [[1, 2], "x", None])
def test_what_is_like_an_array_is_left_to_the_function(hint, value):
    assert refusal(hint, value) is value


def documented(doc):
    """Return the docstring that a checked function with this one has."""

    def inner(a: Count):
        return a

    inner.__doc__ = doc
    return checked(inner).__doc__


def test_a_docstring_with_parameters_says_what_is_raised():
    head = "Do.\n\n    Parameters\n    ----------\n    a : int\n        What.\n"
    tail = "\n    Notes\n    -----\n    None.\n"
    raises = "\n    Raises\n    ------\n    ValueError\n        If an argument is not of the kind "
    raises += 'described, or leads out of the range of a float: "<argument>\n        must '
    raises += '<expectation>, got <value>".\n'
    assert documented(head + tail) == head + raises + tail
    assert documented(head + "    ").rstrip() == (head + raises).rstrip()
    told = head + "\n    Raises\n    ------\n    ValueError\n        If it rains.\n"
    for doc in (None, "Do.", told):
        assert documented(doc) == doc


def test_a_hint_may_name_what_stands_further_down():
    @checked
    def inner(later: "Later"):
        return later

    with pytest.raises(ValueError, match=r"^later must be a Later, got 1$"):
        inner(1)


class Later:
    """Is known when the function is called."""


def test_fields_of_a_record_are_checked_and_it_stays_one():
    pair = Pair(0, high=2)
    assert pair == Pair(0.0, 2.0) == pickle.loads(pickle.dumps(pair)) and hash(pair) == hash(pair)
    with pytest.raises(ValueError, match=r"^high must be finite, got nan$"):
        Pair(0, np.nan)
    with pytest.raises(AttributeError):
        pair.low = 3


class Methods:
    """A method and a class method."""

    @checked
    def method(self, a: Count):
        """Return it."""
        return self, a

    @classmethod
    @checked
    def of_class(cls, a: Count):
        """Return it."""
        return cls, a


def test_methods_are_checked_as_well():
    here = Methods()
    assert here.method(2) == (here, 2) and Methods.of_class(2) == (Methods, 2)
    with pytest.raises(ValueError, match=r"^a must"):
        here.method(a=0)


TAKEN = [
    (float, 2, 2.0),
    (int, -2, -2),
    (bool, np.True_, True),
    (str, "", ""),
    (Pair, Pair(1), Pair(1)),
    (Pair | None, None, None),
    (float | None, 1, 1.0),
    (Literal["a", "b"] | None, "b", "b"),
    (Literal[None, "a"], None, None),
    (Iterable[float], (x for x in (1, 2)), (1.0, 2.0)),
    (list[Pair], [Pair(1)], (Pair(1),)),
    (tuple[float, ...], [], ()),
    (tuple[float, str], [1, "x"], (1.0, "x")),
    (dict[str, float], {"a": 1}, {"a": 1.0}),
    (Callable[[float], float], abs, abs),
    (Any, "x", "x"),
    (dict[str, Any], {"a": 1}, {"a": 1}),
    (Literal["auto"] | float, 2, 2.0),
    (Literal["auto"] | float, "auto", "auto"),
    (Pair | float, 2, 2.0),
    (Annotated[float, lambda name, value: value + 1], 2, 3),
    (Count, 7, 7),
    (Index, 0, 0),
    (Positive, 7, 7.0),
    (Real, -7, -7.0),
    (Probability, 0.5, 0.5),
]


@pytest.mark.parametrize(("hint", "value", "result"), TAKEN, ids=lambda x: repr(x)[:30])
def test_what_a_hint_says_is_taken_and_becomes_what_it_says(hint, value, result):
    got = refusal(hint, value)
    assert got == result and type(got) is type(result)


ARRAYS = [
    (Reals, 1, ()),
    (State, [0] * 6, (6,)),
    (States, [[0] * 6] * 2, (2, 6)),
    (Booleans, [True], (1,)),
    (Covariance, np.eye(6), (6, 6)),
    (Measurements, np.ones((2, 3, 6)), (2, 3, 6)),
    (FloatArray, np.ones(3), (3,)),
    (Annotated[ArrayLike, shaped(None, 2)], np.ones((4, 3, 2)), (4, 3, 2)),
    (Annotated[ArrayLike, exactly(None, 2)], np.ones((3, 2)), (3, 2)),
]


@pytest.mark.parametrize(("hint", "value", "shape"), ARRAYS, ids=lambda x: repr(x)[:30])
def test_what_is_like_an_array_becomes_one(hint, value, shape):
    got = refusal(hint, value)
    assert isinstance(got, np.ndarray) and got.shape == shape


REFUSED = [
    (float, "1"),
    (float, True),
    (float, [1.0]),
    (float, np.nan),
    (float, None),
    (int, 1.0),
    (int, True),
    (bool, 1),
    (str, 1),
    (Pair, (0, 1)),
    (Pair | None, 1),
    (float | None, "x"),
    (Literal["a", "b"] | None, "c"),
    (Literal["a", "b"], ["a"]),
    (Iterable[float], "12"),
    (Iterable[float], [1, "x"]),
    (tuple[float, str], [1]),
    (dict[str, float], {"a": "b"}),
    (dict[str, float], [("a", 1)]),
    (Callable[[float], float], 1),
    (Literal["auto"] | float, "manual"),
    (Pair | float, "x"),
    (Count, 0),
    (Index, -1),
    (Runs, 10**7),
    (Positive, 0),
    (Positive, 1e155),
    (Real, 1e155),
    (Reals, [1e155]),
    (Probability, 1),
    (State, [[0] * 6]),
    (State, [0] * 5),
    (States, [0] * 5),
    (FloatArray, [1.0]),
    (Booleans, [1]),
    (Annotated[ArrayLike, exactly(None, 2)], np.ones((4, 3, 2))),
    (Annotated[ArrayLike, exactly(None, 2)], np.ones((0, 2))),
    (Covariance, -np.eye(6)),
    (Covariance, [np.eye(6)] * 2),
    (Measurements, np.ones((3, 6))),
]


@pytest.mark.parametrize(("hint", "value"), REFUSED, ids=lambda x: repr(x)[:30])
def test_what_a_hint_rules_out_is_refused_by_name(hint, value):
    assert str(refusal(hint, value)).startswith("argument")
    assert " must " in refusal(hint, value) and " got " in refusal(hint, value)
