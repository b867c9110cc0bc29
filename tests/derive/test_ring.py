"""What a ring of sensors cannot see, proved with symbols and compared with the numbers."""

import numpy as np
import pytest
import sympy as sp

from dopplerlib import ring_family, ring_family_direction
from dopplerlib.derive import doppler, ring
from dopplerlib.derive.printers import python_function

STATES = np.array([[0.833, 0.111, 0.092, -0.75, -0.125, -0.018], [0.4, -0.5, 0.3, 0.2, 1.0, -0.7]])


@pytest.mark.parametrize(
    "proof",
    [
        ring.prove_invariants_suffice,
        ring.prove_family_looks_alike,
        ring.prove_direction_is_unseen,
        ring.prove_rigid_motion_is_no_cure,
        ring.prove_mirror_looks_alike,
        ring.prove_turn_looks_alike,
        ring.prove_circling_is_unseen,
    ],
)
def test_the_difference_is_zero(proof):
    assert proof() == 0


def test_the_family_of_states_has_the_scaled_invariants():
    assert ring.prove_family_state() == sp.zeros(6, 1)


@pytest.mark.parametrize("place", [[0.01, 0.2, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.0]])
def test_a_sensor_off_the_circle_sees_the_direction(place):
    # The proof would be empty if the derivative vanished for every sensor.
    direction = ring.family_direction().subs(ring.RADIUS, sp.Rational(1, 5))
    seen = sp.Matrix(doppler.doppler_gradient()).dot(direction)
    values = dict(zip(doppler.SENSOR, place, strict=True))
    values |= dict(zip(doppler.STATE, STATES[0], strict=True)) | {doppler.WAVELENGTH: 0.0125}
    # The largest gradient is 160 Hz per m/s; rounding leaves some 1e-13 of it.
    assert abs(float(seen.subs(values))) > 1e-3


def test_halves_of_a_ring_that_turn_against_each_other_do_not_share_a_direction():
    # Of each half one direction is lost, and they are not the same: nothing is lost by both.
    turn = dict(zip(ring.FRAME, (2, 0, 0), strict=True)) | dict.fromkeys(ring.PLATFORM, 0)
    turn |= dict(zip(doppler.STATE, STATES[0], strict=True)) | {ring.RADIUS: 0.2}
    one, other = (ring.platform_direction().subs(turn | {ring.FRAME[0]: rate}) for rate in (2, -2))
    pair = np.array(one.row_join(other), float)
    assert np.linalg.svd(pair / np.linalg.norm(pair, axis=0), compute_uv=False)[1] > 0.1
    at_rest = np.array(ring.platform_direction().subs(turn | {ring.FRAME[0]: 0}), float)
    np.testing.assert_allclose(at_rest[:, 0], ring_family_direction(STATES[0], 0.2), rtol=1e-12)


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("scale", [0.8, 1.0, 1.1])
def test_numbers_and_symbols_agree(state, scale):
    values = dict(zip(doppler.STATE, map(float, state), strict=True)) | {ring.RADIUS: 0.2}
    family = ring.family_state().subs(values | {ring.SCALE: scale})
    direction = ring.family_direction().subs(values)
    program = {}
    exec(python_function(ring.family_block()), {"sqrt": np.sqrt}, program)
    printed = program["ring_family_state"](*map(float, state), 0.2, scale)
    np.testing.assert_allclose(printed, np.array(family, float)[:, 0], rtol=1e-13, atol=1e-14)
    # A dozen roundings of numbers near one.
    np.testing.assert_allclose(
        ring_family(state, 0.2, scale), np.array(family, float)[:, 0], rtol=1e-13, atol=1e-14
    )
    np.testing.assert_allclose(
        ring_family_direction(state, 0.2), np.array(direction, float)[:, 0], rtol=1e-12, atol=1e-14
    )
