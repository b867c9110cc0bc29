"""Arguments checked by their hints: one decorator, and hints that say what a type checker cannot.

A function whose arguments are records, generators, numbers and words needs no lines of its own for
them::

    @checked
    def figure(draws: Count, *, rng: np.random.Generator, plane: Literal["x", "z"] = "x"): ...

Its body gets what the checks return: an array for an array_like, a tuple for an iterable.
"""

import inspect
import re
from collections.abc import Callable, Iterable, Sequence
from functools import cache, partial, wraps
from math import inf
from textwrap import indent
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

from . import _checks
from ._typing import ArrayLike, BoolArray, FloatArray

_T = TypeVar("_T", bound=Callable[..., Any])


def checked(function: _T) -> _T:
    """Check arguments of a function, or fields of a record, against their hints at every call.

    A hint may be a class, a type of numbers or text, `Literal`, a union of these and None,
    ``Iterable[...]``, ``tuple[...]`` or ``dict[..., ...]`` of them, an array, or ``Annotated`` with
    a check ``(name, value) -> value`` like those of `_checks`. Not checked are defaults, ``*args``
    and ``**kwargs``, what has another hint or none, and an `ArrayLike`: its shape depends on other
    arguments, so that the function itself checks it. It stands above `record` and `cache`.

    Raises
    ------
    ValueError
        From the decorated function: "<argument> must <expectation>, got <value>". A docstring with
        parameters and no such section gets one. An error from deeper down, about a name that the
        caller does not know, is preceded by its arguments.
    """
    if isinstance(function, type):
        function.__init__ = checked(function.__init__)
        function.__doc__ = _with_raises(function.__doc__)
        return function
    signature = inspect.signature(function)
    named = [p for p in signature.parameters.values() if p.kind not in _COLLECTING]

    @cache  # when it is called first: a hint may name a class that stands further down
    def checks():
        hints = get_type_hints(function, include_extras=True)
        places = [i if p.kind is not p.KEYWORD_ONLY else inf for i, p in enumerate(named)]
        found = [(i, p.name, _check(hints.get(p.name))) for i, p in zip(places, named, strict=True)]
        return [each for each in found if each[2]]

    @wraps(function)
    def call(*args, **kwargs):
        given = list(args)
        for place, name, check in checks():
            if place < len(given):
                given[place] = check(name, given[place])
            elif name in kwargs:
                kwargs[name] = check(name, kwargs[name])
        try:
            return function(*given, **kwargs)
        except ValueError as error:
            first = re.match(r"\w+", str(error))
            if first is None or first[0] in signature.parameters or named[0].name == "self":
                raise
            arguments = ", ".join(signature.bind(*args, **kwargs).arguments)
            raise ValueError(f"{arguments} must suit each other: {error}") from error

    call.__doc__ = _with_raises(function.__doc__)
    return cast(_T, call)


def shaped(*shape, check=_checks.moderate):
    """Return a check of arrays whose last axes have `shape`, None for any length; more may lead."""
    return partial(check, shape=shape)


def covariances(name, value, shape):
    """Return covariances of `shape`, singular ones too; a check for `shaped` and `exactly`."""
    return _checks.covariance(name, _checks.moderate(name, value), shape[0], definite=False)


def exactly(*shape, check=_checks.moderate):
    """Return a check of arrays of `shape`, None for any length but zero."""

    def of_shape(name, value):
        array = check(name, value, shape)
        if array.ndim != len(shape) or not array.size:
            wanted = f"{len(shape)} axes and something in it"
            raise ValueError(f"{name} must have {wanted}, got shape {array.shape}")
        return array

    return of_shape


def between(low, high):
    """Return a check of one number from `low` to `high`."""

    def one(name, value):
        number = _checks.one_number(name, value)
        if not low <= number <= high:
            raise ValueError(f"{name} must be from {low} to {high}, got {number}")
        return number

    return one


def up_to(most, least=1):
    """Return a check of one whole number from `least` to `most`."""
    return partial(_checks.count, most=most, least=least)


