"""The mathematics before it is printed: proved with symbols."""

import pytest
import sympy as sp

from dopplerlib.derive import doppler, ekf

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


def test_the_printed_time_update_is_f_p_f_plus_q():
    block = ekf.predict_block()
    values = {}
    for stage in block.stages:
        values |= {str(name): expression for name, expression in stage.assignments}
    f = ekf.transition()
    expected = f @ ekf.symmetric(ekf.COVARIANCE) @ f.T + ekf.symmetric(ekf.PROCESS_NOISE)
    for (i, j), symbol in zip(ekf.UPPER, ekf.COVARIANCE, strict=True):
        assert sp.expand(values[f"{symbol.name}_new"] - expected[i, j]) == 0
