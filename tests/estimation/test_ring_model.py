"""The ring model is the straight motion and the Doppler shift, in other coordinates."""

import numpy as np
import pytest

from dopplerlib import RadarArray, doppler_shift, ekf_records, ukf
from dopplerlib.estimation.ring_model import RingModel
from dopplerlib.model.motion import constant_velocity
from dopplerlib.model.ring_coordinates import to_ring_coordinates

RING = RadarArray.ring(6, 0.2)
PLANE = RadarArray([[0, 0.05, 0.1], [0, -0.3, 0.02], [0, 0.2, 0.0], [0, 0.0, 0.0]])
STATES = np.array([[0.833, 0.111, 0.092, -0.75, -0.125, -0.018], [0.4, -0.5, 0.3, 0.2, 1.0, -0.7]])
T, SIGMA = 0.05, 3.0
NOISES = ["shared", "per_axis"]
arrays = pytest.mark.parametrize("array", [RING, PLANE])


def by_steps(function, at, step=1e-6):
    """Return the derivatives of `function` by central differences, the argument last."""
    sides = [function(at + step * e) - function(at - step * e) for e in np.eye(6)]
    return np.stack(sides, axis=-1) / (2 * step)


def coordinates(model, x=STATES):
    return to_ring_coordinates(x, model.radius)


@arrays
def test_motion_and_shift_are_those_of_the_state(array):
    model = RingModel(array, T, SIGMA)
    xi = coordinates(model)
    after = STATES @ constant_velocity(T, SIGMA)[0].T
    # A dozen roundings.
    np.testing.assert_allclose(model.f(xi), coordinates(model, after), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(model.h(xi), doppler_shift(STATES, array), rtol=0, atol=1e-11)


@arrays
def test_derivatives_are_those_of_differences(array):
    model = RingModel(array, T, SIGMA)
    xi = coordinates(model)
    # Differences are off by some 1e-10 of the values, and by the square of the step.
    for function, jacobian in ((model.f, model.F), (model.h, model.H)):
        slopes = by_steps(function, xi)
        np.testing.assert_allclose(jacobian(xi), slopes, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("noise", NOISES)
def test_noise_is_that_of_the_state_carried_over(noise):
    model = RingModel(RING, T, SIGMA, noise)
    F, Q = constant_velocity(T, SIGMA, noise)
    D = np.array([by_steps(lambda x: coordinates(model, x), x) for x in STATES @ F.T])
    np.testing.assert_allclose(
        model.Q(coordinates(model)), D @ Q @ D.mT, rtol=1e-6, atol=1e-8 * np.abs(Q).max()
    )


def test_at_a_ring_nothing_tells_the_scale():
    model = RingModel(RING, T, SIGMA)
    # Rounding of s.s - r^2, times a shift of some 100 Hz.
    assert np.abs(model.H(coordinates(model))[..., 5]).max() < 1e-12
    assert np.abs(RingModel(PLANE, T, SIGMA).H(coordinates(model))[..., 5]).max() > 1


def test_a_filter_learns_nothing_of_the_scale_wherever_it_linearizes():
    """Of a state that stands still, information about ln rho stays what it was at the start.

    The prior is so broad that sigma points lie where there is no state.
    """
    model = RingModel(RING, T, SIGMA)
    rng = np.random.default_rng(1)
    z = doppler_shift(STATES[0], RING) + 0.4 * rng.standard_normal((20, 6))
    x0, P0 = model.start([0.8, 0, 0, -0.75, 0, 0], 0.0625 * np.eye(6))
    still = {"f": lambda xi: xi, "Q": np.zeros((6, 6)), "h": model.h, "R": 0.16 * np.eye(6)}
    slopes = {"F": lambda xi: np.eye(6), "H": model.H}
    for iterations in (1, 3):
        start = {"x0": x0, "P0": P0, "iterations": iterations}
        for track in (ekf_records(z, **still, **slopes, **start), ukf(z, **still, **start)):
            information = np.linalg.inv(track.P)[:, 5, 5]
            np.testing.assert_allclose(information, np.linalg.inv(P0)[5, 5], rtol=1e-6)


def test_small_clouds_go_there_and_back():
    model = RingModel(RING, T, SIGMA)
    P = 1e-8 * np.diag([1.0, 2, 3, 4, 5, 6])
    xi, spread = model.start(STATES, np.stack([P, P]))
    np.testing.assert_allclose(xi, coordinates(model), atol=1e-6)
    x, P_back = model.state(xi, spread)
    np.testing.assert_allclose(x, STATES, atol=1e-6)
    # The curvature of the coordinates over 1e-4 m changes a deviation by some 1e-4 of it.
    np.testing.assert_allclose(P_back, np.stack([P, P]), atol=1e-3 * P.max())


def test_one_state_takes_several_covariances():
    model = RingModel(RING, T, SIGMA)
    several = np.stack([np.eye(6), 4 * np.eye(6)]) * 1e-6
    together = model.start(STATES[0], several)
    for i, P in enumerate(several):
        for found, alone in zip(together, model.start(STATES[0], P), strict=True):
            np.testing.assert_allclose(found[i], alone, rtol=1e-9, atol=1e-15)


def test_a_broad_prior_keeps_its_spread():
    """Beside 40 000 draws; three points an axis are exact to the fifth order, not beyond."""
    x0, P0 = np.array([0.8, 0, 0, -0.75, 0, 0]), np.diag([0.2, *[0.25] * 5]) ** 2
    mean, P = RingModel(RING, T, SIGMA).start(x0, P0)
    draws = to_ring_coordinates(np.random.default_rng(2).multivariate_normal(x0, P0, 40_000), 0.2)
    np.testing.assert_allclose(mean, draws.mean(axis=0), rtol=0, atol=0.01)
    np.testing.assert_allclose(np.sqrt(np.diag(P)), draws.std(axis=0), rtol=0.1)


def test_coordinates_without_a_state_are_taken_for_some_with_one():
    model = RingModel(RING, T, SIGMA)
    odd = np.tile(coordinates(model, STATES[0]), (4, 1))
    odd[0, 5], odd[1, 5] = 5.0, -5.0
    odd[2, :2], odd[3, [0, 5]] = (9.0, -9.0), (9.0, -9.0)
    for function in (model.f, model.F, model.Q, model.h, model.H):
        assert np.isfinite(function(odd)).all()
    x, _ = model.state(odd, np.zeros((4, 6, 6)))
    # Its square is a difference of numbers up to 1e4.
    assert (x[:, 0] >= 0.15 * 0.2 * (1 - 1e-6)).all()
    there = coordinates(model)
    np.testing.assert_array_equal(model.state(there, np.zeros((2, 6, 6)))[0].round(12), STATES)


@pytest.mark.parametrize("positions", [[[0, 0, 0]], [[0, 0, 0.1], [0.1, 0.2, 0]]])
def test_an_array_off_the_plane_is_refused(positions):
    with pytest.raises(ValueError, match=r"^array must have its sensors in the plane x = 0"):
        RingModel(RadarArray(positions), T, SIGMA)


@pytest.mark.parametrize(
    ("method", "arguments", "match"),
    [
        ("f", [[1.0, 2]], r"^xi must have shape"),
        ("h", [np.full(6, np.inf)], "^xi must be finite"),
        ("start", [STATES, np.stack([np.eye(6)] * 3)], "^x0, P0 must have leading axes"),
        ("state", [STATES, -np.eye(6)], "^P must be positive semidefinite"),
    ],
)
def test_bad_input_is_named(method, arguments, match):
    with pytest.raises(ValueError, match=match):
        getattr(RingModel(RING, T, SIGMA), method)(*arguments)
