"""Bounds and second valleys of layouts, against other ways to compute them."""

import numba
import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.stats import binom

from dopplerlib import doppler_jacobian, doppler_shift
from dopplerlib.workspace import _layout_loop, _layout_search
from dopplerlib.workspace.layouts import layout_quality, named_layouts, twins
from dopplerlib.workspace.targets import (
    ARRAY,
    INTERVAL,
    PRIOR_COVARIANCE,
    PRIOR_MEAN,
    SIGMA_F,
    TABLE_2,
)

ARRAYS = named_layouts()
NEAR = np.array([0.7, 0.1, 0.05, -0.8, -0.1, 0.1])
TARGETS = np.stack([TABLE_2, NEAR])


def test_layouts_stand_in_the_disc_of_the_ring():
    for array in ARRAYS.values():
        assert len(array) == 6
        assert (np.linalg.norm(array.positions[:, 1:], axis=-1) < 0.2 + 1e-12).all()
        assert ((array.positions[:, 0] <= 0) & (array.positions[:, 0] >= -0.05)).all()


@pytest.mark.parametrize("name", ["ring of six", "ring, every other one set back"])
def test_the_static_bound_is_that_of_ten_linear_updates(name):
    """A Kalman filter in the form of gains, one sensor after the other."""
    H = doppler_jacobian(TABLE_2, ARRAYS[name])
    P = PRIOR_COVARIANCE.copy()
    for row in np.tile(H, (10, 1)):
        P -= np.outer(P @ row, row @ P) / (row @ P @ row + SIGMA_F**2)
    expected = np.sqrt(np.trace(P[:3, :3]))
    found = layout_quality(TARGETS, ARRAYS[name]).static[0]
    np.testing.assert_allclose(found, expected, rtol=1e-6)  # rounding of ten thousand to one


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_states_that_cannot_be_written_to_are_not_compiled_for():
    states = TARGETS.copy()
    twins(states, ARRAY)
    states.flags.writeable = False
    twins(states, ARRAY)
    assert len(_layout_loop.chances.signatures) == 1


def test_blocks_of_the_search_lose_two_percent_of_the_bound_at_most():
    for array in ARRAYS.values():
        exact = np.exp(np.mean(np.log(layout_quality(TARGETS, array).moving)))
        blocks = np.exp(_layout_search._log_bound(array.positions, TARGETS, 100, False))
        assert exact < blocks < 1.02 * exact


def descent(array, z, times, weight, start):
    """Return the fit of residuals whose halved squares are minus the log posterior density."""
    whiten = np.linalg.cholesky(np.linalg.inv(PRIOR_COVARIANCE))

    def residuals(x):
        """Return those of states (..., 6): so many at once for the slopes, by differences."""
        p, v = x[..., None, :3], x[..., None, 3:]
        path = np.concatenate([p + times[:, None] * v, v + 0 * times[:, None]], axis=-1)
        off = (weight * (doppler_shift(path, array) - z)).reshape(*x.shape[:-1], -1)
        return np.concatenate([off, (x - PRIOR_MEAN) @ whiten], axis=-1)

    def slopes(x):
        there, back = (residuals(x + step * np.eye(6)) for step in (1e-6, -1e-6))
        return (there - back).T / 2e-6

    return least_squares(residuals, start, slopes, x_scale="jac")


def test_the_twin_is_a_valley_that_weighs_more_as_often_as_stated():
    """60 noises, both valleys searched by another algorithm; fails by chance once in 10^5."""
    array, runs, false_alarm = ARRAYS["five and the center"], 60, 1e-5
    x = np.array([0.93, 0.23, 0.1, -0.74, -0.26, -0.06])
    found = twins(x[None], array)
    times = INTERVAL * (10 * np.arange(10) + 5.5)
    weight = np.sqrt(10) / SIGMA_F
    path = np.concatenate([x[:3] + times[:, None] * x[3:], np.tile(x[3:], (10, 1))], axis=1)
    true, rng = doppler_shift(path, array), np.random.default_rng(1)
    heavier = 0
    for _ in range(runs):
        z = true + rng.standard_normal(true.shape) / weight
        weights = []
        for start in (x, found.x[0]):
            end = descent(array, z, times, weight, start)
            _, logarithm = np.linalg.slogdet(end.jac.T @ end.jac)
            weights.append(-end.cost - logarithm / 2)
        heavier += weights[1] > weights[0]
    low, high = binom.interval(1 - false_alarm, runs, found.probability[0])
    assert 0.2 < found.probability[0] < 0.8
    assert low <= heavier <= high
    end = descent(array, true, times, weight, found.x[0])
    assert np.abs(end.x - found.x[0]).max() < 0.01


def test_where_the_ring_sees_one_valley_there_is_no_twin():
    """Straight along the axis state and twin are the same."""
    found = twins(np.array([[0.5, 0.0, 0, -0.75, 0, 0]]), ARRAY)
    assert found.probability[0] == 0
    np.testing.assert_array_equal(found.x[0], [0.5, 0, 0, -0.75, 0, 0])
