"""Odd arguments that are made from the valid one: other entries, shapes, types, layouts."""

import math

import numpy as np
from hypothesis import strategies as st

from .values import NAMES, Odd, Raised, changed

SPECIAL = ("math.nan", "math.inf", "-math.inf", "0.0", "-0.0", "-1.0", "1e9", "1e155", "-1e155")
SPECIAL += ("1e308", "1e-155", "1e-320")

SHAPES = [
    changed("array", text)
    for text in (
        "a[..., :-1] if a.ndim else a[None]",
        "a[:-1] if a.ndim else a[None]",
        "a[:0] if a.ndim else a[None][:0]",
        "a[..., :0] if a.ndim else a[None][:0]",
        "a[None]",
        "a[..., None]",
        "a.T",
        "a.ravel()",
        "np.concatenate([a, a]) if a.ndim else np.array([a, a])",
        "np.concatenate([a, a], -1) if a.ndim else np.array([[a]])",
        "np.stack([a] * 3)",
        "np.stack([a] * 2, -1)",
        "a[0] if a.ndim and len(a) else a[None]",
    )
]

VALUES = [
    changed("number", "-a if a.dtype.kind in 'iufc' else ~a"),
    changed("number", "a * 0"),
    changed("number", "a + 1"),
    changed("number", "a * 1e-9"),
    changed("number", "a * 1e9"),
    changed("number", "a * 1e160"),
    changed("number", "a * 1e-160"),
    changed("number", "np.full(a.shape, math.nan)"),
    changed("complex", "a + 0j"),
    changed("complex", "a * 1j"),
    changed("object", "a.astype(object)"),
    changed("texts", "a.astype(str)"),
    changed("texts", "a.astype(bytes)"),
    changed("bool", "a.astype(bool)"),
    changed("date", "a.astype('m8[s]')"),
    changed("masked", "np.ma.masked_array(a, np.arange(a.size).reshape(a.shape) == 0)"),
    changed("masked", "[np.ma.masked_array(row, True) for row in np.atleast_1d(a)]"),
    changed("object", "[*a.tolist()[:-1], None] if a.ndim else object()"),
    changed("unit", "a.astype(float).view(Quantity) if a.dtype.kind in 'iuf' else Pint(a)"),
    changed("unit", "Pint(a)"),
    changed("unit", "list(map(Pint, a)) if a.ndim else [Pint(a)]"),
]


def narrow(a, kind):
    """Return `a` in a narrower type if no digit is lost, and as it is otherwise."""
    if a.dtype.kind not in "iuf" or (a.dtype.kind != "f" and np.dtype(kind).kind == "f"):
        return a
    with np.errstate(all="ignore"):
        less = a.astype(kind)
    return less if (less.astype(a.dtype) == a).all() else a


def strided(a):
    """Return `a` as every second entry of a wider array."""
    wide = np.zeros((*a.shape[:-1], 2 * a.shape[-1]), a.dtype)
    wide[..., ::2] = a
    return wide[..., ::2]


def read_only(a):
    """Return a copy of `a` that cannot be written to."""
    a = a.copy()
    a.flags.writeable = False
    return a


NAMES |= {"narrow": narrow, "strided": strided, "read_only": read_only}

