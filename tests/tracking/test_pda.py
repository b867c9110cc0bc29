"""Probabilistic data association is the mixture over all associations, matched by one Gaussian."""

import numpy as np
import pytest
from scipy.stats import chi2, multivariate_normal

from dopplerlib import kf_update
from dopplerlib.tracking.pda import pda_update
from tests.gate_edges import beside_the_gate

H = np.array([[1.0, 0.0], [0.3, 1.0]])
R = np.array([[0.5, 0.1], [0.1, 0.3]])
P = np.array([[1.0, 0.2], [0.2, 0.6]])
X = np.array([0.4, -0.1])


def enumerated(z, detection, density, gate):
    """Return mean and covariance of the mixture, from one Kalman update per association."""
    S = H @ P @ H.T + R
    means, covariances, weights = [X], [P], [1 - detection * gate]
    for one in z:
        nu = one - H @ X
        if nu @ np.linalg.solve(S, nu) > chi2.ppf(gate, 2):
            continue
        x, Pu, _, _ = kf_update(X, P, one, H, R)
        means.append(x)
        covariances.append(Pu)
        weights.append(detection * multivariate_normal(H @ X, S).pdf(one) / density)
    w = np.array(weights) / np.sum(weights)
    mean = w @ np.array(means)
    away = np.array(means) - mean
    spread = np.array(covariances) + away[:, :, None] * away[:, None, :]
    return mean, np.einsum("i,ijk->jk", w, spread), w


@pytest.mark.parametrize("gate", [0.9, 0.999])
def test_it_has_the_moments_of_the_enumerated_mixture(gate):
    z = np.array([[0.5, 0.2], [1.5, -0.4], [0.1, 0.1], [8.0, 8.0]])
    step = pda_update(X, P, z, H, R, detection=0.8, density=0.2, gate=gate)
    mean, covariance, weight = enumerated(z, 0.8, 0.2, gate)
    np.testing.assert_allclose(step.x, mean, rtol=1e-12)
    np.testing.assert_allclose(step.P, covariance, rtol=1e-12)
    assert step.missed == pytest.approx(weight[0])
    np.testing.assert_allclose(step.weight[step.weight > 0], weight[1:], rtol=1e-12)
    assert step.weight[3] == 0  # outside the gate


@pytest.mark.parametrize("m", [1, 2])
@pytest.mark.parametrize("gate", [0.9, 0.999])
def test_the_gate_ends_at_the_quantile_for_the_components_of_a_detection(m, gate):
    """Two states, one or two components: it is theirs that count."""
    for nu, inside in beside_the_gate(H[:m] @ P @ H[:m].T + R[:m, :m], gate):
        step = pda_update(
            X, P, [H[:m] @ X + nu], H[:m], R[:m, :m], detection=0.9, density=0.1, gate=gate
        )
        assert (step.weight[0] > 0) == inside


def test_a_lone_detection_without_false_ones_is_a_kalman_update():
    """The chance that it is false is 1e-9 or so, and so is the difference."""
    z = np.array([[0.5, 0.2]])
    step = pda_update(X, P, z, H, R, detection=0.99, density=1e-9)
    x, Pu, _, _ = kf_update(X, P, z[0], H, R)
    np.testing.assert_allclose(step.x, x, atol=1e-8)
    np.testing.assert_allclose(step.P, Pu, atol=1e-7)


def test_without_a_detection_the_state_stays_predicted():
    z = np.array([[np.nan, np.nan], [0.5, np.nan]])
    step = pda_update(X, P, z, H, R, detection=0.9, density=0.1)
    np.testing.assert_array_equal(step.x, X)
    np.testing.assert_allclose(step.P, P)
    assert step.missed == 1


def test_many_runs_are_each_done_alone():
    rng = np.random.default_rng(4)
    x, z = rng.normal(size=(6, 2)), rng.normal(size=(6, 3, 2))
    together = pda_update(x, P, z, H, R, detection=0.9, density=0.1)
    for i in range(6):
        alone = pda_update(x[i], P, z[i], H, R, detection=0.9, density=0.1)
        np.testing.assert_allclose(together.x[i], alone.x, rtol=1e-12)
        np.testing.assert_allclose(together.P[i], alone.P, rtol=1e-12)


def test_a_detection_however_far_outside_the_gate_changes_nothing_but_an_infinite_one_is_refused():
    near = np.array([0.5, 0.2])
    alone = pda_update(X, P, near[None], H, R, detection=0.9, density=0.1)
    both = pda_update(X, P, [near, [1e100, -1e100]], H, R, detection=0.9, density=0.1)
    np.testing.assert_allclose(both.x, alone.x, rtol=1e-12)
    np.testing.assert_allclose(both.P, alone.P, rtol=1e-12)
    with pytest.raises(ValueError, match=r"^z must be finite, or NaN where it is missing"):
        pda_update(X, P, [near, [np.inf, 0.0]], H, R, detection=0.9, density=0.1)


def test_leading_axes_that_do_not_fit_are_named():
    with pytest.raises(ValueError, match=r"^x, P, z, H, R must .* \(3,\) of x, .* \(4,\) of z"):
        pda_update(np.zeros((3, 2)), P, np.zeros((4, 5, 2)), H, R, detection=0.9, density=0.1)


def test_what_is_no_probability_is_refused():
    with pytest.raises(ValueError, match="detection must lie between 0 and 1"):
        pda_update(X, P, np.zeros((1, 2)), H, R, detection=1.0, density=0.1)
    with pytest.raises(ValueError, match="density must be positive"):
        pda_update(X, P, np.zeros((1, 2)), H, R, detection=0.9, density=0.0)
