"""Operations are counted as they are printed, not as SymPy sees them."""

import pytest
import sympy as sp

from dopplerlib.derive.block import Block, Stage
from dopplerlib.derive.operations import KINDS, count_operations

a, b, c = sp.symbols("a b c", positive=True)
OUT, SECOND = sp.symbols("out_ second", real=True)


@pytest.mark.parametrize(
    ("expression", "counts"),  # additions, multiplications, divisions, square roots: by hand
    [
        (a + b - c, (2, 0, 0, 0)),
        (a**4 * b, (0, 4, 0, 0)),
        (1 / (a**2 * sp.sqrt(b)), (0, 2, 1, 1)),
        (c - a * b, (1, 1, 0, 0)),  # whichever way the sign is written
        (-a, (0, 0, 0, 0)),
        (a ** sp.Rational(-3, 2), (0, 1, 1, 1)),
    ],
    ids=str,
)
def test_what_is_printed_is_counted(expression, counts):
    block = Block("f", "A test.", (a, b, c), (Stage("all", [(OUT, expression)]),), (OUT,))
    count = count_operations(block)
    assert tuple(count[kind] for kind in KINDS) == counts


def test_a_shared_term_is_counted_once():
    length = sp.sqrt(a**2 + b**2)
    stage = Stage("all", [(OUT, a / length), (SECOND, b / length)])
    count = count_operations(Block("f", "A test.", (a, b), (stage,), (OUT, SECOND)))
    assert count["square roots"] == 1 and count["additions"] == 1
