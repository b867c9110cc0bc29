"""Alarms are raised by what they are meant for, and hardly ever without cause."""

from dataclasses import replace

import numpy as np
import pytest

from dopplerlib import Track
from dopplerlib.evaluation.alarms import first_alarm, innovation_alarms

LOOKS = (5, 20, 50, 200)
S = np.array([[2.0, 0.5], [0.5, 1.0]])


def track(white):
    """Return a track whose innovations are these, colored by the Cholesky factor of S."""
    innovation = white @ np.linalg.cholesky(S).T
    return Track(None, None, innovation, np.broadcast_to(S, (*white.shape, 2)), None, None)


@pytest.fixture
def noise():
    return np.random.default_rng(1).standard_normal((1000, 200, 2))


def test_a_right_filter_raises_about_as_many_alarms_as_promised(noise):
    """At most 1 % in 1000 runs: more than 25 has a probability below 1e-4."""
    for name, alarms in innovation_alarms(track(noise), LOOKS, probability=0.01).items():
        assert alarms.shape == (1000, 4)
        assert alarms.any(axis=-1).sum() <= 25, name
    # The first look of the test on memory comes after ten samples per lag.
    assert not innovation_alarms(track(noise), LOOKS)["whiteness"][:, :2].any()


@pytest.mark.parametrize(
    ("name", "spoil"),
    [
        ("NIS average", lambda w: 1.5 * w),
        ("innovation mean", lambda w: w + 0.5),
        ("whiteness", lambda w: (w[:, 1:] + w[:, :-1]) / np.sqrt(2)),
    ],
)
def test_each_test_finds_what_it_looks_for(noise, name, spoil):
    """Each effect is ten standard errors of its statistic and more after 200 samples."""
    white = spoil(np.concatenate([noise[:20], noise[20:40, :1]], axis=1))[:, :200]
    alarms = innovation_alarms(track(white), (len(white[0]),))
    assert alarms[name].all()


def test_a_mean_of_zero_and_no_memory_hide_from_the_other_tests(noise):
    alarms = innovation_alarms(track(1.5 * noise[:50]), (200,))
    assert alarms["NIS average"].all()
    assert alarms["whiteness"].sum() <= 3  # does not see the size at all: 0.001 each


def test_innovations_that_are_too_small_are_no_alarm(noise):
    assert not innovation_alarms(track(0.5 * noise[:50]), LOOKS)["NIS average"].any()


def test_more_looks_make_each_of_them_stricter(noise):
    one = innovation_alarms(track(1.08 * noise[:300]), (200,))["NIS average"]
    many = innovation_alarms(track(1.08 * noise[:300]), range(20, 201, 20))["NIS average"]
    assert many[:, -1].sum() < one.sum()


def test_the_first_alarm_is_the_first():
    alarms = [[False, True, False], [False, False, False], [True, True, True]]
    assert first_alarm(alarms, (1, 5, 10)).tolist() == [5, np.inf, 1]


def test_what_does_not_fit_is_refused(noise):
    good = track(noise[:2])
    with pytest.raises(ValueError, match="looks must be at most the 200 samples, got 201"):
        innovation_alarms(good, (201,))
    with pytest.raises(ValueError, match="looks"):
        innovation_alarms(good, (0,))
    with pytest.raises(ValueError, match="probability must"):
        innovation_alarms(good, LOOKS, probability=0)
    with pytest.raises(ValueError, match=r"track\.innovation must"):
        innovation_alarms(replace(good, innovation=good.innovation * np.nan), LOOKS)
