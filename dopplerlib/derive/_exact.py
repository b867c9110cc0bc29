"""Printers of expressions in three languages: what each computes to the last bit, or nothing."""

import math
import re

import sympy as sp
from sympy.printing.c import C99CodePrinter
from sympy.printing.jscode import JavascriptCodePrinter
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

_NODES = (sp.Symbol, sp.Rational, sp.Float, sp.Add, sp.Mul, sp.Pow)
_EXACT_INTEGER = 2**53  # up to here a double holds every integer
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")  # what every language takes
# What the printed text itself is made of.
_USED = {"sqrt", "Math", "out", "lanes", "lane", "doppler_real", "DOPPLER_SQRT"}


class _Exact:
    """Print only what every language computes to the last bit, or raise a ValueError.

    A power becomes a product, because pow() may round differently elsewhere: x**3 is x*x*x,
    x**(-3/2) is 1/(x*sqrt(x)).
    """

    def takes(self, name):
        """Return whether a variable may have this name."""
        return bool(_NAME.fullmatch(name)) and name not in {*self.reserved_words, *_USED}

    def name(self, text):
        """Return the name of a variable, or raise."""
        if not self.takes(text):
            raise ValueError(
                f"block must use names that are identifiers and not reserved, got {text!r}"
            )
        return text

    def doprint(self, expression):
        for node in sp.preorder_traversal(expression):
            if not isinstance(node, _NODES):
                raise _inexact(f"{node} in {expression}")
        return super().doprint(expression)

    def parenthesize(self, item, level, strict=False):
        # SymPy believes that a power binds more tightly than a product: ours is a product.
        if item.is_Pow and item.exp != sp.S.Half:
            return f"({self._print(item)})"
        return super().parenthesize(item, level, strict)

    def _print_Symbol(self, symbol):
        return self.name(symbol.name)

    def _print_Pow(self, expression, **kwargs):
        base, exponent = expression.args
        if not (2 * exponent).is_Integer:
            raise _inexact(expression)
        whole, half = divmod(int(2 * abs(exponent)), 2)
        factors = [self.parenthesize(base, PRECEDENCE["Atom"], strict=True)] * whole
        factors += [f"{self.square_root}({self._print(base)})"] * half
        product = "*".join(factors)
        if exponent > 0:
            return product
        return f"1/{product}" if len(factors) == 1 else f"1/({product})"

    def _print_Integer(self, expression):
        return self._number(expression, super()._print_Integer)

    def _print_Rational(self, expression):
        return self._number(expression, super()._print_Rational)

    def _number(self, number, write):
        if max(abs(number.p), number.q) > _EXACT_INTEGER:
            raise _inexact(number)
        return write(number)

    def _print_Float(self, expression):
        number = float(expression)
        if not math.isfinite(number) or (number == 0) != (expression == 0):
            raise _inexact(expression)
        return repr(number)  # the shortest text that reads back as the same double


def _inexact(part):
    return ValueError(f"block must hold what has an exactly rounded form, got {str(part)[:200]}")


class Python(_Exact, PythonCodePrinter):
    square_root = "sqrt"


class C99(_Exact, C99CodePrinter):
    square_root = "sqrt"


class C99Real(C99):
    """C99 for numbers of the type doppler_real: no constant of another type may widen them."""

    square_root = "DOPPLER_SQRT"

    def _print_Float(self, expression):
        return f"(doppler_real){super()._print_Float(expression)}"

    def _print_Rational(self, expression):
        return self._number(expression, "(doppler_real){0.p}/(doppler_real){0.q}".format)


class JavaScript(_Exact, JavascriptCodePrinter):
    square_root = "Math.sqrt"
    reserved_words = frozenset(
        "arguments await break case catch class const continue debugger default delete do else "
        "enum eval export extends false finally for function if implements import in instanceof "
        "interface let new null package private protected public return static super switch this "
        "throw true try typeof var void while with yield".split()
    )  # SymPy knows those of the other two
