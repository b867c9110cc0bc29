"""The printers print what is meant, in every language, or refuse."""

import inspect
import math

import numpy as np
import pytest
import sympy as sp

from dopplerlib.derive.block import Block, Stage
from dopplerlib.derive.printers import (
    c99_function,
    c99_in_place,
    javascript_function,
    python_function,
    python_lanes,
)

a, b, c = sp.symbols("a b c", positive=True)
OUT = sp.Symbol("out_", real=True)
FUNCTIONS = (python_function, c99_function, javascript_function)

HARD = [
    a / b**2,
    a / (b**2 * c),
    a / b / c,
    -(b**2),
    a - (b - c) ** 2,
    (a + b) ** 2 / c**3,
    (a + b) ** 3,
    1 / a,
    -1 / a,
    a**-2,
    (a + b) ** -2,
    a ** sp.Rational(3, 2),
    a ** sp.Rational(-3, 2),
    b / (a**2 + c**2) ** sp.Rational(3, 2),
    1 / sp.sqrt(a),
    c / (a * sp.sqrt(b)),
    sp.sqrt(a / b),
    1 / (a + 1 / b**2),
    a / 3 - 2 * b / 7,
    a / (2 * b),
    -2 * a**2 * b / 3,
    sp.Float(0.1) * a + sp.Float(-1e-7),
    # as elimination leaves them: powers of powers and of products
    sp.Pow(sp.Pow(a, 2, evaluate=False), 3, evaluate=False),
    sp.Pow(a / b, 3, evaluate=False),
    sp.Pow(a * b, -2, evaluate=False),
    sp.Mul(c, sp.Pow(a * b, -1, evaluate=False), evaluate=False),
    sp.Pow(-a, 3, evaluate=False),
    sp.Pow(a, 1, evaluate=False),
]


def block(expression, inputs=(a, b, c)):
    return Block("f", "A test.", inputs, (Stage("all", [(OUT, expression)]),), (OUT,))


def printed(function, expression):
    """Return the right-hand side that `function` prints for `expression`."""
    text = function(block(expression))
    return text.split("out_ = ")[1].splitlines()[0].rstrip(";")


@pytest.mark.parametrize("expression", HARD, ids=str)
def test_the_printed_text_means_the_expression(expression):
    # Read with the ordinary rules of precedence, which Python, C and JavaScript share. The values
    # differ and are far from 1, so a lost parenthesis changes the result in the first digits; 1e-14
    # leaves room for a dozen roundings.
    values = {a: 1.7, b: 0.3, c: 5.1}
    expected = float(sp.N(expression.subs({k: sp.Float(v, 40) for k, v in values.items()}), 30))
    for function in FUNCTIONS:
        text = printed(function, expression).replace("Math.", "")
        names = {str(symbol): value for symbol, value in values.items()}
        got = eval(text, {"sqrt": math.sqrt}, names)
        assert math.isclose(got, expected, rel_tol=1e-14), text


@pytest.mark.parametrize("expression", HARD, ids=str)
def test_the_languages_print_the_same_operations(expression):
    python, c99, javascript = (printed(function, expression) for function in FUNCTIONS)
    assert javascript.replace("Math.", "") == python
    # C99 writes the parts of a fraction as 1.0, because 1/3 would be 0 there.
    assert c99.replace(".0", "") == python.replace(".0", "")


def test_a_power_prints_as_a_product():
    for function in FUNCTIONS:
        text = printed(function, a**3 + b**-2)
        assert text == "a*a*a + 1/(b*b)"


def test_a_fraction_is_no_integer_division_in_c():
    assert printed(c99_function, a / 3) == "(1.0/3.0)*a"


def test_a_float_prints_with_all_its_digits():
    for number in (0.1, 1 / 3, 1e-300, 2.0**60):
        for function in FUNCTIONS:
            assert float(printed(function, sp.Float(number))) == number


