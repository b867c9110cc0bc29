"""Moving sensors before they are printed: proved with symbols."""

import inspect

import mpmath as mp
import pytest
import sympy as sp

from dopplerlib.derive import doppler, links

PROOFS = [f for name, f in inspect.getmembers(links) if name.startswith("prove_")]


@pytest.mark.parametrize("proof", PROOFS)
def test_the_difference_is_zero(proof):
    assert proof() == 0


def test_there_are_proofs():
    assert len(PROOFS) == 6


def values():
    numbers = zip(
        (*doppler.STATE, *doppler.SENSOR, *links.SENSOR_VELOCITY),
        map(sp.Rational, (3, -2, 1, 5, 7, -1, 0, 1, 4, -3, 2, 6)),
        strict=True,
    )
    return dict(numbers) | {doppler.WAVELENGTH: sp.Rational(1, 80)}


def test_a_velocity_of_one_end_alone_or_a_scale_of_one_part_is_seen():
    # The proofs would be empty if nothing changed the shift.
    shift, at = links.link_shift(), values()
    for symbol in (
        doppler.STATE[3],
        links.SENSOR_VELOCITY[1],
        doppler.WAVELENGTH,
        doppler.STATE[0],
    ):
        assert sp.diff(shift, symbol).subs(at) != 0


@pytest.mark.parametrize("ways", ["one", "two"])
def test_the_second_order_is_that_of_exact_kinematics(ways):
    """Two clocks on a line pass each other pulses; with c = 1, and proper times by Lorentz."""

    def left(size):  # of the ratio of frequencies, after both orders
        with mp.workdps(60):
            a, b = size * mp.mpf("3e-4"), size * mp.mpf("-5e-4")
            heard = 1 / ((1 - a) / (1 - b))  # one pulse sent at t = 0 from 0, the next from a
            if ways == "two":
                heard *= 1 / ((1 + b) / (1 + a))
            else:
                heard *= mp.sqrt((1 - a * a) / (1 - b * b))
            first = (a - b) * (2 if ways == "two" else 1)
            at = dict(zip((*links.ALONG, *links.SPEEDS), (a, b, a * a, b * b), strict=True))
            second = sp.lambdify(list(at), links.beyond_first_order(ways), "mpmath")(*at.values())
            assert abs(second) > 1e-4 * abs(first)
            return float(heard - 1 - first - second)

    # Third order is left: half of the speeds leave an eighth.
    assert left(1) / left(0.5) == pytest.approx(8, rel=1e-2)


def test_one_oscillator_has_no_offset_and_two_have_their_difference():
    y_t, y_r = links.DETUNING
    shift = links.detuned_shift()
    assert shift.subs(y_r, y_t) == (1 + y_t) * doppler.SHIFT
    assert sp.expand(shift.subs(doppler.SHIFT, 0)) == y_t - y_r
