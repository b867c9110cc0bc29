"""What sensors on a circle, in a plane or on a line cannot tell apart: proofs in symbols.

Every ``prove_...`` function returns an expression that SymPy has simplified; the claim is proved
if it is zero. The numbers belong to `dopplerlib.model.ambiguity`.

The ring theorem. Let all sensors stand on one circle of radius r about the origin in the plane
x = 0. Their Doppler shifts depend on a state through A = p.p + r^2, y, z, w = p.v, v_y and v_z
only, and multiplying A, y, z by t^2 and w, v_y, v_z by t changes none of them, wherever on the
circle a sensor stands. So however many sensors there are, the states of such a family look alike,
and a Fisher information of a constant state has rank five at most.

A platform that moves and turns as a whole cures none of this: seen from it the ring stands still,
and the velocity of the target differs by a known linear function of its position. What it does is
to turn the direction that is lost, by another amount at each time.
"""

from functools import cache

import sympy as sp

from .._hints import checked
from ._arguments import Expression
from .block import Block, Stage
from .doppler import SENSOR, STATE, WAVELENGTH, doppler_gradient, doppler_shift
from .links import FRAME, SENSOR_VELOCITY, link_shift

RADIUS = sp.Symbol("r", positive=True)
ANGLE = sp.Symbol("varphi", real=True)  # where on the circle a sensor stands
SCALE = sp.Symbol("t", positive=True)  # where in the family a state is; 1 is the state itself
TURN = sp.Symbol("alpha", real=True)
PLATFORM = sp.symbols("c_x c_y c_z", real=True)  # velocity of the ring's center; FRAME: its turn

INVARIANTS = sp.symbols("A y z w v_y v_z", real=True)

_State = tuple[Expression, Expression, Expression, Expression, Expression, Expression]


def sensor_on_circle():
    """Return the position of a sensor at `ANGLE`, counted from the y axis towards the z axis."""
    return sp.Matrix([0, RADIUS * sp.cos(ANGLE), RADIUS * sp.sin(ANGLE)])


@checked
def invariants(state: _State = STATE) -> sp.Matrix:
    """Return what a ring sees of a state: p.p + r^2, y, z, p.v, v_y and v_z.

    Parameters
    ----------
    state : iterable of six sympy.Expr
        In the order of `STATE`.

    Examples
    --------
    >>> from dopplerlib.derive.doppler import STATE
    >>> invariants(STATE).T
    Matrix([[r**2 + x**2 + y**2 + z**2, y, z, v_x*x + v_y*y + v_z*z, v_y, v_z]])
    """
    p, v = sp.Matrix(state[:3]), sp.Matrix(state[3:])
    return sp.Matrix([p.dot(p) + RADIUS**2, p[1], p[2], p.dot(v), v[1], v[2]])


def shift_on_circle():
    """Return the Doppler shift of a sensor on the circle as a function of `INVARIANTS`.

    A sensor s at distance r from the origin has (s - p).(s - p) = A - 2 s.p and
    (s - p).v = s.v - w, and without an x component s.p and s.v hold y, z, v_y and v_z only.
    """
    A, y, z, w, v_y, v_z = INVARIANTS
    s = sensor_on_circle()
    square = A - 2 * (s[1] * y + s[2] * z)
    return 2 * (s[1] * v_y + s[2] * v_z - w) / (WAVELENGTH * sp.sqrt(square))


def family_state():
    """Return the state at `SCALE` in the family of `STATE`, on the side x > 0."""
    A, y, z, w, v_y, v_z = invariants()
    y, z, w, v_y, v_z = SCALE**2 * y, SCALE**2 * z, SCALE * w, SCALE * v_y, SCALE * v_z
    x = sp.sqrt(SCALE**2 * A - RADIUS**2 - y**2 - z**2)
    return sp.Matrix([x, y, z, (w - y * v_y - z * v_z) / x, v_y, v_z])


def family_block():
    """Return the program of `family_state`."""
    seen = list(zip(INVARIANTS, invariants(), strict=True))
    (A, square), (w, along) = seen[0], seen[3]
    new = sp.symbols("x_new y_new z_new v_x_new v_y_new v_z_new", real=True)
    x, y, z, v_x, v_y, v_z = new
    _, start_y, start_z, _, start_v_y, start_v_z = STATE
    scaled = [
        (y, SCALE**2 * start_y), (z, SCALE**2 * start_z),
        (v_y, SCALE * start_v_y), (v_z, SCALE * start_v_z),
        (x, sp.sqrt(SCALE**2 * A - RADIUS**2 - y**2 - z**2)),
        (v_x, (SCALE * w - y * v_y - z * v_z) / x),
    ]  # fmt: skip
    return Block(
        name="ring_family_state",
        summary="State at t in the family that a ring of radius r cannot tell apart, for x > 0.",
        inputs=(*STATE, RADIUS, SCALE),
        stages=(
            Stage("what the ring sees of the state", [(A, square), (w, along)]),
            Stage("the same of the scaled state, solved for it", scaled),
        ),
        outputs=new,
    )


@cache
def family_direction():
    """Return the derivative of `family_state` by `SCALE` at the state itself, for x > 0."""
    ahead = sp.Symbol("x", positive=True)
    at_state = sp.diff(family_state().subs(STATE[0], ahead), SCALE).subs(SCALE, 1)
    return sp.ImmutableMatrix(at_state.applyfunc(sp.simplify).subs(ahead, STATE[0]))


