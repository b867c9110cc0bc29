"""Polar measurements, the scheme of Fig 6, smoother and models, and two who cross."""

import numpy as np
import pytest

from dopplerlib import gnn_assign, nees, rts_smooth
from dopplerlib.estimation.extended_update import ekf_update
from dopplerlib.model.motion import ncv_transition
from dopplerlib.model.polar_radar import polar_radar_h
from dopplerlib.systems import macaveiu2013 as paper
from dopplerlib.tracking.association import greedy_assign

PATHS = paper.vehicle_paths()
S = paper.automotive_settings()


def test_a_start_from_one_scan_has_the_covariance_of_its_error():
    """NEES of positions and range rates of 4000 starts. False-alarm probability 6e-7 each."""
    truth = np.tile([4.0, 1.0, 8.0, 2.0], (1, 1))
    z = paper.measure_polar(truth, 4000, rng=np.random.default_rng(1))[:, 0]
    x, P = paper.start_polar(z)
    off = x[:, ::2] - truth[0, ::2]
    value = np.einsum("ri,rij,rj->r", off, np.linalg.inv(P[:, ::2, ::2]), off)
    # One degree at 9 m bends the polar noise by a millimeter: nothing to see.
    assert value.mean() == pytest.approx(2, abs=5 * np.sqrt(4 / 4000))
    np.testing.assert_allclose(polar_radar_h(x), z, atol=1e-12)
    across = np.stack([np.cos(z[:, 1]), -np.sin(z[:, 1])], axis=-1)
    spread = np.einsum("ri,rij,rj->r", across, P[:, 1::2, 1::2], across)
    np.testing.assert_allclose(spread, paper.polar_filters.SIDEWAYS**2)


def test_the_polar_filter_is_consistent_on_a_target_that_wanders_as_it_assumes():
    """Mean NEES of 300 runs at the end; bounds of probability 1e-6."""
    rng = np.random.default_rng(2)
    s = S.with_(samples=60)
    runs = 300
    F = ncv_transition(s.T)
    x = np.tile([-4.0, 1.4, 15.0, 0.3], (runs, 1))
    path = np.empty((runs, 60, 4))
    for k in range(60):
        path[:, k] = x
        x = x @ F.T
        x[:, 1::2] += s.w * rng.standard_normal((runs, 2))
    seen = polar_radar_h(path)
    z = seen + rng.standard_normal(seen.shape) * np.sqrt(np.diag(paper.polar_noise()))
    track = paper.track_polar(z, s)
    at_end = nees(track, path)[:, -1].mean()
    assert 4 - 5 * np.sqrt(8 / runs) < at_end < 4 + 5 * np.sqrt(8 / runs)


def test_the_range_rate_taken_for_the_velocity_stops_a_crossing_target():
    """Naive speeds stay below 0.12 m/s, where the bound is 0.69.

    The error of 20 runs is 0.032 (0.003) m/s: its bound is 20 deviations away.
    """
    z = paper.measure_polar(PATHS[8].truth, 20, rng=np.random.default_rng(3))
    middle = slice(230, 270)
    naive, ekf = paper.track_polar_naive(z), paper.track_polar(z)
    assert np.abs(naive.x[:, middle, 1]).max() < 0.5 * 5 * paper.KMH
    assert np.sqrt(np.mean((ekf.x - PATHS[8].truth)[:, middle, 1] ** 2)) < 0.1


def test_a_scan_that_is_missing_is_predicted():
    z = paper.measure_polar(PATHS[8].truth[:20], 2, rng=np.random.default_rng(4))
    z[0, 10:] = np.nan
    track = paper.track_polar(z, S)
    assert track.updated[1, 1:].all() and not track.updated[0, 10:].any()
    np.testing.assert_allclose(track.x[0, 12], ncv_transition(S.T) @ track.x[0, 11])


