"""The Doppler shift of a moving point seen by a fixed sensor, and its gradient.

Equation numbers are those of Mittermaier et al. (2016), doi:10.5194/ars-14-39-2016.
"""

import sympy as sp

from .._hints import checked
from . import _arguments
from ._arguments import Expression
from .block import Block, Stage

STATE = sp.symbols("x y z v_x v_y v_z", real=True)
SENSOR = sp.symbols("s_x s_y s_z", real=True)
WAVELENGTH = sp.Symbol("lambda", positive=True)

# In code the factor 2 / lambda is one number: the Doppler shift of 1 m/s straight ahead.
DOPPLER_PER_SPEED = sp.Symbol("doppler_per_speed", positive=True)

LINE_OF_SIGHT = sp.symbols("d_x d_y d_z", real=True)
INVERSE_RANGE = sp.Symbol("inverse_range", positive=True)
RANGE = sp.Symbol("rho", positive=True)  # for the reader's formulas only

SHIFT = sp.Symbol("shift", real=True)
GRADIENT = sp.symbols("h_x h_y h_z h_vx h_vy h_vz", real=True)


def doppler_shift():
    """Return Eq 6, positive when target and sensor approach each other."""
    p, v = sp.Matrix(STATE[:3]), sp.Matrix(STATE[3:])
    to_sensor = sp.Matrix(SENSOR) - p
    return 2 * to_sensor.dot(v) / (WAVELENGTH * sp.sqrt(to_sensor.dot(to_sensor)))


def doppler_gradient():
    """Return the six partial derivatives of Eq 6, in the order of `STATE`."""
    return [sp.diff(doppler_shift(), component) for component in STATE]


@checked
def in_line_of_sight(expression: Expression) -> sp.Expr:
    """Rewrite `expression` with ``d = s - p``, inverse range ``1/|d|``, and 2/lambda as one name.

    The three are what a person would compute first. Naming them leaves only sums and products,
    so that every processor which follows IEEE 754 computes the same bits.

    Parameters
    ----------
    expression : sympy.Expr
        Of `STATE`, `SENSOR` and `WAVELENGTH`.

    Examples
    --------
    >>> in_line_of_sight((SENSOR[0] - STATE[0]) * STATE[3])
    d_x*v_x
    """
    d = LINE_OF_SIGHT
    to_line_of_sight = {p: s - d_i for p, s, d_i in zip(STATE[:3], SENSOR, d, strict=True)}
    named = sp.factor_terms(
        expression.subs(to_line_of_sight, simultaneous=True)
        .subs(sum(d_i**2 for d_i in d), INVERSE_RANGE**-2)
        .subs(WAVELENGTH, 2 / DOPPLER_PER_SPEED)
    )
    return _arguments.expression("expression", named)


def line_of_sight_stage():
    """Return the assignments that define what `in_line_of_sight` names."""
    d = LINE_OF_SIGHT
    return Stage(
        "line of sight and inverse range",
        [(d_i, s - p) for d_i, s, p in zip(d, SENSOR, STATE[:3], strict=True)]
        + [(INVERSE_RANGE, 1 / sp.sqrt(sum(d_i**2 for d_i in d)))],
    )


def shift_stage():
    """Return the assignment of the Doppler shift."""
    return Stage("Doppler shift, Eq 6", [(SHIFT, in_line_of_sight(doppler_shift()))])


def gradient_stage():
    """Return the assignments of the Doppler shift and its gradient, which share most terms."""
    gradient = [in_line_of_sight(g) for g in doppler_gradient()]
    return Stage(
        "Doppler shift, Eq 6, and its gradient, Eq 7",
        [(SHIFT, in_line_of_sight(doppler_shift())), *zip(GRADIENT, gradient, strict=True)],
    )


@checked
def as_written(expression: Expression) -> sp.Expr:
    """Rewrite `expression` as by hand: with ``d = s - p``, the range ``rho = |d|``, and lambda.

    Parameters
    ----------
    expression : sympy.Expr
        Of `STATE`, `SENSOR` and `WAVELENGTH`.

    Examples
    --------
    >>> as_written(doppler_shift())
    2*(d_x*v_x + d_y*v_y + d_z*v_z)/(lambda*rho)
    """
    by_hand = {INVERSE_RANGE: 1 / RANGE, DOPPLER_PER_SPEED: 2 / WAVELENGTH}
    return in_line_of_sight(expression).subs(by_hand)


@checked
def equations(gradient: bool = True) -> tuple:
    """Return the formulas behind a block as (left side, right side), for its docstring.

    Parameters
    ----------
    gradient : bool
        Whether the derivatives are among them.

    Examples
    --------
    >>> equations(gradient=False)[0]
    (d_x, s_x - x)
    """
    d, h = LINE_OF_SIGHT, sp.Symbol("h")
    lines = [(d_i, s - p) for d_i, s, p in zip(d, SENSOR, STATE[:3], strict=True)]
    lines += [(RANGE, sp.sqrt(sum(d_i**2 for d_i in d))), (h, as_written(doppler_shift()))]
    if gradient:
        for component, derivative in zip(STATE, doppler_gradient(), strict=True):
            left = sp.Symbol(rf"\frac{{\partial h}}{{\partial {sp.latex(component)}}}")
            lines.append((left, as_written(derivative)))
    factor = sp.Symbol(r"\mathtt{doppler\_per\_speed}")  # how the code spells it
    return (*lines, (factor, 2 / WAVELENGTH))


def shift_block():
    """Return the program of the Doppler shift alone."""
    return Block(
        name="doppler_shift",
        summary="Doppler shift in Hz, positive when approaching (Eq 6).",
        inputs=(*STATE, *SENSOR, DOPPLER_PER_SPEED),
        stages=(line_of_sight_stage(), shift_stage()),
        outputs=(SHIFT,),
        equations=equations(gradient=False),
    )


def gradient_block():
    """Return the program of the Doppler shift and its six partial derivatives."""
    return Block(
        name="doppler_shift_and_gradient",
        summary="Doppler shift in Hz and its derivatives by x, y, z, v_x, v_y, v_z (Eqs 6, 7).",
        inputs=(*STATE, *SENSOR, DOPPLER_PER_SPEED),
        stages=(line_of_sight_stage(), gradient_stage()),
        outputs=(SHIFT, *GRADIENT),
        equations=equations(),
    )
