"""The Doppler shift between a moving target and moving sensors: one way, two ways, bistatic.

The wave travels along *legs*, each between the target and a sensor that has a velocity of its own
(Mittermaier et al. 2016, Eq 2). The shift is minus the rate of the legs' lengths over the
wavelength: one leg if one end sends and the other listens, the same leg twice for a radar, two
different ones if the transmitter stands elsewhere. Every ``prove_...`` function returns an
expression that SymPy has simplified; the claim is proved if it is zero.

This is the first order in v / c, with both ends of a leg at one time. What it leaves out is
`beyond_first_order`, relative to the shift some v / c: 1e-7 for a car; 1e-5 for a navigation
satellite, which is 0.01 Hz at 1.6 GHz, and 0.1 Hz of time dilation that all satellites share.
"""

from typing import Literal

import sympy as sp

from .._hints import checked
from .block import Block, Stage
from .doppler import (
    DOPPLER_PER_SPEED,
    GRADIENT,
    SENSOR,
    SHIFT,
    STATE,
    WAVELENGTH,
    doppler_shift,
    equations,
    in_line_of_sight,
    line_of_sight_stage,
)

SENSOR_VELOCITY = sp.symbols("u_x u_y u_z", real=True)
RELATIVE_VELOCITY = sp.symbols("w_x w_y w_z", real=True)  # of the target, seen from the sensor
TRANSMITTER = sp.symbols("q_x q_y q_z", real=True)
TRANSMITTER_VELOCITY = sp.symbols("r_x r_y r_z", real=True)
FRAME = sp.symbols("Omega_x Omega_y Omega_z", real=True)  # velocity, or angular rate, of a frame
SCALE = sp.Symbol("kappa", positive=True)  # true wavelength over the assumed one
TIME = sp.Symbol("tau", real=True)
SLOWNESS = sp.Symbol("epsilon", positive=True)  # 1 / c
ALONG = sp.symbols("a b", real=True)  # velocity of emitter and receiver along the path
SPEEDS = sp.symbols("V_a V_b", positive=True)  # their speeds, squared
DETUNING = sp.symbols("y_t y_r", real=True)  # relative errors of the two oscillators

_Ways = Literal["one", "two", "bistatic"]


def range_rate():
    """Return the rate of the distance between target and sensor: its derivative by time."""
    apart = sp.Matrix(STATE[:3]) - sp.Matrix(SENSOR)
    apart += TIME * (sp.Matrix(STATE[3:]) - sp.Matrix(SENSOR_VELOCITY))
    return sp.diff(sp.sqrt(apart.dot(apart)), TIME).subs(TIME, 0)


@checked
def link_shift(ways: _Ways = "two") -> sp.Expr:
    """Return the Doppler shift of a link, positive when its path gets shorter.

    Parameters
    ----------
    ways : {"one", "two", "bistatic"}
        Between target and sensor; from the sensor to the target and back; or from a transmitter
        over the target to the sensor.

    Examples
    --------
    >>> sp.simplify(link_shift("two") / link_shift("one"))
    2
    """
    leg = -range_rate() / WAVELENGTH
    if ways == "bistatic":
        ends = (*SENSOR, *SENSOR_VELOCITY), (*TRANSMITTER, *TRANSMITTER_VELOCITY)
        return leg + leg.subs(dict(zip(*ends, strict=True)))
    return leg if ways == "one" else 2 * leg


def prove_rest_is_equation_6():
    """Return the shift of a radar whose velocity is zero minus Eq 6."""
    at_rest = link_shift("two").subs(dict.fromkeys(SENSOR_VELOCITY, 0))
    return sp.simplify(at_rest - doppler_shift())


def prove_one_place_is_a_radar():
    """Return the bistatic shift with the transmitter at the sensor minus the shift of a radar."""
    ends = (*TRANSMITTER, *TRANSMITTER_VELOCITY), (*SENSOR, *SENSOR_VELOCITY)
    return sp.simplify(link_shift("bistatic").subs(dict(zip(*ends, strict=True))) - link_shift())


def prove_common_velocity_is_unseen():
    """Return what the bistatic shift changes by if all three are given the same velocity more."""
    boosted = {
        old: old + more
        for velocity in (STATE[3:], SENSOR_VELOCITY, TRANSMITTER_VELOCITY)
        for old, more in zip(velocity, FRAME, strict=True)
    }
    shift = link_shift("bistatic")
    return sp.simplify(shift.subs(boosted, simultaneous=True) - shift)


def prove_rotating_frame_is_unseen():
    """Return what the range rate changes by if all are seen from a frame that rotates.

    So positions and velocities relative to the earth give the shifts as well as inertial ones.
    """
    turned = {}
    for position, velocity in ((STATE[:3], STATE[3:]), (SENSOR, SENSOR_VELOCITY)):
        turn = sp.Matrix(FRAME).cross(sp.Matrix(position))
        turned |= {old: old - less for old, less in zip(velocity, turn, strict=True)}
    return sp.simplify(range_rate().subs(turned, simultaneous=True) - range_rate())


