"""How many directions are seen, how well, and what is taken for what."""

import numpy as np
import pytest

from dopplerlib import (
    DopplerLinks,
    RadarArray,
    crlb,
    doppler_jacobian,
    doppler_shift,
    ml_initialize,
    ring_family,
)
from dopplerlib.evaluation.observability import nearest_ambiguity, observable_rank, rms_bounds
from dopplerlib.model.twin import planar_twin

T, SIGMA_F = 1e-3, 0.4
STATE = np.array([0.833, 0.111, 0.092, -0.75, -0.125, -0.018])
RING, LINE = RadarArray.ring(6, 0.2), RadarArray.linear(5, 0.4)
BOX = [0.1, -1, -1, -2, -2, -2], [3, 1, 1, 2, 2, 2]


@pytest.mark.parametrize("sensors", [1, 2, 3, 4, 5, 6, 24])
def test_a_ring_sees_as_many_directions_as_sensors_and_five_at_most(sensors):
    x = np.random.default_rng(60).normal(size=(30, 6))
    seen = observable_rank(x, RadarArray.ring(sensors, 0.2))
    assert (seen == min(sensors, 5)).all()


@pytest.mark.parametrize(
    ("x", "seen"), [([0.8, 0, 0, -0.75, 0, 0], 3), ([0.8, 0, 0, -0.75, 0.3, 0], 5)]
)
def test_a_target_straight_on_the_axis_is_seen_in_three_directions(x, seen):
    assert observable_rank(x, RadarArray.ring(9, 0.2)) == seen


def test_motion_shows_all_to_a_ring_but_never_the_turn_about_a_line():
    assert observable_rank(STATE, RING, 50, T, "constant_velocity") == 6
    assert observable_rank(STATE, LINE) == 4
    assert observable_rank(STATE, LINE, 50, T, "constant_velocity") == 5


def test_in_a_plane_a_line_sees_all_four_unknowns():
    plane = [True, True, False, True, True, False]
    assert observable_rank(STATE * plane, LINE, free=plane) == 4


def test_bounds_are_roots_of_sums_of_variances():
    P = np.diag([1.0, 4.0, 4.0, 9.0, 36.0, 36.0])
    position, velocity, away = rms_bounds(P, [2.0, 0, 0, 0, 0, 1])
    assert (position, velocity, away) == (3.0, 9.0, 1.0)
    assert rms_bounds(P) == (3.0, 9.0)


def test_the_bound_on_range_does_not_depend_on_the_axes():
    H = doppler_jacobian(STATE, RadarArray(np.random.default_rng(61).normal(size=(9, 3))))
    turn, _ = np.linalg.qr(np.random.default_rng(62).normal(size=(3, 3)))
    both = np.kron(np.eye(2), turn)
    P = np.linalg.inv(H.T @ H)
    # Rounding of six products.
    np.testing.assert_allclose(
        rms_bounds(both @ P @ both.T, both @ STATE), rms_bounds(P, STATE), rtol=1e-10
    )


def test_what_is_not_seen_has_infinite_bounds():
    assert all(np.isinf(rms_bounds(crlb(STATE, RING, SIGMA_F), STATE)))
    on_axis = [0.8, 0, 0, -0.75, 0.3, -0.2]
    P = np.diag([np.inf, 1.0, 1.0, 1.0, 1.0, 1.0])
    assert np.isinf(rms_bounds(P, on_axis)[2])
    assert rms_bounds(P, [0, 1.0, 0, 0, 0, 0])[2] == 1.0


@pytest.fixture(scope="module")
def second():
    return nearest_ambiguity(STATE, RING, SIGMA_F, 100, T, BOX)


def test_the_second_valley_is_near_the_family_of_the_twin(second):
    x, _ = second
    family = ring_family(planar_twin(STATE), 0.2, np.linspace(0.8, 1.25, 200))
    # The third order moves it by centimeters, out of half a meter between the two valleys.
    assert np.linalg.norm((family - x)[:, :3], axis=1).min() < 0.06
    assert np.linalg.norm(x[:3] - STATE[:3]) > 0.3


def test_noise_chooses_the_second_valley_as_often_as_predicted(second):
    x, chance = second
    runs = 600
    path = np.tile(STATE, (100, 1))
    path[:, :3] += T * np.arange(100)[:, None] * STATE[3:]
    noise = np.random.default_rng(63).normal(0, SIGMA_F, (runs, 100, 6))
    found = ml_initialize(doppler_shift(path, RING) + noise, RING, SIGMA_F, T, BOX).x
    to_truth, to_second = (np.linalg.norm((found - y)[:, 1:3], axis=1) for y in (STATE, x))
    # Five standard errors (false alarms: 1e-6), and 0.03 as the formula lets no optimum move.
    tolerance = 5 * np.sqrt(chance * (1 - chance) / runs) + 0.03
    assert np.mean(to_second < to_truth) == pytest.approx(chance, abs=tolerance)
    assert 0.2 < chance < 0.4


def test_a_second_ring_leaves_nothing_to_be_confused_with():
    array = RadarArray(np.vstack([RING.positions, RING.positions / 2]))
    assert nearest_ambiguity(STATE, array, SIGMA_F, 100, T, BOX)[1] < 1e-3


def platform(array, velocity, rate, times=(0.0,)):
    return DopplerLinks.on_platform(array, [0, 0, 0, *velocity], rate, times)


def test_a_ring_that_moves_as_a_whole_sees_five_directions_and_one_that_is_bent_six():
    rng = np.random.default_rng(14)
    twelve = RadarArray.ring(12, 0.2)
    x = rng.normal([2, 0, 0, 0, 0, 0], 1, (20, 6))
    for _ in range(5):
        links = platform(twelve, *rng.normal(size=(2, 3)) * 3)
        assert (observable_rank(x, links) == 5).all()
    two = [platform(twelve, [0, 0, 0], [rate, 0, 0]).receivers for rate in (3.0, -3.0)]
    halves = np.concatenate([two[0][:, ::2], two[1][:, 1::2]], axis=1)
    bent = DopplerLinks.two_way(halves, times=[0.0])
    assert (observable_rank(x, bent) == 6).all()


def test_a_platform_that_goes_straight_sees_a_target_at_rest_like_a_target_that_comes():
    u, K, times = np.array([5.0, 1, -2]), 40, 0.002 * np.arange(40)
    x = np.array([2.0, 0.3, -0.4, 0, 0, 0])
    driven = platform(RING, u, [0, 0, 0], times)
    driven = crlb(x, driven, SIGMA_F, likelihood="constant_velocity")
    comes = crlb(x - [0, 0, 0, *u], RING, SIGMA_F, K, times[1], "constant_velocity")
    # Correlations of some 1e-4 less than one cost as many digits of sixteen.
    np.testing.assert_allclose(driven, comes, rtol=1e-8)
    # Both at rest, no shift depends on the position.
    assert observable_rank(x, RING, K, times[1], "constant_velocity") == 3
