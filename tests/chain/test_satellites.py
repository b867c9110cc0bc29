"""Links to satellites are exact: beside a simulation of light, in the frame of the stars."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.constants import speed_of_light as c

from dopplerlib.chain.satellites import L1, satellite_links
from dopplerlib.model.broadcast_orbit import EARTH_RATE, satellite_state
from dopplerlib.model.doppler import doppler_shift
from dopplerlib.signal.rinex import recorded_receiver


def inertial(position, t):
    """Positions (..., 3) of the earth's frame in axes that do not turn, which agree at t = 0."""
    cos, sin = np.cos(EARTH_RATE * t), np.sin(EARTH_RATE * t)
    x, y, z = np.moveaxis(position, -1, 0)
    return np.stack([x * cos - y * sin, x * sin + y * cos, z + 0 * cos], axis=-1)


def emitted(elements, place, t, start, air=None):
    """Return what the satellites' clocks showed when light left that arrives at `start` + t.

    `air` gives the delay in m for sines of elevation. Times are relative to `start`.
    """
    flight = np.full(len(elements), 0.075)
    for _ in range(6):
        x, clock, _ = satellite_state(elements, start + (t - flight))
        line = inertial(x[:, :3], t - flight) - inertial(place, np.array(t))
        distance = np.linalg.norm(line, axis=-1)
        up = inertial(place, np.array(t)) / np.linalg.norm(place)
        extra = 0.0 if air is None else air(line @ up / distance)
        flight = (distance + extra) / c
    return t - flight + clock


def received(recording, place, drift, air=None):
    """Return Doppler shifts (1, S) by differences over 2 s of the clocks' readings.

    The receiver's clock runs fast by `drift`, a part of one. The third derivative of a range is
    below 1e-4 m/s^3, so that a difference is off by 2e-5 m/s or 1e-4 Hz.
    """
    start = recording.times[0]
    elements = recording.orbits.nearest(recording.satellites, [start])[0]
    sent = np.subtract(*(emitted(elements, place, t, start, air) for t in (1.0, -1.0))) / 2
    return (L1 * sent / (1 + drift) - L1)[None]


@pytest.mark.parametrize("drift", [0.0, 1e-6, -3e-5])
@pytest.mark.parametrize("name", ["ublox", "javad"])
def test_the_measurement_is_the_first_order_shift_and_one_clock(name, drift):
    """Light time, rotation of the earth, both clocks, second order: 2e-4 Hz are 0.04 mm/s."""
    recording, place = recorded_receiver(name)
    recording = recording.part(0, 1)
    recording = replace(recording, doppler=received(recording, place, drift))
    z, links = satellite_links(recording, place)
    state = np.r_[place, np.zeros(3), 0.0]
    left = (z - doppler_shift(state[None], links))[0]
    np.testing.assert_allclose(left, -L1 * np.log1p(drift), rtol=0, atol=2e-4)
    # Without the terms of second order, or with plain Doppler shifts, it would not be: 5 mHz.
    assert np.ptp(recording.doppler - doppler_shift(state[None], replace(links, bias=0))) > 5e-3


def test_the_air_is_a_delay_that_changes_with_elevation():
    """Beside the difference of delays over 2 s; up is not quite away from the earth's center."""
    recording, place = recorded_receiver("javad")
    recording = recording.part(0, 1)

    def air(sine):
        return 2.4 * np.exp(-100 / 8000) * 1.001 / np.sqrt(0.002001 + sine**2)

    recording = replace(recording, doppler=received(recording, place, 0.0, air))
    state = np.r_[place, np.zeros(3), 0.0]
    for mask, least, most in ((None, 0.02, 0.1), (1.0, 0.0, 2e-3)):
        z, links = satellite_links(recording, place, mask)
        left = z - doppler_shift(state[None], links)
        assert least < np.nanmax(np.abs(left)) < most


def test_a_mask_leaves_low_satellites_out_and_a_missing_orbit_too():
    recording, place = recorded_receiver("javad")
    recording = recording.part(0, 1)
    z, _ = satellite_links(recording, place, 20.0)
    # Elevations by RTKLIB's solution status of the first epoch, in degrees.
    low = {"G02", "G11", "G12", "G24", "G28", "G32"}
    assert {s for s, v in zip(recording.satellites, z[0], strict=True) if np.isnan(v)} == low
    keep = [name != "G17" for name in recording.orbits.satellites]
    names = tuple(np.array(recording.orbits.satellites)[keep])
    orbits = replace(recording.orbits, satellites=names, elements=recording.orbits.elements[keep])
    z, links = satellite_links(replace(recording, orbits=orbits), place)
    assert np.isnan(z[0]).tolist() == [name == "G17" for name in recording.satellites]
    assert np.isfinite(links.receivers).all()


def test_where_no_satellite_is_seen_it_says_so():
    recording, place = recorded_receiver("novatel")
    with pytest.raises(ValueError, match="recording must have shifts of satellites with elements"):
        satellite_links(recording, -place, 30.0)
    late = replace(recording, times=recording.times + 1e5)
    with pytest.raises(ValueError, match="recording must have shifts of satellites with elements"):
        satellite_links(late, place)
