"""Ridges on a simulated road: vehicles of many points, colored noise, a steady line, no Q.

What a vehicle is, and where, is known: the curve of its middle. Seeds are not chosen.
"""

import numpy as np
import pytest
from scipy.signal import lfilter

from dopplerlib import TrackManager
from dopplerlib.chain.ridges import Ridge, follow_ridges
from dopplerlib.signal.detections import Detections
from dopplerlib.signal.noise_spectrum import noise_spectrum
from dopplerlib.signal.peak_detection import detect_peaks

FS, LENGTH, WAVELENGTH, WINDOW = 6000.0, 12.0, 0.0125, 384
HOP = WINDOW // 4
QUIET = 2.0  # s without a vehicle at the beginning
TIME = np.arange(int(FS * LENGTH)) / FS
MOTION = {"chirp": 12e3, "chirp_walk": 160.0, "turn_rate": 7.5, "passage": 0.2}


def passing(time, speed, distance, moment):
    """Return range and Doppler shift of a point that passes at a moment."""
    along = speed * (time - moment)
    r = np.hypot(along, distance)
    return r, -2 / WAVELENGTH * speed * along / r


def vehicle(rng, speed, distance, moment, begin, end, points=12):
    """Return the samples of a body of 3 m with points of random size and phase; it fades in."""
    x = np.zeros(len(TIME))
    place = rng.uniform(-1.5, 1.5, points) / speed
    for later, size, phase in zip(
        place, rng.rayleigh(1.0, points), rng.uniform(0, 2 * np.pi, points), strict=True
    ):
        r, _ = passing(TIME, speed, distance, moment + later)
        x += size * (distance / r) ** 0.7 * np.cos(4 * np.pi / WAVELENGTH * r + phase)
    edge = np.clip(np.minimum(TIME - begin, end - TIME) / 0.2, 0, 1)
    return x * edge


def road(rng, *vehicles):
    """Return samples in noise that falls by 30 dB up to 200 Hz, with a steady line at 2064 Hz."""
    white = rng.standard_normal(len(TIME))
    slow = lfilter([1.0], [1.0, -0.97], rng.standard_normal(len(TIME)))
    line = 0.2 * np.cos(2 * np.pi * 2064.0 * TIME)
    return 0.3 * (white + slow + line) + sum(vehicle(rng, *one) for one in vehicles)


def followed(x):
    """Return noise, detections and ridges; noise is measured where no target is."""
    settings = {"band": (150, 2800), "false_alarm": 1e-2, "extent": 150.0}
    first = detect_peaks(x, FS, WINDOW, HOP, noise=noise_spectrum(x, FS, WINDOW), **settings)
    noise = noise_spectrum(x, FS, WINDOW, HOP, without=first)
    found = detect_peaks(x, FS, WINDOW, HOP, noise=noise, **settings)
    return noise, found, follow_ridges(found, **MOTION)


def near(ridges, *motion):
    """Return the ridge with the most windows within 60 Hz of the curve of a motion."""
    off = [np.abs(r.frequency) - np.abs(passing(r.time, *motion)[1]) for r in ridges]
    return ridges[int(np.argmax([np.sum(np.abs(one) < 60) for one in off]))]


@pytest.fixture(scope="module")
def vehicles():
    """A car that has passed and goes away, and a slower one that comes later."""
    cars = (14.0, 4.0, 2.6, QUIET, 9.0), (12.5, 3.5, 9.5, 4.0, 11.0)
    return cars, followed(road(np.random.default_rng(1), *cars))


def test_the_line_is_found_and_the_quiet_beginning_has_no_ridge(vehicles):
    _, (noise, found, ridges) = vehicles
    assert np.abs(noise.lines()[0] - 2064.0).min() < FS / WINDOW
    quiet = found.time + WINDOW / FS / 2 < QUIET
    assert found.detected[quiet].mean() < 0.05  # overlapping windows of a hundredth each
    assert all(r.time[0] > QUIET - WINDOW / FS for r in ridges)
    assert found.detected[(found.time > 3) & (found.time < 9)].mean() > 0.9


def test_the_deviation_is_that_about_the_true_curve(vehicles):
    """Within 1.5, steady or not, where the bound of a pure tone is ten times too good."""
    cars, (_, _, ridges) = vehicles
    for speed, distance, moment, _, _ in cars:
        ridge = near(ridges, speed, distance, moment)
        z, std = (v[:, 0] for v in ridge.measurements())
        curve = passing(ridge.time, speed, distance, moment)[1]
        ratio = (np.abs(z) - np.abs(curve)) / std
        away = np.abs(ridge.time - moment)
        for some in (away < 1.5, away > 1.5):
            seen = np.sqrt(np.nanmean(ratio[some] ** 2))
            assert 1 / 1.5 < seen < 1.5
        assert np.nanmedian(std[away < 1.5] / ridge.bound[away < 1.5]) > 10


