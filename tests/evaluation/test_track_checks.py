"""Checks of a track reject as seldom as they say, and name the sensor that is off."""

import numpy as np
import pytest

from dopplerlib import Track
from dopplerlib.chain.track import IqTrack
from dopplerlib.evaluation.track_checks import LIMIT, sensor_checks, track_checks

N, K = 3, 80
S = np.array([[2.0, 0.5, 0.1], [0.5, 1.0, 0.3], [0.1, 0.3, 0.5]])


def of(white, cost=10.0, degrees=10):
    """Return a track with these innovations, colored by the Cholesky factor of S."""
    nu = white @ np.linalg.cholesky(S).T
    x, P = np.zeros((1, K + 1, 6)), np.tile(np.eye(6), (1, K + 1, 1, 1))
    z, time = np.ones((K + 1, N)), np.arange(K + 1.0)
    nis, score = np.nansum(white**2, axis=-1), np.full((1, K + 1), cost)
    cov = np.broadcast_to(S, (1, K, N, N))
    return IqTrack(time, time, z, z, 1, x, P, nu[None], cov, nis[None], 0.0, score, degrees, 0.1)


def failed(found):
    return [check.name for check in track_checks(found) if not check.passed]


def test_a_right_track_fails_as_seldom_as_stated():
    """Five checks at 0.001 in 300 tracks, 1.5 expected: more than 8 have a probability of 3e-5."""
    rng = np.random.default_rng(3)
    count = sum(len(failed(of(rng.standard_normal((K, N))))) for _ in range(300))
    assert LIMIT == 1e-3 and count <= 8


@pytest.mark.parametrize(
    ("spoil", "name"),
    [
        (lambda w: 1.4 * w, "NIS"),
        (lambda w: w + 0.6, "mean"),
        (lambda w: w + 0.9 * np.roll(w, 1, axis=0), "whiteness"),
        (lambda w: w * [1, 1, 2], "sensors"),
    ],
)
def test_what_is_wrong_fails_its_check(spoil, name):
    white = np.random.default_rng(4).standard_normal((K, N))
    assert name in failed(of(spoil(white)))


def test_a_start_that_nothing_explains_fails():
    white = np.random.default_rng(5).standard_normal((K, N))
    assert failed(of(white, cost=50.0)) == ["start"]
    assert "start" in failed(of(white, cost=np.inf))


def test_a_track_without_a_measurement_fails_all_but_its_start():
    checks = track_checks(of(np.full((K, N), np.nan)))
    assert [c.name for c in checks if not c.passed] == ["NIS", "sensors", "mean", "whiteness"]


def test_the_sensor_that_is_off_is_named():
    nu = np.random.default_rng(6).standard_normal((K, N)) * np.sqrt(np.diagonal(S)) * [1, 3, 1]
    nu[:20, 2] = np.nan
    found = sensor_checks(Track(None, None, nu, np.broadcast_to(S, (K, N, N)), None, None))
    assert np.argmax(found.nis) == 1 and found.p_value[1] < 1e-6 < found.p_value[[0, 2]].min()
    np.testing.assert_allclose(found.present, [1, 1, 0.75])
    expected = np.nansum(nu[:, 0]) / np.sqrt(K * S[0, 0])
    assert found.mean[0] == pytest.approx(expected)


def test_several_records_are_refused():
    one = of(np.zeros((K, N)))
    fields = "time available_at shift shift_std used x P innovation S nis".split()
    two = {name: getattr(one, name) for name in fields}
    for name in fields[2:4] + fields[5:]:
        two[name] = np.stack([two[name]] * 2)
    score = np.stack([one.score] * 2)
    both = IqTrack(**two, lag1_autocorrelation=np.zeros(2), score=score, degrees=np.zeros(2),
                   velocity_random_walk=0.1)  # fmt: skip
    with pytest.raises(ValueError, match="found must be of one record"):
        track_checks(both)
