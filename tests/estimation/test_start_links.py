"""A start with links: sensors that move, clocks, and times that are not even."""

import numpy as np
import pytest
from scipy.stats import chi2

from dopplerlib import DopplerLinks, RadarArray, crlb, doppler_shift, ml_initialize

BOX = [0.1, -0.75, -0.75, -2, -2, -2], [1.5, 0.75, 0.75, 2, 2, 2]
GLOBE = [-7e6] * 3 + [0] * 3, [7e6] * 3 + [0] * 3


def satellites(rng, times, count=9):
    """Return states (K, count, 6) on circles of 26 560 km, at the speed that gravity leaves."""
    radius = 26_560e3
    rate = np.sqrt(3.986e14 / radius**3)
    u, v = np.moveaxis(np.linalg.qr(rng.standard_normal((count, 3, 2)))[0], -1, 0)
    angle = rate * times[:, None, None]
    place = radius * (u * np.cos(angle) + v * np.sin(angle))
    return np.concatenate([place, radius * rate * (v * np.cos(angle) - u * np.sin(angle))], -1)


@pytest.mark.parametrize(
    ("model", "count"), [("epoch", 1), ("epoch", 6), ("constant", 6), ("drift", 6)]
)
def test_satellites_place_a_receiver_from_anywhere_on_the_globe(model, count):
    """Within the bound, which knows nothing of how clocks are eliminated here."""
    rng = np.random.default_rng(20)
    times = np.cumsum(rng.uniform(0.5, 1.5, count))
    links = DopplerLinks.one_way(
        satellites(rng, times), 0.19, times=times, clocks="common", clock_model=model
    )
    x = np.zeros(links.n)
    x[:3] = 6371e3 * np.linalg.qr(rng.standard_normal((3, 1)))[0][:, 0]
    x[6:] = [800.0, -3.0][: links.n - 6]
    path = links.transition(times - times[0]) @ x
    if model == "epoch":
        path[:, 6] = 800 * rng.standard_normal(count)
        x[6] = path[0, 6]
    z = doppler_shift(path, links) + 0.1 * rng.standard_normal((count, 9))
    z[count // 2, 4] = np.nan
    start = ml_initialize(z, links, 0.1, 1.0, GLOBE)
    assert start.converged and start.identifiable
    clocks = count if model == "epoch" else links.n - 6
    assert start.degrees == 9 * count - 1 - 3 - clocks
    free = np.r_[[True] * 3, [False] * 3, np.ones(links.n - 6, bool)]
    sigma_f = np.where(np.isnan(z), np.nan, 0.1)
    bound = crlb(start.x, links, sigma_f, likelihood="constant_velocity", free=free)
    block = np.ix_(free, free)
    # Two ways to eliminate clocks, and condition numbers of 1e8.
    np.testing.assert_allclose(start.P[block], bound[block], rtol=1e-4, atol=1e-9)
    error = (start.x - x)[free]
    assert error @ np.linalg.solve(bound[block], error) < chi2.isf(1e-6, free.sum())


def test_a_satellite_that_is_wrong_is_found():
    rng = np.random.default_rng(21)
    times = np.arange(8.0)
    links = DopplerLinks.one_way(
        satellites(rng, times), 0.19, times=times, clocks="common", clock_model="epoch"
    )
    path = np.zeros((8, 7))
    path[:, 0], path[:, 6] = 6371e3, 500 * rng.standard_normal(8)
    z = doppler_shift(path, links) + 0.1 * rng.standard_normal((8, 9))
    z[:, 3] += 4.0
    z[2, 7] -= 50.0
    start = ml_initialize(z, links, 0.1, 1.0, GLOBE, loss="bisquare", rng=rng)
    wrong = np.zeros((8, 9), bool)
    wrong[:, 3] = wrong[2, 7] = True
    assert start.converged and ((start.weights == 0) == wrong).all()
    error = start.x[:3] - path[0, :3]
    # The covariance is that of the accepted measurements.
    assert error @ np.linalg.solve(start.P[:3, :3], error) < chi2.isf(1e-6, 3)
    plain = ml_initialize(z, links, 0.1, 1.0, GLOBE)
    assert not plain.converged and np.linalg.norm(plain.x[:3] - path[0, :3]) > 1000


def test_links_that_stand_still_start_as_their_array():
    ring = RadarArray.ring(6, 0.2)
    x = np.array([0.8, 0.1, -0.2, -0.7, 0.2, 0.1])
    states = np.tile(x, (20, 1))
    states[:, :3] += 0.02 * np.arange(20)[:, None] * x[3:]
    z = doppler_shift(states, ring) + 0.4 * np.random.default_rng(22).standard_normal((20, 6))
    one = ml_initialize(z, ring, 0.4, 0.02, BOX)
    other = ml_initialize(z, DopplerLinks.two_way(ring.positions), 0.4, 0.02, BOX)
    # Both end when a step gains 1e-12 of the cost.
    np.testing.assert_allclose(one.x, other.x, atol=1e-5)
    np.testing.assert_allclose(one.P, other.P, rtol=1e-4, atol=1e-9)
    assert one.cost == pytest.approx(other.cost, rel=1e-9)


@pytest.mark.parametrize("clocks", [None, "each"])
def test_radars_on_a_car_find_one_that_comes_towards_it(clocks):
    front = RadarArray([[0, -0.8, 0], [0, 0.8, 0], [0.3, -0.3, 0], [-1, 0.5, 0]])
    rng = np.random.default_rng(23)
    T = rng.uniform(0.03, 0.07, 50)  # times need not be even
    links = DopplerLinks.on_platform(front, [0, 0, 0, 15, 0, 0], clocks=clocks)
    x = np.array([60, 4, 0, -11, 0.5, 0, *20 * rng.standard_normal(links.n - 6)])
    there = links.sampled(50, T)
    z = doppler_shift(links.transition(there.times) @ x, there) + rng.standard_normal((50, 4))
    box = [0, -20, 0, -20, -20, 0], [100, 20, 0, 20, 20, 0]
    first, last = (ml_initialize(z, links, 1.0, T, box, at=at) for at in ("first", "last"))
    free = np.r_[[True, True, False, True, True, False], np.ones(links.n - 6, bool)]
    error = (first.x - x)[free]
    assert first.converged
    assert error @ np.linalg.solve(first.P[free][:, free], error) < chi2.isf(1e-6, free.sum())
    F = links.transition(there.times[-1])
    np.testing.assert_allclose(last.x, F @ first.x, rtol=1e-9)
    np.testing.assert_allclose(last.P, F @ first.P @ F.T, rtol=1e-5, atol=1e-9)


def test_an_array_at_uneven_times_is_the_links_that_stand_still():
    ring = RadarArray.ring(6, 0.2)
    x, T = np.array([0.8, 0.1, -0.2, -0.7, 0.2, 0.1]), np.linspace(0.01, 0.04, 15)
    times = np.append(0, np.cumsum(T[1:]))
    states = np.tile(x, (15, 1))
    states[:, :3] += times[:, None] * x[3:]
    start = ml_initialize(doppler_shift(states, ring), ring, 0.1, T, BOX)
    np.testing.assert_allclose(start.x, x, atol=1e-5)
