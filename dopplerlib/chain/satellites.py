"""Links from GPS satellites to a receiver on the earth, made at the place where it may be."""

from typing import Annotated

import numpy as np
from scipy.constants import speed_of_light

from .. import _checks
from .._hints import between, checked
from .._typing import ArrayLike, FloatArray
from ..model.broadcast_orbit import EARTH_RATE, satellite_state
from ..model.earth import east_north_up, geodetic
from ..model.links import DopplerLinks
from ..signal.rinex import SatelliteShifts

L1 = 1575.42e6  # Hz, the carrier of GPS that everything listens to
_ZENITH, _SCALE = (
    2.4,
    8000.0,
)  # m: delay of the air above the sea, and height in which it falls to 1/e
_ELSEWHERE = np.array([0, 0, 1e9, 0, 0, 0])  # state that stands for a satellite without elements

_Degrees = Annotated[float, between(0, 90)]


@checked
def satellite_links(
    recording: SatelliteShifts, place: ArrayLike, mask: _Degrees | None = None
) -> tuple[FloatArray, DopplerLinks]:
    """Return Doppler measurements of a receiver, and the links that they belong to.

    Parameters
    ----------
    recording : SatelliteShifts
        What the receiver measured at K epochs of S satellites.
    place : array_like, shape (3,)
        Where the receiver may be, in m in the frame of the earth: light times, terms of second
        order and the air are those of this place. An error of 1000 km costs some 0.05 Hz.
    mask : float, optional
        Least elevation in degrees. Satellites below it are left out, and the delay of the air is
        taken into account. If None, the place is taken to be unknown: all satellites count, and
        there is no air.

    Returns
    -------
    z : ndarray, shape (K, S)
        Measurements in Hz, NaN where there is none: the carrier L1 times the logarithm of received
        over sent frequency.
    links : DopplerLinks
        One-way links with the satellites at the moments of sending, all in the frame of the earth
        at the moment of reception, and one unknown clock anew at each epoch.

    Notes
    -----
    With the unit vector u from satellite to receiver and their velocities v_s, v_r against the
    stars, the received frequency is (1 - u.v_r / c) / (1 - u.v_s / c) times the sent one, and the
    clocks of both ends are factors, too. In the logarithm factors become terms: the receiver's
    clock is exactly common to all satellites, the satellite's is known, the first order is that of
    `doppler_shift`, and ((u.v_s)^2 - (u.v_r)^2) / 2c^2, up to 0.01 Hz, is known well enough.
    u.(v_s - v_r) is the same with velocities against the earth, since what the rotation adds to
    both differs by a vector across u; so the receiver stands still. The delay of the air is 2.4 m
    at the zenith and at the sea, over the sine of elevation (Black and Eisner 1984); it is its
    change with the elevation that shifts the carrier.

    Examples
    --------
    >>> from dopplerlib.signal.rinex import recorded_receiver
    >>> recording, place = recorded_receiver("novatel")
    >>> z, links = satellite_links(recording, place, mask=15)
    >>> z.shape, len(links), links.n
    ((46, 9), 9, 7)
    """
    place = _checks.exact_shape("place", _checks.moderate("place", place, (3,)), (3,))
    elements = recording.orbits.nearest(recording.satellites, recording.times)
    there = ~np.isnan(elements[..., 0])
    flight = 0.075  # s; a wrong one is wrong by a factor of 1e-5 after each round
    for _ in range(3):
        x, _, rate = satellite_state(elements, recording.times[:, None] - flight)
        x = _turned(x, EARTH_RATE * flight)
        line = place - x[..., :3]
        distance = np.linalg.norm(line, axis=-1)
        flight = np.where(there, distance / speed_of_light, flight)
    if not (distance[there] > 0).all():
        raise ValueError(f"place must not be that of a satellite, got {place.tolist()}")
    u = line / distance[..., None]
    sent = _dot(u, x[..., 3:] + _carried(x)) / speed_of_light
    heard = _dot(u, _carried(place)) / speed_of_light
    bias = L1 * (np.log1p(rate) + (sent**2 - heard**2) / 2)
    if np.isnan(recording.doppler).all():
        raise ValueError(
            "recording must have Doppler shifts, got none: take those of its `counted`"
        )
    z = L1 * np.log1p(recording.doppler / L1)
    if mask is not None:
        sine = -_dot(u, east_north_up(place)[2])
        bias -= L1 / speed_of_light * _air_rate(place, x, u, distance, sine)
        there &= sine > np.sin(np.radians(mask))
    z = np.where(there, z, np.nan)
    if np.isnan(z).all():
        raise ValueError(
            "recording must have shifts of satellites with elements for its time and above the "
            f"mask at {place.round(-3).tolist()}, got none: are the signs and the day right?"
        )
    links = DopplerLinks.one_way(
        np.where(np.isnan(x), _ELSEWHERE, x),
        speed_of_light / L1,
        bias=np.where(np.isnan(bias), 0.0, bias),
        clocks="common",
        clock_model="epoch",
        times=recording.times - recording.times[0],
    )
    return z, links


def _turned(x, angle):
    """Return states in axes that have turned about z by an angle."""
    x, c, s = x.copy(), np.cos(angle), np.sin(angle)
    for i in (0, 3):
        x[..., i], x[..., i + 1] = (
            c * x[..., i] + s * x[..., i + 1],
            c * x[..., i + 1] - s * x[..., i],
        )
    return x


def _carried(x):
    """Return the velocity of the earth's frame at positions."""
    return EARTH_RATE * np.stack([-x[..., 1], x[..., 0], 0 * x[..., 0]], axis=-1)


def _dot(u, v):
    return np.sum(u * v, axis=-1)


def _air_rate(place, x, u, distance, sine):
    """Return the rate of the delay of the air in m/s."""
    _, _, height = geodetic(place)
    delay = _ZENITH * np.exp(-np.clip(height, -1e3, 1e5) / _SCALE)
    # The line of sight turns by the part of the velocity across it.
    rising = (x[..., 3:] - u * _dot(u, x[..., 3:])[..., None]) / distance[..., None]
    sine_rate = _dot(rising, east_north_up(place)[2])
    return -delay * 1.001 * sine * sine_rate / (0.002001 + sine**2) ** 1.5
