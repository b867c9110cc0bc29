"""Sensor arrays: where the sensors stand, and what is refused."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dopplerlib import RadarArray

NAN, INF = float("nan"), float("inf")
# The plane of a ring and the direction in which it is counted are right-handed about the normal.
AXES = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}
FIRST = {"x": "y", "y": "z", "z": "x"}

# Coordinates of a few tenths of a meter, rounded a few times: 1e-16 each.
ROUNDING = 1e-15


@pytest.mark.parametrize("normal", "xyz")
@pytest.mark.parametrize(("n", "radius"), [(1, 0.1), (2, 1.0), (5, 0.3), (6, 0.2)])
def test_a_ring_lies_in_its_plane_at_its_radius_about_the_origin(n, radius, normal):
    positions = RadarArray.ring(n, radius, phase=0.7, normal=normal).positions
    assert positions.shape == (n, 3)
    assert (positions @ AXES[normal] == 0).all()
    np.testing.assert_allclose(np.linalg.norm(positions, axis=1), radius, rtol=1e-15)
    if n > 1:
        np.testing.assert_allclose(positions.mean(axis=0), 0, atol=ROUNDING)


@pytest.mark.parametrize("normal", "xyz")
def test_turning_a_ring_by_one_step_about_its_normal_makes_each_sensor_the_next(normal):
    positions = RadarArray.ring(5, 0.3, phase=0.7, normal=normal).positions
    turn = Rotation.from_rotvec(2 * np.pi / 5 * np.array(AXES[normal]))
    turned = positions @ turn.as_matrix().T
    np.testing.assert_allclose(turned, np.roll(positions, -1, axis=0), atol=ROUNDING)


@pytest.mark.parametrize("normal", "xyz")
def test_the_first_sensor_stands_on_the_axis_after_the_normal_turned_by_the_phase(normal):
    start = 0.3 * np.array(AXES[FIRST[normal]])
    turn = Rotation.from_rotvec(0.7 * np.array(AXES[normal]))
    for phase, first in [(0.0, start), (0.7, turn.apply(start))]:
        array = RadarArray.ring(5, 0.3, phase=phase, normal=normal)
        np.testing.assert_allclose(array.positions[0], first, atol=ROUNDING)


def test_the_default_ring_counts_from_plus_y_towards_plus_z():
    four = [[0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, -1]]
    np.testing.assert_allclose(RadarArray.ring(4, 1.0).positions, four, atol=ROUNDING)


@pytest.mark.parametrize("axis", "xyz")
@pytest.mark.parametrize(("n", "length"), [(2, 1.0), (5, 0.4), (8, 0.7)])
def test_a_line_is_centered_with_its_ends_at_half_its_length(n, length, axis):
    positions = RadarArray.linear(n, length, axis).positions
    along = [-length / 2 + i * length / (n - 1) for i in range(n)]
    np.testing.assert_allclose(positions, np.outer(along, AXES[axis]), atol=ROUNDING)


@pytest.mark.parametrize(
    "make",
    [
        lambda w: RadarArray([[0, 0, 0]], w),
        lambda w: RadarArray.ring(3, 0.2, wavelength=w),
        lambda w: RadarArray.linear(3, 0.2, wavelength=w),
    ],
)
def test_one_meter_per_second_shifts_the_echo_by_two_over_the_wavelength(make):
    assert make(0.004).doppler_per_speed == 500
    assert make(0.0125).doppler_per_speed == 160


def test_the_default_wavelength_gives_160_hz_per_meter_per_second():
    for array in (RadarArray([[0, 0, 0]]), RadarArray.ring(3, 0.2), RadarArray.linear(3, 0.2)):
        assert array.doppler_per_speed == 160


def test_an_array_cannot_be_changed_once_it_is_made():
    mine = np.array([[0.0, 0, 0], [0, 1, 0]])
    array = RadarArray(mine)
    mine[0] = 7
    assert (array.positions[0] == 0).all()
    with pytest.raises(ValueError, match="read-only"):
        array.positions[0, 0] = 1
    with pytest.raises(FrozenInstanceError):
        array.wavelength = 1.0
    with pytest.raises(FrozenInstanceError):
        array.positions = mine


def test_arrays_are_equal_if_positions_and_wavelength_are():
    array = RadarArray([[0, 0, 0], [0, 1, 0]])
    assert array == RadarArray(np.array([[0.0, 0, 0], [0, 1, 0]]), wavelength=0.0125)
    assert array != RadarArray([[0, 1, 0], [0, 0, 0]])  # the order of the sensors is that of z
    assert array != RadarArray([[0, 0, 0]])
    assert array != RadarArray(array.positions, wavelength=0.01)
    assert array != "an array"
    assert len({array, RadarArray(array.positions.copy())}) == 1


def test_the_length_of_an_array_is_its_number_of_sensors():
    assert [len(RadarArray.ring(n, 0.2)) for n in (1, 2, 7)] == [1, 2, 7]


ONE = [[0, 0, 0]]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: RadarArray([[0, NAN, 0]]), "positions must be finite, got nan"),
        (lambda: RadarArray([[0, INF, 0]]), "positions must be finite, got inf"),
        (lambda: RadarArray([0, 0, 0]), r"positions must have shape .*, 3\), got \(3,\)"),
        (lambda: RadarArray([[0, 0]]), r"positions must have shape .*, 3\), got \(1, 2\)"),
        (lambda: RadarArray(np.zeros((0, 3))), r"positions .* N >= 1, got \(0, 3\)"),
        (lambda: RadarArray(np.zeros((1, 1, 3))), r"positions .*got \(1, 1, 3\)"),
        (lambda: RadarArray([["a", 0, 0]]), "positions must be an array of real numbers, got"),
        (lambda: RadarArray([[0, 1, 0], [0, 1, 0]]), r"positions must differ .*got \[\[0"),
        (lambda: RadarArray([[0, 0.0, 0], [0, -0.0, 0]]), "positions must differ"),
        (lambda: RadarArray(ONE, 0), "wavelength must be positive, got 0"),
        (lambda: RadarArray(ONE, -0.01), "wavelength must be positive, got -0.01"),
        (lambda: RadarArray(ONE, NAN), "wavelength must be finite, got nan"),
        (lambda: RadarArray(ONE, [0.01, 0.02]), r"wavelength must be one number, .*\(2,\)"),
        (lambda: RadarArray.ring(0, 0.2), "n must be a whole number of at least 1, got 0"),
        (lambda: RadarArray.ring(6.0, 0.2), "n must be a whole number of at least 1, got 6.0"),
        (lambda: RadarArray.ring(True, 0.2), "n must be a whole number of at least 1, got True"),
        (lambda: RadarArray.ring(6, -0.2), "radius must be positive, got -0.2"),
        (lambda: RadarArray.ring(6, 0), "radius must be positive, got 0"),
        (lambda: RadarArray.ring(6, 0.2, NAN), "phase must be finite, got nan"),
        (lambda: RadarArray.ring(6, 0.2, [0, 1]), r"phase must be one number, got .*\(2,\)"),
        (lambda: RadarArray.ring(6, 0.2, normal="w"), "normal must be one of 'x', 'y', 'z', .*'w'"),
        (lambda: RadarArray.ring(6, 0.2, wavelength=0), "wavelength must be positive, got 0"),
        (lambda: RadarArray.linear(1, 0.4), "n must be a whole number of at least 2, got 1"),
        (lambda: RadarArray.linear(5, 0), "length must be positive, got 0"),
        (lambda: RadarArray.linear(5, INF), "length must be finite, got inf"),
        (lambda: RadarArray.linear(5, 0.4, "xy"), "axis must be one of 'x', 'y', 'z', got 'xy'"),
        (lambda: RadarArray.linear(5, 0.4, wavelength=-1), "wavelength must be positive, got -1"),
    ],
)
def test_an_impossible_array_is_refused_by_name_value_and_expectation(make, message):
    with pytest.raises(ValueError, match=message):
        make()
