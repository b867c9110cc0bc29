"""The SIMULATED stand-in looks as the prose of Chapter 6 tells, and its trackers do their work."""

import numpy as np
import pytest

from dopplerlib.systems import asheim2015 as thesis
from dopplerlib.systems.asheim2015.stand_in import WALKS

REAL = thesis.scenario()["real"]


@pytest.fixture(scope="module", params=WALKS)
def walk(request):
    return thesis.walk(50, rng=np.random.default_rng(1), variant=request.param)


@pytest.mark.parametrize("radar_count", [1, 2])
@pytest.mark.parametrize("variant", WALKS)
def test_the_target_is_gone_when_the_thesis_says(variant, radar_count):
    w = thesis.walk(1, rng=np.random.default_rng(2), variant=variant, radar_count=radar_count)
    hidden = (w.time > REAL["gone"] + 0.5) & (w.time < REAL["back"] - 0.5)
    assert not w.visible[:, hidden].any()
    assert w.visible[:, (w.time > 4) & (w.time < REAL["gone"] - 2)].all()
    assert w.visible[:, (w.time > REAL["back"] + 1.5) & (w.time < 55)].all()


def test_the_speed_is_the_derivative_of_the_path():
    for variant in WALKS:
        w = thesis.walk(1, rng=np.random.default_rng(3), variant=variant)
        mean = (w.truth[1:, 3] + w.truth[:-1, 3]) / 2
        step = np.diff(w.truth[:, 1])
        jump = np.abs(np.diff(w.truth[:, 3])) > 0.1  # where the walk turns or ends within a scan
        np.testing.assert_allclose(step[~jump], mean[~jump], atol=0.02)


def test_nothing_is_detected_outside_the_window(walk):
    d = walk.detections[..., 0]
    near, far = REAL["window"]
    assert np.nanmin(d) >= near and np.nanmax(d) <= far


def test_a_moving_target_is_detected_as_often_as_set(walk):
    """A detection within 4 deviations of the truth; clutter seldom is. 0.9 within 0.05."""
    own = thesis.scenario()["stand_in"]
    sees = walk.visible & (np.abs(walk.ranges[..., 0] - 3) < 1)
    off = np.abs(walk.detections[..., 0] - walk.ranges[..., :1])
    hit = (off < 4 * thesis.deviations(4.2)[0]).any(axis=-1)[:, sees]
    assert abs(hit.mean() - own["detection"]) < 0.05


def test_a_managed_tracker_gives_up_and_begins_again():
    """In at least 45 of 50 walks one confirmed track covers a scan before, another one after."""
    own, s = thesis.scenario()["stand_in"], thesis.scenario()
    w = thesis.walk(50, rng=np.random.default_rng(4))
    modern = thesis.settings("modern", s["real"]["T"], floor=(own["body"], own["limb"]))
    good = 0
    for run in w.detections[:, 0]:
        tracks = thesis.managed_tracks(w.time, run, modern)
        near = [
            [t for t in tracks if k in t["scan"]
             and abs(t["x"][list(t["scan"]).index(k), 0] - w.ranges[0, k, 0]) < 0.5]
            for k in (15, 52)
        ]  # fmt: skip
        good += bool(near[0] and near[1])
        assert all((np.diff(t["scan"]) == 1).all() for t in tracks)
    assert good >= 45


def test_association_by_probability_follows_the_target(walk):
    """Median error before the gap below the spread of the body."""
    own = thesis.scenario()["stand_in"]
    modern = thesis.settings("modern", REAL["T"], floor=(own["body"], own["limb"]))
    x, missed = thesis.pda_radar(walk.detections, modern, x0=walk.ranges[:, 0])
    before = slice(2, int(REAL["gone"]))
    error = np.abs(x[..., 0] - walk.ranges[..., 0])[..., before]
    assert np.median(error) < own["body"]
    gone = missed[..., int(REAL["gone"]) + 2 : int(REAL["back"]) - 1]
    assert np.median(gone) > 0.9


def test_a_box_of_fixed_size_seldom_finds_the_track_again(walk):
    """0.06 and 0.24 of 200 walks: of 50 not half, by chance 1e-4."""
    code = thesis.settings("code", REAL["T"])
    x = thesis.filter_radar(walk.detections, code, x0=walk.ranges[:, 0].mean(axis=0)).x
    back = round(REAL["back"] / REAL["T"])
    error = np.abs(x[:, 0, :, 0] - walk.ranges[0, :, 0])[:, back + 3 : back + 9]
    assert (error < code.box[0]).all(axis=1).mean() < 0.5


def test_the_errors_that_the_thesis_reads_off_lie_among_those_of_the_walks():
    """Of 100 walks each lies between the least and the largest; the four places of Fig 6.4(c)."""
    w, q = thesis.walk(100, rng=np.random.default_rng(5)), thesis.quoted()["real"]
    code = thesis.settings("code", REAL["T"])
    track = thesis.filter_radar(w.detections, code, x0=w.ranges[:, 0].mean(axis=0))
    off, raw = (
        thesis.distance_error(thesis.triangulate(d[:, 0], d[:, 1], REAL["baseline"])[0], w.truth)
        for d in (track.x[..., 0], track.chosen[..., 0])
    )
    before, y = w.time < REAL["gone"], w.truth[:, 1]
    two_to_three = before & (y >= 2) & (y <= 3)
    for values, told in (
        (off[:, before & (y < 2.4)].mean(axis=1), q["error_near"]),
        (np.nanmean(raw[:, two_to_three], axis=1), np.mean(q["raw_near"])),
        (np.nanmax(raw[:, before], axis=1), q["raw_worst"]),
        (off[:, before & (np.abs(y - 4) < 0.2)].mean(axis=1), q["error_at_four"]),
    ):
        assert values.min() < told < values.max()
