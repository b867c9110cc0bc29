"""The Cramér-Rao bound: the likelihood's own curvature, and what it says where nothing is seen."""

import numpy as np
import pytest

from dopplerlib import (
    RadarArray,
    crlb,
    doppler_jacobian,
    fisher_information,
    ring_family_direction,
)
from dopplerlib.model.information import inverse_information

T = 1e-3
RING, LINE = RadarArray.ring(6, 0.2), RadarArray.linear(5, 0.4)
SCATTERED = RadarArray([[0.1, -0.3, 0.2], [-0.4, 0.5, 0], [0, 0.2, -0.6], [0, 0, 0], [0.2, 0.1, 0]])
STATE = np.array([0.833, 0.111, 0.092, -0.75, -0.125, -0.018])
PLANE = [True, True, False, True, True, False]


def log_likelihood(x, z, array, sigma_f, moving):
    """Return log p(z | x), written out anew, for complex x as well."""
    total = 0.0
    for k in range(len(z)):
        p = x[:3] + (k * T * x[3:] if moving else 0)
        for n, sensor in enumerate(array.positions):
            d = sensor - p
            shift = array.doppler_per_speed * (d @ x[3:]) / np.sqrt(d @ d)
            total = total - ((z[k, n] - shift) / sigma_f[k, n]) ** 2 / 2
    return total


def numerical_information(x, array, sigma_f, moving):
    """Return the sum of outer products of the score, for one deviation of each measurement.

    The score is linear in Gaussian noise, so this sum is its covariance, without any sampling.
    Complex steps have no cancellation and no truncation error to speak of.
    """
    K, N = sigma_f.shape
    path = x + np.outer(np.arange(K), np.r_[T * x[3:], 0, 0, 0]) * moving
    z = np.array([
        [array.doppler_per_speed * (s - p[:3]) @ p[3:] / np.linalg.norm(s - p[:3])
         for s in array.positions] for p in path
    ])  # fmt: skip
    information = np.zeros((6, 6))
    for k in range(K):
        for n in range(N):
            deviated = z.copy()
            deviated[k, n] += sigma_f[k, n]
            score = [
                log_likelihood(x + 1e-30j * axis, deviated, array, sigma_f, moving).imag / 1e-30
                for axis in np.eye(6)
            ]
            information += np.outer(score, score)
    return information


@pytest.mark.parametrize("array", [RING, LINE, SCATTERED], ids=["ring", "line", "scattered"])
@pytest.mark.parametrize("likelihood", ["stationary", "constant_velocity"])
def test_the_information_is_the_covariance_of_the_score(array, likelihood):
    sigma_f = np.random.default_rng(51).uniform(0.1, 1, (3, len(array)))
    got = fisher_information(STATE, array, sigma_f, 3, T, likelihood)
    want = numerical_information(STATE, array, sigma_f, likelihood == "constant_velocity")
    scale = np.sqrt(np.diag(want))
    scale[scale == 0] = 1.0
    # Relative to the diagonal; the measurement z = h + sigma is rounded to 1e-16 of hundreds of Hz.
    np.testing.assert_allclose(
        got / scale / scale[:, None], want / scale / scale[:, None], atol=1e-11
    )


def test_the_bound_is_the_inverse_of_a_regular_information():
    J = fisher_information(STATE, RING, 0.4, 10, T, "constant_velocity")
    # The condition number, scaled, is 1e5; both sides lose as many of sixteen digits.
    identity = J @ crlb(STATE, RING, 0.4, 10, T, "constant_velocity")
    scale = np.sqrt(np.diag(J))
    np.testing.assert_allclose(identity * scale / scale[:, None], np.eye(6), atol=1e-9)


@pytest.mark.parametrize("sensors", [6, 7, 12, 100])
def test_a_ring_of_any_number_of_sensors_sees_five_directions(sensors):
    x = np.random.default_rng(52).normal(size=(50, 6))
    array = RadarArray.ring(sensors, 0.2, phase=0.1)
    J = fisher_information(x, array, 0.4)
    scale = 1 / np.sqrt(np.diagonal(J, axis1=1, axis2=2))
    eigenvalue = np.linalg.eigvalsh(J * scale[:, :, None] * scale[:, None, :])
    # Rounding of a matrix with ones on its diagonal, and the fifth eigenvalue far above it.
    assert (np.abs(eigenvalue[:, 0]) < 1e-14).all()
    assert (eigenvalue[:, 1] > 1e-9).all()
    _, regular = inverse_information(J)
    assert not regular.any()