def prove_wavelength_is_speed():
    """Return Eq 6 with wavelength and velocity scaled alike minus Eq 6.

    Sensors at rest so cannot tell, from one sample, an error of the wavelength from one of speed.
    """
    scaled = {name: SCALE * name for name in (WAVELENGTH, *STATE[3:])}
    return sp.simplify(doppler_shift().subs(scaled, simultaneous=True) - doppler_shift())


def prove_one_sensor_has_no_scale():
    """Return the shift at any time with the scene scaled about one sensor minus the shift.

    Wavelength, distance and relative velocity are scaled alike, and the sensor and the target go
    straight. Of several sensors the distances from one another are known, and would have to be
    scaled, too: they see the scale of the scene as well as they see range.
    """
    later = {p: p + TIME * v for p, v in zip(STATE[:3], STATE[3:], strict=True)}
    later |= {s: s + TIME * u for s, u in zip(SENSOR, SENSOR_VELOCITY, strict=True)}
    scaled = {WAVELENGTH: SCALE * WAVELENGTH}
    sensor = (*SENSOR, *SENSOR_VELOCITY)
    scaled |= {x: s + SCALE * (x - s) for x, s in zip(STATE, sensor, strict=True)}
    shift = link_shift().subs(later, simultaneous=True)
    return sp.expand(_factored(shift.subs(scaled, simultaneous=True)) - _factored(shift))


def detuned_shift():
    """Return the frequency at a mixer's output over the carrier's, for a true relative shift.

    The transmitter's oscillator is off by y_t and the receiver's by y_r, relative to the carrier
    that is assumed: of two oscillators the difference is an offset, of one and the same (y_t = y_r)
    only the factor 1 + y_t is left, a wavelength that is wrong.
    """
    y_t, y_r = DETUNING
    return sp.collect(sp.expand((1 + y_t) * (1 + SHIFT) - (1 + y_r)), SHIFT)


@checked
def beyond_first_order(ways: Literal["one", "two"] = "one") -> sp.Expr:
    """Return the second order of the frequency ratio in 1 / c, which `link_shift` leaves out.

    Parameters
    ----------
    ways : {"one", "two"}
        See `link_shift`.

    Notes
    -----
    Special relativity: the ratio of frequencies is (1 - b / c) / (1 - a / c) with the velocities
    of emitter (a) and receiver (b) along the path from where the wave left to where it arrives,
    times the ratio of their Lorentz factors. Two ways are a product of two such ratios.

    Examples
    --------
    With a range rate b - a of a radar and its target, whatever either does:

    >>> sp.factor(beyond_first_order("two"))
    2*(a - b)**2
    """
    (a, b), (V_a, V_b), e = ALONG, SPEEDS, SLOWNESS
    there = (1 - e * b) / (1 - e * a)
    back = (1 + e * a) / (1 + e * b)
    dilation = sp.sqrt((1 - e**2 * V_a) / (1 - e**2 * V_b))
    ratio = there * back if ways == "two" else there * dilation
    return sp.expand(sp.diff(ratio, e, 2).subs(e, 0) / 2)


def shift_block():
    """Return the program of the Doppler shift along one leg."""
    return _block(
        "leg_shift",
        "Doppler shift along a leg in Hz, positive when it gets shorter.",
        {SHIFT: link_shift()},
    )


def gradient_block():
    """Return the program of the Doppler shift along one leg and its six partial derivatives."""
    shift = link_shift()
    gradient = zip(GRADIENT, (sp.diff(shift, component) for component in STATE), strict=True)
    return _block(
        "leg_shift_and_gradient",
        "Doppler shift along a leg and its derivatives by x, y, z, v_x, v_y, v_z.",
        {SHIFT: shift, **dict(gradient)},
    )


def _factored(expression):
    """Factor what stands under a root, which is all that `sp.simplify` would search for."""
    return expression.replace(
        lambda e: e.is_Pow and e.exp.is_Rational and e.exp.q == 2,
        lambda e: sp.Pow(sp.factor(e.base), e.exp),
    )


def _block(name, summary, formulas):
    velocities = list(zip(RELATIVE_VELOCITY, STATE[3:], SENSOR_VELOCITY, strict=True))
    relative = [(w, v - u) for w, v, u in velocities]
    seen = {v: w + u for w, v, u in velocities}
    named = [(f, in_line_of_sight(x.subs(seen, simultaneous=True))) for f, x in formulas.items()]
    # Eq 6 of the relative velocity, which `prove_rest_is_equation_6` and the printed text say.
    at_rest = {v: w for w, v, _ in velocities}
    written = [(left, right.subs(at_rest)) for left, right in equations(len(formulas) > 1)]
    return Block(
        name=name,
        summary=summary,
        inputs=(*STATE, *SENSOR, *SENSOR_VELOCITY, DOPPLER_PER_SPEED),
        stages=(
            line_of_sight_stage(),
            Stage("velocity of the target, seen from the sensor", relative),
            Stage("Doppler shift, Eq 6 with that velocity", named),
        ),
        outputs=tuple(formulas),
        equations=(*written[:3], *relative, *written[3:]),
    )