def test_a_track_cannot_start_without_a_first_measurement():
    z = paper.measure_polar(PATHS[8].truth[:3], 2, rng=np.random.default_rng(4))
    z[1, 0] = np.nan
    with pytest.raises(ValueError, match=r"z\[:, 0\], where the track starts, must be finite"):
        paper.track_polar(z)
    z = paper.measure_polar(PATHS[8].truth[:3], 2, rng=np.random.default_rng(4))
    z[0, 2] = np.nan
    with pytest.raises(ValueError, match="z must be finite"):
        paper.track_polar_naive(z)


def test_the_polar_filter_follows_a_target_that_passes_behind_the_radar():
    """Its azimuth jumps from pi to -pi. An error of 1 m is 10 deviations of what is left."""
    k = np.arange(200)
    truth = np.stack([-5 + 1.4 * S.T * k, 0 * k + 1.4, 0 * k - 6.0, 0.0 * k], axis=-1)
    z = paper.measure_polar(truth, 5, rng=np.random.default_rng(13))
    assert np.ptp(z[..., 1]) > 6
    off = (paper.track_polar(z).x - truth)[:, 30:, ::2]
    assert np.abs(off).max() < 1
    scans = [paper.VehicleScan(one[None], np.zeros(1, int)) for one in polar_radar_h(truth)]
    (track,) = paper.track_objects(scans, rule="never")  # one, from end to end
    assert len(track.scan) == 200


def test_the_scheme_follows_a_target_straight_behind_whose_azimuth_has_either_sign():
    """The noise makes it pi or -pi. No scan is lost: the scheme expects twice that noise."""
    k = np.arange(100)
    truth = np.stack([0.0 * k, 0 * k, -6 - 1.4 * S.T * k, 0 * k - 1.4], axis=-1)
    z = paper.measure_polar(truth, 1, rng=np.random.default_rng(15))[0]
    z[:, 1] = (z[:, 1] + np.pi) % (2 * np.pi) - np.pi
    assert (z[:, 1] > 3).any() and (z[:, 1] < -3).any()
    scans = [paper.VehicleScan(one[None], np.zeros(1, int)) for one in z]
    (track,) = paper.track_objects(scans, rule="never")
    assert len(track.scan) == 100 and (track.detection >= 0).all()


def test_the_clutter_rule_deletes_the_crossing_target_and_no_one_that_recedes():
    """|x / r| < v_min / v: with v = 5 km/h and y = 20 m, |x| < 2.38 m, which takes 3.4 s."""
    hidden = {figure: paper.hidden_scans(path.truth) for figure, path in PATHS.items()}
    ratio = paper.reported().scenario.polar.v_min / (5 * paper.KMH)
    width = 2 * 20 * ratio / np.sqrt(1 - ratio**2)
    assert hidden[8].sum() == pytest.approx(width / (5 * paper.KMH) / S.T, abs=1)
    assert [hidden[figure].sum() for figure in (7, 9, 10)] == [0, 0, 0]
    assert hidden[11].sum() > hidden[8].sum()


def test_the_object_association_groups_what_fits_into_the_box():
    z = np.array([[20.0, 0.0, 1.0], [22.0, 0.1, 1.2], [22.0, 0.1, 2.0], [40.0, 0.0, 1.0]])
    means, member = paper.group_detections(z)
    assert member.tolist() == [0, 0, 1, 2]
    np.testing.assert_allclose(means[0], [21.0, 0.05, 1.1])
    means, member = paper.group_detections(np.empty((0, 3)))
    assert means.shape == (0, 3) and member.shape == (0,)


