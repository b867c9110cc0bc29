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
    parts = [st.sampled_from(CONSTANTS)]
    if isinstance(value, (bool, np.bool_)):
        pass
    elif symbolic(value):
        parts += [st.sampled_from(symbolic(value))] * 2
    elif _numeric(value) and np.ndim(value):
        kinds = (changes.SHAPES, changes.VALUES, changes.REPRESENTATIONS)
        parts += [changes.entries(), *map(st.sampled_from, kinds)]
    elif _numeric(value):
        whole = np.asarray(value).dtype.kind in "iu"
        kinds = (changes.SHAPES, changes.VALUES, changes.WHOLE if whole else changes.SCALARS)
        parts += [st.floats().map(_just), st.integers(-3, 40).map(_just)]
        parts += map(st.sampled_from, kinds)
    elif isinstance(value, str):
        parts += [st.sampled_from(changes.TEXTS), st.text(max_size=8).map(_just)]
    elif isinstance(value, Path):
        parts.append(st.sampled_from(changes.PATHS))
    elif dataclasses.is_dataclass(value):
        parts += [_fields(value)] * 3
    elif callable(value):
        parts = [st.sampled_from([odd for odd in CONSTANTS if not callable(odd.make(None))])]
        parts.append(st.sampled_from(changes.CALLABLES))
    elif isinstance(value, (list, tuple)) and len(value):
        parts += [_items(value), st.sampled_from(changes.SEQUENCES)]
    elif isinstance(value, dict) and value:
        parts += [_held(value)] * 2
    return st.one_of(parts)


def _numeric(value):
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        return False
    return array.dtype.kind in "iufc" or (array.dtype.kind == "b" and array.ndim > 0)


def _just(value):
    return Odd(repr(value), lambda valid: value, "text" if isinstance(value, str) else "number")


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
