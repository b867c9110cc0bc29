"""Printed kernels as compiled code, written without inferring types.

A kernel is a straight line of sums, products, quotients and roots of doubles. It runs once, on
values that write down what is done with them; numba would infer a type for each of its thousand
names, which takes longer than all the rest of a compilation.
"""

import inspect
from functools import partialmethod

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.core.cgutils import get_or_insert_function
from numba.extending import intrinsic

# Arrays of kernels that share no place, so that what is written to one leaves the other as it was.
_APART = "work", "sensor"
_WIDTH = 4  # lanes that one instruction takes at once


def straight(kernel, one=False):
    """Return a kernel of `dopplerlib.kernels`, of the form that works on lanes, for compiled code.

    Behind each array it takes the place where its rows begin, then the number of lanes, which has
    to be a constant, and the numbers. It does all lanes at once, or with ``one=True`` the lane at
    whose place the rows begin, and checks nothing. Arrays have one axis.
    """
    names = list(inspect.signature(kernel).parameters)
    arrays = names.index("lanes")
    if config.DISABLE_JIT:

        def plain(*arguments):
            places, (lanes, *numbers) = arguments[: 2 * arrays], arguments[2 * arrays :]
            rows = [array[at:] for array, at in zip(places[::2], places[1::2], strict=True)]
            for lane in range(1 if one else lanes):
                kernel(*rows, lanes, lane, *numbers)

        return plain

    def typed(typingctx, *arguments):
        kinds = [*arguments[: 2 * arrays + 1], *[types.float64] * (len(names) - arrays - 2)]
        kinds[1 : 2 * arrays : 2] = [types.intp] * arrays
        lanes = arguments[2 * arrays].literal_value
        return types.void(*kinds), lambda *built: _write(kernel, names[:arrays], lanes, one, *built)

    form = [f"{word}_{i}" for i in range(arrays) for word in ("array", "at")]
    form += ["lanes", *names[arrays + 2 :]]
    kind = inspect.Parameter.POSITIONAL_ONLY
    typed.__signature__ = inspect.Signature(
        [inspect.Parameter(name, kind) for name in ("typingctx", *form)]
    )
    typed.__name__ = kernel.__name__
    return intrinsic(prefer_literal=True)(typed)


def where_known(measured, value, otherwise):
    """Return `value` where something is measured, and `otherwise` where that is NaN; in kernels."""
    if isinstance(measured, _Value):
        return measured.where_known(value, otherwise)
    return value if measured == measured else otherwise


def _write(kernel, names, lanes, one, context, builder, signature, arguments):
    """Write a kernel into the function that `builder` builds."""
    data = []
    for i in range(0, 2 * len(names), 2):
        array = context.make_array(signature.args[i])(context, builder, arguments[i])
        data.append(builder.gep(array.data, [arguments[i + 1]]))
    width = 1 if one else min(lanes, _WIDTH)
    number = ir.DoubleType() if width == 1 else ir.VectorType(ir.DoubleType(), width)
    for first in range(0, 1 if one else lanes, width):
        rows = [
            _Rows(builder, pointer, number, 1 if one else lanes, first, _tag(builder.module, name))
            for pointer, name in zip(data, names, strict=True)
        ]
        numbers = [_spread(builder, value, number) for value in arguments[2 * len(names) + 1 :]]
        values = [_Value(builder, value) for value in numbers]
        kernel(*rows, lanes if one else 1, 0, *values)
    return context.get_dummy_value()


def _spread(builder, value, number):
    """Return a number as one for each of several lanes."""
    if isinstance(number, ir.DoubleType):
        return value
    first = ir.Constant(ir.IntType(32), 0)
    one = builder.insert_element(ir.Constant(number, ir.Undefined), value, first)
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), number.count), None)
    return builder.shuffle_vector(one, one, zeros)


def _constant(number, value):
    several = [float(value)] * number.count if isinstance(number, ir.VectorType) else float(value)
    return ir.Constant(number, several)


def _tag(module, name):
    """Return the type that LLVM's analysis of aliases sees (TBAA), or None for any."""
    if name not in _APART:
        return None
    zero = ir.Constant(ir.IntType(64), 0)
    kind = module.add_metadata([name, module.add_metadata(["rows"]), zero])
    return module.add_metadata([kind, kind, zero])


class _Rows:
    """An array `work` of which a kernel reads and writes rows."""

    def __init__(self, builder, pointer, number, lanes, first, tag):
        self._builder, self._number, self._tag = builder, number, tag
        self._pointer, self._lanes, self._first = pointer, lanes, first

    def _place(self, row):
        offset = ir.Constant(ir.IntType(64), row * self._lanes + self._first)
        place = self._builder.gep(self._pointer, [offset])
        return self._builder.bitcast(place, self._number.as_pointer())

    def __getitem__(self, row):
        loaded = self._builder.load(self._place(row), align=8)
        return _Value(self._builder, self._tagged(loaded))

    def __setitem__(self, row, value):
        value = value.value if isinstance(value, _Value) else _constant(self._number, value)
        self._tagged(self._builder.store(value, self._place(row), align=8))

    def _tagged(self, instruction):
        if self._tag is not None:
            instruction.set_metadata("tbaa", self._tag)
        return instruction


class _Value:
    """A double, or one for each of several lanes, that arithmetic writes instructions for."""

    def __init__(self, builder, value):
        self._builder, self.value = builder, value

    def _with(self, other, operation, turned=False):
        a, b = self.value, self._alike(other)
        return _Value(
            self._builder, getattr(self._builder, operation)(*((b, a) if turned else (a, b)))
        )

    def _alike(self, other):
        return other.value if isinstance(other, _Value) else _constant(self.value.type, other)

    def where_known(self, value, otherwise):
        known = self._builder.fcmp_ordered("ord", self.value, self.value)
        chosen = self._builder.select(known, self._alike(value), self._alike(otherwise))
        return _Value(self._builder, chosen)

    __add__ = partialmethod(_with, operation="fadd")
    __radd__ = partialmethod(_with, operation="fadd", turned=True)
    __sub__ = partialmethod(_with, operation="fsub")
    __rsub__ = partialmethod(_with, operation="fsub", turned=True)
    __mul__ = partialmethod(_with, operation="fmul")
    __rmul__ = partialmethod(_with, operation="fmul", turned=True)
    __truediv__ = partialmethod(_with, operation="fdiv")
    __rtruediv__ = partialmethod(_with, operation="fdiv", turned=True)

    def __neg__(self):
        return _Value(self._builder, self._builder.fneg(self.value))

    def __array_ufunc__(self, function, method, *inputs):
        if function is not np.sqrt or method != "__call__":
            return NotImplemented
        kind = self.value.type
        name = "f64" if isinstance(kind, ir.DoubleType) else f"v{kind.count}f64"
        root = get_or_insert_function(
            self._builder.module, ir.FunctionType(kind, [kind]), f"llvm.sqrt.{name}"
        )
        return _Value(self._builder, self._builder.call(root, [self.value]))
