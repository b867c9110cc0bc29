"""A block is a straight line in which every name has one value before it is used."""

import pytest
import sympy as sp

from dopplerlib.derive.block import Block, Stage

a, b, c, d = sp.symbols("a b c d", real=True)


def block(*assignments, inputs=(a, b), outputs=()):
    return Block("f", "A test.", inputs, (Stage("all", list(assignments)),), outputs)


def run(block, values):
    """Execute what elimination left of `block`, exactly."""
    values = dict(values)
    for _, assignments in block.straight_line():
        for name, expression in assignments:
            assert expression.free_symbols <= values.keys()  # nothing is used before it is there
            values[name] = expression.subs(values)
    return values


def test_a_name_without_a_value_is_refused():
    with pytest.raises(ValueError, match=r"^stages must use names that have a value, got c$"):
        block((d, c + 1))
    with pytest.raises(ValueError, match=r"^stages must use names that have a value, got c$"):
        block((d, c + 1), (c, a))
    with pytest.raises(ValueError, match=r"^outputs must use names that have a value, got d$"):
        block((c, a), outputs=(d,))


def test_a_second_value_is_refused_even_if_the_symbols_differ_in_their_assumptions():
    with pytest.raises(ValueError, match=r"^stages must give c a value once"):
        block((c, a), (c, b))
    with pytest.raises(ValueError, match=r"^stages must give c a value once"):
        block((c, a), (sp.Symbol("c", positive=True), b))
    with pytest.raises(ValueError, match=r"^inputs must give a a value once"):
        block((c, a), inputs=(a, a))


def test_a_symbol_that_only_looks_like_an_input_is_refused():
    with pytest.raises(ValueError, match=r"^stages must use names that have a value, got a$"):
        block((c, 2 * sp.Symbol("a", positive=True)))


@pytest.mark.parametrize(
    "value",
    [2, sp.oo, sp.nan, sp.zoo, a > b, sp.Integral(a, b), sp.Symbol("A", commutative=False)],
    ids=str,
)
def test_what_is_no_finite_expression_is_refused(value):
    with pytest.raises(ValueError, match=r"^assignments must be a finite SymPy expression"):
        block((c, value))


def test_a_power_that_nobody_would_write_out_is_refused():
    block((c, a**64))
    for value in (a**65, a**-65, a ** (10**9)):
        with pytest.raises(ValueError, match=r"^assignments must hold powers up to 64 only"):
            block((c, value))


def test_elimination_computes_a_shared_term_once_and_changes_nothing():
    shared = (a + b) ** 2
    program = block((c, shared * a + 1 / shared), (d, shared + sp.sqrt(1 + shared)))
    values = run(program, {a: sp.Rational(3, 7), b: sp.Rational(5, 11)})
    for name, expression in program.stages[0].assignments:
        assert values[name] == expression.subs({a: sp.Rational(3, 7), b: sp.Rational(5, 11)})
    ((_, assignments),) = program.straight_line()
    assert sum(expression.count(sp.Add(a, b)) for _, expression in assignments) == 1


def test_a_temporary_never_takes_a_name_of_the_block():
    t0, t1 = sp.symbols("t0 t1", real=True)
    program = block((c, (a + b) * t0), (t1, (a + b) + t0), inputs=(a, b, t0))
    names = [name.name for _, assignments in program.straight_line() for name, _ in assignments]
    assert len(set(names)) == len(names)
    assert "t0" not in names
    assert run(program, {a: 2, b: 3, t0: 7})[c] == 35
