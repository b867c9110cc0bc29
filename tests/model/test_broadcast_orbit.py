"""Orbits are those of RTKLIB, obey Kepler's laws, and lie where the code ranges put them."""

import numpy as np
import pytest
from scipy.constants import speed_of_light

from dopplerlib.model.broadcast_orbit import (
    EARTH_RATE,
    ELEMENTS,
    GRAVITATION,
    WEEK,
    BroadcastOrbits,
    satellite_state,
)
from dopplerlib.signal.rinex import recorded_receiver

RECEIVERS = ("ublox", "novatel", "javad")
# Time of sending in s of the day, place in m and clock in ns, as the trace of RTKLIB 2.4.3 b34 has
# them for the first epoch of each file.
RTKLIB = {
    "ublox": [
        ("G05", 21569.931041, -20942678.153, 14804830.429, 6333993.541, 781366.882),
        ("G09", 21569.930606, -14600175.520, 1915317.049, 21480774.542, 126151.532),
        ("G26", 21569.914883, -24648190.330, -10671649.543, -820131.191, 261028.277),
    ],
    "novatel": [
        ("G03", 83219.932084, -13911594.751, 7661801.693, 20917969.926, 489803.552),
        ("G08", 83219.917523, 11730165.190, 9025200.950, 22069560.351, 1083.113),
        ("G22", 83219.917512, -22765978.521, -12300275.551, 6325503.318, 183707.278),
    ],
    "javad": [
        ("G02", 8802.918370, 10054434.201, 21609670.091, 12216489.952, 314746.676),
        ("G17", 8802.932953, -17247711.177, 14533240.436, 13963457.510, 181689.124),
        ("G32", 8802.916678, -10215011.358, -14345344.413, 20294702.510, -175275.551),
    ],
}


def elements_of(recording):
    """Return the elements of all satellites at the first epoch."""
    return recording.orbits.nearest(recording.satellites, recording.times[:1])[0]


@pytest.mark.parametrize("name", RECEIVERS)
def test_satellites_are_where_another_program_has_them(name):
    """It tells the time to 1 us, in which a satellite moves 4 mm, and the clock to 1 ps."""
    recording, _ = recorded_receiver(name)
    day = recording.times[0] // 86400 * 86400
    for satellite, sent, *place, nanoseconds in RTKLIB[name]:
        x, clock, _ = satellite_state(
            elements_of(recording)[recording.satellites.index(satellite)], day + sent
        )
        np.testing.assert_allclose(x[:3], place, rtol=0, atol=0.004)
        assert clock * 1e9 == pytest.approx(nanoseconds, abs=0.002)


@pytest.mark.parametrize("name", RECEIVERS)
def test_code_ranges_agree_with_orbits_and_clocks(name):
    """What is left are the receiver's clock, noise, and 2 to 20 m of atmosphere: 10 m rms."""
    recording, place = recorded_receiver(name)
    elements, times = elements_of(recording), recording.times[:1, None] - 0.075
    for _ in range(3):
        x, clock, _ = satellite_state(elements, times)
        angle = EARTH_RATE * (recording.times[0] - times[0])  # of the earth, while it is under way
        c, s = np.cos(angle), np.sin(angle)
        x = np.moveaxis(x[0], -1, 0)
        turned = np.stack([c * x[0] + s * x[1], c * x[1] - s * x[0], x[2]], axis=-1)
        distance = np.linalg.norm(turned - place, axis=-1)
        times = recording.times[:1, None] - distance / speed_of_light
    left = recording.pseudorange[0] - distance + speed_of_light * clock[0]
    assert np.std(left) < 10


