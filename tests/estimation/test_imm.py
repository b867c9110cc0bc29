"""The interacting multiple model estimator, against Bayes' rule where it is exact."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from dopplerlib import kf
from dopplerlib.estimation.imm import imm
from dopplerlib.model.motion import cwna_process_noise, ncv_transition

T, K = 0.5, 8
F1 = ncv_transition(T, dim=1)
Q1, Q2 = cwna_process_noise(T, 0.01, dim=1), cwna_process_noise(T, 4.0, dim=1)
F, Q = np.stack([F1, F1]), np.stack([Q1, Q2])
H, R = np.array([[1.0, 0.0]]), np.array([[0.3]])
x0, P0 = np.array([0.0, 1.0]), np.diag([1.0, 0.5])
SWITCH = np.array([[0.9, 0.1], [0.2, 0.8]])
Z = np.random.default_rng(8).normal(scale=2, size=(3, K, 1))


def test_with_one_model_or_two_alike_it_is_the_kalman_filter():
    alone = kf(Z, F1, Q1, H, R, x0, P0)
    for M, transition in ((1, [[1.0]]), (2, SWITCH)):
        track = imm(Z, F[[0] * M], Q[[0] * M], H, R, transition, x0, P0)
        np.testing.assert_allclose(track.x, alone.x, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(track.P, alone.P, rtol=1e-10, atol=1e-12)


def test_models_that_never_switch_are_weighed_by_the_likelihood_of_the_whole_record():
    prior = np.array([0.3, 0.7])
    track = imm(Z, F, Q, H, R, np.eye(2), x0, P0, prior)
    weight = np.empty((3, 2))
    means = np.empty((3, 2, 2))
    for i, noise in enumerate((Q1, Q2)):
        alone = kf(Z, F1, noise, H, R, x0, P0)
        means[:, i] = alone.x[:, -1]
        for run in range(3):
            log = sum(
                multivariate_normal(cov=S).logpdf(nu)
                for nu, S in zip(alone.innovation[run], alone.S[run], strict=True)
            )
            weight[run, i] = prior[i] * np.exp(log)
    weight /= weight.sum(axis=1, keepdims=True)
    np.testing.assert_allclose(track.mode[:, -1], weight, rtol=1e-9)
    np.testing.assert_allclose(
        track.x[:, -1], np.sum(weight[..., None] * means, axis=1), rtol=1e-9, atol=1e-10
    )


def test_the_first_step_is_the_exact_mixture():
    """All models start from one Gaussian, so that mixing loses nothing yet."""
    track = imm(Z, F, Q, H, R, SWITCH, x0, P0, [0.3, 0.7])
    prior = np.array([0.3, 0.7]) @ SWITCH
    for run in range(3):
        weight, mean, second = [], [], []
        for p, noise in zip(prior, (Q1, Q2), strict=True):
            predicted = F1 @ P0 @ F1.T + noise
            S = H @ predicted @ H.T + R
            weight.append(p * multivariate_normal(H @ F1 @ x0, S).pdf(Z[run, 0]))
            one = kf(Z[run, :1], F1, noise, H, R, x0, P0)
            mean.append(one.x[0])
            second.append(one.P[0] + np.outer(one.x[0], one.x[0]))
        weight = np.array(weight) / sum(weight)
        expected = np.tensordot(weight, mean, 1)
        np.testing.assert_allclose(track.mode[run, 0], weight, rtol=1e-10)
        np.testing.assert_allclose(track.x[run, 0], expected, rtol=1e-10, atol=1e-12)
        covariance = np.tensordot(weight, second, 1) - np.outer(expected, expected)
        np.testing.assert_allclose(track.P[run, 0], covariance, rtol=1e-9, atol=1e-12)


def test_where_nothing_is_measured_only_the_models_switch():
    holes = Z.copy()
    holes[:, 2:5] = np.nan
    track = imm(holes, F, Q, H, R, SWITCH, x0, P0)
    for k in (2, 3, 4):
        np.testing.assert_allclose(track.mode[:, k], track.mode[:, k - 1] @ SWITCH, rtol=1e-12)


def test_gaps_and_uneven_times_are_those_of_the_kalman_filter():
    steps = np.array([0.5, 1.5, 0.2, 0.5, 0.5, 3.0, 0.5, 0.5])
    moves = np.stack([ncv_transition(T, dim=1) for T in steps])
    noises = np.stack([cwna_process_noise(T, 0.3, dim=1) for T in steps])
    two, noise = np.array([[1.0, 0.0], [0.3, 1.0]]), np.diag([0.3, 0.5])
    z = np.random.default_rng(18).standard_normal((3, K, 2))
    z[0, 1, 0] = z[:, 3, 1] = z[1, 5] = np.nan
    alone = kf(z, moves, noises, two, noise, x0, P0)
    for M, transition in ((1, [[1.0]]), (2, SWITCH)):
        models = [np.repeat(value[:, None], M, axis=1) for value in (moves, noises)]
        track = imm(z, *models, two, noise, transition, x0, P0)
        np.testing.assert_allclose(track.x, alone.x, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(track.P, alone.P, rtol=1e-10, atol=1e-12)


def test_a_component_that_is_missing_speaks_for_no_model():
    """The likelihood of what is there, as in the first step of the exact mixture."""
    two, noise = np.array([[1.0, 0.0], [0.3, 1.0]]), np.array([[0.3, 0.1], [0.1, 0.5]])
    track = imm([[0.4, np.nan]], F, Q, two, noise, SWITCH, x0, P0, [0.3, 0.7])
    few = imm([[0.4]], F, Q, two[:1], noise[:1, :1], SWITCH, x0, P0, [0.3, 0.7])
    np.testing.assert_allclose(track.mode, few.mode, rtol=1e-12)
    np.testing.assert_allclose(track.x, few.x, rtol=1e-12)


def test_a_model_that_cannot_be_reached_changes_nothing():
    track = imm(Z, F, Q, H, R, [[1.0, 0.0], [1.0, 0.0]], x0, P0)
    alone = kf(Z, F1, Q1, H, R, x0, P0)
    assert (track.mode[..., 1] == 0).all()
    np.testing.assert_allclose(track.x, alone.x, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(track.P, alone.P, rtol=1e-10, atol=1e-12)


@pytest.mark.filterwarnings("error")
def test_not_even_if_it_alone_could_explain_the_data():
    """Densities of a jump of 1e4: exp(-2.5e7) in the one that is possible, about 1e-5 in the other.

    By hand: S = 1 + 1, the gain is one half.
    """
    one = np.ones((1, 1))
    track = imm([[1e4]], [one] * 2, [0 * one, 1e8 * one], one, one, np.eye(2), [0], one, [1, 0])
    assert track.mode.tolist() == [[1.0, 0.0]]
    assert (track.x.item(), track.P.item()) == (5e3, 0.5)


@pytest.mark.filterwarnings("error")
def test_not_even_if_its_state_would_grow_beyond_all_bounds():
    """What it does not measure it multiplies by 10, 400 times: more than a float can hold."""
    wild = np.stack([np.eye(2), np.diag([1.0, 10.0])])
    z = np.random.default_rng(9).normal(size=(400, 1))
    track = imm(z, wild, Q, H, R, [[1.0, 0.0], [1.0, 0.0]], x0, P0)
    alone = kf(z, np.eye(2), Q1, H, R, x0, P0)
    np.testing.assert_allclose(track.x, alone.x, rtol=1e-10, atol=1e-12)


@pytest.mark.filterwarnings("error")
def test_a_model_that_seemed_impossible_comes_back_when_the_whole_record_speaks_for_it():
    """Models that never switch; 400 calm samples leave the second exp(-922), no float.

    A jump follows. The reference is the likelihood of the whole record, from one filter each.
    """
    z = np.r_[np.zeros(400), np.full(4, 50.0)][:, None]
    one = np.ones((1, 1))
    noises = [0 * one, 100 * one]
    track = imm(z, [one] * 2, noises, one, one, np.eye(2), [0.0], one)
    alone = [kf(z, one, noise, one, one, [0.0], one) for noise in noises]
    log = np.stack([-(a.nis + np.log(a.S[..., 0, 0])) / 2 for a in alone], axis=-1).cumsum(axis=0)
    assert log[399, 1] - log[399, 0] < -800 and log[-1, 1] > log[-1, 0] + 100
    np.testing.assert_allclose(
        track.mode, np.exp(log - np.logaddexp.reduce(log, axis=-1)[:, None]), rtol=1e-9
    )
    np.testing.assert_allclose(track.x[-1], alone[1].x[-1], rtol=1e-12)


def test_a_model_far_from_the_data_does_not_break_it():
    """Its likelihood is below the smallest float; the other's is not much above."""
    far = Z + 1e3
    track = imm(far, F, Q, H, R, SWITCH, x0, P0)
    assert np.isfinite(track.x).all() and np.isfinite(track.P).all()
    np.testing.assert_allclose(track.mode.sum(axis=-1), 1)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("transition", np.ones((2, 2))),
        ("transition", np.eye(3)),
        ("mode0", [0.5, 0.6]),
        ("mode0", [1.5, -0.5]),
        ("z", np.empty((3, 0, 1))),
        ("F", np.eye(2)),
        ("F", np.empty((0, 2, 2))),
        ("F", np.ones((2, 2, 3))),
        ("Q", np.stack([Q1] * 3)),
        ("R", np.zeros((1, 1))),
    ],
)
def test_bad_input_is_named(name, value):
    arguments = {"z": Z, "F": F, "Q": Q, "H": H, "R": R, "transition": SWITCH, "x0": x0, "P0": P0}
    with pytest.raises(ValueError, match=rf"^{name} must "):
        imm(**(arguments | {name: value}))
