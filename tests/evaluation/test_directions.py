"""Errors along the axes of their covariance add up to NEES, and a bad direction stands out."""

import numpy as np
import pytest

from dopplerlib import nis, principal_axis_errors


@pytest.fixture
def covariance():
    A = np.random.default_rng(61).normal(size=(5, 4, 4))
    return A @ A.swapaxes(-1, -2) + 0.1 * np.eye(4)


def test_the_squares_add_up_to_the_quadratic_form(covariance):
    error = np.random.default_rng(62).normal(size=(7, 5, 4))
    along = principal_axis_errors(error, covariance)
    assert along.shape == (7, 5, 4)
    np.testing.assert_allclose(np.sum(along**2, axis=-1), nis(error, covariance), rtol=1e-9)


def test_an_error_along_the_widest_axis_stands_first(covariance):
    variance, axis = np.linalg.eigh(covariance)
    widest = np.sqrt(variance[:, -1:]) * axis[:, :, -1]
    np.testing.assert_allclose(
        np.abs(principal_axis_errors(2 * widest, covariance)),
        np.tile([2, 0, 0, 0], (5, 1)),
        atol=1e-9,
    )


def test_the_sign_is_that_of_the_largest_component_of_the_axis():
    P = np.diag([1.0, 4.0])
    np.testing.assert_allclose(principal_axis_errors([[3, -2], [-3, 2]], P), [[-1, 3], [1, -3]])


def test_one_covariance_serves_many_errors(covariance):
    error = np.random.default_rng(63).normal(size=(9, 4))
    once = principal_axis_errors(error, covariance[:1])
    np.testing.assert_allclose(once, principal_axis_errors(error, covariance[[0] * 9]))


@pytest.mark.parametrize(
    ("error", "P", "message"),
    [
        ([1, 2, 3], np.eye(2), "P must have shape"),
        ([1, np.nan], np.eye(2), "error must be finite"),
        ([1, 2], -np.eye(2), "P must be positive semidefinite"),
        (np.ones((3, 2)), np.stack([np.eye(2)] * 2), "broadcast"),
    ],
)
def test_wrong_arguments_are_named(error, P, message):
    with pytest.raises(ValueError, match=message):
        principal_axis_errors(error, P)


def test_an_axis_without_spread_has_no_error_or_an_infinite_one():
    P = np.diag([4.0, 0.0, 1.0])
    assert principal_axis_errors([2.0, 0.0, 3.0], P).tolist() == [1.0, 3.0, 0.0]
    assert principal_axis_errors([2.0, -1e-3, 3.0], P).tolist() == [1.0, 3.0, -np.inf]
    assert principal_axis_errors(np.zeros(3), 0 * P).tolist() == [0.0, 0.0, 0.0]
