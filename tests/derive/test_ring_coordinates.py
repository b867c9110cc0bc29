"""Ring coordinates: proved with symbols, and the printed programs compared with other code."""

import numpy as np
import pytest

from dopplerlib import RadarArray, doppler_jacobian, doppler_shift, ring_family
from dopplerlib.derive import ring_coordinates as derived
from dopplerlib.kernels import ring_coordinates as kernel
from dopplerlib.model.ring_coordinates import from_ring_coordinates, to_ring_coordinates

R = 0.2
STATES = np.array([[0.833, 0.111, 0.092, -0.75, -0.125, -0.018], [0.4, -0.5, 0.3, 0.2, 1.0, -0.7]])


@pytest.mark.parametrize("proof", [derived.prove_shift, derived.prove_sign, derived.prove_volume])
def test_the_difference_is_zero(proof):
    assert proof() == 0


@pytest.mark.parametrize(
    "proof", [derived.prove_scale_is_unseen, derived.prove_rates, derived.prove_inverse]
)
def test_all_entries_are_zero(proof):
    assert proof().is_zero_matrix


def test_the_motion_is_straight():
    rest, growth = derived.prove_motion()
    assert rest.is_zero_matrix
    assert growth == 0


@pytest.mark.parametrize(("order", "zero"), [(0, True), (1, True), (2, True), (3, False)])
def test_the_twin_differs_in_the_third_order_only(order, zero):
    assert (derived.prove_twin(order) == 0) is zero


def by_steps(function, at, step=1e-6):
    """Return the derivatives of `function` by central differences, the argument last."""
    sides = [function(at + step * e) - function(at - step * e) for e in np.eye(len(at))]
    return np.stack(sides, axis=-1) / (2 * step)


def matrix(places, entries):
    """Return the (6, 6) matrix whose entries at `places` are given."""
    result = np.zeros((6, 6))
    result[tuple(zip(*places, strict=True))] = entries
    return result


def places(symbols):
    return [(i, j) for i in range(6) for j in range(6) if symbols[i, j] != 0]


@pytest.mark.parametrize("x", STATES)
def test_the_printed_shift_is_that_of_the_state(x):
    # The last but one is on the circle; the last is off the plane.
    array = RadarArray([[0, 0.05, 0.1], [0, -0.3, 0.02], [0, 0.2, 0.0], [0.06, 0.1, -0.1]])
    *seen, scale = to_ring_coordinates(x, R)
    shift, *gradient, by_x, by_v = kernel.shift_and_gradient(
        *seen, np.exp(-scale), x[0], x[3], *array.positions.T, R, array.doppler_per_speed
    )
    # A dozen roundings of shifts up to some 200 Hz.
    np.testing.assert_allclose(shift, doppler_shift(x, array), rtol=0, atol=1e-11)
    inverse = matrix(*zip(*_inverse_entries(x), strict=True))
    found = np.stack(np.broadcast_arrays(*gradient), axis=-1)
    found += by_x[:, None] * inverse[0] + by_v[:, None] * inverse[3]
    slopes = doppler_jacobian(x, array) @ inverse
    np.testing.assert_allclose(found, slopes, rtol=1e-11, atol=1e-10)
    assert gradient[-1][2] == pytest.approx(0, abs=1e-12)


def _inverse_entries(x):
    *seen, scale = to_ring_coordinates(x, R)
    entries = kernel.to_state(*seen, np.exp(scale), R)[6:]
    return zip(places(derived.inverse_jacobian()), entries, strict=True)


@pytest.mark.parametrize("x", STATES)
def test_the_way_back_and_its_derivatives(x):
    xi = to_ring_coordinates(x, R)
    # A dozen roundings of numbers near one, and some 1e-10 of the differences.
    np.testing.assert_allclose(from_ring_coordinates(xi, R), x, rtol=1e-13, atol=1e-14)
    names, values = zip(*_inverse_entries(x), strict=True)
    slopes = by_steps(lambda at: from_ring_coordinates(at, R), xi)
    np.testing.assert_allclose(matrix(names, values), slopes, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("x", STATES)
@pytest.mark.parametrize("T", [0.001, 0.3])
def test_the_printed_motion_is_that_of_the_state(x, T):
    xi = to_ring_coordinates(x, R)
    F = np.eye(6) + T * np.eye(6, k=3)

    def speed(at):
        return np.sum(from_ring_coordinates(at, R)[3:] ** 2)

    *after, growth = (
        moved := kernel.moved(*xi[:5], np.exp(-xi[5]), speed(xi), *by_steps(speed, xi), T)
    )[:6]
    expected = to_ring_coordinates(F @ x, R)
    np.testing.assert_allclose([*after, xi[5] + np.log(growth)], expected, rtol=1e-13, atol=1e-13)
    slopes = by_steps(lambda at: to_ring_coordinates(F @ from_ring_coordinates(at, R), R), xi)
    np.testing.assert_allclose(np.reshape(moved[6:], (6, 6)), slopes, rtol=1e-6, atol=1e-7)


def test_a_family_is_a_line_along_the_scale():
    t = np.array([0.6, 1.0, 1.7])
    xi = to_ring_coordinates(ring_family(STATES[0], R, t), R)
    np.testing.assert_allclose(xi[:, :5], np.tile(xi[1, :5], (3, 1)), rtol=1e-13, atol=1e-14)
    np.testing.assert_allclose(xi[:, 5] - xi[1, 5], np.log(t), rtol=0, atol=1e-14)


def test_there_may_be_no_state():
    xi = to_ring_coordinates(STATES[0], R)
    with pytest.raises(ValueError, match="xi must belong to a state in front of the ring"):
        from_ring_coordinates(xi + np.array([0, 0, 0, 0, 0, 5.0]), R)