def test_the_scheme_finds_the_target_that_recedes_and_few_others():
    """One run. The target is lost only if it goes undetected for 13 scans in a row: 1e-39."""
    scans = paper.simulate_scans(PATHS[7].truth[:150], rng=np.random.default_rng(5))
    tracks = [track for track in paper.track_objects(scans) if track.confirmed.any()]
    offs = [
        np.median(np.linalg.norm((track.x - PATHS[7].truth[track.scan])[:, ::2], axis=1))
        for track in tracks
    ]
    assert min(offs) < 0.5
    assert tracks[int(np.argmin(offs))].scan[-1] == 149
    without = paper.track_objects(scans, rule="never")
    assert sum(track.confirmed.any() for track in without) > len(tracks) + 5
    with pytest.raises(ValueError, match="rule must be one of"):
        paper.track_objects(scans, rule="sometimes")


def test_a_target_that_stands_still_is_simulated():
    """It heads where it moved last, and along y if it never moves."""
    truth = PATHS[8].truth[:6].copy()  # along x
    truth[3:, 1::2] = 0
    row = paper.reflection_points(truth)
    np.testing.assert_allclose(row[4, :, 0] - truth[4, 0], [-1.5, 0, 1.5])
    np.testing.assert_allclose(row[4, :, 2], truth[4, 2])
    np.testing.assert_allclose(paper.reflection_points(truth[::-1])[0], row[5])
    never = paper.reflection_points(truth[3:])
    np.testing.assert_allclose(never[0, :, 2] - truth[3, 2], [-1.5, 0, 1.5])
    for points in (1, 3):
        scans = paper.simulate_scans(truth[3:], rng=np.random.default_rng(14), points=points)
        assert all(np.isfinite(scan.z).all() for scan in scans)


def test_the_scheme_asks_the_assignment_that_it_is_given():
    scans = paper.simulate_scans(PATHS[7].truth[:20], rng=np.random.default_rng(15))
    asked = []

    def assign(cost, gate):
        asked.append(cost.shape)
        return gnn_assign(cost, gate)

    paper.track_objects(scans, assign=assign)
    assert asked


def test_with_the_rule_for_new_tracks_a_track_goes_on_where_the_target_stands_and_none_begins():
    """Without noise: the pedestrian of Fig 8, who has no range rate for 90 scans, and a sign."""
    seen = polar_radar_h(PATHS[8].truth[100:400])
    sign = np.array([40.0, 0.3, 0.0])
    scans = [paper.VehicleScan(np.stack([one, sign]), np.array([0, 1])) for one in seen]
    (track,) = paper.track_objects(scans, rule="new tracks only")
    assert track.scan[0] == 0 and len(track.scan) == 300 and (track.detection >= 0).all()
    first, second = paper.track_objects(
        scans
    )  # as in Fig 6: gone half a second after the last detection
    assert first.scan[-1] + 60 < second.scan[0]
    assert len(paper.track_objects(scans, rule="never")) == 2


def test_the_filter_of_the_scheme_is_tuned_to_the_turn_of_figure_10():
    """Three runs, with the noise that the scheme expects of its objects: the speed v_x is off by
    0.28 (0.01) m/s, by 0.5 to 0.6 if the velocity step is ten times as large, and the track is
    lost if it is a tenth.
    """
    seen = polar_radar_h(PATHS[10].truth)
    off = []
    for rng in np.random.default_rng(16).spawn(3):
        z = seen + rng.standard_normal(seen.shape) * np.sqrt(np.diag(paper.processing.OBJECT_NOISE))
        tracks = paper.track_objects([paper.VehicleScan(one[None], np.zeros(1, int)) for one in z])
        track = max(tracks, key=lambda track: len(track.scan))
        off.append((track.x - PATHS[10].truth[track.scan])[S.skip :, 1])
    assert np.sqrt(np.mean(np.concatenate(off) ** 2)) < 0.4


def test_scans_say_where_detections_come_from():
    """Means of 200 scans: 2.7, 8.4 and 0.3 detections; each off by 5 deviations with 6e-7."""
    scans = paper.simulate_scans(PATHS[7].truth[:200], rng=np.random.default_rng(6))
    count = np.array([np.bincount(scan.source, minlength=3) for scan in scans])
    expected = np.array([2.7, 8.4, 0.3])
    variance = np.array([3 * 0.9 * 0.1, 12 * 0.7 * 0.3, 0.3])
    assert (np.abs(count.mean(axis=0) - expected) < 5 * np.sqrt(variance / 200)).all()