def test_two_vehicles_that_cross_keep_their_ridges():
    """Five crossings; nine of ten windows are detected, one peak where they are one."""
    rng = np.random.default_rng(2)
    time = np.arange(250) * HOP / FS
    for _ in range(5):
        moments, speeds = rng.uniform(-2, -1, 2), rng.uniform(10, 14, 2)
        speeds[1] += 2.0
        curves = np.stack(
            [passing(time, v, 4.0, t)[1] for v, t in zip(speeds, (moments[0], 5.0), strict=True)]
        )
        f = np.abs(curves) + rng.standard_normal(curves.shape)
        one = np.abs(f[0] - f[1]) < 2 * FS / WINDOW
        f[rng.random(f.shape) < 0.1] = np.nan
        f[1, one] = np.nan
        found = Detections(
            time, np.ones(250, bool), f.T, np.where(np.isnan(f.T), np.nan, 0.1), WINDOW, HOP, FS
        )
        ridges = follow_ridges(found, **MOTION)
        ends = sorted(ridges, key=lambda r: len(r.time))[-2:]
        for curve in np.abs(curves):
            (mine,) = [r for r in ends if abs(r.frequency[0] - curve[0]) < 40]
            assert abs(mine.frequency[-1] - curve[-1]) < 40


def test_a_pure_tone_passes_the_test_of_its_bound_and_a_vehicle_does_not(vehicles):
    _, (_, _, ridges) = vehicles
    long = [r for r in ridges if len(r.time) > 100]
    assert max(r.bound_test().p_value for r in long) < 1e-6
    rng = np.random.default_rng(2)
    x = np.cos(2 * np.pi * (700 * TIME + 10 * TIME**2)) + rng.standard_normal(len(TIME))
    found = detect_peaks(x, FS, WINDOW, HOP)
    ridge = max(follow_ridges(found, **MOTION), key=lambda r: len(r.time))
    assert ridge.bound_test().p_value > 1e-6
    assert np.isfinite(ridge.frequency).mean() > 0.99


def test_without_signs_a_ridge_goes_through_zero_and_changes_its_own():
    f = np.linspace(200, -200, 300)
    shape = (300, 1)
    found = Detections(
        np.arange(300) * 0.01, np.ones(300, bool), np.abs(f).reshape(shape), np.ones(shape),
        WINDOW, 60, FS, signed=False,
    )  # fmt: skip
    (ridge,) = follow_ridges(found, chirp=1000.0, chirp_walk=10.0, turn_rate=0.1)
    np.testing.assert_allclose(np.where(np.abs(f) > 10, ridge.frequency - f, 0), 0, atol=1e-9)


def test_a_ridge_that_is_lost_ends_and_what_follows_is_another():
    K = 400
    f = np.full((K, 1), 500.0)
    f[100:300] = np.nan
    found = Detections(
        np.arange(K) * 0.01, np.ones(K, bool), f, np.where(np.isnan(f), np.nan, 1.0),
        WINDOW, 60, FS,
    )  # fmt: skip
    manager = TrackManager(3, 6, K)
    ends = [
        [
            (r.time[0], r.time[-1])
            for r in follow_ridges(found, **(MOTION | {"chirp_walk": w}), manager=manager)
        ]
        for w in (1e-3, 300.0)
    ]
    assert len(ends[0]) == 1 and len(ends[1]) == 2
    assert ends[1][0][1] == pytest.approx(0.99)


def test_parts_of_a_vehicle_and_ridges_too_short_are_left_out():
    """Beside a steep curve: another part of the body, a vehicle of its own, and a short one."""
    time = np.arange(200) * HOP / FS
    curve = 500 + 600 * time
    others = curve + 100, curve + 700, np.where(np.arange(200) < 15, 2500.0, np.nan)
    f = np.stack([curve, *others], axis=-1)
    f[150:, 1] = np.nan
    found = Detections(
        time, np.ones(200, bool), f, np.where(np.isnan(f), np.nan, 1.0), WINDOW, HOP, FS
    )
    for passage, left in ((0.05, [0, 1, 2]), (0.2, [0, 2])):
        ridges = follow_ridges(found, **(MOTION | {"passage": passage}))
        begun = sorted(ridge.frequency[0] for ridge in ridges)
        np.testing.assert_allclose(begun, f[0, left])


def test_a_ridge_is_checked_and_a_record_that_is_not_there_is_refused():
    one = np.ones(2)
    with pytest.raises(ValueError, match="std must have shape"):
        Ridge(one, one, np.ones(3), one, WINDOW, HOP, "hann")
    found = Detections(one, one > 0, one[:, None], one[:, None], WINDOW, HOP, FS)
    with pytest.raises(ValueError, match="run must be less than the 1 records"):
        follow_ridges(found, **MOTION, run=1)
