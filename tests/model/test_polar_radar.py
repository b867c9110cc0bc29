"""Range, azimuth and range rate, and their Jacobian."""

import numpy as np
import pytest

from dopplerlib.model.polar_radar import polar_position, polar_radar_h, polar_radar_jacobian

RNG = np.random.default_rng(3)
STATES = RNG.normal(scale=5, size=(50, 4))


def test_the_range_rate_is_the_derivative_of_the_range():
    step = 1e-6
    moved = STATES.copy()
    moved[:, [0, 2]] += step * STATES[:, [1, 3]]
    rate = (polar_radar_h(moved)[:, 0] - polar_radar_h(STATES)[:, 0]) / step
    # Half the second derivative, v^2 / r, times the step: 1e-3 even at a tenth of a meter.
    np.testing.assert_allclose(polar_radar_h(STATES)[:, 2], rate, atol=1e-3)


def test_the_jacobian_is_that_of_a_complex_step():
    """A complex step loses no digits, so that only rounding is left."""
    step = 1e-30
    expected = np.empty((len(STATES), 3, 4))
    for i, state in enumerate(STATES):
        p_x, _, p_y, _ = state
        for j in range(4):
            x = state.astype(complex)
            x[j] += 1j * step
            r = np.sqrt(x[0] ** 2 + x[2] ** 2)
            rate = (x[0] * x[1] + x[2] * x[3]) / r
            expected[i, [0, 2], j] = np.imag([r, rate]) / step
            # d atan2(p_x, p_y) of the real part has no analytic twin in NumPy: the rotation by
            # the azimuth brings the point onto +y, and there the angle is p_x' / p_y'.
            across = (x[0] * p_y - x[2] * p_x) / (x[0] * p_x + x[2] * p_y)
            expected[i, 1, j] = np.imag(across) / step
    np.testing.assert_allclose(polar_radar_jacobian(STATES), expected, rtol=1e-12, atol=1e-13)


def test_position_and_measurement_are_inverse():
    np.testing.assert_allclose(
        polar_position(polar_radar_h(STATES)), STATES[:, [0, 2]], rtol=1e-12, atol=1e-12
    )


def test_a_rotation_of_the_world_turns_the_azimuth_and_nothing_else():
    turn = 0.4  # to the right, from +y towards +x
    rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    turned = np.empty_like(STATES)
    turned[:, [0, 2]] = STATES[:, [0, 2]] @ rotation.T
    turned[:, [1, 3]] = STATES[:, [1, 3]] @ rotation.T
    difference = polar_radar_h(turned) - polar_radar_h(STATES)
    np.testing.assert_allclose(difference[:, [0, 2]], 0, atol=1e-13)
    np.testing.assert_allclose(np.exp(1j * difference[:, 1]), np.exp(1j * turn), atol=1e-13)


def test_one_scan_leaves_one_direction_of_the_state_open():
    for H, state in zip(polar_radar_jacobian(STATES), STATES, strict=True):
        assert np.linalg.matrix_rank(H) == 3
        across = np.array([0, state[2], 0, -state[0]])  # velocity at right angles to the sight
        np.testing.assert_allclose(H @ across, 0, atol=1e-12)


@pytest.mark.parametrize("function", [polar_radar_h, polar_radar_jacobian])
def test_a_target_on_the_radar_is_refused(function):
    with pytest.raises(ValueError, match="x must not lie on the radar"):
        function([0.0, 1.0, 0.0, 1.0])
    with pytest.raises(ValueError, match="x must have shape"):
        function(np.zeros(6))
    with pytest.raises(ValueError, match="z must have range and azimuth"):
        polar_position([1.0])
