"""Courses and decisions to stop, beside geometry and a tracker that knows the truth."""

import numpy as np
import pytest

from dopplerlib.workspace import stopping
from dopplerlib.workspace.stopping import (
    DECELERATION,
    FIRST,
    KINDS,
    LATENCY,
    RADIUS,
    RULES,
    courses_along,
    draw_courses,
    judge_stops,
    stop_times,
)
from dopplerlib.workspace.targets import draw_targets


def straight(p, v, samples=1200):
    """Return the path of uniform motion from p and v at time zero."""
    time = 0.001 * np.arange(1, samples + 1)[:, None]
    path = np.concatenate([p + time * np.asarray(v), np.tile(v, (samples, 1))], axis=-1)
    path[path[:, 0] < 0.05] = np.nan
    return path


@pytest.mark.parametrize(
    ("p", "v", "entry", "closest"),
    [
        ([0.8, 0.0, 0.0], [-1.0, 0, 0], 0.7, 0.0),  # the record ends before, at 0.05 m
        ([0.8, 0.06, 0.0], [-1.0, 0, 0], 0.72, 0.06),
        ([0.8, 0.1, -0.06], [-1.0, 0, 0], np.inf, np.hypot(0.1, 0.06)),  # after the record
        ([0.3, 0.5, 0.0], [0.0, -1.0, 0], np.inf, 0.3),
        ([1.3, 0.0, 0.0], [-0.5, 0, 0], np.inf, np.nan),  # still coming at the end
        ([0.8, 0.0, 0.0], [0.1, 0, 0], np.inf, 0.8001),  # goes away
    ],
)
def test_entry_and_closest_approach_of_straight_courses(p, v, entry, closest):
    one = courses_along(straight(p, v)[None])
    np.testing.assert_allclose(one.entry, [entry], atol=0.0011)  # a sample late
    np.testing.assert_allclose(one.closest, [closest], atol=0.001 if entry < 1 else 1e-9)
    need = LATENCY + np.linalg.norm(v) / (2 * DECELERATION) if entry < 1 else np.nan
    np.testing.assert_allclose(one.need, [need])


@pytest.fixture(scope="module")
def courses():
    return draw_courses(300, "any", rng=np.random.default_rng(1))


def test_courses_of_a_kind_are_those_of_all_targets(courses):
    np.testing.assert_array_equal(
        courses.paths, draw_targets(300, rng=np.random.default_rng(1), samples=1200)
    )
    for kind in ("near miss", "passing"):
        some = courses.part(courses.kind == kind)
        low, high = KINDS[kind]
        assert ((low <= some.closest) & (some.closest < high)).all()
        few = draw_courses(2, kind, rng=np.random.default_rng(1))
        np.testing.assert_array_equal(few.paths, some.paths[:2])


def test_a_collision_enters_the_ball_while_it_is_recorded(courses):
    some = courses.part(courses.kind == "collision")
    assert len(some.entry) > 3
    distance = np.linalg.norm(some.paths[..., :3], axis=-1)
    for d, entry in zip(distance, some.entry, strict=True):
        k = round(entry / 0.001) - 1
        assert d[k] < RADIUS and (d[:k] >= RADIUS).all()


def test_a_kind_that_no_target_has_is_an_error():
    away = [0.8, 0, 0, 1.0, 0, 0], 1e-6 * np.eye(6)
    with pytest.raises(ValueError, match="prior must lead to courses of the kind 'collision'"):
        draw_courses(1, "collision", rng=np.random.default_rng(1), prior=away, samples=1)


def test_who_knows_the_truth_stops_as_early_as_the_rule_says(courses):
    some = courses.part(courses.kind == "collision")
    x = some.paths[:, 4::5]
    alarm = stop_times(some.paths, x, np.zeros((1, 1, 6, 6)), list(RULES), [0.02, 0.98])
    judged = judge_stops(some, alarm)
    assert judged.in_time.all() and alarm.shape == (len(x), 5, 2)
    np.testing.assert_array_equal(alarm[..., 0], alarm[..., 1])
    for i, ahead in ((1, 0.2), (2, 0.3)):
        # A decision each 5 ms, an entry on the millisecond, and process noise.
        assert (np.abs(judged.lead[:, i, 0] - ahead + 0.002) < 0.006).all()
    late = judged.lead[:, 0, 0] - some.need
    assert (late > 0.003).all() and (late < 0.013).all()


def test_decisions_begin_after_a_few_samples_and_end_with_the_record():
    path = straight([0.8, 0, 0], [-1.0, 0, 0])[None]  # 0.75 s long
    hit, miss = np.array([[0.3, 0, 0, -1, 0, 0], [0.3, 0, 0, 1.0, 0, 0]])
    P = np.zeros((1, 1, 6, 6))
    always = np.tile(hit, (1, 240, 1))
    np.testing.assert_allclose(stop_times(path, always, P), [FIRST * 0.001])
    late = np.where(np.arange(240)[:, None] < 150, miss, hit)[None]
    assert np.isinf(stop_times(path, late, P)).all()
    late[0, 100] = hit
    np.testing.assert_allclose(stop_times(path, late, P), [0.505])
    late[0, 90] = np.nan
    np.testing.assert_allclose(stop_times(path, late, P), [0.505])


def test_the_threshold_is_that_of_the_mixture():
    path = straight([0.8, 0, 0], [-1.0, 0, 0])[None]
    hit, miss = [0.3, 0, 0, -1, 0, 0], [0.3, 0, 0, 1.0, 0, 0]
    x = np.tile([hit, miss], (1, 240, 1, 1))
    weights = np.tile([0.4, 0.6], (1, 240, 1))
    P = np.zeros((1, 1, 1, 6, 6))
    found = stop_times(path, x, P, "ever", [0.39, 0.41], weights=weights)
    np.testing.assert_allclose(found, [[0.02, np.inf]])


def test_decisions_are_judged_by_the_braking_distance():
    courses = courses_along(np.stack([straight([0.8, y, 0], [-1.0, 0, 0]) for y in (0, 0, 0, 0.2)]))
    need = 0.07  # 20 ms, and 1 m/s over 20 m/s^2
    np.testing.assert_allclose(courses.need[:3], need)
    entry = courses.entry[0]
    judged = judge_stops(courses, [entry - need - 1e-6, entry - need + 1e-6, np.inf, 0.1])
    assert judged.in_time.tolist() == [True, False, False, False]
    assert judged.false.tolist() == [False, False, False, True]
    np.testing.assert_allclose(judged.lead, [need, need, -np.inf, np.nan], atol=1e-5)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda c: courses_along(c.paths * np.nan), "paths must hold a sample of each course"),
        (lambda c: stop_times(c.paths, c.paths, np.eye(6)), "x must be estimates of 300 courses"),
        (lambda c: judge_stops(c, [1.0]), r"alarm must have shape \(300, ...\)"),
        (
            lambda c: stop_times(c.paths, c.paths[:, 4::5], np.eye(6), threshold=1.0),
            "threshold must lie between 0 and 1",
        ),
    ],
)
def test_errors_name_the_argument(courses, call, text):
    with pytest.raises(ValueError, match=text):
        call(courses)


def test_the_rules_are_those_that_may_be_named():
    assert set(RULES) == set(stopping._Rule.__args__)