def test_filter_and_smoother_of_the_comparison_are_the_library_s():
    path = PATHS[10]
    z = paper.measure_vehicle(path.truth, 2, rng=np.random.default_rng(7))
    filtered, smoothed = paper.smooth_vehicle(z)
    np.testing.assert_allclose(filtered, paper.filter_vehicle(z), atol=1e-10)
    runs = paper.track_vehicle(path, 2, rng=np.random.default_rng(7))  # the same records
    x, _ = rts_smooth(runs.x, runs.P, ncv_transition(S.T), S.E_x)
    np.testing.assert_allclose(smoothed, x, atol=1e-9)


def test_constant_acceleration_follows_the_turn_without_lag_and_pays_in_noise():
    """The mean of 20 runs is 2.7 (0.1) times the other one: the bound is 12 deviations away."""
    path = PATHS[10]
    still = paper.track_accelerating(path.truth[None], q=0.01, a_max=1.45)[0]
    # The acceleration is known at the end, to what is left of the start.
    np.testing.assert_allclose(still[-1], path.truth[-1], atol=0.002)
    z = paper.measure_vehicle(PATHS[7].truth, 20, rng=np.random.default_rng(8))
    settled = np.arange(S.samples) >= S.skip
    noisy = paper.rms_of_runs(
        paper.track_accelerating(z, 0.01, 1.45), PATHS[7].truth, settled, "velocity"
    )
    calm = paper.rms_of_runs(paper.smooth_vehicle(z)[0], PATHS[7].truth, settled, "velocity")
    assert noisy.mean() > 1.5 * calm.mean()


def test_two_models_notice_the_hard_turn():
    """Means of 20 runs are 0.84 (0.01) and 0.32 (0.01): both bounds are 8 deviations away."""
    path, turning = paper.hard_turn()
    z = paper.measure_vehicle(path.truth, 20, rng=np.random.default_rng(9))
    _, agile = paper.track_two_models(z, (0.01, 0.055))
    late = turning & np.roll(turning, 13)  # half a second to notice
    before = (S.time > 4) & (S.time < 8)
    assert agile[:, late].mean() > 0.6 > 0.4 > agile[:, before].mean()


def test_root_mean_square_of_a_run_is_that_of_its_samples():
    x = np.zeros((1, 3, 4))
    x[0, :, 0], x[0, :, 2] = [3, 0, 9], [4, 0, 9]
    where = np.array([True, True, False])
    assert paper.rms_of_runs(x, np.zeros((3, 4)), where, "position")[0] == pytest.approx(5 / 2**0.5)
    assert paper.rms_of_runs(x, np.zeros((3, 4)), where, "velocity")[0] == 0


@pytest.mark.parametrize(("rule", "assign"), [("Hungarian", gnn_assign), ("greedy", greedy_assign)])
def test_choices_for_two_are_those_of_the_general_assignments(rule, assign):
    cost = np.random.default_rng(10).uniform(0, 9, size=(200, 2, 2))
    chosen = paper.crossing._choice(cost, rule)
    assert [list(assign(one, 100.0)) for one in cost] == chosen.tolist()


def test_the_hungarian_rule_keeps_both_targets_and_swaps_them_more_often_than_greedy():
    """200 runs each. Lost: 0.81 (0.03) against 0, which is certain. Swapped: 0.58 against 0.09, a
    difference of 0.49 (0.04). The bounds are 7 deviations away."""

    def share(degrees, rule, which, velocity):
        truth, rng = paper.crossing_paths(np.deg2rad(degrees)), np.random.default_rng(12)
        return getattr(
            paper.track_crossing(truth, rule, 200, rng=rng, velocity=velocity), which
        ).mean()

    assert share(11, "Hungarian", "lost", True) == 0
    assert share(11, "each its nearest", "lost", True) > 0.6
    both = [share(20, rule, "swapped", False) for rule in ("Hungarian", "greedy")]
    assert both[0] > both[1] + 0.2


