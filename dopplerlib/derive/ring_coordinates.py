"""Coordinates in which a ring of sensors sees five numbers, and the sixth is a scale of its own.

The sensors stand in the plane x = 0 or close to it, and r is a radius: that of their circle, or
another one. With rho^2 = p.p + r^2 the coordinates of a state with x > 0 are

    eta = (y, z) / rho^2 in 1/m,  beta = (v_y, v_z) / rho in 1/s,  b = p.v / rho in m/s,  ln rho.

The Doppler shift of a sensor on the circle is a function of the first five. Its derivative by
ln rho is zero at *every* state, so no linearization, wherever it is taken, invents knowledge of the
range. For other sensors it is small: of the order of (s.s - r^2) / rho^2, or of s_x x / rho^2.
Bearings have such coordinates, too, the modified polar ones (Aidala and Hammel 1983).

Every ``prove_...`` function returns what is zero if the claim is proved. Range rho is a symbol of
its own, by which `_total` differentiates: then all is a rational function, which SymPy decides.
"""

from typing import Annotated

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from .._hints import checked, up_to
from .block import Block, Stage
from .doppler import DOPPLER_PER_SPEED, RANGE, SENSOR, SHIFT, STATE
from .ekf import T
from .ring import RADIUS

COORDINATES = sp.symbols("eta_y eta_z beta_y beta_z b ell", real=True)
INVERSE_RANGE = sp.Symbol("u", positive=True)  # 1 / rho = exp(-ell)
AXES = "etay", "etaz", "betay", "betaz", "b", "ell"
GRADIENT = sp.symbols([f"h_{axis}" for axis in (*AXES, "x", "vx")], real=True)
SIZE = sp.Symbol("epsilon", positive=True)  # scale of the array

# Speed squared, and the range after an interval over that before it.
SQUARE = sp.Symbol("V", nonnegative=True)
GROWTH = sp.Symbol("growth", positive=True)

_SLOPES = sp.symbols([f"V_{axis}" for axis in AXES], real=True)
_P, _V = sp.Matrix(STATE[:3]), sp.Matrix(STATE[3:])


def coordinates():
    """Return `COORDINATES` as functions of `STATE` and the range."""
    across = [component / RANGE**2 for component in _P[1:]]
    turning = [component / RANGE for component in _V[1:]]
    return sp.Matrix([*across, *turning, _P.dot(_V) / RANGE, sp.log(RANGE)])


def jacobian():
    """Return the derivatives of `coordinates` by the state, (6, 6)."""
    columns = [coordinates().diff(component) for component in STATE]
    for i in range(3):  # the range changes with the position: by p / rho
        columns[i] += coordinates().diff(RANGE) * _P[i] / RANGE
    return sp.Matrix.hstack(*columns)


def rates():
    """Return the rates of `COORDINATES` at constant velocity, as functions of them and of v.v.

    The first five hold the factor 1 / rho: the scale is seen through rates only.
    """
    eta, beta, b = sp.Matrix(COORDINATES[:2]), sp.Matrix(COORDINATES[2:4]), COORDINATES[4]
    u = INVERSE_RANGE
    return sp.Matrix(
        [*(u * (beta - 2 * b * eta)), *(-u * b * beta), u * (_V.dot(_V) - b**2), u * b]
    )


def shift_in_coordinates():
    """Return the Doppler shift of a sensor as a function of `COORDINATES`, x and v_x.

    From (s - p).(s - p) = rho^2 - 2 s.p + s.s - r^2 and (s - p).v = s.v - p.v, over rho. Of a
    sensor in the plane x = 0 it is one of `COORDINATES`.
    """
    (s_x, *across), u, b = SENSOR, INVERSE_RANGE, COORDINATES[4]
    s, eta, beta = sp.Matrix(across), sp.Matrix(COORDINATES[:2]), sp.Matrix(COORDINATES[2:4])
    x, v_x = STATE[0], STATE[3]
    off = (s_x**2 + s.dot(s) - RADIUS**2 - 2 * s_x * x) * u**2  # zero on the circle
    closing = s.dot(beta) + s_x * v_x * u - b
    return DOPPLER_PER_SPEED * closing / sp.sqrt(1 - 2 * s.dot(eta) + off)


