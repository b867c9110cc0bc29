"""A block: a short program in symbols, from which the printers make code."""

import sympy as sp

from .._hints import checked
from .._records import record
from ._arguments import Expression, Line, Name


@checked
@record
class Stage:
    """Named assignments that may use each other's names in order, and all earlier stages'.

    Parameters
    ----------
    comment : str
        One line.
    assignments : iterable of (sympy.Symbol, sympy.Expr)
        Names and what they stand for, in order.
    """

    comment: Line
    assignments: tuple[tuple[Name, Expression], ...]


@checked
@record
class Block:
    """Inputs, stages of assignments, outputs: a straight line without loops or branches.

    Parameters
    ----------
    name, summary : str
        Name of the printed function, and the first line of its docstring.
    inputs, outputs : iterable of sympy.Symbol
        What the function is given and what it returns.
    stages : iterable of Stage
        The program. Every name is assigned once, before it is used.
    equations : iterable of (sympy.Symbol, sympy.Expr)
        What the function computes, as a reader would write it; printed as LaTeX.

    Raises
    ------
    ValueError
        If a name is given a value twice, or is used or returned without one.

    Examples
    --------
    >>> x, y, product = sp.symbols("x y product")
    >>> stage = Stage("both at once", [(product, (x + y) * (x - y))])
    >>> block = Block("times", "Sum times difference.", (x, y), (stage,), (product,))
    >>> for comment, assignments in block.straight_line():
    ...     print(comment, assignments)
    both at once [(product, (x - y)*(x + y))]
    """

    name: str
    summary: Line
    inputs: tuple[Name, ...]
    stages: tuple[Stage, ...]
    outputs: tuple[Name, ...]
    equations: tuple[tuple[Name, Expression], ...] = ()

    def __post_init__(self):
        """Check that every name has one value before it is used."""
        known, names = set(), set()

        def define(argument, symbol):
            # By name: symbols that differ in their assumptions only look the same in code.
            if symbol.name in names:
                raise ValueError(f"{argument} must give {symbol} a value once, got a second one")
            known.add(symbol)
            names.add(symbol.name)

        def check(argument, symbols):
            for symbol in sorted(symbols - known, key=str):
                raise ValueError(f"{argument} must use names that have a value, got {symbol}")

        for symbol in self.inputs:
            define("inputs", symbol)
        for stage in self.stages:
            for symbol, expression in stage.assignments:
                check("stages", expression.free_symbols)
                define("stages", symbol)
        check("outputs", set(self.outputs))

    def names(self):
        """Return the names of all inputs and of all that is assigned, a set of str."""
        assigned = (symbol for stage in self.stages for symbol, _ in stage.assignments)
        return {symbol.name for symbol in (*self.inputs, *assigned)}

    def straight_line(self):
        """Yield (comment, assignments) of each stage, after common-subexpression elimination.

        Elimination stays inside a stage, so that the names of the derivation (d, h, S) survive in
        the code and the reader of the code meets them again.
        """
        taken = self.names()
        temporaries = sp.numbered_symbols("t", real=True)
        temporaries = (symbol for symbol in temporaries if symbol.name not in taken)
        for stage in self.stages:
            names = [name for name, _ in stage.assignments]
            shared, reduced = sp.cse(
                [expression for _, expression in stage.assignments],
                symbols=temporaries,
                order="canonical",
                optimizations=[],
            )
            yield stage.comment, _in_order(shared, list(zip(names, reduced, strict=True)))


def _in_order(shared, assignments):
    """Put each temporary right before the first assignment that needs it."""
    pending = dict(shared)
    ordered = []

    def emit(name, expression):
        for symbol in sorted(expression.free_symbols & pending.keys(), key=lambda s: s.name):
            if symbol in pending:
                emit(symbol, pending.pop(symbol))
        ordered.append((name, expression))

    for name, expression in assignments:
        emit(name, expression)
    return ordered