def prove_invariants_suffice():
    """Return Eq 6 for a sensor on the circle, minus `shift_on_circle` of the state's invariants."""
    on_circle = dict(zip(SENSOR, sensor_on_circle(), strict=True))
    by_invariants = dict(zip(INVARIANTS, invariants(), strict=True))
    return sp.simplify(
        _expanded_roots(doppler_shift().subs(on_circle))
        - _expanded_roots(shift_on_circle().subs(by_invariants, simultaneous=True))
    )


def prove_family_looks_alike():
    """Return the Doppler shift of the scaled invariants minus that of the invariants."""
    A, y, z, w, v_y, v_z = INVARIANTS
    scaled = {A: SCALE**2 * A, y: SCALE**2 * y, z: SCALE**2 * z}
    scaled |= {w: SCALE * w, v_y: SCALE * v_y, v_z: SCALE * v_z}
    shift = shift_on_circle()
    return sp.simplify(_factored_roots(shift.subs(scaled, simultaneous=True)) - shift)


def prove_family_state():
    """Return the invariants of `family_state` minus the scaled invariants of the state, (6, 1)."""
    A, y, z, w, v_y, v_z = invariants()
    t = SCALE
    scaled = sp.Matrix([t**2 * A, t**2 * y, t**2 * z, t * w, t * v_y, t * v_z])
    return (invariants(family_state()) - scaled).applyfunc(sp.simplify)


def prove_direction_is_unseen():
    """Return the derivative of Eq 6 along `family_direction`, for any sensor on the circle."""
    on_circle = dict(zip(SENSOR, sensor_on_circle(), strict=True))
    gradient = sp.Matrix(doppler_gradient()).subs(on_circle)
    return sp.simplify(gradient.dot(family_direction()))


def platform_direction():
    """Return the direction that a ring does not see while it moves and turns, for x > 0."""
    p, v, center, turn = (sp.Matrix(m) for m in (STATE[:3], STATE[3:], PLATFORM, FRAME))
    seen = dict(zip(STATE[3:], v - center - turn.cross(p), strict=True))
    direction = family_direction().subs(seen, simultaneous=True)
    position, velocity = direction[:3, :], direction[3:, :]
    return sp.Matrix([*position, *(velocity + turn.cross(position))])


def prove_rigid_motion_is_no_cure():
    """Return the derivative of the shift along `platform_direction`, for any sensor on the ring.

    It is freed of its denominator x D^(3/2), with the squared range D: that leaves a polynomial.
    """
    s = sensor_on_circle()
    velocity = sp.Matrix(PLATFORM) + sp.Matrix(FRAME).cross(s)
    on_ring = dict(zip((*SENSOR, *SENSOR_VELOCITY), (*s, *velocity), strict=True))
    apart = sp.Matrix(STATE[:3]) - sp.Matrix(SENSOR)
    square = apart.dot(apart)
    M = (link_shift() * sp.sqrt(square) * WAVELENGTH).subs(on_ring)  # the shift without its root
    D = square.subs(on_ring)
    along = (STATE[0] * platform_direction()).applyfunc(sp.expand)
    dM, dD = (sp.Matrix([sp.diff(f, c) for c in STATE]).dot(along) for f in (M, D))
    polynomial = sp.Poly(2 * D * dM - M * dD, sp.cos(ANGLE), sp.sin(ANGLE))
    one = sp.Poly(sp.cos(ANGLE) ** 2 + sp.sin(ANGLE) ** 2 - 1, *polynomial.gens)
    return sp.rem(polynomial, one).as_expr()


def prove_mirror_looks_alike():
    """Return Eq 6 of a state mirrored at x = 0 minus Eq 6, for any sensor in that plane."""
    x, _, _, v_x, _, _ = STATE
    shift = doppler_shift().subs(SENSOR[0], 0)
    return sp.simplify(shift.subs({x: -x, v_x: -v_x}, simultaneous=True) - shift)


def prove_turn_looks_alike():
    """Return Eq 6 of a state turned about the y axis minus Eq 6, for any sensor on that axis."""
    turn = sp.rot_axis2(TURN)
    p, v = sp.Matrix(STATE[:3]), sp.Matrix(STATE[3:])
    turned = dict(zip(STATE, [*(turn @ p), *(turn @ v)], strict=True))
    shift = doppler_shift().subs({SENSOR[0]: 0, SENSOR[2]: 0})
    return sp.simplify(_expanded_roots(shift.subs(turned, simultaneous=True)) - shift)


def prove_circling_is_unseen():
    """Return the derivative of Eq 6 by a speed about the y axis, for any sensor on that axis.

    With `prove_turn_looks_alike` this leaves a line of sensors four of six components.
    """
    x, _, z, _, _, _ = STATE
    _, _, _, h_vx, _, h_vz = doppler_gradient()
    return sp.simplify((z * h_vx - x * h_vz).subs({SENSOR[0]: 0, SENSOR[2]: 0}))


def _expanded_roots(expression):
    """Expand and simplify what stands under a root, so that equal roots look equal."""
    return expression.replace(
        lambda e: e.is_Pow and e.exp.is_Rational and e.exp.q == 2,
        lambda e: sp.Pow(sp.trigsimp(sp.expand(e.base)), e.exp),
    )


def _factored_roots(expression):
    """Take common positive factors out of roots."""
    return expression.replace(
        lambda e: e.is_Pow and e.exp.is_Rational and e.exp.q == 2,
        lambda e: sp.Pow(sp.factor_terms(e.base), e.exp),
    )
