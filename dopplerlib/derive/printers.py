"""From a block to source text: Python, C99 and JavaScript.

All three print the same operations in the same order, and only those that IEEE 754 defines to the
last bit (+, -, *, /, square root). So the languages agree exactly, not just closely.
"""

import textwrap

import sympy as sp
from sympy.printing.c import C99CodePrinter
from sympy.printing.jscode import JavascriptCodePrinter
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

WIDTH = 100


class _ExactPowers:
    """Print x**3 as x*x*x and x**-0.5 as 1/sqrt(x): pow() may round differently elsewhere."""

    def _print_Pow(self, expression, **kwargs):
        base, exponent = expression.as_base_exp()
        if exponent.is_Integer and exponent > 1:
            factor = self.parenthesize(base, PRECEDENCE["Atom"], strict=True)
            return "(" + "*".join([factor] * exponent) + ")"
        if exponent == sp.S.Half:
            return f"{self.square_root}({self._print(base)})"
        if exponent == -sp.S.Half:
            return f"1/{self.square_root}({self._print(base)})"
        raise NotImplementedError(f"no exactly rounded form of {expression}")


class _Python(_ExactPowers, PythonCodePrinter):
    square_root = "sqrt"


class _C99(_ExactPowers, C99CodePrinter):
    square_root = "sqrt"


class _JavaScript(_ExactPowers, JavascriptCodePrinter):
    square_root = "Math.sqrt"


def python_function(block):
    """Return `block` as a Python function of numbers or of arrays that broadcast together."""
    printer = _Python()
    body = [f'"""{block.summary}"""']
    for comment, assignments in block.straight_line():
        body.append(f"# {comment}")
        body += [f"{name} = {printer.doprint(value)}" for name, value in assignments]
    body.append("return " + ", ".join(map(str, block.outputs)))
    return _def(block.name, map(str, block.inputs), body)


def python_lanes(block, rows, parameters):
    """Return `block` as a Python function on a work array, for one lane of many.

    Lane `lane` of quantity i stands at ``work[i * lanes + lane]``. With `work` flat, numba turns a
    loop over lanes into vector instructions. With ``lanes=1, lane=0`` and `work` of shape
    (rows, ...) the same text runs on NumPy arrays, and with `work` of shape (rows,) on numbers.

    Parameters
    ----------
    block : Block
        Its inputs are rows of `work`, or `parameters`; its outputs are rows.
    rows : dict
        Row number of each symbol that lives in `work`.
    parameters : sequence of str
        The remaining arguments of the function, in order.
    """
    printer = _Python()
    used = [symbol for symbol in block.inputs if symbol in rows]
    body = [f'"""{block.summary}"""']
    body += [f"{symbol} = {_place(rows[symbol])}" for symbol in used]
    for comment, assignments in block.straight_line():
        body.append(f"# {comment}")
        body += [f"{name} = {printer.doprint(value)}" for name, value in assignments]
    body += [f"{_place(rows[symbol])} = {symbol}" for symbol in block.outputs]
    return _def(block.name, ["work", "lanes", "lane", *parameters], body)


def c99_function(block):
    """Return `block` as a C99 function that writes its outputs to an array."""
    printer = _C99()
    body = [
        f"const double {name} = {printer.doprint(value)};"
        for _, assignments in block.straight_line()
        for name, value in assignments
    ]
    body += [f"out[{i}] = {symbol};" for i, symbol in enumerate(block.outputs)]
    arguments = ", ".join([f"double {symbol}" for symbol in block.inputs] + ["double *out"])
    head = f"void {block.name}({arguments})"
    return "#include <math.h>\n\n" + _wrapped(head) + "\n{\n" + _indented(body) + "\n}\n"


def javascript_function(block):
    """Return `block` as a JavaScript function that returns an array of its outputs."""
    printer = _JavaScript()
    body = [
        f"const {name} = {printer.doprint(value)};"
        for _, assignments in block.straight_line()
        for name, value in assignments
    ]
    body.append("return [" + ", ".join(map(str, block.outputs)) + "];")
    head = f"function {block.name}({', '.join(map(str, block.inputs))}) {{"
    return _wrapped(head) + "\n" + _indented(body) + "\n}\n"


def _place(row):
    return f"work[{row} * lanes + lane]"


def _def(name, arguments, body):
    return _wrapped(f"def {name}({', '.join(arguments)}):") + "\n" + _indented(body) + "\n"


def _wrapped(line):
    return "\n".join(textwrap.wrap(line, WIDTH, subsequent_indent="        "))


def _indented(lines):
    return "\n".join("    " + line for line in lines)
