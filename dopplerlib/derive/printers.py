"""From a block to source text: Python, C99 and JavaScript.

All three print the same operations in the same order, and only those that IEEE 754 defines to the
last bit (``+ - * /`` and the square root). So the languages agree exactly, not just closely.
"""

import textwrap

import sympy as sp

from .._hints import Index, checked
from ._arguments import Name
from ._exact import C99, C99Real, JavaScript, Python
from .block import Block

WIDTH = 79  # what a page of the book shows without a scroll bar


@checked
def python_function(block: Block) -> str:
    """Return `block` as a Python function of numbers or of arrays that broadcast together.

    Parameters
    ----------
    block : Block
        Of sums, products, quotients, powers of n/2 and square roots.

    Raises
    ------
    ValueError
        If something in `block` has no exactly rounded form, or a name is not to be printed.

    Examples
    --------
    >>> from dopplerlib.derive.block import Stage
    >>> x, cube = sp.symbols("x cube")
    >>> block = Block("power", "A cube.", (x,), (Stage("third", [(cube, x**3)]),), (cube,))
    >>> program = {}
    >>> exec(python_function(block), program)
    >>> program["power"](2)
    8
    """
    printer = Python()
    returned = "return " + ", ".join(_names(block.outputs, printer))
    if len(returned) > WIDTH:
        returned = _wrapped(f"return ({returned.removeprefix('return ')})")
    body = [*_docstring(block), *_commented(block, printer), *returned.split("\n")]
    return _def(printer.name(block.name), _names(block.inputs, printer), body)


