"""A coordinated turn is the flow of a linear equation whose matrix holds the turn rate."""

import numpy as np
import pytest
from scipy.linalg import expm

from dopplerlib import coordinated_turn, coordinated_turn_jacobian, ekf_records, kf, ukf
from dopplerlib.model.motion import ncv_transition

RATES = [0.0, 1e-320, 1e-12, -1e-7, 1e-4, 0.03, 0.249, -0.251, -0.7, 2.0, -9.0]
T = 0.8


def flow(x, T):
    """Return the state by a matrix exponential; for complex states as well."""
    A = np.zeros((5, 5), complex)
    A[0, 2] = A[1, 3] = 1
    A[2, 3], A[3, 2] = -x[4], x[4]
    return expm(T * A) @ x


@pytest.mark.parametrize("rate", RATES)
def test_the_motion_and_its_derivative_are_those_of_the_matrix_exponential(rate):
    """The derivative by a complex step, which has no error of differences."""
    x = np.array([3.0, -2.0, 1.5, -4.0, rate])
    np.testing.assert_allclose(coordinated_turn(x, T), flow(x, T).real, rtol=1e-13, atol=1e-13)
    F = coordinated_turn_jacobian(x, T)
    for i in range(5):
        step = x.astype(complex)
        step[i] += 1e-30j
        np.testing.assert_allclose(F[:, i], flow(step, T).imag / 1e-30, rtol=1e-12, atol=1e-13)


def test_the_jacobian_is_smooth_through_a_rate_of_zero():
    """Its own series: -v T^3 / 3 per unit of rate along the way, v T^2 / 2 across it."""
    rate = np.array([1e-14, 1e-9, 1e-6])
    x = np.stack([0 * rate, 0 * rate, 1 + 0 * rate, 0 * rate, rate], axis=-1)
    F = coordinated_turn_jacobian(x, T)
    np.testing.assert_allclose(F[:, 0, 4], -rate * T**3 / 3, rtol=1e-11)
    np.testing.assert_allclose(F[:, 1, 4], T**2 / 2, rtol=1e-11)


def test_without_a_turn_it_is_constant_velocity():
    x = np.random.default_rng(1).standard_normal((6, 5))
    x[:, 4] = 0
    F = ncv_transition(T, 2, "derivative")
    np.testing.assert_allclose(coordinated_turn(x, T)[:, :4], x[:, :4] @ F.T, rtol=1e-14)
    np.testing.assert_array_equal(coordinated_turn(x, 0.0), x)
    np.testing.assert_array_equal(coordinated_turn_jacobian(x[0], 0.0), np.eye(5))


def test_two_intervals_are_one_and_speed_stays():
    x = np.random.default_rng(2).standard_normal((4, 3, 5))
    whole = coordinated_turn(x, 0.7)
    twice = coordinated_turn(coordinated_turn(x, 0.3), 0.4)
    np.testing.assert_allclose(twice, whole, rtol=1e-12, atol=1e-13)
    speed = np.hypot(x[..., 2], x[..., 3])
    np.testing.assert_allclose(np.hypot(whole[..., 2], whole[..., 3]), speed, rtol=1e-13)


def test_filters_find_the_rate_of_a_turn_that_constant_velocity_misses():
    """A turn of 0.3 rad/s, of which positions are measured without a word on the rate."""
    rng = np.random.default_rng(3)
    x = np.array([0.0, 0.0, 10.0, 0.0, 0.3])
    path = np.array([x := coordinated_turn(x, T) for _ in range(60)])
    z = path[:, :2] + 0.5 * rng.standard_normal((60, 2))
    Q, R = np.diag([0, 0, 0.01, 0.01, 1e-4]), 0.25 * np.eye(2)
    start, P0 = np.array([0.0, 0.0, 9.0, 1.0, 0.0]), np.diag([1.0, 1.0, 4.0, 4.0, 0.1])
    common = {"f": lambda x: coordinated_turn(x, T), "Q": Q, "h": lambda x: x[..., :2], "R": R}
    slopes = {
        "F": lambda x: coordinated_turn_jacobian(x, T), "H": lambda x: np.eye(2, 5),
    }  # fmt: skip
    tracks = [
        ekf_records(z, **common, **slopes, x0=start, P0=P0),
        ukf(z, **common, x0=start, P0=P0),
    ]
    for track in tracks:
        late = track.x[30:]
        assert np.abs(late[:, 4] - 0.3).max() < 4 * np.sqrt(track.P[30:, 4, 4].max())
        assert np.abs(late[:, 4] - 0.3).mean() < 0.05
        # NIS of 2 components over 60 samples: chi-square of 120, inside five of its deviations.
        assert abs(track.nis.sum() - 120) < 5 * np.sqrt(240)
    straight = ncv_transition(T, 2, "derivative")
    lost = kf(z, straight, Q[:4, :4], np.eye(2, 4), R, start[:4], P0[:4, :4])
    error = [np.linalg.norm(t.x[30:, :2] - path[30:, :2], axis=-1).mean() for t in (*tracks, lost)]
    assert max(error[:2]) < 0.5 < error[2]


@pytest.mark.parametrize("function", [coordinated_turn, coordinated_turn_jacobian])
@pytest.mark.parametrize(
    ("x", "T", "message"),
    [
        (np.ones(4), 1.0, r"x must have shape \(..., 5\), got \(4,\)"),
        (np.full(5, np.nan), 1.0, "x must be finite, got nan at index"),
        (np.full(5, 1e61), 1.0, r"x must be between .*, got 1e\+61"),
        (np.ones(5), -1.0, r"T must not be negative, got -1.0"),
        (np.ones(5), [1.0, 2.0], "T must be one number, got"),
    ],
)
def test_bad_input_is_named(function, x, T, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        function(x, T)