def gradient_in_coordinates():
    """Return the derivatives of `shift_in_coordinates` by `COORDINATES`, x and v_x.

    The latter two are functions of the coordinates, with the slopes of `inverse_jacobian`.
    """
    shift = shift_in_coordinates()
    by_scale = -INVERSE_RANGE * sp.diff(shift, INVERSE_RANGE)  # u = exp(-ell)
    ahead = (sp.diff(shift, STATE[i]) for i in (0, 3))
    return [*(sp.diff(shift, component) for component in COORDINATES[:5]), by_scale, *ahead]


def moved():
    """Return growth^2 and the coordinates after `T`, in terms of those before, V = v.v and growth.

    Of rho'^2 = rho^2 + 2 T rho b + T^2 V only the growth rho' / rho is needed; the last coordinate
    becomes ell + ln growth.
    """
    eta, beta, b = sp.Matrix(COORDINATES[:2]), sp.Matrix(COORDINATES[2:4]), COORDINATES[4]
    u = INVERSE_RANGE
    growth_square = 1 + 2 * T * u * b + T**2 * u**2 * SQUARE
    across = (eta + T * u * beta) / GROWTH**2
    return growth_square, sp.Matrix([*across, *(beta / GROWTH), (b + T * u * SQUARE) / GROWTH])


def transition():
    """Return the derivatives of the coordinates after `T` by those before, (6, 6).

    Those of V by the coordinates stay symbols: V is worked out from the state.
    """
    growth_square, after = moved()
    slopes = sp.Matrix([_SLOPES])

    def total(value):  # V and the inverse range are functions of the coordinates
        row = (
            sp.Matrix([[sp.diff(value, c) for c in COORDINATES]]) + sp.diff(value, SQUARE) * slopes
        )
        row[5] -= INVERSE_RANGE * sp.diff(value, INVERSE_RANGE)
        return row

    relative = total(growth_square) / (2 * GROWTH**2)  # of growth, over itself: that of ln growth
    rows = [total(value) + GROWTH * sp.diff(value, GROWTH) * relative for value in after]
    last = relative + sp.Matrix([[0, 0, 0, 0, 0, 1]])
    return sp.Matrix.vstack(*rows, last)


def twin_in_coordinates():
    """Return the coordinates that a plane array confuses with `COORDINATES` to second order.

    With m = beta - b eta the shift of a sensor is, in powers of s, and but for 2 / lambda,

        -b + s.m - (b / 2) ((s.delta)^2 - (s.m / b)^2) + ...,  delta = eta - m / b.

    The *square* of delta is seen, not its sign: the twin has -delta, and the same m, b and rho.
    """
    eta, beta, b = sp.Matrix(COORDINATES[:2]), sp.Matrix(COORDINATES[2:4]), COORDINATES[4]
    m = beta - b * eta
    other = 2 * m / b - eta
    return sp.Matrix([*other, *(m + b * other), *COORDINATES[4:]])


def conditions():
    """Return what determines `STATE`, with x > 0, from `COORDINATES`, one component after another.

    A list of (component, left side, right side). The left side holds the component and earlier
    ones, the right side coordinates, the range and earlier ones.
    """
    eta_y, eta_z, beta_y, beta_z, b, _ = COORDINATES
    x, y, z, v_x, v_y, v_z = STATE
    return [
        (y, y, eta_y * RANGE**2),
        (z, z, eta_z * RANGE**2),
        (v_y, v_y, beta_y * RANGE),
        (v_z, v_z, beta_z * RANGE),
        (x, x**2, RANGE**2 - RADIUS**2 - y**2 - z**2),
        (v_x, x * v_x, RANGE * b - y * v_y - z * v_z),
    ]


def inverse_jacobian():
    """Return the derivatives of `STATE` by `COORDINATES`, (6, 6), as functions of both and rho.

    By differentiation of the `conditions`; the derivative of rho = exp(ell) by ell is rho.
    """
    rows = {}
    for component, left, right in conditions():
        row = sp.Matrix([[sp.diff(right, c) for c in COORDINATES]])
        row[5] += RANGE * sp.diff(right, RANGE)
        for known, slope in rows.items():
            row += sp.diff(right - left, known) * slope
        rows[component] = (row / sp.diff(left, component)).applyfunc(sp.factor)
    return sp.Matrix.vstack(*(rows[component] for component in STATE))


