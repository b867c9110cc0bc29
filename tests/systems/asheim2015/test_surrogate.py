"""The SIMULATED surrogate looks as the prose of Chapter 6 tells, and its trackers do their work."""

import numpy as np
import pytest

from dopplerlib.systems import asheim2015 as thesis
from dopplerlib.systems.asheim2015.surrogate import WALKS
from dopplerlib.tracking.pda import pda_update

REAL = thesis.reported().scenario.real


@pytest.fixture(scope="module", params=WALKS)
def walk(request):
    return thesis.simulate_walk(50, rng=np.random.default_rng(1), variant=request.param)


@pytest.mark.parametrize("radar_count", [1, 2])
@pytest.mark.parametrize("variant", WALKS)
def test_the_target_is_gone_when_the_thesis_says(variant, radar_count):
    w = thesis.simulate_walk(
        1, rng=np.random.default_rng(2), variant=variant, radar_count=radar_count
    )
    hidden = (w.time > REAL.gone + 0.5) & (w.time < REAL.back - 0.5)
    assert not w.visible[:, hidden].any()
    assert w.visible[:, (w.time > 4) & (w.time < REAL.gone - 2)].all()
    assert w.visible[:, (w.time > REAL.back + 1.5) & (w.time < 55)].all()


def test_the_speed_is_the_derivative_of_the_path():
    for variant in WALKS:
        w = thesis.simulate_walk(1, rng=np.random.default_rng(3), variant=variant)
        mean = (w.truth[1:, 3] + w.truth[:-1, 3]) / 2
        step = np.diff(w.truth[:, 1])
        jump = np.abs(np.diff(w.truth[:, 3])) > 0.1  # where the walk turns or ends within a scan
        np.testing.assert_allclose(step[~jump], mean[~jump], atol=0.02)


def test_nothing_is_detected_outside_the_window(walk):
    d = walk.detections[..., 0]
    near, far = REAL.window
    assert np.nanmin(d) >= near and np.nanmax(d) <= far


def test_a_moving_target_is_detected_as_often_as_set(walk):
    """A detection within 4 deviations of the truth; clutter seldom is. 0.9 within 0.05."""
    own = thesis.reported().scenario.surrogate
    sees = walk.visible & (np.abs(walk.ranges[..., 0] - 3) < 1)
    off = np.abs(walk.detections[..., 0] - walk.ranges[..., :1])
    hit = (off < 4 * thesis.noise_std(4.2)[0]).any(axis=-1)[:, sees]
    assert abs(hit.mean() - own.detection) < 0.05


def test_a_managed_tracker_gives_up_and_begins_again():
    """In at least 45 of 50 walks one confirmed track covers a scan before, another one after."""
    own, s = thesis.reported().scenario.surrogate, thesis.reported().scenario
    w = thesis.simulate_walk(50, rng=np.random.default_rng(4))
    modern = thesis.filter_settings("modern", s.real.T, floor=(own.body, own.limb))
    good = 0
    for run in w.detections[:, 0]:
        tracks = thesis.managed_tracks(run, modern)
        near = [
            [t for t in tracks if (np.abs(t.x[t.scan == k, 0] - w.ranges[0, k, 0]) < 0.5).any()]
            for k in (15, 52)
        ]
        good += bool(near[0] and near[1])
        assert all((np.diff(t.scan) == 1).all() for t in tracks)
    assert good >= 45


def test_association_by_probability_follows_the_target(walk):
    """Median error before the gap below the spread of the body."""
    own = thesis.reported().scenario.surrogate
    modern = thesis.filter_settings("modern", REAL.T, floor=(own.body, own.limb))
    x, missed = thesis.pda_ranges(walk.detections, modern, x0=walk.ranges[:, 0])
    before = slice(2, int(REAL.gone))
    error = np.abs(x[..., 0] - walk.ranges[..., 0])[..., before]
    assert np.median(error) < own.body
    gone = missed[..., int(REAL.gone) + 2 : int(REAL.back) - 1]
    assert np.median(gone) > 0.9


def test_a_box_of_fixed_size_seldom_finds_the_track_again(walk):
    """0.06 and 0.24 of 200 walks: of 50 not half, by chance 1e-4."""
    code = thesis.filter_settings("code", REAL.T)
    x = thesis.track_ranges(walk.detections, code, x0=walk.ranges[:, 0].mean(axis=0)).x
    back = round(REAL.back / REAL.T)
    error = np.abs(x[:, 0, :, 0] - walk.ranges[0, :, 0])[:, back + 3 : back + 9]
    assert (error < code.box[0]).all(axis=1).mean() < 0.5


def test_the_gate_makes_most_walks_more_even():
    """In nine walks of ten: of 60 more than a half, by chance 1e-9."""
    w = thesis.simulate_walk(60, rng=np.random.default_rng(6), radar_count=1)
    at = (w.time >= 4) & (w.time < REAL.gone)
    bends = [
        np.sum(np.diff(thesis.track_ranges(w.detections, own, x0=REAL.guess).x[..., 0], 2) ** 2
               * at[1:-1], axis=-1)
        for own in (thesis.filter_settings("code", REAL.T, gate=gate) for gate in ("box", None))
    ]  # fmt: skip
    assert np.mean(bends[0] < bends[1]) > 0.5


