"""Doppler shifts obey physics; their Jacobian is their derivative."""

import mpmath as mp
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dopplerlib import RadarArray, doppler_jacobian, doppler_shift

RING = RadarArray.ring(6, 0.2)
SCATTERED = RadarArray([[0.1, -0.3, 0.2], [-0.4, 0.5, 0.0], [0.0, 0.2, -0.6]], wavelength=0.004)
ARRAYS = [RING, RadarArray.linear(5, 0.4), SCATTERED]

# Shifts are hundreds of Hz and take some ten roundings of 1e-16 each.
ROUNDING = 1e-11


@pytest.fixture
def x():
    """Forty states a meter or so away from every sensor of all `ARRAYS`."""
    rng = np.random.default_rng(20)
    x = rng.normal(size=(40, 6))
    x[:, :3] *= (1 + rng.uniform(size=(40, 1))) / np.linalg.norm(x[:, :3], axis=1, keepdims=True)
    return x


def along(direction, speed, position, array, sensor=0):
    """Return a state that moves towards (or at right angles to) one sensor."""
    d = array.positions[sensor] - position
    d /= np.linalg.norm(d)
    if direction == "across":
        d = np.cross(d, [0.3, -0.5, 0.8])
        d /= np.linalg.norm(d)
    return np.concatenate([position, speed * d])


def closing_speed(state, sensor):
    """Return how fast distance shrinks: its derivative by time, taken in forty digits."""
    with mp.workdps(40):
        start, velocity = mp.matrix(state[:3]), mp.matrix(state[3:])
        place = mp.matrix(sensor)
        return -float(mp.diff(lambda t: mp.norm(start + t * velocity - place), 0))


@pytest.mark.parametrize("array", ARRAYS)
def test_a_target_that_approaches_a_sensor_shifts_its_echo_up_by_the_full_amount(array):
    for sensor in range(len(array)):
        x = along("towards", 1.5, [0.8, 0.1, -0.2], array, sensor)
        shift = doppler_shift(x, array)
        assert shift[sensor] == pytest.approx(1.5 * array.doppler_per_speed, rel=1e-14)
        x[3:] *= -1
        assert doppler_shift(x, array)[sensor] == -shift[sensor]


@pytest.mark.parametrize("array", ARRAYS)
def test_a_target_that_moves_across_the_line_of_sight_shifts_nothing(array):
    x = along("across", 1.5, [0.8, 0.1, -0.2], array)
    assert doppler_shift(x, array)[0] == pytest.approx(0, abs=ROUNDING)


@pytest.mark.parametrize("array", ARRAYS)
def test_no_direction_shifts_more_than_the_radial_one(array, x):
    speed = np.linalg.norm(x[:, 3:], axis=1, keepdims=True)
    largest = array.doppler_per_speed * speed
    assert (np.abs(doppler_shift(x, array)) <= largest * (1 + 1e-15)).all()


@pytest.mark.parametrize("array", ARRAYS)
def test_the_shift_is_the_rate_at_which_distance_shrinks_times_two_over_the_wavelength(array, x):
    few = x[:8]
    speed = np.array([[closing_speed(state, s) for s in array.positions] for state in few])
    np.testing.assert_allclose(
        doppler_shift(few, array), 2 / array.wavelength * speed, rtol=1e-13, atol=ROUNDING
    )


@pytest.mark.parametrize("array", ARRAYS)
def test_the_jacobian_is_the_derivative_of_the_shift(array, x):
    def shift(states):  # scipy puts the state first and any number of points after it
        return np.moveaxis(doppler_shift(np.moveaxis(states, 0, -1), array), -1, 0)

    differentiate = pytest.importorskip("scipy.differentiate", reason="SciPy has it from 1.15 on")
    numerical = differentiate.jacobian(shift, x.T, initial_step=0.05, order=10)
    assert numerical.success.all()
    ours = np.moveaxis(doppler_jacobian(x, array), 0, -1)
    # Differences of shifts of up to 1e3 Hz over steps of 1e-2 m keep 1e-16 * 1e3 / 1e-2.
    np.testing.assert_allclose(ours, numerical.df, rtol=1e-9, atol=1e-8)


@pytest.mark.parametrize("array", ARRAYS)
def test_turning_array_and_target_together_changes_nothing(array, x):
    turn = Rotation.from_rotvec([0.3, -1.2, 0.5]).as_matrix().T
    turned = np.concatenate([x[:, :3] @ turn, x[:, 3:] @ turn], axis=1)
    there = RadarArray(array.positions @ turn, array.wavelength)
    np.testing.assert_allclose(
        doppler_shift(turned, there), doppler_shift(x, array), rtol=1e-13, atol=ROUNDING
    )


@pytest.mark.parametrize("array", ARRAYS)
def test_moving_array_and_target_together_changes_nothing(array, x):
    step = np.array([0.3, -1.2, 0.5, 0, 0, 0])
    moved, there = x + step, RadarArray(array.positions + step[:3], array.wavelength)
    np.testing.assert_allclose(
        doppler_shift(moved, there), doppler_shift(x, array), rtol=1e-13, atol=ROUNDING
    )


@pytest.mark.parametrize("array", ARRAYS)
def test_a_scene_twice_as_large_at_the_same_velocity_has_the_same_shifts_to_the_last_bit(array, x):
    larger = x * [2, 2, 2, 1, 1, 1]
    there = RadarArray(2 * array.positions, array.wavelength)
    np.testing.assert_array_equal(doppler_shift(larger, there), doppler_shift(x, array))