def prove_shift():
    """Return the difference of both squares of the shift, as (s - p).v / range and in coordinates.

    The signs of the two agree where their numerators do, which `prove_sign` shows.
    """
    s = sp.Matrix(SENSOR)
    from_state = DOPPLER_PER_SPEED**2 * (s - _P).dot(_V) ** 2 / (s - _P).dot(s - _P)
    return _decided(_in_state(shift_in_coordinates() ** 2) - from_state)


def prove_sign():
    """Return rho times the numerator of the shift in coordinates, minus that of the shift."""
    numerator = sp.numer(_in_state(shift_in_coordinates() / DOPPLER_PER_SPEED)) * RANGE
    return _decided(numerator - (sp.Matrix(SENSOR) - _P).dot(_V))


def prove_scale_is_unseen():
    """Return the derivatives by ln rho, x and v_x of the shift of a sensor on the circle."""
    y, z = SENSOR[1:]
    circle = {RADIUS: sp.sqrt(y**2 + z**2), SENSOR[0]: 0}
    return sp.Matrix([sp.simplify(slope.subs(circle)) for slope in gradient_in_coordinates()[5:]])


def prove_rates():
    """Return `jacobian` times (v, 0), less `rates`, (6, 1)."""
    moved = jacobian() @ sp.Matrix([*_V, 0, 0, 0])
    return (moved - _in_state(rates())).applyfunc(_decided)


def prove_inverse():
    """Return `jacobian` times `inverse_jacobian`, less the identity, (6, 6)."""
    return (jacobian() @ _in_state(inverse_jacobian()) - sp.eye(6)).applyfunc(_decided)


def prove_motion():
    """Return the coordinates of (p + T v, v) less `moved`, (5, 1), and the same of growth^2."""
    later = _P + T * _V
    after = RANGE * GROWTH  # squared: p'.p' + r^2
    ahead = dict(zip(STATE[:3], later, strict=True)) | {RANGE: after}
    expected = coordinates()[:5, :].subs(ahead, simultaneous=True)
    growth_square, values = moved()
    speed = {SQUARE: _V.dot(_V)}
    rest = (_in_state(values.subs(speed)) - expected).applyfunc(_decided)
    grown = (later.dot(later) + RADIUS**2) / RANGE**2 - growth_square.subs(speed)
    return rest, _decided(_in_state(grown))


def prove_volume():
    """Return the determinant of `jacobian` plus x^2 / rho^9: densities change by that factor."""
    matrix = DomainMatrix.from_Matrix(jacobian()).to_field()
    return sp.cancel(matrix.domain.to_sympy(matrix.det()) + STATE[0] ** 2 / RANGE**9)


@checked
def prove_twin(order: Annotated[int, up_to(3, least=0)]) -> sp.Expr:
    """Return the term of this order in the size of the array of the shifts' difference.

    Parameters
    ----------
    order : int
        From 0 to 3, the first that is not zero.

    Examples
    --------
    >>> prove_twin(2)
    0
    """
    grown = {s: SIZE * s for s in SENSOR} | {SENSOR[0]: 0, RADIUS: SIZE * RADIUS}
    shift = shift_in_coordinates().subs(grown, simultaneous=True)
    twin = dict(zip(COORDINATES, twin_in_coordinates(), strict=True))
    difference = shift.subs(twin, simultaneous=True) - shift
    return sp.factor(sp.diff(difference, SIZE, order).subs(SIZE, 0))


def shift_block():
    """Return the program of the shift of a sensor, and of its gradient."""
    root = sp.Symbol("inverse_root", positive=True)
    under = sp.denom(shift_in_coordinates()) ** 2
    values = [shift_in_coordinates(), *gradient_in_coordinates()]
    named = [sp.factor_terms(value.subs(under, root**-2)) for value in values]
    return Block(
        name="shift_and_gradient",
        summary="Doppler shift in Hz; derivatives by eta, beta, b and ln rho, and by x and v_x.",
        inputs=(*COORDINATES[:5], INVERSE_RANGE, STATE[0], STATE[3], *SENSOR, RADIUS,
                DOPPLER_PER_SPEED),
        stages=(
            Stage("rho over the distance of sensor and target", [(root, 1 / sp.sqrt(under))]),
            Stage("shift and gradient", list(zip((SHIFT, *GRADIENT), named, strict=True))),
        ),
        outputs=(SHIFT, *GRADIENT),
    )  # fmt: skip