@pytest.mark.parametrize(
    "expression",
    [
        sp.sin(a),
        sp.exp(a),
        sp.Abs(sp.Symbol("w", real=True)),
        sp.pi * a,
        a + sp.I,
        a ** sp.Rational(1, 3),
        a ** sp.Rational(1, 4),
        a**b,
        a ** sp.Float(2.0),
        a + sp.Float("1e400"),
        a + sp.Float("1e-400"),
        a + sp.Integer(2**53 + 1),
        a / sp.Integer(10**30),
        sp.Max(a, b),
    ],
    ids=str,
)
def test_an_expression_without_an_exactly_rounded_form_is_refused(expression):
    inputs = tuple(sorted(expression.free_symbols, key=str))
    for function in FUNCTIONS:
        with pytest.raises(ValueError, match=r"^block must hold what has an exactly rounded form"):
            function(block(expression, inputs))


@pytest.mark.parametrize(
    ("function", "name"),
    [
        (python_function, "lambda"),
        (c99_function, "double"),
        (javascript_function, "var"),
        *((function, name) for function in FUNCTIONS for name in ("sqrt", "x y", "", "1a", "é")),
    ],
)
def test_a_name_that_the_language_cannot_take_is_refused(function, name):
    odd = sp.Symbol(name, positive=True)
    with pytest.raises(ValueError, match=r"^block must use names .* not reserved, got"):
        function(block(2 * odd, (odd,)))
    with pytest.raises(ValueError, match=r"^block must use names .* not reserved, got"):
        function(Block(name, "A test.", (a,), (), (a,)))


@pytest.mark.parametrize("summary", ['a "quote"', "a\nline", "a \\", None])
def test_a_summary_that_would_end_the_docstring_is_refused(summary):
    with pytest.raises(ValueError, match=r"^summary must be one line of text"):
        Block("f", summary, (a,), (), (a,))


@pytest.mark.parametrize(
    "places", [{}, {OUT: ("while", 0)}, {OUT: ("a", 0)}, {OUT: ("work", -1)}, {"out_": ("w", 0)}]
)
@pytest.mark.parametrize("function", [python_lanes, c99_in_place])
def test_places_that_do_not_fit_are_refused(function, places):
    with pytest.raises(ValueError, match=r"^places.* must"):
        function(block(a), places)


def test_no_number_has_a_type_of_its_own_where_the_precision_is_open():
    expression = a / 3 + sp.Float(0.1) * b + 1 / sp.sqrt(c)
    text = c99_in_place(block(expression), {OUT: ("work", 0), a: ("read", 2)})
    assert "static void f(const doppler_real *read, doppler_real *work, doppler_real b," in text
    assert "const doppler_real a = read[2];" in text and "work[0] = out_;" in text
    assert "((doppler_real)1/(doppler_real)3)*a" in text and "(doppler_real)0.1*b" in text
    assert "1/DOPPLER_SQRT(c)" in text and "double" not in text


def test_a_remark_does_not_end_a_comment():
    odd = Block("f", "P */ x", (a,), (Stage("*/", [(OUT, a)]),), (OUT,))
    text = c99_in_place(odd, {OUT: ("work", 0)})
    assert text.count("*/") == text.count("/*") == 2


def test_lanes_are_neither_mixed_up_nor_touched():
    expression = (a - b) / c
    places = {a: ("work", 0), b: ("other", 1), OUT: ("work", 1)}
    text = python_lanes(block(expression), places)
    assert text.startswith("def f(work, other, lanes, lane, c):")
    space = {}
    exec(text, space)
    work = np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]])
    other = np.array([[9.0, 9.0, 9.0], [5.0, 8.0, 11.0]])
    flat = work.ravel().copy()
    space["f"](flat, other.ravel(), 3, 1, 2.0)
    assert flat.tolist() == [1.0, 2.0, 3.0, 0.0, -3.0, 0.0]
    space["f"](work, other, 1, 0, 2.0)
    assert work[1].tolist() == [-2.0, -3.0, -4.0]


def test_the_docstring_holds_the_equations_as_latex():
    with_equations = Block(
        "f", "A test.", (a,), (Stage("", [(OUT, 1 / a)]),), (OUT,), ((b, 1 / a),)
    )
    space = {}
    exec(python_function(with_equations), space)
    text = inspect.getdoc(space["f"])  # from Python 3.13 on, the compiler itself dedents
    assert r"b &= \frac{1}{a}" in text
    assert "\n.. math::\n\n    \\begin{aligned}\n" in text