def test_the_errors_that_the_thesis_reads_off_lie_among_those_of_the_walks():
    """Of 100 walks each lies between the least and the largest; the four places of Fig 6.4(c)."""
    w, q = thesis.simulate_walk(100, rng=np.random.default_rng(5)), thesis.reported().quoted.real
    code = thesis.filter_settings("code", REAL.T)
    track = thesis.track_ranges(w.detections, code, x0=w.ranges[:, 0].mean(axis=0))
    before, y = w.time < REAL.gone, w.truth[:, 1]
    follows = (np.abs(track.x[..., 0] - w.ranges[..., 0])[..., before] < code.box[0]).all((1, 2))
    assert follows.mean() > 0.9  # the others are lost to a false detection
    off, raw = (
        thesis.position_errors(
            thesis.clipped_bilateration(*np.moveaxis(d[follows], 1, 0), REAL.baseline)[0], w.truth
        )
        for d in (track.x[..., 0], track.chosen[..., 0])
    )
    for values, at, told in (
        (off, before & (y < 2.4), q.error_near),
        (raw, before & (y >= 2) & (y <= 3), np.mean(q.raw_near)),
        (off, before & (np.abs(y - 4) < 0.2), q.error_at_four),
    ):
        mean = np.nanmean(values[:, at], axis=1)
        assert mean.min() < told < mean.max()
    worst = np.nanmax(raw[:, before], axis=1)
    assert worst.min() < q.raw_worst < worst.max()


def test_clean_detections_scatter_with_the_law_and_the_loss():
    """Between 2 and 4 m, some 1500 of them: a standard error of 2 % of the deviation."""
    w = thesis.simulate_walk(50, rng=np.random.default_rng(7))
    loss = thesis.reported().scenario.surrogate.snr_loss
    z, d = w.detections[..., 0, 0], w.ranges[..., 0]  # the first place is that of the target
    scaled = (z - d) / thesis.noise_std(d, lambda d: thesis.snr(d) - loss)[..., 0]
    inside = scaled[:, (d > 2) & (d < 4)]
    assert np.nanstd(inside) == pytest.approx(1.0, abs=0.1)


def test_ghosts_come_while_the_target_is_nearer_than_the_window_and_then_only():
    """2 a scan, at most 4 of them: 1.93 by hand; else clutter over a sixth of the window.

    500 scans and more: standard errors of 0.06 and 0.01.
    """
    w = thesis.simulate_walk(60, rng=np.random.default_rng(8), radar_count=1)
    own, d = thesis.reported().scenario.surrogate, w.ranges[0, 1:, 0]  # the first scan is empty
    low, high = own.ghost_range
    z = w.detections[:, 0, 1:, :, 0]
    count = ((z > low) & (z < high)).sum(axis=-1)
    clutter = own.clutter / 6
    near, inside = d < REAL.window[0], (d > 2) & (d < 3)
    assert count[:, near].mean() == pytest.approx(1.93 + clutter, abs=0.3)
    assert count[:, inside].mean() == pytest.approx(clutter, abs=0.05)


def one_radar_tracks(*scans):
    """Return the confirmed tracks of scans with these detections, with the noise of a person."""
    own = thesis.reported().scenario.surrogate
    modern = thesis.filter_settings("modern", REAL.T, floor=(own.body, own.limb))
    detections = np.full((len(scans), 2, 2), np.nan)
    for k, scan in enumerate(scans):
        detections[k, : len(scan)] = np.reshape(scan, (-1, 2))
    return thesis.managed_tracks(detections, modern)


def test_a_detection_outside_all_gates_starts_a_track_and_moves_none():
    near, far = [2.0, 0.0], [4.0, 0.0]
    first, second = one_radar_tracks(*[[near]] * 4, [far], [far])
    assert (first.detection >= 0).tolist() == [True] * 4 + [False] * 2
    np.testing.assert_allclose(first.x[:, 0], 2.0, atol=1e-12)
    assert second.scan.tolist() == [4, 5]


def test_a_lone_detection_is_no_track():
    assert one_radar_tracks([[2.0, 0.0]], [], [], [], []) == []


def test_two_echoes_of_a_body_are_one_track():
    assert len(one_radar_tracks(*[[[2.0, 0.0], [2.1, 0.1]]] * 4)) == 1


def test_a_track_is_on_the_target_or_false():
    """Two seconds of the target at 2 m; a track of a ghost at 4 m."""
    tracks = one_radar_tracks(*[[[2.0, 0.0], [4.0, 0.0]]] * 4)
    truth = np.full(4, 2.0)
    assert thesis.on_track(tracks, truth, [1, 2, 3], 0.5)
    assert not thesis.on_track(tracks, truth + 1, [1, 2, 3], 0.5)
    assert not thesis.on_track(tracks, truth + np.eye(4)[3], [1, 2, 3], 0.5)
    assert not thesis.on_track(one_radar_tracks(*[[[2.0, 0.0]]] * 3), truth, [2, 3], 0.5)
    assert thesis.false_tracks(tracks, truth, 0.5) == 1
    assert thesis.false_tracks(tracks, truth + 1, 0.5) == 2
    assert thesis.false_tracks([], truth, 0.5) == 0


def test_association_by_probability_weighs_with_the_density_of_the_clutter():
    """By hand: 0.2 false detections over 3 m and 2 m/s."""
    own = thesis.reported().scenario.surrogate
    modern = thesis.filter_settings("modern", REAL.T, floor=(own.body, own.limb))
    z = np.array([[[2.0, 0.1], [np.nan] * 2], [[2.2, 0.1], [1.9, -0.2]]])
    x, missed = thesis.pda_ranges(z, modern, x0=z[0, 0])
    F = np.array([[1.0, REAL.T], [0.0, 1.0]])
    expected = pda_update(
        F @ z[0, 0], F @ modern.P0 @ F.T + modern.Q, z[1], np.eye(2), np.diag(modern.R(2.1)),
        detection=own.detection, density=0.2 / 6, gate=modern.gate_probability,
    )  # fmt: skip
    np.testing.assert_allclose(x[1], expected.x, rtol=1e-9)
    assert missed[1] == pytest.approx(float(expected.missed), rel=1e-9)
