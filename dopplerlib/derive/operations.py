"""Operations of a block, counted in the text that is printed of it."""

import ast
from collections import Counter

from .._hints import checked
from ._exact import Python
from .block import Block

KINDS = ("additions", "multiplications", "divisions", "square roots")
_OF_NODE = {
    ast.Add: "additions",
    ast.Sub: "additions",
    ast.Mult: "multiplications",
    ast.Div: "divisions",
}


@checked
def count_operations(block: Block) -> Counter:
    """Count the operations of a block, with shared terms computed once.

    Parameters
    ----------
    block : Block
        As `python_function` takes it.

    Returns
    -------
    collections.Counter
        Number by kind: "additions", which are subtractions, too, "multiplications", "divisions" and
        "square roots". A change of sign is not counted: it costs nothing beside an addition.

    Raises
    ------
    ValueError
        As by `python_function`.

    Notes
    -----
    All printers print the same operations, so the numbers are those of every language.

    Examples
    --------
    >>> import sympy as sp
    >>> from dopplerlib.derive.block import Stage
    >>> x, y, length = sp.symbols("x y length")
    >>> stage = Stage("length", [(length, sp.sqrt(x**2 + y**2))])
    >>> count = count_operations(Block("norm", "Length.", (x, y), (stage,), (length,)))
    >>> [count[kind] for kind in KINDS]
    [1, 2, 0, 1]
    """
    printer, count = Python(), Counter()
    for _, assignments in block.straight_line():
        for _, value in assignments:
            for node in ast.walk(ast.parse(printer.doprint(value))):
                if isinstance(node, ast.Call):  # the printer knows no other function
                    count["square roots"] += 1
                elif isinstance(node, ast.BinOp):
                    count[_OF_NODE[type(node.op)]] += 1
    return count
