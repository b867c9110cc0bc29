"""The pseudo-measurement of a radial velocity: corrected terms are right, published ones wrong."""

import numpy as np
import pytest

from dopplerlib import kf_update
from dopplerlib.estimation.radial_velocity import radial_velocity_terms, radial_velocity_update
from dopplerlib.model.range_rate import range_rate, range_rate_jacobian

X = np.array([1.5, 2.0, 0.3, -0.2])
A = np.random.default_rng(6).normal(size=(4, 4))
P = 0.01 * A @ A.T
ORIGIN = np.zeros((1, 2))


def test_its_matrix_is_the_jacobian_of_the_range_rate():
    terms = radial_velocity_terms(X, P, 0.1)
    np.testing.assert_allclose(terms.H[0], range_rate_jacobian(X, ORIGIN)[0, 1], rtol=1e-12)


def test_with_the_printed_square_root_it_would_not_be():
    """Eqs 3.20 and 3.21 multiply by the distance, here 2.5 m, where they should divide."""
    Y = X[:2]
    published = np.sqrt(Y @ Y) * Y
    u = Y / np.linalg.norm(Y)
    assert np.linalg.norm(published) == pytest.approx(np.linalg.norm(Y) ** 2)
    np.testing.assert_allclose(radial_velocity_terms(X, P, 0.1).H[0, 2:], u, rtol=1e-12)


def test_what_the_code_subtracts_is_h_because_the_direction_has_no_part_across_itself():
    """H x = u.v: the first half of H is orthogonal to the position."""
    terms = radial_velocity_terms(X, P, 0.1)
    assert (terms.H @ X)[0] == pytest.approx(range_rate(X, ORIGIN)[0, 1], rel=1e-12)
    assert terms.predicted[0] == pytest.approx(
        range_rate(X, ORIGIN)[0, 1] + np.trace(terms.C), rel=1e-12
    )


def test_the_corrected_moments_are_those_of_the_quadratic_form():
    """200 000 draws of e'Be. Its mean and variance are within 5 of their own deviations.

    The deviation of the variance is taken from the draws; by chance it fails at 1e-6.
    """
    terms = radial_velocity_terms(X, P, 0.1)
    u = X[:2] / np.hypot(*X[:2])
    B = np.zeros((4, 4))
    B[:2, 2:] = B[2:, :2] = (np.eye(2) - np.outer(u, u)) / np.hypot(*X[:2]) / 2
    np.testing.assert_allclose(terms.C, B @ P)
    e = np.random.default_rng(7).multivariate_normal(np.zeros(4), P, 200_000)
    form = np.einsum("ri,ij,rj->r", e, B, e)
    trace, extra = np.trace(terms.C), terms.R[0, 0] - 0.01
    assert abs(form.mean() - trace) < 5 * form.std() / np.sqrt(len(form))
    squares = (form - trace) ** 2
    assert abs(squares.mean() - extra) < 5 * squares.std() / np.sqrt(len(form))
    published = radial_velocity_terms(X, P, 0.1, variance="published").R[0, 0] - 0.01
    assert abs(squares.mean() - published) > 20 * squares.std() / np.sqrt(len(form))


def test_on_a_line_it_is_a_linear_update_of_the_velocity():
    P2 = np.array([[0.3, 0.1], [0.1, 0.2]])
    got = radial_velocity_update([2.0, 0.1], P2, 0.15, 0.1)
    expected = kf_update([2.0, 0.1], P2, [0.15], [[0.0, 1.0]], [[0.01]])
    for one, other in zip(got, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-15)


def test_behind_the_radar_on_a_line_the_sign_turns():
    """H = sign(d): a range that the filter believes negative would flip the Doppler."""
    assert radial_velocity_terms([-2.0, 0.1], np.eye(2), 0.1).H.tolist() == [[0.0, -1.0]]


def test_it_moves_the_estimate_towards_the_truth_in_the_plane():
    x, Pu, innovation, _ = radial_velocity_update(X, P, range_rate(X, ORIGIN)[0, 1] + 0.1, 0.01)
    assert range_rate(x, ORIGIN)[0, 1] > range_rate(X, ORIGIN)[0, 1]
    assert np.linalg.eigvalsh(P - Pu).min() > -1e-12
    assert innovation[0] == pytest.approx(0.1 - np.trace(radial_velocity_terms(X, P, 0.01).C))


def test_many_states_or_covariances_or_measurements_are_each_done_alone():
    """Also where only one of the arguments has a leading axis."""
    rng = np.random.default_rng(8)
    x, z = X + 0.1 * rng.normal(size=(5, 4)), rng.normal(size=5)
    covariances, sigma = P * rng.uniform(1, 2, (5, 1, 1)), rng.uniform(0.1, 0.2, 5)
    cases = [(x, P, 0.1, 0.1), (X, covariances, 0.1, 0.1), (X, P, z, 0.1), (X, P, 0.1, sigma)]
    for case in [*cases, (x, covariances, z, sigma)]:
        got = radial_velocity_update(*case)
        for run in range(5):
            own = (1, 2, 0, 0)  # axes of one of each
            one = [a[run] if np.ndim(a) > n else a for a, n in zip(case, own, strict=True)]
            for many, alone in zip(got, radial_velocity_update(*one), strict=True):
                many = np.broadcast_to(many, (5, *alone.shape))
                np.testing.assert_allclose(many[run], alone, rtol=1e-12, atol=1e-15)


def test_leading_axes_that_do_not_fit_are_named():
    x = np.stack([X] * 3)
    with pytest.raises(ValueError, match=r"^x, P, sigma must .* \(3,\) of x, .* \(2,\) of sigma"):
        radial_velocity_terms(x, P, [0.1, 0.2])
    with pytest.raises(ValueError, match=r"^x, P, z, sigma must .* \(2,\) of z"):
        radial_velocity_update(x, P, [0.1, 0.2], 0.1)


@pytest.mark.parametrize(
    ("x", "message"),
    [([0.0, 1.0], r"x must have a position .* got \[0.0\]"), ([1.0, 1.0, 1.0], "x must hold pos")],
)
def test_a_state_without_a_direction_is_refused(x, message):
    with pytest.raises(ValueError, match=message):
        radial_velocity_terms(x, np.eye(len(x)), 0.1)


def test_where_no_velocity_is_measured_the_state_stays():
    z = np.array([0.1, np.nan])
    x, Pu, innovation, S = radial_velocity_update(X, P, z, 0.1)
    np.testing.assert_array_equal(x[1], X)
    np.testing.assert_array_equal(Pu[1], P)
    assert np.isnan(innovation[1, 0]) and np.isfinite(S).all()
    alone = radial_velocity_update(X, P, 0.1, 0.1)
    np.testing.assert_allclose(x[0], alone[0], rtol=1e-12)
