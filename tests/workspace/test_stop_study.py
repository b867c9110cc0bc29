"""Decisions of trackers in many runs, and the saved study of them."""

import numpy as np
import pytest

from dopplerlib.workspace.stop_study import (
    EVERY,
    LABELS,
    SCENES,
    THRESHOLDS,
    StopStudy,
    decision_numbers,
    saved_stops,
    stop_runs,
)
from dopplerlib.workspace.stopping import RULES, Courses
from studies import stopping as module

HALF = THRESHOLDS.index(0.5)


@pytest.mark.parametrize(
    ("scene", "targets", "trackers"),
    [
        ("workspace", 40, [name for name in LABELS if name != "ring_iekf"]),  # that takes 8 s
        ("2 m/s", 20, None),
    ],
)
def test_the_saved_decisions_come_out_again(scene, targets, trackers):
    seed = module.PARAMETERS["seed"]
    study, saved = stop_runs(scene, 0, targets, 2, seed=seed, trackers=trackers), saved_stops(scene)
    courses, kept = study.courses, saved.courses
    # The saved part goes on with passing courses; up to the second one both are the same.
    passing = np.flatnonzero(courses.kind == "passing")
    count = passing[1] + 1 if len(passing) > 1 else len(courses.kind)
    assert count >= 1
    for name in ("entry", "need", "closest"):
        found, expected = getattr(courses, name)[:count], getattr(kept, name)[:count]
        np.testing.assert_allclose(found, expected, atol=1e-6, equal_nan=True)
    for name, alarm in study.alarm.items():
        np.testing.assert_array_equal(alarm[:count], saved.alarm[name][:count], err_msg=name)


def test_the_saved_study_has_the_courses_that_were_asked_for():
    sizes = (module.PARAMETERS[name] for name in ("parts", "passing"))
    for scene, parts, passing in zip(SCENES, *sizes, strict=True):
        kind = saved_stops(scene).courses.kind
        assert set(kind) == {"collision", "near miss", "passing"}
        assert (kind == "passing").sum() == parts * passing
        assert (kind == "collision").sum() > 1000


@pytest.fixture
def study():
    """Three collisions, at 1 s and with a need of 0.1 s, a near miss, and two passing courses."""
    entry = np.array([1.0, 1.0, 1.0, np.inf, np.inf, np.inf])
    need, closest = np.where(entry < 2, 0.1, np.nan), [0.01, 0.02, 0.08, 0.11, 0.2, 0.29]
    alarm = np.full((6, len(RULES), len(THRESHOLDS)), np.inf)
    alarm[:, 2, HALF] = [0.7, 0.95, np.inf, 0.5, 0.5, np.inf]
    return StopStudy(Courses(np.empty((6, 0, 6)), entry, need, closest), {"bank": alarm})


def test_statistics_are_of_collisions_and_of_passing_courses(study):
    found = study.summary("bank", "within 0.3 s", 0.5)
    assert found.in_time.value == pytest.approx(1 / 3)
    assert found.lead.value == pytest.approx(0.05)
    assert found.early.value == -np.inf
    assert found.false.value == 0.5
    curve = study.curve("bank", "within 0.3 s", 0.5)
    np.testing.assert_allclose(curve[HALF], [0.5, 0.05])
    assert (curve[:HALF, 0] == 0).all() and np.isneginf(curve[:HALF, 1]).all()


def test_stops_are_counted_by_the_closest_approach_near_misses_too(study):
    found = study.stopped("bank", "within 0.3 s", 0.5, [0.0, 0.05, 0.1, 0.12, 0.15, 0.3])
    np.testing.assert_allclose(found[:, 0], [0.5, 0, 1, np.nan, 0.5])
    assert (found[[0, 1, 2, 4], 1] <= found[[0, 1, 2, 4], 0]).all()


def test_numbers_of_decisions_are_their_times(study):
    alarm = study.of("bank", "within 0.3 s", 0.5)
    numbers = decision_numbers(alarm)
    np.testing.assert_array_equal(numbers, [140, 190, 255, 100, 100, 255])
    with pytest.raises(ValueError, match="alarm must be times up to"):
        decision_numbers([1.3])
    longest = max(s.samples for s in SCENES.values())
    assert decision_numbers([longest * 0.001]) == longest / EVERY


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("guess", "ever", 0.5), "tracker must be"),
        (("bank", "guess", 0.5), "rule must be"),
        (("bank", "ever", 0.4), "threshold must be"),
    ],
)
def test_errors_name_the_argument(study, arguments, text):
    with pytest.raises(ValueError, match=text):
        study.of(*arguments)
    with pytest.raises(ValueError, match="edges must ascend"):
        study.stopped("bank", "ever", 0.5, [0.2, 0.1])