# Numbers, all of them from 1e-60 to 1e60 in size if not zero: their products are finite.
Count = Annotated[int, _checks.whole_number]  # 1, 2, ...
Index = Annotated[int, partial(_checks.whole_number, least=0)]
Runs = Annotated[int, up_to(10**6)]
Positive = Annotated[float, _checks.moderate_number]
AboveZero = Annotated[float, _checks.positive_number]  # of any size
Number = Annotated[float, partial(_checks.one_number, check=_checks.real)]  # NaN too
Real = Annotated[float, partial(_checks.one_number, check=_checks.moderate)]
Probability = Annotated[float, _checks.probability]
# Arrays of such numbers: an array_like for the caller, an array for a type checker.
Reals = Annotated[FloatArray, _checks.moderate]
State = Annotated[FloatArray, exactly(6)]
States = Annotated[FloatArray, shaped(6)]
Covariance = Annotated[FloatArray, exactly(6, 6, check=covariances)]  # of a state
Measurements = Annotated[FloatArray, exactly(None, None, None)]  # runs, times, sensors
# Booleans, and any numbers, NaN too.
Booleans = Annotated[BoolArray, _checks.booleans]
Array = Annotated[FloatArray, _checks.numbers]  # of any size, NaN too: what a figure draws

_RAISES = """
Raises
------
ValueError
    If an argument is not of the kind described, or leads out of the range of a float: "<argument>
    must <expectation>, got <value>".
"""
_COLLECTING = inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD
_ARRAY_LIKE = frozenset(get_args(ArrayLike))  # a union, of which a larger union keeps the parts
_PLAIN = {
    bool: _checks.one_boolean,
    int: partial(_checks.whole_number, least=None),
    float: _checks.one_number,
    str: _checks.text,
    np.random.Generator: _checks.generator,
}


def _with_raises(doc):
    """Return a numpydoc docstring with a section on errors, behind arguments and result."""
    found = re.search(r"\n( *)(Parameters|Attributes)\n", doc or "")
    if found is None or "Raises\n" in doc:
        return doc
    places = [re.search(rf"\n{found[1]}{title}\n", doc) for title in ("Notes", "Examples")]
    end = min((place.start() for place in places if place), default=len(doc.rstrip()) + 1)
    return doc[:end].rstrip(" ") + indent(_RAISES, found[1]) + doc[end:]


def _check(hint):
    """Return the check ``(name, value) -> value`` of a hint, or None if it says nothing."""
    kind, parts = get_origin(hint) or hint, get_args(hint)
    if kind is Annotated:
        return next(filter(callable, hint.__metadata__), None) or _check(parts[0])
    if kind in (Union, UnionType):
        return _either(parts)
    if kind is Literal:
        return partial(_checks.one_of, choices=parts)
    if kind is Callable:
        return _checks.function
    if kind in (Iterable, Sequence, list):
        return _items(_check(parts[0]))
    if kind is tuple and parts:
        return _items(_check(parts[0])) if parts[-1] is ... else _fixed([*map(_check, parts)])
    if kind is dict and parts:
        return _mapping(*map(_check, parts))
    if isinstance(kind, type) and kind is not Any:
        return _PLAIN.get(kind) or partial(_checks.instance, kind=kind)
    return None


def _either(parts):
    words = sum((get_args(part) for part in parts if get_origin(part) is Literal), ())
    if set(parts) >= _ARRAY_LIKE:
        return None
    if all(isinstance(part, type) and part not in (*_PLAIN, NoneType) for part in parts):
        return partial(_checks.instance, kind=parts)
    rest = [_check(p) for p in parts if p is not NoneType and get_origin(p) is not Literal]

    def either(name, value):
        if value is None and NoneType in parts:
            return None
        if words and (isinstance(value, str) or not rest):
            return _checks.one_of(name, value, (None, *words) if NoneType in parts else words)
        for check in rest[:-1]:
            try:
                return check(name, value)
            except ValueError:
                pass
        return rest[-1](name, value)

    return either if None not in rest else None


def _items(check):
    def items(name, values):
        found = tuple(_checks.iterable(name, values))
        return tuple(check(name, value) for value in found) if check else found

    return items


def _fixed(checks):
    def fixed(name, values):
        found = tuple(_checks.iterable(name, values))
        if len(found) != len(checks):
            raise ValueError(f"{name} must have {len(checks)} parts, got {len(found)}")
        return tuple(
            check(name, value) if check else value
            for check, value in zip(checks, found, strict=True)
        )

    return fixed


def _mapping(key, value):
    def mapping(name, given):
        items = _checks.instance(name, given, dict).items()
        return {
            (key(name, k) if key else k): (value(f"{name}[{k!r}]", v) if value else v)
            for k, v in items
        }

    return mapping
