"""A block: a short program in symbols, from which the printers make code."""

import sympy as sp

from .._records import record


@record
class Stage:
    """Named assignments that may use each other's names in order, and all earlier stages'."""

    comment: str
    assignments: list


@record
class Block:
    """Inputs, stages of assignments, outputs: a straight line without loops or branches.

    Parameters
    ----------
    name, summary : str
        Name of the printed function, and the first line of its docstring.
    inputs, outputs : tuple of sympy.Symbol
        What the function is given and what it returns.
    stages : tuple of Stage
        The program. Every name is assigned once, before it is used.
    equations : tuple of (sympy.Symbol, sympy.Expr)
        What the function computes, as a reader would write it; printed as LaTeX.

    Raises
    ------
    ValueError
        If a name is given a value twice, or is used or returned without one.
    """

    name: str
    summary: str
    inputs: tuple
    stages: tuple
    outputs: tuple
    equations: tuple = ()

    def __post_init__(self):
        """Check that every name has one value before it is used."""
        known, names = set(), set()

        def define(symbol):
            # By name: symbols that differ in their assumptions only look the same in code.
            if symbol.name in names:
                raise ValueError(f"{self.name} must give {symbol} a value once, got a second one")
            known.add(symbol)
            names.add(symbol.name)

        def check(symbols):
            for symbol in sorted(symbols - known, key=str):
                raise ValueError(f"{self.name} must give {symbol} a value before it uses it")

        for symbol in self.inputs:
            define(symbol)
        for stage in self.stages:
            for symbol, expression in stage.assignments:
                check(expression.free_symbols)
                define(symbol)
        check(set(self.outputs))

    def straight_line(self):
        """Yield (comment, assignments) of each stage, after common-subexpression elimination.

        Elimination stays inside a stage, so that the names of the derivation (d, h, S) survive in
        the code and the reader of the code meets them again.
        """
        taken = {*self.inputs, *(name for stage in self.stages for name, _ in stage.assignments)}
        taken = {symbol.name for symbol in taken}
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
