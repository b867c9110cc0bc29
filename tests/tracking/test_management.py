"""The life of a track under the rule M of N."""

from itertools import product

import pytest

from dopplerlib.tracking.management import TrackLife, TrackManager


def lives(manager, scans):
    life = manager.start()
    statuses = [life.status]
    for detected in scans:
        life = manager.advance(life, detected)
        statuses.append(life.status)
    return statuses


def test_every_record_of_four_scans_is_judged_as_two_of_three_says():
    """The start counts as a detection: one more in the next two scans, or the track is dropped."""
    manager = TrackManager(hits=2, window=3, delete_after=2)
    for scans in product([False, True], repeat=4):
        statuses = lives(manager, scans)
        first = next((i for i in (0, 1) if scans[i]), None)
        if first is None:
            assert statuses == ["tentative", "tentative", "deleted", "deleted", "deleted"]
            continue
        rest = scans[first + 1 :]
        dead = [i for i in range(1, len(rest)) if not rest[i] and not rest[i - 1]]
        alive = dead[0] if dead else len(rest)
        expected = ["tentative"] * (first + 1) + ["confirmed"] * (1 + alive)
        expected += ["deleted"] * (5 - len(expected))
        assert statuses == expected, scans


def test_probability_of_a_false_confirmation_is_that_of_the_binomial():
    """Clutter with detection probability p confirms a 3-of-5 track iff 2 of the next 4 are hits."""
    manager, p = TrackManager(hits=3, window=5, delete_after=9), 0.2
    confirmed = 0.0
    for scans in product([False, True], repeat=4):
        weight = 1.0
        for detected in scans:
            weight *= p if detected else 1 - p
        confirmed += weight * ("confirmed" in lives(manager, scans))
    assert confirmed == pytest.approx(1 - 0.8**4 - 4 * 0.2 * 0.8**3)


def test_one_of_one_is_confirmed_at_once_and_a_deleted_track_stays_deleted():
    manager = TrackManager(hits=1, window=1, delete_after=1)
    assert lives(manager, [False, True, True]) == ["confirmed", "deleted", "deleted", "deleted"]


def test_age_and_misses_are_counted():
    manager = TrackManager(hits=1, window=3, delete_after=9)
    life = manager.start()
    for detected in (True, False, False):
        life = manager.advance(life, detected)
    assert (life.age, life.misses, life.recent) == (4, 2, (True, False, False))


@pytest.mark.parametrize(
    ("rules", "name"),
    [
        ((0, 3, 1), "hits"),
        ((4, 3, 1), "hits"),
        ((2, 2.5, 1), "window"),
        ((1, 1, 0), "delete_after"),
    ],
)
def test_impossible_rules_are_refused(rules, name):
    with pytest.raises(ValueError, match=rf"^{name} must "):
        TrackManager(*rules)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("status", "lost", "status must be one of 'tentative', 'confirmed', 'deleted', got 'lost'"),
        ("recent", (1,), "recent must be one of True, False, got 1"),
        ("recent", None, "recent must be a collection of True, False, got None"),
        ("age", 0, "age must be a whole number of at least 1, got 0"),
        ("misses", -1, "misses must be a whole number of at least 0, got -1"),
    ],
)
def test_a_life_that_cannot_be_is_refused(name, value, message):
    fields = {"status": "tentative", "recent": (True,), "age": 1, "misses": 0}
    with pytest.raises(ValueError, match=f"^{message}$"):
        TrackLife(**fields | {name: value})


def test_only_a_life_and_a_boolean_advance_a_track():
    manager = TrackManager(hits=2, window=3, delete_after=2)
    with pytest.raises(ValueError, match=r"^life must be a TrackLife, got None"):
        manager.advance(None, True)
    for detected in ("no", 1, None):
        with pytest.raises(ValueError, match=r"^detected must be True or False, got "):
            manager.advance(manager.start(), detected)
