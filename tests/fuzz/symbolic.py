"""Odd values for what is validly made of symbols: an expression or a matrix of SymPy."""

import sympy as sp

from .values import Odd

NAMES = {"sp": sp, "x": sp.Symbol("x"), "y": sp.Symbol("y")}


def _changed(*texts, nature="symbols"):
    same = None if nature == "same" else False
    functions = {text: eval(f"lambda a: {text}", NAMES) for text in texts}
    return [Odd(text, function, nature, same) for text, function in functions.items()]


EXPRESSIONS = [
    *_changed("sp.nan", "sp.oo", "-sp.oo", "sp.zoo", "sp.I", "sp.pi", "sp.Integer(0)"),
    *_changed("sp.Rational(1, 3)", "sp.Integer(10) ** 400", "sp.Float('1e400')"),
    *_changed("x", "x + y", "x / y", "sp.sqrt(x)", "x ** sp.Rational(1, 3)", "x ** y"),
    *_changed("1 / (x * (y + 1) - x * y - x)", "sp.sin(x)", "abs(x)", "sp.Function('f')(x)"),
    *_changed("sp.Symbol('lambda')", "sp.Symbol('')", "sp.Symbol('x y')", "sp.Dummy()"),
    *_changed("sp.Symbol('A', commutative=False)", "a * sp.Symbol('A', commutative=False)"),
    *_changed("sp.true", "sp.Eq(x, y)", "x > y", "sp.Interval(0, 1)", "sp.Tuple(x, y)"),
    *_changed("sp.Piecewise((x, x > 0), (y, True))", "sp.Max(x, y)", "sp.Order(x)"),
    *_changed("sp.Sum(x, (x, 1, y))", "sp.Integral(x, y)", "sp.Derivative(x**2, x)"),
    *_changed("sp.MatrixSymbol('M', 6, 1)", "sp.MatrixSymbol('M', x, y)", "sp.Symbol"),
    *_changed("sp.Matrix([x])", "sp.zeros(0)", "sp.zeros(2, 0)", "sp.ones(3, 2)"),
    *_changed("a / 0", "a * 0", "1 / a", "-a", "a ** 2", "a + sp.oo", "a + 0.5", "sp.sqrt(a)"),
    *_changed("sp.Pow(a, 10**9, evaluate=False)", "sp.Pow(0, -1, evaluate=False)", "sp.Abs(a)"),
    *_changed("sp.Wild('w')", "x ** 10**9", "a.evalf()", "a / x"),
]
MATRICES = [
    *_changed("a.T", "a[:, :0]", "a[:-1, :]", "a.tolist()", "a.applyfunc(sp.sin)"),
    *_changed("a.applyfunc(lambda e: sp.zoo)", "a.applyfunc(lambda e: x ** 10**9)", "a.evalf()"),
    *_changed("sp.ImmutableMatrix(a)", "sp.SparseMatrix(a)", nature="same"),
]


def symbolic(value):
    """Return the oddities of an expression or of a matrix, and none of another value."""
    if isinstance(value, sp.MatrixBase):
        return EXPRESSIONS + MATRICES
    return EXPRESSIONS if isinstance(value, sp.Basic) else []