def test_what_a_ring_does_not_see_is_the_direction_of_the_theorem():
    J = fisher_information(STATE, RING, 0.4)
    scale = np.sqrt(np.diag(J))
    _, V = np.linalg.eigh(J / scale / scale[:, None])
    direction = ring_family_direction(STATE, 0.2) * scale
    # Rounding over the gap to the second eigenvalue, some 1e-4.
    assert abs(V[:, 0] @ direction) == pytest.approx(np.linalg.norm(direction), rel=1e-9)


def test_a_ring_bounds_no_component_of_a_state_that_is_off_its_axis():
    P = crlb(STATE, RING, 0.4)
    assert np.isinf(np.diag(P)).all()
    assert np.isnan(P[~np.eye(6, dtype=bool)]).all()


ON_AXIS = [0.8, 0, 0, -0.75, 0.3, -0.2]


def test_on_the_axis_of_a_ring_the_direction_to_the_target_is_seen():
    # The family of equal shifts leaves y and z at zero.
    P = crlb(ON_AXIS, RING, 0.4)
    assert np.isinf(np.diag(P)).tolist() == [True, False, False, True, True, True]
    assert np.isfinite(P[1:3, 1:3]).all() and np.isnan(P[1, 0])


def test_a_component_that_is_seen_keeps_its_bound_whatever_is_known_of_the_others():
    J = fisher_information(ON_AXIS, RING, 0.4)
    for prior in (1.0, 1e3):  # on range alone it makes the information regular
        regular = np.linalg.inv(J + np.diag([prior, 0, 0, 0, 0, 0]))
        # The prior is some 1e-6 of the information, which costs as many of sixteen digits.
        np.testing.assert_allclose(
            crlb(ON_AXIS, RING, 0.4)[1:3, 1:3], regular[1:3, 1:3], rtol=1e-6, atol=1e-9
        )


def test_a_line_of_sensors_sees_four_directions_in_space_and_four_in_a_plane():
    J = fisher_information(STATE, RadarArray.linear(9, 0.4), 0.4)
    scale = 1 / np.sqrt(np.diag(J))
    assert np.linalg.matrix_rank(J * scale * scale[:, None], rtol=1e-12, hermitian=True) == 4
    x = [0.5, 0.2, 0, -1, 0.5, 0]
    P = crlb(x, LINE, 0.1, free=PLANE)
    assert (np.diag(P)[PLANE] > 0).all() and np.isfinite(P).all()
    assert (P[[2, 5]] == 0).all() and (P[:, [2, 5]] == 0).all()
    H = doppler_jacobian(x, LINE)[:, PLANE]
    # The plain formula for four unknowns; the condition number allows nine digits.
    np.testing.assert_allclose(P[np.ix_(PLANE, PLANE)], np.linalg.inv(H.T @ H / 0.01), rtol=1e-8)


def test_samples_of_a_constant_state_count_like_their_number():
    one, ten = (crlb(STATE, RADAR7, 0.4, K) for K in (1, 10))
    np.testing.assert_allclose(ten, one / 10, rtol=1e-7)


def test_motion_makes_a_ring_see_range():
    P = crlb(STATE, RING, 0.4, 10, T, "constant_velocity")
    assert np.isfinite(P).all() and (np.linalg.eigvalsh(P) > 0).all()


def test_the_bound_is_batched():
    x = np.random.default_rng(53).normal(size=(2, 3, 6))
    together = crlb(x, RADAR7, 0.4, 2, T, "constant_velocity")
    assert together.shape == (2, 3, 6, 6)
    np.testing.assert_array_equal(
        together[1, 2], crlb(x[1, 2], RADAR7, 0.4, 2, T, "constant_velocity")
    )


RADAR7 = RadarArray(np.vstack([RING.positions, [0.05, 0.02, 0.01]]))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x": [1, 2]}, r"x must have shape \(..., 6\)"),
        ({"x": np.r_[RING.positions[0], 1, 0, 0]}, "x must not lie on a sensor"),
        ({"array": RING.positions}, "array must be a RadarArray"),
        ({"sigma_f": 0.0}, "sigma_f must be positive"),
        ({"sigma_f": [1.0, 2.0]}, "sigma_f must have leading axes that broadcast"),
        ({"K": 0}, "K must be a whole number of at least 1"),
        ({"T": 0}, "T must be positive"),
        ({"likelihood": "both"}, "likelihood must be one of 'stationary', 'constant_velocity'"),
        ({"free": [1, 1, 0]}, "free must be an array of booleans"),
    ],
)
def test_a_wrong_argument_is_named(change, message):
    arguments = {
        "x": STATE,
        "array": RING,
        "sigma_f": 0.4,
        "K": 2,
        "T": T,
        "likelihood": "stationary",
    }
    with pytest.raises(ValueError, match=message):
        crlb(**arguments | change)
