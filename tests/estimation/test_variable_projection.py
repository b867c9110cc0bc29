"""The velocity inside the search: linear, best, and what the search itself finds."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import multivariate_normal, norm

from dopplerlib import RadarArray, doppler_shift, ml_initialize
from dopplerlib.estimation.variable_projection import (
    log_position_density,
    velocity_given_position,
)

RING, LINE = RadarArray.ring(6, 0.2), RadarArray.linear(5, 0.4)
STATE = np.array([0.8, 0.1, 0.1, -0.7, -0.1, 0.2])


def noisy(x, array, sigma_f, seed):
    rng = np.random.default_rng(seed)
    return doppler_shift(x, array) + sigma_f * rng.standard_normal(len(array))


def test_at_the_true_position_exact_shifts_give_the_true_velocity():
    v, cost = velocity_given_position(doppler_shift(STATE, RING), RING, 0.4, STATE[:3])
    assert_allclose(v, STATE[3:], rtol=1e-10)  # the matrix has a condition number of 20
    assert cost < 1e-18


def test_the_cost_is_the_misfit_of_position_and_velocity():
    z = noisy(STATE, RING, 0.4, 1)
    p = np.random.default_rng(2).normal(STATE[:3], 0.1, (7, 3))
    v, cost = velocity_given_position(z, RING, 0.4, p)
    misfit = (z - doppler_shift(np.concatenate([p, v], axis=-1), RING)) / 0.4
    assert_allclose(cost, np.sum(misfit**2, axis=-1), rtol=1e-9)


def test_no_other_velocity_is_better():
    z = noisy(STATE, RING, 0.4, 3)
    deviations = 0.4 * np.arange(1, 7)
    p = np.add(STATE[:3], [0.1, 0, 0])
    v, cost = velocity_given_position(z, RING, deviations, p)
    others = v + np.random.default_rng(4).normal(0, 0.01, (200, 3))
    states = np.concatenate([np.broadcast_to(p, (200, 3)), others], axis=-1)
    misfits = np.sum(((z - doppler_shift(states, RING)) / deviations) ** 2, axis=-1)
    assert (misfits > cost).all()


def test_the_search_ends_where_no_position_is_better_and_with_this_velocity():
    z = noisy([0.5, 0.2, 0, -1, 0.5, 0], LINE, 0.1, 5)
    box = [0.05, -1, 0, -3, -3, 0], [2, 1, 0, 3, 3, 0]
    start = ml_initialize(z[None], LINE, 0.1, 0.001, box)
    v, cost = velocity_given_position(z, LINE, 0.1, start.x[:3], in_plane=True)
    assert not start.at_bound.any()
    assert_allclose(v, start.x[3:], atol=1e-6)
    assert cost == pytest.approx(float(start.cost), rel=1e-9)
    across = np.random.default_rng(6).uniform([0.05, -1, 0], [2, 1, 0], (4000, 3))
    assert velocity_given_position(z, LINE, 0.1, across, in_plane=True)[1].min() >= cost


def test_in_the_plane_no_velocity_leaves_it():
    v, _ = velocity_given_position(
        [1.0, 2, 3, 4, 5], LINE, 0.1, [[0.5, 0.1, 0], [0.2, -0.3, 0]], True
    )
    assert (v[:, 2] == 0).all()


def test_on_the_line_of_the_sensors_the_shortest_velocity_is_taken():
    v, _ = velocity_given_position(np.full(5, -160.0), LINE, 0.1, [0, 0.7, 0])
    assert_allclose(v, [0, 1, 0], atol=1e-12)  # speed across the line changes no shift


@pytest.mark.parametrize(
    ("changed", "match"),
    [
        ({"z": [1.0, 2]}, "z must have shape"),
        ({"z": np.ones((2, 6))}, "z must be one sample"),
        ({"z": [np.nan] * 6}, "z must be finite"),
        ({"array": 3}, "array must be a RadarArray"),
        ({"sigma_f": 0.0}, "sigma_f must be"),
        ({"sigma_f": [1.0, 2]}, "sigma_f must have leading axes"),
        ({"p": [1.0, 2]}, "p must have shape"),
        ({"p": RING.positions[0]}, "must not lie on a sensor"),
    ],
)
def test_what_is_no_linear_problem_is_refused(changed, match):
    arguments = {"z": np.ones(6), "array": RING, "sigma_f": 0.4, "p": [1.0, 0, 0]} | changed
    with pytest.raises(ValueError, match=match):
        velocity_given_position(**arguments)


PRIOR = np.array([0.7, 0.1, 0, -0.6, 0, 0.1]), np.diag([0.04, 0.09, 0.06, 0.05, 0.02, 0.08]) + 0.01


def test_the_density_of_positions_is_that_of_all_samples_at_once():
    """SciPy's normal density of the stacked samples, and of the position; some are missing."""
    rng = np.random.default_rng(7)
    z = doppler_shift(STATE, RING) + 0.4 * rng.standard_normal((5, 6))
    z[1, 2] = z[:, 4] = np.nan
    deviations = 0.3 + 0.1 * np.arange(6)
    p = STATE[:3] + 0.2 * rng.standard_normal((4, 3))
    x0, P0 = PRIOR
    wanted = []
    for place in p:
        gain = P0[3:, :3] @ np.linalg.inv(P0[:3, :3])
        v, V = x0[3:] + gain @ (place - x0[:3]), P0[3:, 3:] - gain @ P0[:3, 3:]
        lines = [doppler_shift([*place, *axis], RING) for axis in np.eye(3)]
        A, R = np.tile(np.transpose(lines), (5, 1)), np.diag(np.tile(deviations**2, 5))
        there = ~np.isnan(z.ravel())
        mean, S = (A @ v)[there], (A @ V @ A.T + R)[np.ix_(there, there)]
        wanted.append(multivariate_normal.logpdf(z.ravel()[there], mean, S))
        wanted[-1] += multivariate_normal.logpdf(place, x0[:3], P0[:3, :3])
    found = log_position_density(z, RING, deviations, p, x0, P0)
    assert_allclose(found - found[0], np.subtract(wanted, wanted[0]), rtol=1e-9, atol=1e-9)


def test_the_density_of_positions_is_an_integral_over_velocities():
    """One sensor sees one component of the velocity: a sum over a fine grid of that."""
    sensor, z = RadarArray([[0, 0, 0]]), np.full((3, 1), -100.0)
    x0, P0 = np.array([1.0, 0, 0, -0.5, 0, 0]), np.diag([0.1, 0.1, 0.1, 0.04, 0.04, 0.04])
    p = np.array([[0.8, 0, 0], [1.3, 0, 0]])
    speed = np.linspace(-2, 1, 30_001)
    likelihood = norm.logpdf(-100.0, -160 * speed, 5.0) * 3 + norm.logpdf(speed, -0.5, 0.2)
    wanted = np.log(np.exp(likelihood).sum()) + norm.logpdf(p[:, 0], 1, 0.1**0.5)
    found = log_position_density(z, sensor, 5.0, p, x0, P0)
    # In front of one sensor the velocity is the same at both distances.
    assert found[1] - found[0] == pytest.approx(wanted[1] - wanted[0], rel=1e-9)
    slower = log_position_density(z, sensor, 5.0, p, [*x0[:3], -0.3, 0, 0], P0)
    shifted = norm.logpdf(-100.0, -160 * speed, 5.0) * 3 + norm.logpdf(speed, -0.3, 0.2)
    gained = np.log(np.exp(shifted).sum() / np.exp(likelihood).sum())
    assert_allclose(slower - found, gained, rtol=1e-6)