REPRESENTATIONS = [
    changed("same", text, True)
    for text in (
        "a.tolist()",
        "tuple(a.tolist())",
        "list(a)",
        "np.asfortranarray(a)",
        "a.astype(a.dtype.newbyteorder('>'))",
        "narrow(a, 'f4')",
        "narrow(a, 'f2')",
        "narrow(a, 'i8')",
        "narrow(a, 'i1')",
        "a[::-1].copy()[::-1]",
        "a[..., ::-1].copy()[..., ::-1]",
        "strided(a)",
        "read_only(a)",
        "a.view(Plain)",
        "np.broadcast_to(a, a.shape)",
    )
]
REPRESENTATIONS += [
    changed("same", text, None)
    for text in (
        "Duck(a)",
        "(row for row in a)",
        "iter(a.tolist())",
    )
]
WHOLE = [
    changed("same", "a[()]", True),
    changed("same", "a.astype('i4')[()]", True),
    changed("same", "a.item()", True),
    changed("same", "a.astype('>i4')", None),
    changed("same", "a.astype('f8')[()]", None),
]
SCALARS = [
    changed("same", "np.array(a)", True),
    changed("same", "a[()]", True),
    changed("same", "narrow(a, 'f4')[()]", True),
    changed("same", "a.item()", True),
    changed("same", "a.astype(a.dtype.newbyteorder('>'))", True),
]
TEXTS = [
    Odd("upper", lambda valid: str(valid).upper(), "text"),
    Odd("with a space", lambda valid: f"{valid} ", "text"),
    Odd("encoded", lambda valid: str(valid).encode(), "bytes"),
    Odd("in a list", lambda valid: [valid], "container"),
    Odd("in an array", lambda valid: np.array([valid]), "container"),
    Odd("np.str_", np.str_, "same", None),
]
PATHS = [
    Odd("str(valid)", str, "same", True),
    Odd("the folder", lambda valid: valid.parent, "path"),
    Odd("missing", lambda valid: valid.with_name("missing"), "path"),
    Odd("below a file", lambda valid: valid.parent / "walk.wav" / "x", "path"),
    Odd("a FIFO", lambda valid: valid.with_name("fifo"), "path"),
    Odd("a device", lambda valid: "/dev/null", "path"),
    Odd("no end", lambda valid: "/dev/zero", "path"),
    Odd("another kind", lambda valid: valid.with_name("other"), "path"),
    Odd("with NUL", lambda valid: f"{valid}\0", "path"),
    Odd("a surrogate", lambda valid: f"{valid}\udcff", "path"),
    Odd("empty", lambda valid: "", "path"),
    Odd("bytes", bytes, "same", None),
    Odd("in a list", lambda valid: [valid], "same", None),
    Odd("in an iterator", lambda valid: iter([valid]), "same", None),
    Odd("twice", lambda valid: [valid, valid], "path"),
]
SEQUENCES = [
    Odd("iter(valid)", iter, "same", None),
    Odd("(item for item in valid)", lambda valid: (item for item in valid), "same", None),
    Odd("list(valid)", list, "same", None),
    Odd("tuple(valid)", tuple, "same", None),
    Odd("twice", lambda valid: (*valid, *valid), "array"),
    Odd("valid[:-1]", lambda valid: valid[:-1], "array"),
]


def _passing(function):
    """Let what a callable itself raises pass: it is not an error of the function that calls it."""

    def called(*args, **kwargs):
        try:
            return function(*args, **kwargs)
        except Exception as error:
            raise Raised from error

    return called


def _returning(text):
    function = eval(f"lambda result: {text}", NAMES)
    return lambda valid: _passing(lambda *args, **kwargs: function(valid(*args, **kwargs)))


def _raising(valid):
    def function(*args, **kwargs):
        raise Raised("by the callable")

    return function


CALLABLES = [
    Odd(f"lambda: {text}", _returning(text), "result")
    for text in (
        "np.asarray(result)[..., :-1]",
        "np.asarray(result) * math.nan",
        "np.asarray(result)[None]",
        "np.asarray(result) * 1e300",
        "np.asarray(result) * 0",
        "np.asarray(result) * 1j",
        "np.asarray(result).tolist()",
        "list(result)",
        "(result, result)",
        "None",
        "'text'",
        "True",
        "0.0",
        "[]",
        "{'a': 1}",
        "np.zeros((0, 0))",
        "np.ma.masked_array(result, True)",
    )
]
CALLABLES += [
    Odd("lambda: raise", _raising, "result"),
    Odd("lambda: (no arguments)", lambda valid: _passing(lambda: None), "result"),
    *(
        Odd(function.__name__, lambda valid, f=function: _passing(f), "result")
        for function in (len, abs, int, dict, str)
    ),
]


def with_entry(text, number):
    """Return what makes, of a place, the oddity that one entry is `number`."""

    def build(place):
        def make(valid):
            array = np.array(valid, dtype=np.result_type(np.asarray(valid).dtype, float))
            if array.size:
                array.flat[place % array.size] = number
            return array if array.ndim else array[()]

        return Odd(f"entry {place} = {text}", make, "number")

    return build


def entries():
    """Return a strategy that sets one entry, of an array of numbers, to a special or any number."""
    special = st.sampled_from([with_entry(text, eval(text, {"math": math})) for text in SPECIAL])
    drawn = st.floats(width=64).map(lambda number: with_entry(repr(number), number))
    place = st.integers(0, 40)
    return st.builds(lambda build, place: build(place), st.one_of(special, drawn), place)
