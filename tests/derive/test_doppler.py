"""The mathematics before it is printed: proved with symbols."""

import random
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from dopplerlib.derive import doppler, ekf
from dopplerlib.derive.printers import python_function

d = sp.Matrix(doppler.SENSOR) - sp.Matrix(doppler.STATE[:3])
rho = sp.sqrt(d.dot(d))
BACK = {
    **dict(zip(doppler.LINE_OF_SIGHT, d, strict=True)),
    doppler.INVERSE_RANGE: 1 / rho,
    doppler.RANGE: rho,
    doppler.DOPPLER_PER_SPEED: 2 / doppler.WAVELENGTH,
}


def closed_form():
    """Return Eq 6 and its gradient from the vector form (g/rho)(u (u.v) - v), g u, typed anew."""
    v = sp.Matrix(doppler.STATE[3:])
    u, g = d / rho, 2 / doppler.WAVELENGTH
    position = g / rho * (u * u.dot(v) - v)
    return [g * u.dot(v), *position, *(g * u)]


DERIVED = [doppler.doppler_shift(), *doppler.doppler_gradient()]


@pytest.mark.parametrize("place", range(7))
def test_the_gradient_is_the_closed_vector_form(place):
    assert sp.simplify(DERIVED[place] - closed_form()[place]) == 0


@pytest.mark.parametrize("rewrite", [doppler.in_line_of_sight, doppler.as_written])
@pytest.mark.parametrize("place", range(7))
def test_naming_the_line_of_sight_changes_nothing(rewrite, place):
    named = rewrite(DERIVED[place])
    assert not named.free_symbols & {*doppler.SENSOR, *doppler.STATE[:3]}
    assert sp.simplify(named.subs(BACK) - DERIVED[place]) == 0


def test_the_sign_is_that_of_an_approach():
    head_on = {**dict.fromkeys(doppler.SENSOR, 0), **dict.fromkeys(doppler.STATE, 0)}
    head_on |= {doppler.STATE[0]: 1, doppler.STATE[3]: -1, doppler.WAVELENGTH: sp.Rational(1, 80)}
    assert doppler.doppler_shift().subs(head_on) == 160


def test_the_equations_in_the_docstring_are_those_that_are_printed():
    lines = {sp.latex(left): right for left, right in doppler.equations()}
    for component, derivative in zip(doppler.STATE, doppler.doppler_gradient(), strict=True):
        right = lines[rf"\frac{{\partial h}}{{\partial {sp.latex(component)}}}"]
        assert sp.simplify(right.subs(BACK) - derivative) == 0
    assert sp.simplify(lines["h"].subs(BACK) - doppler.doppler_shift()) == 0


def test_the_transition_moves_the_position_by_one_interval():
    moved = ekf.transition() @ sp.Matrix(doppler.STATE)
    x, v = sp.Matrix(doppler.STATE[:3]), sp.Matrix(doppler.STATE[3:])
    assert moved == sp.Matrix([*(x + ekf.T * v), *v])


def in_fractions(block, values):
    """Return the values of all symbols by name after the printed `block`, as exact fractions."""
    program = {}
    # What keeps 0 / 0 out has no place in exact arithmetic.
    exec(python_function(block).replace(repr(float(ekf.NOTHING)), "0"), program)
    outputs = program[block.name](*(values[symbol.name] for symbol in block.inputs))
    names = [symbol.name.removesuffix("_new") for symbol in block.outputs]
    return values | dict(zip(names, outputs, strict=True))


def matrix(values, entries):
    return np.array([[values.get(str(entry), entry) for entry in row] for row in entries.tolist()])


def covariance(values):
    U, D = (matrix(values, factor) for factor in ekf.factors())
    return U @ D @ U.T


@pytest.mark.parametrize("step", ["predict", "add_noise", "update", "covariance"])
def test_the_steps_of_the_factors_are_those_of_the_covariance(step):
    rng = random.Random(2016)
    block = next(block for block in ekf.blocks() if block.name == step)
    names = {symbol.name for symbol in (*block.inputs, *ekf.FACTORS, *doppler.GRADIENT, *ekf.NOISE)}
    values = {name: Fraction(rng.randint(1, 99), rng.randint(1, 99)) for name in sorted(names)}
    after, P = in_fractions(block, values), covariance(values)
    g, h = (np.array([values[s.name] for s in v]) for v in (ekf.NOISE, doppler.GRADIENT))
    if step == "predict":
        F = matrix(values, ekf.transition())
        assert (covariance(after) == F @ P @ F.T).all()
    elif step == "add_noise":
        assert (covariance(after) == P + np.outer(g, g)).all()
    elif step == "update":
        s = h @ P @ h + values["variance"]
        assert (covariance(after) == P - np.outer(P @ h, P @ h) / s).all()
    else:
        assert [after[symbol.name] for symbol in ekf.COVARIANCE] == P[np.triu_indices(6)].tolist()
