"""From a block to source text: Python, C99 and JavaScript.

All three print the same operations in the same order, and only those that IEEE 754 defines to the
last bit (``+ - * /`` and the square root). So the languages agree exactly, not just closely.
"""

import textwrap

import sympy as sp
from sympy.printing.c import C99CodePrinter
from sympy.printing.jscode import JavascriptCodePrinter
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

WIDTH = 79  # what a page of the book shows without a scroll bar


_NODES = (sp.Symbol, sp.Rational, sp.Float, sp.Add, sp.Mul, sp.Pow)
_EXACT_INTEGER = 2**53  # up to here a double holds every integer


class _Exact:
    """Print only what every language computes to the last bit, or raise NotImplementedError.

    A power becomes a product, because pow() may round differently elsewhere: x**3 is x*x*x,
    x**(-3/2) is 1/(x*sqrt(x)).
    """

    def __init__(self):
        super().__init__({"error_on_reserved": True})

    def doprint(self, expression):
        for node in sp.preorder_traversal(expression):
            if not isinstance(node, _NODES):
                raise NotImplementedError(f"no exactly rounded form of {node} in {expression}")
        return super().doprint(expression)

    def parenthesize(self, item, level, strict=False):
        # SymPy believes that a power binds more tightly than a product: ours is a product.
        if item.is_Pow and item.exp != sp.S.Half:
            return f"({self._print(item)})"
        return super().parenthesize(item, level, strict)

    def _print_Pow(self, expression, **kwargs):
        base, exponent = expression.args
        if not (2 * exponent).is_Integer:
            raise NotImplementedError(f"no exactly rounded form of {expression}")
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
            raise NotImplementedError(f"no exact double for a part of {number}")
        return write(number)

    def _print_Float(self, expression):
        return repr(float(expression))  # the shortest text that reads back as the same double


class _Python(_Exact, PythonCodePrinter):
    square_root = "sqrt"


class _C99(_Exact, C99CodePrinter):
    square_root = "sqrt"


class _JavaScript(_Exact, JavascriptCodePrinter):
    square_root = "Math.sqrt"


def python_function(block):
    """Return `block` as a Python function of numbers or of arrays that broadcast together."""
    printer = _Python()
    body = [*_docstring(block), *_commented(block, printer)]
    body.append("return " + ", ".join(_names(block.outputs, printer)))
    return _def(block.name, _names(block.inputs, printer), body)


def python_lanes(block, places):
    """Return `block` as a Python function on work arrays, for one lane of many.

    Lane `lane` of the quantity in row i of an array `work` stands at ``work[i * lanes + lane]``.
    With `work` flat, numba turns a loop over lanes into vector instructions. With
    ``lanes=1, lane=0`` and `work` of shape (rows, ...) the same text runs on NumPy arrays, and
    with `work` of shape (rows,) on numbers.

    Parameters
    ----------
    block : Block
        Its outputs have places. Its inputs have places too, or else are arguments of the function.
    places : dict
        Name of the array and row number of each symbol that lives in an array.
    """
    printer = _Python()
    inputs = [symbol for symbol in block.inputs if symbol in places]
    arguments = [symbol for symbol in block.inputs if symbol not in places]
    arrays = dict.fromkeys(places[symbol][0] for symbol in (*inputs, *block.outputs))
    body = [
        *_docstring(block),
        *(f"{printer.doprint(symbol)} = {_place(*places[symbol])}" for symbol in inputs),
        *_commented(block, printer),
        *(f"{_place(*places[symbol])} = {printer.doprint(symbol)}" for symbol in block.outputs),
    ]
    return _def(block.name, [*arrays, "lanes", "lane", *_names(arguments, printer)], body)


def c99_function(block):
    """Return `block` as a C99 function that writes its outputs to an array."""
    printer = _C99()
    body = [
        f"const double {printer.doprint(name)} = {printer.doprint(value)};"
        for _, assignments in block.straight_line()
        for name, value in assignments
    ]
    body += [f"out[{i}] = {name};" for i, name in enumerate(_names(block.outputs, printer))]
    arguments = [f"double {name}" for name in _names(block.inputs, printer)]
    head = f"void {block.name}({', '.join([*arguments, 'double *out'])})"
    return "#include <math.h>\n\n" + _wrapped(head) + "\n{\n" + _indented(body) + "\n}\n"


def javascript_function(block):
    """Return `block` as a JavaScript function that returns an array of its outputs."""
    printer = _JavaScript()
    body = [
        f"const {printer.doprint(name)} = {printer.doprint(value)};"
        for _, assignments in block.straight_line()
        for name, value in assignments
    ]
    body.append("return [" + ", ".join(_names(block.outputs, printer)) + "];")
    head = f"function {block.name}({', '.join(_names(block.inputs, printer))}) {{"
    return _wrapped(head) + "\n" + _indented(body) + "\n}\n"


def _names(symbols, printer):
    return [printer.doprint(symbol) for symbol in symbols]


def _docstring(block):
    if not block.equations:
        return [f'"""{block.summary}"""']
    *lines, last = [f"{sp.latex(name)} &= {sp.latex(value)}" for name, value in block.equations]
    return [
        f'r"""{block.summary}', "",
        ".. math::", "",
        r"    \begin{aligned}", *(rf"    {line} \\" for line in lines), f"    {last}",
        r"    \end{aligned}",
        '"""',
    ]  # fmt: skip


def _commented(block, printer):
    for comment, assignments in block.straight_line():
        yield f"# {comment}"
        for name, value in assignments:
            yield f"{printer.doprint(name)} = {printer.doprint(value)}"


def _place(array, row):
    return f"{array}[{row} * lanes + lane]"


def _def(name, arguments, body):
    return _wrapped(f"def {name}({', '.join(arguments)}):") + "\n" + _indented(body) + "\n"


def _wrapped(line):
    return "\n".join(textwrap.wrap(line, WIDTH, subsequent_indent="        "))


def _indented(lines):
    return "\n".join("    " + line if line else "" for line in lines)
