"""Range and range rate are what geometry says, and their Jacobian is their derivative."""

import numpy as np
import pytest

from dopplerlib import RadarArray, doppler_shift
from dopplerlib.model.range_rate import range_rate, range_rate_jacobian

SENSORS = np.array([[-0.5, 0.0], [0.5, 0.0], [1.0, -2.0]])
STATES = np.random.default_rng(1).uniform(0.3, 3, (20, 4))


def test_the_range_is_the_length_of_the_line_of_sight():
    assert range_rate([0.5, 4.0, 0, 0], SENSORS[1:2])[0, 0] == 4.0
    d = range_rate(STATES, SENSORS)[..., 0]
    for n, sensor in enumerate(SENSORS):
        np.testing.assert_allclose(d[:, n], np.linalg.norm(STATES[:, :2] - sensor, axis=1))


def test_the_rate_is_the_doppler_shift_with_the_opposite_sign_over_doppler_per_speed():
    """Another function of the library, printed from another expression, in three dimensions."""
    x = np.zeros((20, 6))
    x[:, [0, 1, 3, 4]] = STATES
    array = RadarArray(np.column_stack([SENSORS, np.zeros(3)]))
    expected = -doppler_shift(x, array) / array.doppler_per_speed
    np.testing.assert_allclose(range_rate(STATES, SENSORS)[..., 1], expected, rtol=1e-12)


def test_the_jacobian_is_the_derivative():
    """Central differences with a step of 1e-6 err by about 1e-10 for values near one."""
    H = range_rate_jacobian(STATES, SENSORS)
    for i in range(4):
        step = 1e-6 * np.eye(4)[i]
        up, down = range_rate(STATES + step, SENSORS), range_rate(STATES - step, SENSORS)
        np.testing.assert_allclose(H[..., i], (up - down) / 2e-6, atol=1e-8)


@pytest.mark.parametrize("function", [range_rate, range_rate_jacobian])
def test_a_target_on_a_radar_is_refused(function):
    with pytest.raises(ValueError, match="x must not lie on a radar"):
        function([0.5, 0, 1, 1], SENSORS)
    with pytest.raises(ValueError, match="sensors must"):
        function([0.5, 1, 1, 1], [0.0, 1.0])
