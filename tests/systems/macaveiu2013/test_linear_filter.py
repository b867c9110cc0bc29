"""The filter of the document, its lag, and where its claims hold."""

from dataclasses import replace

import numpy as np
import pytest

from dopplerlib import steady_state_gain
from dopplerlib.model.motion import ncv_transition
from dopplerlib.systems import macaveiu2013 as paper

PATHS = paper.vehicle_paths()
S = paper.automotive_settings()
A = 10 * paper.KMH / 19  # m/s^2, of Fig 10


def test_the_fast_filter_is_the_library_filter():
    path = PATHS[10]
    for s in (S, S.with_(sigma_x=2.0, w=0.1)):
        slow = paper.track_vehicle(path, 3, rng=np.random.default_rng(4), s=s)
        z = paper.measure_vehicle(path.truth, 3, rng=np.random.default_rng(4), s=s)
        np.testing.assert_allclose(paper.filter_vehicle(z, s), slow.x, rtol=1e-10, atol=1e-10)


def test_errors_of_several_paths_are_those_of_each():
    together = paper.tracking_errors([PATHS[7], PATHS[11]], 3, rng=np.random.default_rng(5))
    for one, child, path in zip(
        together, np.random.default_rng(5).spawn(2), (PATHS[7], PATHS[11]), strict=True
    ):
        alone = paper.track_vehicle(path, 3, rng=child)
        np.testing.assert_allclose(one, alone.error, atol=1e-10)


