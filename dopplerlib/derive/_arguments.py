"""What arguments made of symbols must be: checks for hints, in the form of `_checks`."""

from typing import Annotated

import sympy as sp
from sympy.core.function import Application

# Infinity and NaN are none of these, nor is what binds a symbol of its own, such as an integral.
_PARTS = (
    sp.Symbol, sp.Rational, sp.Float, sp.NumberSymbol, type(sp.I), sp.Add, sp.Mul, sp.Pow,
    Application,
)  # fmt: skip
_MOST_FACTORS = 64  # of a power: SymPy writes out that of a number, a printer that of a symbol
_RATIONAL = (sp.Symbol, sp.Rational, sp.Add, sp.Mul, sp.Pow)


def expression(name, value):
    """Return `value`, or raise if it is not a finite expression in symbols that commute."""
    known = isinstance(value, sp.Expr) and value.is_commutative and _made_of(value, _PARTS)
    powers = value.atoms(sp.Pow) if known else ()
    if not known or any(p.base == 0 and p.exp.is_negative for p in powers):
        raise ValueError(
            f"{name} must be a finite SymPy expression of numbers, functions and symbols that "
            f"commute, got {repr(value)[:100]}"
        )
    if any(p.exp.is_Number and abs(p.exp) > _MOST_FACTORS for p in powers):
        raise ValueError(
            f"{name} must hold powers up to {_MOST_FACTORS} only, got {repr(value)[:100]}"
        )
    return value


def symbol(name, value):
    """Return `value`, or raise if it is not a symbol that commutes."""
    if not isinstance(value, sp.Symbol) or not value.is_commutative:
        raise ValueError(f"{name} must be a SymPy symbol that commutes, got {repr(value)[:100]}")
    return value


def rational_matrix(name, value):
    """Return `value`, or raise if it is not a matrix of rational functions."""
    if not isinstance(value, sp.MatrixBase) or not all(map(_is_rational, value)):
        raise ValueError(
            f"{name} must be a SymPy matrix of rational functions without decimals, "
            f"got {repr(value)[:100]}"
        )
    return value


def line(name, value):
    """Return `value`, or raise if it does not fit into a docstring or a comment of one line."""
    if not isinstance(value, str) or not value.isprintable() or {'"', "\\"} & set(value):
        raise ValueError(
            f"{name} must be one line of text without quotation marks and backslashes, "
            f"got {repr(value)[:100]}"
        )
    return value


Expression = Annotated[sp.Expr, expression]
Name = Annotated[sp.Symbol, symbol]
RationalMatrix = Annotated[sp.MatrixBase, rational_matrix]
Line = Annotated[str, line]


def _made_of(value, kinds):
    return all(isinstance(node, kinds) for node in sp.preorder_traversal(value))


def _is_rational(value):
    """Return whether an entry is a rational function, without a denominator of zero."""
    if not _made_of(value, _RATIONAL) or not value.is_commutative:
        return False
    powers = sorted(value.atoms(sp.Pow), key=sp.count_ops)  # what stands inside of others first
    return all(
        power.exp.is_Integer and (power.exp > 0 or sp.cancel(power.base) != 0) for power in powers
    )
