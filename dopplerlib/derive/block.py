"""A block: a short program in symbols, from which the printers make code."""

from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class Stage:
    """Named assignments that may use each other's names in order, and all earlier stages'."""

    comment: str
    assignments: list


@dataclass(frozen=True)
class Block:
    """Inputs, stages of assignments, outputs: a straight line without loops or branches."""

    name: str
    summary: str
    inputs: tuple
    stages: tuple
    outputs: tuple

    def straight_line(self):
        """Yield (comment, assignments) a stage, after common-subexpression elimination.

        Elimination stays inside a stage, so that the names of the derivation (d, h, S) survive in
        the code and the reader of the code meets them again.
        """
        temporaries = sp.numbered_symbols("t", real=True)
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