def test_the_gains_settle_where_the_riccati_equation_says():
    K, _ = steady_state_gain(ncv_transition(S.T, 1), S.E_x[:2, :2], np.eye(2), S.E_z[:2, :2])
    # Errors of the gain die out as 0.98^(2 k): after 500 samples 1e-9 is left of them.
    np.testing.assert_allclose(paper.gain_sequence()[-1], K, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("w", [0.005, 0.01, 0.05])
def test_lag_in_figure_10_is_the_predicted_one(w):
    """Mean error of 400 runs at the end, and none without noise. False-alarm probability 4e-7: two
    means within 5.2 of their deviations."""
    s = S.with_(w=w)
    predicted = paper.acceleration_lag(A, s)
    still = PATHS[10].truth[-1] - paper.filter_vehicle(PATHS[10].truth, s)[-1]
    # w = 0.005: the transient dies out as 0.986^k, to 1e-3 of the lag at the end.
    np.testing.assert_allclose(still[:2], predicted, rtol=4e-3)
    error = -paper.tracking_errors([PATHS[10]], 400, rng=np.random.default_rng(6), s=s)[
        0, :, -1, :2
    ]
    deviation = error.std(axis=0, ddof=1) / 20
    assert (np.abs(error.mean(axis=0) - still[:2]) < 5.2 * deviation).all()


def test_noise_that_is_left_is_the_predicted_one():
    """Deviation of 800 axes at the end: off by 5 of its deviations, 2.5 %, with 6e-7 each."""
    error = paper.tracking_errors([PATHS[7]], 400, rng=np.random.default_rng(7))[0, :, -1]
    for part, predicted in zip(
        (slice(0, 4, 2), slice(1, 4, 2)), paper.settled_noise_std(), strict=True
    ):
        found = np.sqrt(np.mean(error[:, part] ** 2))
        assert found == pytest.approx(predicted, rel=5 / np.sqrt(2 * 800))


def test_the_error_behind_an_acceleration_is_the_predicted_one():
    """Rms of 400 runs at the end of Fig 10: off by 5 of its deviations with a chance of 6e-7."""
    error = paper.tracking_errors([PATHS[10]], 400, rng=np.random.default_rng(21))[0, :, -1, :2]
    for square, predicted in zip((error**2).T, paper.settled_rms(A), strict=True):
        assert square.mean() == pytest.approx(predicted**2, abs=5 * square.std() / 20)


def test_best_w_is_better_than_its_neighbors():
    best = paper.best_w(A)
    errors = [paper.settled_rms(A, S.with_(w=best * factor))[1] for factor in (0.8, 1.0, 1.25)]
    assert errors[1] < min(errors[0], errors[2])
    assert 0.01 < best < 0.1


def test_a_sinusoidal_velocity_comes_out_as_the_response_says():
    rate = 2 * np.pi / 19
    found = paper.filter_vehicle(PATHS[11].truth)[:, 3]
    r = paper.velocity_response(rate)
    expected = 1.5 * paper.KMH * np.abs(r) * np.sin(rate * S.time + np.angle(r))
    # The start dies out as 0.98^k: 1 % of it is left after 230 samples.
    np.testing.assert_allclose(found[300:], expected[300:], atol=0.003)


def test_nis_hardly_notices_what_nees_cries_out_about():
    """The lag in Fig 10: 200 runs; a NIS of 4.24 and a NEES of 15, where both should be 4.

    Means over a record and 200 runs have deviations of 0.01 and 0.1: the bounds are 20 away.
    """
    runs = paper.track_vehicle(PATHS[10], 200, rng=np.random.default_rng(8))
    assert runs.nis[:, S.skip :].mean() < 4.5
    assert runs.nees[:, S.skip :].mean() > 10
    # On a straight path the filter doubts too much: the target does not wander as E_x says.
    straight = paper.track_vehicle(PATHS[7], 200, rng=np.random.default_rng(9))
    assert straight.nees[:, S.skip :].mean() < 3


def test_a_first_sample_alone_is_off_by_more_than_a_meter_in_one_run_of_seven():
    """exp(-1 / (2 sigma_x^2)) = 13.5 %. 2000 runs: five deviations are 3.8 %; chance 6e-7."""
    z = paper.measure_vehicle(PATHS[7].truth[:1], 2000, rng=np.random.default_rng(10))
    off = np.hypot(z[:, 0, 0], z[:, 0, 2] - PATHS[7].truth[0, 2]) > 1
    assert off.mean() == pytest.approx(np.exp(-1 / (2 * S.sigma_x**2)), abs=0.038)


def test_small_position_noise_meets_the_claims_and_large_does_not():
    """The intervals of 100 runs lie beyond 90 and 10 %: shares are 100 and 0 %, but for chance."""
    rng = np.random.default_rng(11)
    kept = paper.claim_map(("sigma_x", (0.25, 3.0)), ("w", (0.01,)), 100, rng=rng)
    for name in paper.CLAIMS[:2] + paper.CLAIMS[3:]:
        share, low, high = kept[name][..., 0]
        assert low[0] > 0.9 and high[1] < 0.1, name
        assert low[0] < share[0] <= high[0]
        assert paper.decided_claims(kept[name])[:, 0].tolist() == [1, -1]
    with pytest.raises(ValueError, match="must be one of 'sigma_x', 'sigma_v', 'w', got 'T'"):
        paper.claim_map(("T", (1.0,)), ("w", (0.01,)), 1, rng=rng)


@pytest.mark.parametrize("s", [S, S.with_(sigma_x=2.0, sigma_v=0.3, w=0.1)])
def test_scores_are_those_of_the_errors_of_the_filter(s):
    """The map follows errors, pushed by what the truth does beside the model, not estimates."""
    scores = paper.score_paths(5, rng=np.random.default_rng(13), s=s)
    error = paper.tracking_errors(list(PATHS.values()), 5, rng=np.random.default_rng(13), s=s)
    distance = np.hypot(error[..., 0], error[..., 2])
    np.testing.assert_allclose(scores.whole, distance.max(axis=-1), rtol=1e-9)
    np.testing.assert_allclose(scores.settled, distance[..., s.skip :].max(axis=-1), rtol=1e-9)
    speed = np.sqrt(np.mean(error[:, :, s.skip :, 1::2] ** 2, axis=2))
    np.testing.assert_allclose(scores.speed, speed, rtol=1e-9)


def test_places_of_a_map_differ_by_their_settings_alone():
    """A place comes out the same whatever stands beside it, and as if it were scored alone."""
    rows, columns = ("sigma_x", (0.5, 1.5)), ("w", (0.01, 0.05))
    whole = paper.claim_map(rows, columns, 20, rng=np.random.default_rng(14))
    one = paper.claim_map(("sigma_x", (1.5,)), ("w", (0.05,)), 20, rng=np.random.default_rng(14))
    alone = paper.score_paths(20, rng=np.random.default_rng(14), s=S.with_(sigma_x=1.5, w=0.05))
    for name, true in alone.by_claim().items():
        np.testing.assert_array_equal(whole[name][:, 1, 1], one[name][:, 0, 0])
        assert one[name][0, 0, 0] == true.mean()


def test_a_bound_lies_between_the_decided_places_beside_it():
    shares = np.array([[1.0, 0.95, 0.9, 0.5], [0.98, 0.91, 0.85, 0.4], [1.0, 0.98, 0.94, 0.6]])
    assert paper.decided_claims(shares).tolist() == [1, 1, 0, -1]
    assert paper.claim_borders((1.0, 2.0, 3.0, 4.0), shares) == [(2.0, 4.0, False)]
    assert paper.claim_borders((1.0, 2.0, 3.0, 4.0), shares[:, ::-1]) == [(1.0, 3.0, True)]
    assert paper.claim_borders((1.0, 2.0), shares[:, :2]) == []


def test_a_bound_of_the_noise_is_where_the_largest_error_reaches_the_limit():
    """Without model errors (Fig 7) everything grows with the noise: twice the resolution, twice
    the bound. The scaled filter has the same gain."""
    values = np.geomspace(0.4, 1.6, 6)
    found = []
    for factor in (1, 2):
        s = S.with_(sigma_v=factor * S.sigma_v, w=factor * S.w, range_resolution=float(factor))
        rng = np.random.default_rng(15)
        found.append(paper.claim_borders_along("sigma_x", factor * values, 50, rng=rng, s=s))
    ((low, high, holds),) = found[0]["1  away: error far below 1 m"]
    assert low < high and not holds
    ((twice_low, twice_high, _),) = found[1]["1  away: error far below 1 m"]
    assert (twice_low, twice_high) == pytest.approx((2 * low, 2 * high))


@pytest.mark.parametrize(("w", "true"), [(S.w, True), (0.1, False)])
def test_speed_errors_stand_out_where_the_speed_varies_if_the_filter_is_calm(w, true):
    """200 runs: all of them for our w; 13 % for one ten times as large, with a deviation of 2.4 %:
    the bound is 11 of them away."""
    scores = paper.score_paths(200, rng=np.random.default_rng(16), s=S.with_(w=w))
    share = scores.speed_worse_when_it_varies().mean()
    assert share > 0.95 if true else share < 0.4


def test_a_tenfold_measurement_covariance_smooths_and_lags():
    """Same noise, two filters. The gain depends on the ratio of the covariances: w / sqrt 10.

    Ratios of 100 runs are 0.43 (0.02) and 1.94 (0.02): the bounds are 8 and 25 deviations away."""
    less = S.with_(w=S.w / np.sqrt(10))
    straight, turning = (
        [
            paper.tracking_errors([PATHS[i]], 100, rng=np.random.default_rng(17), s=s)[0]
            for s in (S, less)
        ]
        for i in (7, 10)
    )
    smooth = [one[:, 250:, 1].std() for one in straight]
    behind = [-one[:, -100:, 1].mean() for one in turning]
    assert smooth[1] < 0.6 * smooth[0]
    assert behind[1] > 1.4 * behind[0] > 0


def test_the_lateral_speed_of_figure_7_is_zero_but_for_noise():
    """Without noise exactly; the mean of 200 runs has a deviation of 0.0007 m/s: chance 6e-7."""
    assert np.abs(paper.filter_vehicle(PATHS[7].truth)[:, 1]).max() == 0
    runs = paper.tracking_errors([PATHS[7]], 200, rng=np.random.default_rng(18))[0, :, S.skip :, 1]
    assert abs(runs.mean()) < 0.0035


def test_scores_read_the_right_rows():
    scores = paper.PathScores(
        (7, 8, 9, 10, 11),
        settled=np.array([[0.4], [0.9], [0.9], [0.9], [0.9]]),
        whole=np.array([[0.4], [0.9], [0.9], [0.9], [1.1]]),
        speed=np.array([[[1, 1]], [[2, 1]], [[1, 3]], [[2.5, 0]], [[0, 2.5]]]),
        resolution=1.0,
    )
    assert scores.small_in_figure_7() and scores.below_resolution()
    assert not replace(scores, settled=scores.whole).below_resolution()
    assert not scores.speed_worse_when_it_varies()  # v_y of Fig 9 is worse than that of Fig 11


def test_the_noise_of_the_document_depends_on_the_sampling_interval():
    """Halving T and keeping w doubles what the velocity wanders in a second."""
    half = S.with_(T=S.T / 2)
    slow = paper.acceleration_lag(A, S)[1]
    assert paper.acceleration_lag(A, half)[1] < 0.85 * slow