def to_coordinates_block():
    """Return the program of the coordinates of a state, with rho as the last one."""
    return Block(
        name="to_coordinates",
        summary="Coordinates eta, beta, b of a state in m and m/s, and its rho in m.",
        inputs=(*STATE, RADIUS),
        stages=(
            Stage("range", [(RANGE, sp.sqrt(RADIUS**2 + _P.dot(_P)))]),
            Stage("coordinates", list(zip(COORDINATES[:5], coordinates(), strict=False))),
        ),
        outputs=(*COORDINATES[:5], RANGE),
    )


def to_state_block():
    """Return the program of the state at coordinates and rho, and of its derivatives by them."""
    state = [
        (name, sp.sqrt(right) if left == name**2 else right / sp.diff(left, name))
        for name, left, right in conditions()
    ]
    entries = _entries("d", "x y z vx vy vz".split(), inverse_jacobian())
    return Block(
        name="to_state",
        summary="State with x > 0 at eta, beta, b and rho; its derivatives by them and ln rho.",
        inputs=(*COORDINATES[:5], RANGE, RADIUS),
        stages=(Stage("state", state), Stage("derivatives that are not zero", entries)),
        outputs=(*STATE, *(name for name, _ in entries)),
    )


def moved_block():
    """Return the program of the coordinates after an interval, and of their derivatives."""
    growth_square, after = moved()
    new = sp.symbols([f"{c.name}_new" for c in COORDINATES[:5]], real=True)
    entries = _entries("f", AXES, transition())
    return Block(
        name="moved",
        summary="Coordinates and growth of rho after T at constant velocity; their derivatives.",
        inputs=(*COORDINATES[:5], INVERSE_RANGE, SQUARE, *_SLOPES, T),
        stages=(
            Stage("growth of rho", [(GROWTH, sp.sqrt(growth_square))]),
            Stage("coordinates", list(zip(new, after, strict=True))),
            Stage("derivatives", entries),
        ),
        outputs=(*new, GROWTH, *(name for name, _ in entries)),
    )


def pushed_block():
    """Return the program of the change of the coordinates along a change of the state."""
    change = sp.symbols([f"c_{component.name}" for component in STATE], real=True)
    new = sp.symbols([f"c_{axis}" for axis in AXES], real=True)
    along = [sp.factor_terms(entry) for entry in jacobian() @ sp.Matrix(change)]
    return Block(
        name="pushed",
        summary="Change of eta, beta, b and ln rho along a small change of the state.",
        inputs=(*STATE, RANGE, *change),
        stages=(Stage("derivative along the change", list(zip(new, along, strict=True))),),
        outputs=tuple(new),
    )


def blocks():
    """Return the programs that are printed into `dopplerlib.kernels.ring_coordinates`."""
    return shift_block(), to_coordinates_block(), to_state_block(), moved_block(), pushed_block()


def _entries(prefix, rows, matrix):
    """Return named assignments of the entries of a matrix (6, 6) that are not zero."""
    return [
        (sp.Symbol(f"{prefix}_{row}_{axis}", real=True), matrix[i, j])
        for i, row in enumerate(rows)
        for j, axis in enumerate(AXES)
        if matrix[i, j] != 0
    ]


def _in_state(expression):
    """Return an expression in `COORDINATES` as one in `STATE` and the range."""
    named = dict(zip(COORDINATES, coordinates(), strict=True)) | {INVERSE_RANGE: 1 / RANGE}
    return expression.subs(named, simultaneous=True)


def _decided(expression):
    """Return a rational expression reduced, with r^2 = rho^2 - p.p: zero if it is zero."""
    return sp.cancel(sp.together(expression.subs(RADIUS, sp.sqrt(RANGE**2 - _P.dot(_P)))))