def test_swapped_and_lost_exclude_each_other_and_are_what_the_estimates_say():
    """200 runs in which each happens: at 11 degrees two of three tracks are lost."""
    truth = paper.crossing_paths(np.deg2rad(11))
    rng = np.random.default_rng(16)
    out = paper.track_crossing(truth, "each its nearest", 200, rng=rng, velocity=False)
    end = np.linalg.norm(out.x[:, :, None, -1, ::2] - truth[None, None, :, -1, ::2], axis=-1)
    to_own = end[:, [0, 1], [0, 1]] < end[:, [0, 1], [1, 0]]  # (runs, tracks)
    np.testing.assert_array_equal(out.swapped, ~to_own.any(axis=1))
    np.testing.assert_array_equal(out.lost, to_own.sum(axis=1) == 1)
    assert out.lost.any() and not (out.swapped & out.lost).any()


@pytest.mark.parametrize("velocity", [True, False])
def test_the_distance_of_a_track_and_a_detection_is_the_squared_innovation_in_its_covariance(
    velocity, monkeypatch
):
    truth, found = paper.crossing_paths(0.3), []
    choice = paper.crossing._choice

    def spy(cost, rule):
        found.append(cost)
        return choice(cost, rule)

    monkeypatch.setattr(paper.crossing, "_choice", spy)
    rng = np.random.default_rng(16)
    out = paper.track_crossing(truth, "greedy", 1, rng=rng, velocity=velocity)
    z = [paper.measure_vehicle(one, 1, rng=c) for one, c in
         zip(truth, np.random.default_rng(16).spawn(2), strict=True)]  # fmt: skip
    F, P = ncv_transition(S.T), S.E_z
    H = np.eye(4) if velocity else np.eye(4)[::2]
    R = H @ S.E_z @ H.T
    for k in range(1, 4):
        predicted = F @ P @ F.T + S.E_x
        for track, detection in np.ndindex(2, 2):
            x = F @ out.x[0, track, k - 1]
            *_, nu, covariance = ekf_update(
                x, predicted, H @ z[detection][0, k], lambda x: x @ H.T, lambda x: H, R
            )
            nis = nu @ np.linalg.solve(covariance, nu)
            assert found[k - 1][0, track, detection] == pytest.approx(nis, rel=1e-9)
        P = predicted - predicted @ np.linalg.solve(predicted + S.E_z, predicted)


def test_crossing_paths_meet_half_way_at_their_angle():
    truth = paper.crossing_paths(0.5)
    half = truth[:, [249, 250]].mean(axis=1)
    np.testing.assert_allclose(half[0, ::2], half[1, ::2], atol=1e-9)
    v = truth[:, 0, 1::2]
    assert np.arccos(v[0] @ v[1] / paper.crossing._SPEED**2) == pytest.approx(0.5)


def test_far_apart_every_rule_follows_both():
    truth = paper.crossing_paths(0.0)
    truth[1, :, 2] += 30
    for rule in paper.RULES:
        out = paper.track_crossing(truth, rule, 20, rng=np.random.default_rng(11))
        assert not out.swapped.any() and not out.lost.any()
        np.testing.assert_allclose(
            out.x[:, 0],
            paper.filter_vehicle(
                paper.measure_vehicle(truth[0], 20, rng=np.random.default_rng(11).spawn(2)[0])
            ),
            atol=1e-9,
        )


def test_the_longest_gap_is_counted():
    seen = np.array([[True, False, False, True, False], [False] * 5, [True] * 5])
    assert paper.longest_gap(seen).tolist() == [2, 5, 0]