@checked
def python_lanes(block: Block, places: dict[Name, tuple[str, Index]]) -> str:
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

    Raises
    ------
    ValueError
        As by `python_function`; or if `places` leaves out an output, or an array has the name of
        something else.

    Examples
    --------
    >>> from dopplerlib.derive.block import Stage
    >>> x, cube = sp.symbols("x cube")
    >>> block = Block("power", "A cube.", (x,), (Stage("third", [(cube, x**3)]),), (cube,))
    >>> program, work = {}, [2, None]
    >>> exec(python_lanes(block, {x: ("work", 0), cube: ("work", 1)}), program)
    >>> program["power"](work, lanes=1, lane=0)
    >>> work
    [2, 8]
    """
    printer = Python()
    inputs, arguments, arrays = _placed(block, places, printer)
    body = [
        *_docstring(block),
        *(f"{printer.doprint(symbol)} = {_place(*places[symbol])}" for symbol in inputs),
        *_commented(block, printer),
        *(f"{_place(*places[symbol])} = {printer.doprint(symbol)}" for symbol in block.outputs),
    ]
    head = [*arrays, "lanes", "lane", *_names(arguments, printer)]
    return _def(printer.name(block.name), head, body)


@checked
def c99_function(block: Block) -> str:
    """Return `block` as a C99 function that writes its outputs to an array.

    It takes and refuses the same blocks as `python_function`.

    Examples
    --------
    >>> from dopplerlib.derive.block import Stage
    >>> x, cube = sp.symbols("x cube")
    >>> block = Block("power", "A cube.", (x,), (Stage("third", [(cube, x**3)]),), (cube,))
    >>> print(c99_function(block).partition("void ")[2])
    power(double x, double *out)
    {
        const double cube = x*x*x;
        out[0] = cube;
    }
    <BLANKLINE>
    """
    printer = C99()
    body = [
        f"const double {printer.doprint(name)} = {printer.doprint(value)};"
        for _, assignments in block.straight_line()
        for name, value in assignments
    ]
    body += [f"out[{i}] = {name};" for i, name in enumerate(_names(block.outputs, printer))]
    arguments = [f"double {name}" for name in _names(block.inputs, printer)]
    head = f"void {printer.name(block.name)}({', '.join([*arguments, 'double *out'])})"
    return "#include <math.h>\n\n" + _wrapped(head) + "\n{\n" + _indented(body) + "\n}\n"


@checked
def c99_in_place(block: Block, places: dict[Name, tuple[str, Index]]) -> str:
    """Return `block` as a static C99 function on arrays, in double or single precision.

    The text that it becomes part of says what `doppler_real` is, and the square root
    `DOPPLER_SQRT`.

    Parameters
    ----------
    block : Block
        As by `python_lanes`.
    places : dict
        Name of the array and index of each symbol that lives in an array.

    Raises
    ------
    ValueError
        As by `python_lanes`.

    Examples
    --------
    >>> from dopplerlib.derive.block import Stage
    >>> x, cube = sp.symbols("x cube")
    >>> block = Block("power", "A cube.", (x,), (Stage("third", [(cube, x**3)]),), (cube,))
    >>> print(c99_in_place(block, {cube: ("work", 1)}))
    /* A cube. */
    static void power(doppler_real *work, doppler_real x)
    {
        /* third */
        const doppler_real cube = x*x*x;
        work[1] = cube;
    }
    <BLANKLINE>
    """
    printer = C99Real()
    inputs, arguments, arrays = _placed(block, places, printer)
    written = {places[symbol][0] for symbol in block.outputs}
    body = [f"const doppler_real {printer.doprint(s)} = {_element(*places[s])};" for s in inputs]
    for comment, assignments in block.straight_line():
        body.append(_remark(comment))
        for name, value in assignments:
            body.append(f"const doppler_real {printer.doprint(name)} = {printer.doprint(value)};")
    body += [f"{_element(*places[s])} = {printer.doprint(s)};" for s in block.outputs]
    head = [f"{'' if name in written else 'const '}doppler_real *{name}" for name in arrays]
    head += [f"doppler_real {name}" for name in _names(arguments, printer)]
    declared = _wrapped(f"static void {printer.name(block.name)}({', '.join(head)})")
    return f"{_remark(block.summary)}\n{declared}\n{{\n{_indented(body)}\n}}\n"


@checked
def javascript_function(block: Block) -> str:
    """Return `block` as a JavaScript function that returns an array of its outputs.

    It takes and refuses the same blocks as `python_function`.

    Examples
    --------
    >>> from dopplerlib.derive.block import Stage
    >>> x, cube = sp.symbols("x cube")
    >>> block = Block("power", "A cube.", (x,), (Stage("third", [(cube, x**3)]),), (cube,))
    >>> print(javascript_function(block))
    function power(x) {
        const cube = x*x*x;
        return [cube];
    }
    <BLANKLINE>
    """
    printer = JavaScript()
    body = [
        f"const {printer.doprint(name)} = {printer.doprint(value)};"
        for _, assignments in block.straight_line()
        for name, value in assignments
    ]
    body.append("return [" + ", ".join(_names(block.outputs, printer)) + "];")
    head = f"function {printer.name(block.name)}({', '.join(_names(block.inputs, printer))}) {{"
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


def _placed(block, places, printer):
    """Return the inputs that live in arrays, those that are arguments, and the arrays' names."""
    for symbol in block.outputs:
        if symbol not in places:
            raise ValueError(f"places must hold every output of the block, got none for {symbol}")
    names = block.names()
    for array, _ in places.values():
        if not printer.takes(array) or array in names:
            raise ValueError(
                f"places must name arrays by identifiers that nothing else has, got {array!r}"
            )
    inputs = [symbol for symbol in block.inputs if symbol in places]
    arguments = [symbol for symbol in block.inputs if symbol not in places]
    return inputs, arguments, dict.fromkeys(places[s][0] for s in (*inputs, *block.outputs))


def _remark(text):
    return f"/* {text.replace('*/', '* /')} */"


def _element(array, index):
    return f"{array}[{index}]"


def _place(array, row):
    return f"{array}[{row} * lanes + lane]"


def _def(name, arguments, body):
    return _wrapped(f"def {name}({', '.join(arguments)}):") + "\n" + _indented(body) + "\n"


def _wrapped(line):
    return "\n".join(textwrap.wrap(line, WIDTH, subsequent_indent="        "))


def _indented(lines):
    return "\n".join("    " + line if line else "" for line in lines)