def test_the_velocity_and_the_clock_s_rate_are_derivatives():
    """Central differences over 2 s err by (1 s)^2 / 6 of the third derivative, some 1e-4 m/s^3."""
    for name in RECEIVERS:
        recording, _ = recorded_receiver(name)
        elements, t = elements_of(recording), recording.times[0]
        (before, early, _), (after, late, _) = (satellite_state(elements, t + s) for s in (-1, 1))
        x, _, rate = satellite_state(elements, t)
        difference = (after[:, :3] - before[:, :3]) / 2
        # Places of 2e7 m are rounded to 4e-9 m.
        np.testing.assert_allclose(x[:, 3:], difference, rtol=0, atol=5e-5)
        np.testing.assert_allclose(rate, (late - early) / 2, rtol=0, atol=2e-18)


def test_without_corrections_energy_and_angular_momentum_stay():
    """The two-body problem, in the frame that does not turn."""
    elements = np.zeros(len(ELEMENTS))
    chosen = {"sqrt_a": 5153.6, "e": 0.02, "i0": 0.96, "omega": 0.5, "omega0": 1.2, "m0": -0.7}
    for key, value in chosen.items():
        elements[ELEMENTS.index(key)] = value
    x, _, _ = satellite_state(elements, np.linspace(0, 7200, 25))
    r, v = x[:, :3], x[:, 3:] + np.cross([0, 0, EARTH_RATE], x[:, :3])
    energy = (v**2).sum(-1) / 2 - GRAVITATION / np.linalg.norm(r, axis=-1)
    np.testing.assert_allclose(energy, -GRAVITATION / (2 * 5153.6**2), rtol=1e-13)
    momentum = np.linalg.norm(np.cross(r, v), axis=-1)
    expected = np.sqrt(GRAVITATION * (1 - 0.02**2)) * 5153.6
    np.testing.assert_allclose(momentum, expected, rtol=1e-13)


def test_two_sets_of_one_satellite_agree_between_their_times():
    """An hour from both, fits of four hours each: to meters, and to a millimeter a second."""
    orbits = recorded_receiver("ublox")[0].orbits
    for satellite in set(orbits.satellites):
        both = orbits.elements[[name == satellite for name in orbits.satellites]]
        assert len(both) == 2
        t = both[:, ELEMENTS.index("toe")].mean()
        (one, other), clock, _ = satellite_state(both, t)
        assert np.linalg.norm(one[:3] - other[:3]) < 5
        assert np.linalg.norm(one[3:] - other[3:]) < 1e-3
        assert abs(np.diff(clock)) * speed_of_light < 5


def test_the_nearest_elements_are_taken_and_old_ones_are_not():
    rows = np.zeros((2, len(ELEMENTS)))
    rows[:, ELEMENTS.index("toe")] = WEEK, WEEK + 7200
    rows[:, ELEMENTS.index("sqrt_a")] = 1, 2
    orbits = BroadcastOrbits(["G07", "G07"], rows)
    found = orbits.nearest(["G07", "G08"], WEEK + np.array([-8000, 0, 3500, 3700, 20000]))
    root = found[..., ELEMENTS.index("sqrt_a")]
    np.testing.assert_array_equal(root[:, 0], [np.nan, 1, 1, 2, np.nan])
    assert np.isnan(root[:, 1]).all()
    x, clock, _ = satellite_state(found, 0.0)
    assert np.isnan(x[0]).all() and np.isnan(clock[0]).all() and np.isfinite(x[1, 0]).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [({"e": 1.0}, "e from 0"), ({"sqrt_a": 0.0}, "sqrt_a positive"), ({"toe": -1.0}, "toe 0 or")],
)
def test_what_is_no_orbit_is_refused(change, message):
    row = np.ones(len(ELEMENTS)) * 0.5
    for key, value in change.items():
        row[ELEMENTS.index(key)] = value
    with pytest.raises(ValueError, match=f"elements must have {message}"):
        BroadcastOrbits(["G01"], [row])
    with pytest.raises(ValueError, match=r"elements must have shape \(1, 20\)"):
        BroadcastOrbits(["G01"], np.zeros((2, len(ELEMENTS))))
