"""Strategies for odd calls: which argument of a valid call is replaced, and by what."""

import dataclasses
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from . import changes
from .symbolic import symbolic
from .values import CONSTANTS, Odd


def odd_calls(calls):
    """Return a strategy of odd calls: (which call, {argument: oddity}), with one oddity or two."""
    return st.one_of([_odd_call(place, call) for place, call in enumerate(calls) if call])


def _odd_call(place, call):
    one = st.one_of(
        [
            st.tuples(st.just(name), _fields(value) if name == "self" else odd_values(value))
            for name, value in call.items()
        ]
    )
    two = st.lists(one, min_size=2, max_size=2)
    pairs = st.one_of(*[st.tuples(one)] * 4, two)
    return pairs.map(lambda drawn: (place, dict(drawn)))


def odd_values(value):
    """Return a strategy of oddities for what is validly `value`."""
    if isinstance(value, (bool, np.bool_)):
        return ANYTHING
    if symbolic(value):
        return st.one_of(ANYTHING, st.sampled_from(symbolic(value)))
    if _numeric(value):
        whole = np.asarray(value).dtype.kind in "iu"
        return KINDS["array" if np.ndim(value) else "whole" if whole else "number"]
    if isinstance(value, str):
        return KINDS["text"]
    if isinstance(value, Path):
        return KINDS["path"]
    if dataclasses.is_dataclass(value):
        return st.one_of(ANYTHING, _fields(value))
    if callable(value):
        return KINDS["callable"]
    if isinstance(value, (list, tuple)) and len(value):
        return st.one_of(ANYTHING, _items(value), KINDS["sequence"])
    if isinstance(value, dict) and value:
        return st.one_of(ANYTHING, _held(value))
    return ANYTHING


def _numeric(value):
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        return False
    return array.dtype.kind in "iufc" or (array.dtype.kind == "b" and array.ndim > 0)


def _just(value):
    return Odd(repr(value), lambda valid: value, "text" if isinstance(value, str) else "number")


# One object for all values of a kind: Hypothesis takes longer to look at a strategy than to draw.
ANYTHING = st.sampled_from(CONSTANTS)
_SHAPES, _VALUES = st.sampled_from(changes.SHAPES), st.sampled_from(changes.VALUES)
_ANY_NUMBER = ANYTHING, st.floats().map(_just), st.integers(-3, 40).map(_just), _SHAPES, _VALUES
_UNCALLABLE = [odd for odd in CONSTANTS if not callable(odd.make(None))]
KINDS = {
    "array": ANYTHING
    | changes.entries()
    | _SHAPES
    | _VALUES
    | st.sampled_from(changes.REPRESENTATIONS),
    "whole": st.one_of(*_ANY_NUMBER, st.sampled_from(changes.WHOLE)),
    "number": st.one_of(*_ANY_NUMBER, st.sampled_from(changes.SCALARS)),
    "text": ANYTHING | st.sampled_from(changes.TEXTS) | st.text(max_size=8).map(_just),
    "path": ANYTHING | st.sampled_from(changes.PATHS),
    "callable": st.sampled_from(_UNCALLABLE) | st.sampled_from(changes.CALLABLES),
    "sequence": st.sampled_from(changes.SEQUENCES),
}


def _fields(record):
    """Return a strategy of records that are `record` but for one field."""
    return st.one_of(
        [
            odd_values(getattr(record, field.name)).map(
                lambda odd, name=field.name: Odd(f".{name}: {odd}", _replaced(name, odd), "field")
            )
            for field in dataclasses.fields(record)
            if field.init
        ]
    )


def _replaced(name, odd):
    return lambda valid: dataclasses.replace(valid, **{name: odd.make(getattr(valid, name))})


def _items(value, most=3):
    """Return a strategy of sequences that are `value` but for one of the first items."""
    return st.one_of(
        [
            odd_values(item).map(
                lambda odd, place=place: Odd(f"[{place}]: {odd}", _item(place, odd), "item")
            )
            for place, item in enumerate(value[:most])
        ]
    )


def _held(value, most=3):
    """Return a strategy of dicts that are `value` but for one of the first keys or its value."""
    keys = list(value)[:most]
    odd = [odd_values(value[key]).map(lambda odd, key=key: _entry(key, odd)) for key in keys]
    return st.one_of(*odd, st.sampled_from(keys).map(_without))


def _entry(key, odd):
    return Odd(f"[{key!r}]: {odd}", lambda valid: {**valid, key: odd.make(valid[key])}, "item")


def _without(key):
    return Odd(f"without {key!r}", lambda v: {k: one for k, one in v.items() if k != key}, "item")


def _item(place, odd):
    def make(valid):
        items = list(valid)
        items[place] = odd.make(items[place])
        return items

    return make
