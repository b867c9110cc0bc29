"""The filter of the document, its lag, and where its claims hold."""

import numpy as np
import pytest

from dopplerlib import steady_state_gain
from dopplerlib.model.kinematics import ncv_transition
from dopplerlib.systems import macaveiu2013 as paper
from dopplerlib.systems.macaveiu2013 import lag, regions, tracking

PATHS = paper.paths()
S = paper.settings()
A = 10 * paper.KMH / 19  # m/s^2, of Fig 10


def test_the_fast_filter_is_the_library_filter():
    path = PATHS[10]
    for s in (S, S.with_(sigma_p=2.0, w=0.1)):
        slow = tracking.track(path, 3, rng=np.random.default_rng(4), s=s)
        z = tracking.measure(path.truth, 3, rng=np.random.default_rng(4), s=s)
        np.testing.assert_allclose(tracking.filtered(z, s), slow.x, rtol=1e-10, atol=1e-10)


def test_errors_of_several_paths_are_those_of_each():
    together = tracking.errors([PATHS[7], PATHS[11]], 3, rng=np.random.default_rng(5))
    for one, child, path in zip(
        together, np.random.default_rng(5).spawn(2), (PATHS[7], PATHS[11]), strict=True
    ):
        alone = tracking.track(path, 3, rng=child)
        np.testing.assert_allclose(one, alone.error, atol=1e-10)


def test_the_gains_settle_where_the_riccati_equation_says():
    K, _ = steady_state_gain(ncv_transition(S.T, 1), S.E_x[:2, :2], np.eye(2), S.E_z[:2, :2])
    # Errors of the gain die out as 0.98^(2 k): after 500 samples 1e-9 is left of them.
    np.testing.assert_allclose(tracking.gain_sequence()[-1], K, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("w", [0.005, 0.01, 0.05])
def test_lag_in_figure_10_is_the_predicted_one(w):
    """Mean error of 400 runs at the end, and none without noise. False-alarm probability 4e-7: two
    means within 5.2 of their deviations."""
    s = S.with_(w=w)
    predicted = lag.lag(A, s)
    still = PATHS[10].truth[-1] - tracking.filtered(PATHS[10].truth, s)[-1]
    # w = 0.005: the transient dies out as 0.986^k, to 1e-3 of the lag at the end.
    np.testing.assert_allclose(still[:2], predicted, rtol=4e-3)
    error = -tracking.errors([PATHS[10]], 400, rng=np.random.default_rng(6), s=s)[0, :, -1, :2]
    deviation = error.std(axis=0, ddof=1) / 20
    assert (np.abs(error.mean(axis=0) - still[:2]) < 5.2 * deviation).all()


def test_noise_that_is_left_is_the_predicted_one():
    """Deviation of 800 axes at the end: off by 5 of its deviations, 2.5 %, with 6e-7 each."""
    error = tracking.errors([PATHS[7]], 400, rng=np.random.default_rng(7))[0, :, -1]
    for part, predicted in zip(
        (slice(0, 4, 2), slice(1, 4, 2)), lag.noise_deviation(), strict=True
    ):
        found = np.sqrt(np.mean(error[:, part] ** 2))
        assert found == pytest.approx(predicted, rel=5 / np.sqrt(2 * 800))


def test_best_w_is_better_than_its_neighbors():
    best = lag.best_w(A)
    errors = [lag.rms(A, S.with_(w=best * factor))[1] for factor in (0.8, 1.0, 1.25)]
    assert errors[1] < min(errors[0], errors[2])
    assert 0.01 < best < 0.1


def test_a_sinusoidal_velocity_comes_out_as_the_response_says():
    rate = 2 * np.pi / 19
    found = tracking.filtered(PATHS[11].truth)[:, 3]
    r = lag.response(rate)
    expected = 1.5 * paper.KMH * np.abs(r) * np.sin(rate * S.time + np.angle(r))
    # The start dies out as 0.98^k: 1 % of it is left after 230 samples.
    np.testing.assert_allclose(found[300:], expected[300:], atol=0.003)


def test_nis_hardly_notices_what_nees_cries_out_about():
    """The lag in Fig 10: 200 runs; a NIS of 4.24 and a NEES of 15, where both should be 4.

    Means over a record and 200 runs have deviations of 0.01 and 0.1: the bounds are 20 away.
    """
    runs = tracking.track(PATHS[10], 200, rng=np.random.default_rng(8))
    assert runs.nis[:, S.skip :].mean() < 4.5
    assert runs.nees[:, S.skip :].mean() > 10
    # On a straight path the filter doubts too much: the target does not wander as E_x says.
    straight = tracking.track(PATHS[7], 200, rng=np.random.default_rng(9))
    assert straight.nees[:, S.skip :].mean() < 3


def test_a_first_sample_alone_is_off_by_more_than_a_meter_in_one_run_of_seven():
    """exp(-1 / (2 sigma_p^2)) = 13.5 %. 2000 runs: five deviations are 3.8 %; chance 6e-7."""
    z = tracking.measure(PATHS[7].truth[:1], 2000, rng=np.random.default_rng(10))
    off = np.hypot(z[:, 0, 0], z[:, 0, 2] - PATHS[7].truth[0, 2]) > 1
    assert off.mean() == pytest.approx(np.exp(-1 / (2 * S.sigma_p**2)), abs=0.038)


def test_small_position_noise_meets_the_claims_and_large_does_not():
    rng = np.random.default_rng(11)
    kept = regions.claim_map(("sigma_p", (0.25, 3.0)), ("w", (0.01,)), 100, rng=rng)["all three"]
    assert kept[0, 0] > 0.95 and kept[1, 0] < 0.05
    with pytest.raises(ValueError, match="must be one of 'sigma_p', 'sigma_v', 'w', got 'T'"):
        regions.claim_map(("T", (1.0,)), ("w", (0.01,)), 1, rng=rng)


def test_scores_read_the_right_rows():
    scores = regions.Scores(
        (7, 8, 9, 10, 11),
        settled=np.array([[0.4], [0.9], [0.9], [0.9], [0.9]]),
        whole=np.array([[0.4], [0.9], [0.9], [0.9], [1.1]]),
        speed=np.array([[[1, 1]], [[2, 1]], [[1, 3]], [[2.5, 0]], [[0, 2.5]]]),
        resolution=1.0,
    )
    assert scores.small_in_figure_7() and scores.below_resolution()
    assert not scores.below_resolution(scores.whole)
    assert not scores.speed_worse_when_it_varies()  # v_y of Fig 9 is worse than that of Fig 11


def test_the_noise_of_the_document_depends_on_the_sampling_interval():
    """Halving T and keeping w doubles what the velocity wanders in a second."""
    half = S.with_(T=S.T / 2)
    slow = lag.lag(A, S)[1]
    assert lag.lag(A, half)[1] < 0.85 * slow