@pytest.mark.parametrize("array", ARRAYS)
def test_a_reversed_velocity_reverses_the_shift_to_the_last_bit(array, x):
    reverse = x * [1, 1, 1, -1, -1, -1]
    np.testing.assert_array_equal(doppler_shift(reverse, array), -doppler_shift(x, array))


@pytest.mark.parametrize("array", ARRAYS)
def test_the_shift_is_linear_in_the_velocity_with_the_jacobian_as_its_coefficients(array, x):
    H = doppler_jacobian(x, array)
    assert (np.linalg.norm(H[..., 3:], axis=-1) > 0).all()
    np.testing.assert_allclose(
        (H[..., 3:] @ x[:, 3:, None])[..., 0], doppler_shift(x, array), rtol=1e-13, atol=ROUNDING
    )
    other = x.copy()
    other[:, 3:] = 5  # does not enter those coefficients
    np.testing.assert_array_equal(doppler_jacobian(other, array)[..., 3:], H[..., 3:])


@pytest.mark.parametrize("array", ARRAYS)
def test_the_shift_does_not_depend_on_distance_along_the_line_of_sight(array, x):
    """Euler's theorem for a function that scaling leaves alone: its gradient has no such part."""
    H = doppler_jacobian(x, array)
    to_sensor = array.positions - x[:, None, :3]
    radial = np.sum(H[..., :3] * to_sensor, axis=-1)
    np.testing.assert_allclose(radial, 0, atol=ROUNDING)


def test_half_the_wavelength_doubles_the_shift(x):
    half = RadarArray(RING.positions, RING.wavelength / 2)
    np.testing.assert_array_equal(doppler_shift(x, half), 2 * doppler_shift(x, RING))
    np.testing.assert_array_equal(doppler_jacobian(x, half), 2 * doppler_jacobian(x, RING))


def test_sensors_do_not_know_of_each_other(x):
    for n, position in enumerate(RING.positions):
        alone = RadarArray([position])
        np.testing.assert_array_equal(doppler_shift(x, alone)[:, 0], doppler_shift(x, RING)[:, n])
        np.testing.assert_array_equal(
            doppler_jacobian(x, alone)[:, 0], doppler_jacobian(x, RING)[:, n]
        )


@pytest.mark.parametrize("lead", [(), (1,), (40,), (5, 8), (2, 4, 5), (0,), (3, 0)])
def test_any_leading_axes_are_batch_axes(lead, x):
    batch = x[: int(np.prod(lead))].reshape(*lead, 6)
    shift, H = doppler_shift(batch, RING), doppler_jacobian(batch, RING)
    assert shift.shape == (*lead, 6)
    assert H.shape == (*lead, 6, 6)
    for i in np.ndindex(lead):
        np.testing.assert_array_equal(shift[i], doppler_shift(batch[i], RING))
        np.testing.assert_array_equal(H[i], doppler_jacobian(batch[i], RING))


@pytest.mark.parametrize("function", [doppler_shift, doppler_jacobian])
def test_a_target_on_a_sensor_is_refused(function):
    x = np.ones((2, 3, 6))
    x[1, 2, :3] = RING.positions[4]
    message = r"x must not lie on a sensor, got a position equal to that of sensor 4, \[0\.0, -0\.1"
    with pytest.raises(ValueError, match=message):
        function(x, RING)


@pytest.mark.parametrize("distance", [1e-3, 1e-9, 1e-150])
def test_a_target_close_to_a_sensor_is_fine(distance):
    at_origin = RadarArray([[0, 0, 0]])
    x = [0, 0, distance, 3.0, 0, -2.0]
    np.testing.assert_allclose(doppler_shift(x, at_origin), [320], rtol=1e-15)
    # The pull aside grows as one over distance: 160 * 3 / distance.
    H = [[-480 / distance, 0, 0, 0, 0, -160]]
    np.testing.assert_allclose(
        doppler_jacobian(x, at_origin), H, rtol=1e-14, atol=1e-15 * 480 / distance
    )


def test_a_distance_whose_square_is_no_number_any_more_counts_as_on_the_sensor():
    with pytest.raises(ValueError, match="x must not lie on a sensor"):
        doppler_shift([0, 0, 1e-170, 0, 0, 1], RadarArray([[0, 0, 0]]))


@pytest.mark.parametrize("function", [doppler_shift, doppler_jacobian])
@pytest.mark.parametrize(
    ("x", "message"),
    [
        ([1, 0, 0], r"x must have shape \(\.\.\., 6\), got \(3,\)"),
        (np.ones((6, 5)), r"x must have shape \(\.\.\., 6\), got \(6, 5\)"),
        (1.0, r"x must have shape \(\.\.\., 6\), got \(\)"),
        ([1, 0, 0, 0, np.nan, 0], "x must be finite, got nan"),
        ([1, 0, 0, 0, -np.inf, 0], "x must be finite, got -inf"),
        ("abc", "x must be an array of real numbers, got 'abc'"),
        ([1, 0, 0, 0, 1j, 0], "x must be an array of real numbers"),
    ],
)
def test_what_is_no_state_is_refused_by_name_value_and_expectation(function, x, message):
    with pytest.raises(ValueError, match=message):
        function(x, RING)
