"""Signs by the law of straight flight are those of the geometry, or none."""

import numpy as np
import pytest
from scipy.optimize import isotonic_regression

from dopplerlib import RadarArray, doppler_shift
from dopplerlib.signal.straight_signs import _falling, straight_signs

ARRAY = RadarArray([[0, 0, 2], [6, 0, 2.2], [6, 5, 2], [0, 5, 2.2], [3, 0, 1.8]])


def flights(rng, runs, samples=40):
    """Return Doppler shifts (runs, samples, 5) of straight flights through a room for 2 s."""
    start, velocity = rng.uniform([1, 1, 1], [5, 4, 1.5], (runs, 3)), rng.normal(size=(runs, 3))
    t = np.linspace(0, 2, samples)[:, None, None]
    path = np.concatenate([start + t * velocity, velocity + 0 * t], axis=-1)
    return np.moveaxis(doppler_shift(path, ARRAY), 0, 1)


def test_costs_are_those_of_isotonic_regression():
    rng = np.random.default_rng(1)
    f, sigma = np.abs(rng.normal(size=30)), rng.uniform(0.5, 2, 30)
    cost = _falling(f, sigma)
    for j in range(1, 31):
        fit = isotonic_regression(f[:j], weights=1 / sigma[:j] ** 2, increasing=False).x
        assert cost[j] == pytest.approx(np.sum(((f[:j] - fit) / sigma[:j]) ** 2), abs=1e-12)


def test_signs_of_straight_flights_are_right_or_unknown():
    """With 0.999, of 10 000 signs 10 may be wrong; more than 40 are less likely than 1e-12."""
    rng = np.random.default_rng(2)
    f = flights(rng, 50)
    noise = 0.5 * rng.standard_normal(f.shape)
    signs = straight_signs(np.abs(f + noise), 0.5)
    known = signs != 0
    assert np.sum((signs != np.sign(f + noise)) & known & (np.abs(f) > 3)) <= 40
    assert known.mean() > 0.9


def test_missing_shifts_count_for_nothing():
    f = flights(np.random.default_rng(3), 3)
    z = np.abs(f)
    z[:, 10:15] = np.nan
    few = straight_signs(z, 0.5)
    rest = np.delete(np.arange(40), np.arange(10, 15))
    np.testing.assert_array_equal(few[:, rest], straight_signs(z[:, rest], 0.5))


def test_head_on_there_is_no_sign():
    """Each of 50 records has one with a probability of less than 1e-6."""
    rng = np.random.default_rng(4)
    f = 40 + 0.5 * rng.standard_normal((50, 30, 1))
    assert not straight_signs(f, 0.5, confidence=1 - 1e-6).any()


def test_what_makes_no_sense_is_refused_by_name():
    with pytest.raises(ValueError, match="sigma_f must be positive"):
        straight_signs(np.ones((3, 2)), 0.0)
    with pytest.raises(ValueError, match=r"sigma_f must have a shape that broadcasts to \(3, 2\)"):
        straight_signs(np.ones((3, 2)), np.ones((4, 2)))
    with pytest.raises(ValueError, match=r"f must have shape \(..., any, any\), got \(3,\)"):
        straight_signs(np.ones(3), 1.0)
