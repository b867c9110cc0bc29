"""Odd values for any argument, and what an oddity is."""

import datetime
import decimal
import fractions
import math
import pathlib
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Odd:
    """One oddity: what stands in a report, and how the valid value is turned into it.

    `nature` is what `documented.refused` goes by. `same` says that it is the valid value in another
    form: True if that has to be taken, None if it may be refused; the result must be the same.
    """

    label: str
    make: object  # valid value -> odd value
    nature: str
    same: bool | None = False

    def __repr__(self):
        return self.label


class Raised(Exception):
    """What a callable of the fuzz test raises: it may pass through."""


class Quantity(np.ndarray):
    """An array with a unit, as astropy and unyt have it: NumPy drops the unit."""

    unit = "km"


class Plain(np.ndarray):
    """A subclass that means nothing."""


class Duck:
    """What only says how it becomes an array, like a series of pandas."""

    def __init__(self, value):
        self.value = value

    def __array__(self, dtype=None, copy=None):
        return np.array(self.value, dtype=dtype)


class Pint(Duck):
    """The like with units."""

    units = "km"


NAMES = {
    "np": np, "datetime": datetime, "fractions": fractions, "decimal": decimal, "math": math,
    "pathlib": pathlib, "Duck": Duck, "Pint": Pint, "Quantity": Quantity, "Plain": Plain,
}  # fmt: skip


def changed(nature, text, same=False):
    """Return the oddity that computes `text` of the valid value `a` as an array."""
    function = eval(f"lambda a: {text}", NAMES)
    return Odd(text, lambda valid: function(np.asarray(valid)), nature, same)


def _constants(nature, *texts):
    return [Odd(text, lambda valid, text=text: eval(text, NAMES), nature) for text in texts]


CONSTANTS = [
    *_constants("none", "None"),
    *_constants("bool", "True", "False", "np.True_"),
    *_constants("bool", "[True, False]", "np.zeros((6, 6), bool)"),
    *_constants("text", "''", "'text'", "'1.0'", "np.str_('x')", "'nan'", "'é\\0'"),
    *_constants("texts", "['a', 'b']", "np.array(['1', '2'])"),
    *_constants("bytes", "b''", "b'12345678'", "bytearray(8)", "memoryview(b'12')"),
    *_constants("complex", "1j", "[1j, 2]", "np.complex64(1)"),
    *_constants("number", "math.nan", "math.inf", "-math.inf", "np.float32('nan')"),
    *_constants("number", "0", "0.0", "-0.0", "1", "-1", "2", "1.5", "-3.7", "100"),
    *_constants("number", "1e155", "-1e155", "1e308", "1e-155", "1e-320", "1e16"),
    *_constants("number", "10**400", "2**62", "2**63", "-2**63", "-10**400"),
    *_constants("number", "np.int8(3)", "np.uint64(3)", "np.float16(2)", "np.longdouble(2)"),
    *_constants("other number", "fractions.Fraction(1, 3)", "decimal.Decimal('1.5')"),
    *_constants("date", "datetime.date(2020, 1, 1)", "datetime.datetime(2020, 1, 1)"),
    *_constants("date", "datetime.timedelta(1)", "np.datetime64('2020-01-01')"),
    *_constants("date", "np.timedelta64(3, 's')", "np.array([1, 2], 'm8[s]')"),
    *_constants("object", "object()", "...", "NotImplemented", "int", "np", "slice(3)"),
    *_constants("object", "np.array([1.0, None], object)", "np.array(1.0, object)"),
    *_constants("object", "np.array([(1, 2.0)], 'i4,f8')", "[1.0, None]"),
    *_constants("container", "{}", "{'a': 1}", "set()", "{1, 2}", "frozenset()"),
    *_constants("iterator", "iter([])", "(i for i in [1.0, 2.0])", "map(float, [1, 2])"),
    *_constants("iterator", "range(3)"),
    *_constants("array", "[]", "()", "[[]]", "np.zeros(0)", "np.zeros((0, 6))"),
    *_constants("array", "np.zeros((6, 0))"),
    *_constants("array", "np.zeros((1, 1, 1, 1, 1))", "[1.0]", "np.ones(3)", "np.ones((2, 2))"),
    *_constants("array", "np.eye(6)", "np.ones((7, 5))", "np.ones((2, 3, 4))", "np.zeros(1)"),
    *_constants("ragged", "[[1.0, 2.0], [3.0]]", "[1.0, [2.0, 3.0]]", "[[[1.0]], 2.0]"),
    *_constants("masked", "np.ma.masked", "np.ma.masked_less([-1.0, 2.0], 0)"),
    *_constants("masked", "[np.ma.masked_less([-1.0, 2.0], 0), [1.0, 2.0]]"),
    *_constants("unit", "Quantity((2,))", "Pint([1.0, 2.0])", "[Pint(1.0)]"),
    *_constants("path", "pathlib.Path('/nowhere/at/all')", "'/dev/null/x'", "'a' * 5000"),
    *_constants("callable", "len", "abs", "dict", "int.__add__"),
]  # fmt: skip
