"""Constant velocity: the matrices move a target as the equations of motion say."""

import numpy as np
import pytest

from dopplerlib import constant_velocity

# Powers of two and small whole numbers: every product below is exact.
T, SIGMA = 4.0, 0.5
BOTH = ["shared", "per_axis", "horizontal"]


def test_the_transition_moves_the_position_by_the_velocity_times_the_interval():
    F, _ = constant_velocity(T, SIGMA)
    assert (F @ [1, 2, 3, 10, 20, 30]).tolist() == [41, 82, 123, 10, 20, 30]


@pytest.mark.parametrize("noise", BOTH)
def test_two_steps_are_one_of_twice_the_length(noise):
    F, _ = constant_velocity(T, SIGMA, noise)
    np.testing.assert_array_equal(F @ F, constant_velocity(2 * T, SIGMA, noise)[0])


def test_a_thousand_predictions_lie_on_the_straight_line_to_the_last_bit():
    T = 2.0**-10
    F, _ = constant_velocity(T, SIGMA)
    start = np.array([0.75, -0.125, 0.5, -0.75, 0.25, 1.5])
    x = start.copy()
    for _ in range(1000):
        x = F @ x
    assert x.tolist() == [*(start[:3] + 1000 * T * start[3:]), *start[3:]]


def test_the_common_noise_has_the_covariance_of_one_acceleration_along_the_diagonal():
    """One draw a moves every axis by a T^2/2 and quickens it by a T: 8 and 4 times a, var 1/4."""
    _, Q = constant_velocity(T, SIGMA, "shared")
    position, mixed, velocity = 8 * 8 / 4, 8 * 4 / 4, 4 * 4 / 4
    expected = [[position] * 3 + [mixed] * 3] * 3 + [[mixed] * 3 + [velocity] * 3] * 3
    assert Q.tolist() == expected


def test_independent_noise_has_the_same_variances_and_nothing_between_the_axes():
    _, Q = constant_velocity(T, SIGMA, "per_axis")
    _, common = constant_velocity(T, SIGMA, "shared")
    same_axis = np.equal.outer(np.arange(6) % 3, np.arange(6) % 3)
    np.testing.assert_array_equal(Q, np.where(same_axis, common, 0))


def test_the_common_noise_has_rank_one_and_the_independent_rank_three():
    for noise, rank in [("shared", 1), ("per_axis", 3), ("horizontal", 2)]:
        values = np.linalg.eigvalsh(constant_velocity(T, SIGMA, noise)[1])
        assert (values > 1e-12 * values.max()).sum() == rank
        assert values.min() >= -1e-12 * values.max()


def test_the_papers_noise_is_the_default():
    np.testing.assert_array_equal(
        constant_velocity(T, SIGMA)[1], constant_velocity(T, SIGMA, "shared")[1]
    )


@pytest.mark.parametrize("noise", BOTH)
def test_noise_grows_with_the_square_of_its_deviation(noise):
    _, Q = constant_velocity(T, SIGMA, noise)
    np.testing.assert_array_equal(constant_velocity(T, 2 * SIGMA, noise)[1], 4 * Q)
    np.testing.assert_array_equal(Q, Q.T)


@pytest.mark.parametrize("noise", BOTH)
def test_each_interval_has_the_matrices_of_this_interval_alone(noise):
    intervals = np.array([[0.001, 4.0, 0.3], [1.0, 0.07, 12.0]])
    F, Q = constant_velocity(intervals, SIGMA, noise)
    for at, interval in np.ndenumerate(intervals):
        alone = constant_velocity(interval, SIGMA, noise)
        assert (F[at].tolist(), Q[at].tolist()) == (alone[0].tolist(), alone[1].tolist())


@pytest.mark.parametrize(
    ("name", "bad"),
    [(name, bad) for name in ("T", "sigma_a") for bad in (0, -1.0, np.nan, np.inf, "fast", None)]
    + [("T", [1.0, 0.0]), ("sigma_a", [1.0, 2.0])],
)
def test_an_impossible_number_is_refused_by_name(name, bad):
    arguments = {"T": T, "sigma_a": SIGMA, name: bad}
    with pytest.raises(ValueError, match=rf"^{name} must be .*, got "):
        constant_velocity(**arguments)


@pytest.mark.parametrize("bad", ["white", "Common", None, 1])
def test_an_unknown_noise_is_refused(bad):
    with pytest.raises(
        ValueError, match=f"noise must be one of 'shared', 'per_axis', 'horizontal', got {bad!r}"
    ):
        constant_velocity(T, SIGMA, bad)
