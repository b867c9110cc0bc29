"""Positions, velocities and clocks of GPS satellites from their broadcast elements."""

import numpy as np

from .. import _checks
from .._hints import Positive, checked, shaped
from .._records import record
from .._typing import ArrayLike, FloatArray

# Constants of IS-GPS-200, Table 20-IV and 20.3.3.3.3.1: those that the elements were fitted with.
GRAVITATION = 3.986005e14  # of the earth, m^3/s^2
EARTH_RATE = 7.2921151467e-5  # rad/s
RELATIVITY = -4.442807633e-10  # s/m^(1/2)
WEEK = 604800.0  # s

ELEMENTS = (
    "toc", "af0", "af1", "af2",
    "toe", "sqrt_a", "e", "m0", "delta_n",
    "i0", "i_dot", "omega", "omega0", "omega_dot",
    "cuc", "cus", "crc", "crs", "cic", "cis",
)  # fmt: skip
_TURNS = 20  # of Newton's method for Kepler's equation; four are enough for an orbit of GPS


@record
class BroadcastOrbits:
    """Broadcast elements of GPS satellites.

    Parameters
    ----------
    satellites : sequence of str, length E
        Name of the satellite of each set of elements. One satellite may have several sets.
    elements : array_like, shape (E, 20)
        One set a row: toc, af0, af1, af2, toe, sqrt_a, e, m0, delta_n, i0, i_dot, omega, omega0,
        omega_dot, cuc, cus, crc, crs, cic, cis, in m, s and rad. The two times, of clock and of
        ephemeris, count in s from the start of GPS time, 6 January 1980.

    Raises
    ------
    ValueError
        If there is not one row for each name, a number is not finite, an orbit is no ellipse, or a
        time is before GPS began.

    Examples
    --------
    >>> import numpy as np
    >>> circle = np.zeros(20)
    >>> circle[5] = 5153.6
    >>> BroadcastOrbits(["G01"], [circle]).nearest(["G01", "G02"], [60.0])[..., 5]
    array([[5153.6,    nan]])
    """

    satellites: tuple[str, ...]
    elements: np.ndarray

    def __post_init__(self):
        satellites, elements = _sets(self.satellites, self.elements)
        column = dict(zip(ELEMENTS, elements.T, strict=True))
        for name, wrong, wanted in (
            ("e", (column["e"] < 0) | (column["e"] >= 1), "from 0 up to, not including, 1"),
            ("sqrt_a", column["sqrt_a"] <= 0, "positive"),
            ("toe", column["toe"] < 0, "0 or later"),
        ):
            if wrong.any():
                got = column[name][wrong][0]
                raise ValueError(f"elements must have {name} {wanted}, got {got}")
        return {"satellites": satellites, "elements": elements}

    @checked
    def nearest(
        self, satellites: tuple[str, ...], times: ArrayLike, age: Positive = 7200.0
    ) -> FloatArray:
        """Return for each time and satellite the elements whose reference time is nearest.

        Parameters
        ----------
        satellites : sequence of str, length S
            Names of the satellites.
        times : array_like, shape (K,)
            GPS times in s.
        age : float
            Largest distance in s from the time of ephemeris. GPS fits its elements to the two hours
            before and after it.

        Returns
        -------
        ndarray, shape (K, S, 20)
            NaN where there are none.
        """
        times = _checks.one_row("times", _checks.moderate("times", times))
        known, elements = _sets(self.satellites, self.elements)
        found = np.full((len(times), len(satellites), len(ELEMENTS)), np.nan)
        for s, name in enumerate(satellites):
            mine = elements[[one == name for one in known]]
            if len(mine):
                distance = np.abs(times[:, None] - mine[:, ELEMENTS.index("toe")])
                best = distance.argmin(axis=1)
                near = distance.min(axis=1) <= age
                found[near, s] = mine[best[near]]
        return found


@checked
@_checks.quiet
def satellite_state(elements: ArrayLike, t: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return position and velocity of satellites in the earth's frame, and their clocks.

    Parameters
    ----------
    elements : array_like, shape (..., 20)
        Broadcast elements as in `BroadcastOrbits`; NaN where there are none.
    t : array_like, shape (...)
        GPS times in s at which the signal leaves the satellite.

    Returns
    -------
    x : ndarray, shape (..., 6)
        Position in m and velocity in m/s, both in the frame that turns with the earth: a satellite
        above the equator that keeps its place over the ground has velocity zero.
    clock : ndarray, shape (...)
        How much the satellite's clock is ahead of GPS time in s, for a receiver of one frequency
        without the group delay.
    clock_rate : ndarray, shape (...)
        Its derivative: 1e-9 makes the carrier higher by one part in 1e9.

    Notes
    -----
    IS-GPS-200, 20.3.3.3.3.1 and 20.3.3.4.3: Kepler's ellipse with six harmonic corrections. The
    velocity is the derivative of each formula in turn. The clock's polynomial has the relativistic
    term F e sqrt(A) sin E beside it, whose rate is up to some parts in 1e12.

    Examples
    --------
    A circle in the plane of the equator, of the radius at which satellites seem to stand still:

    >>> elements = [0.0] * 20
    >>> elements[5] = 42164172.0 ** 0.5
    >>> x, clock, clock_rate = satellite_state(elements, 3600.0)
    >>> bool(abs(x[3:]).max() < 1e-3)
    True
    """
    elements = _elements(elements)
    t = _checks.finite("t", t)
    _checks.check_leading(elements=(elements, 1), t=(t, 0))
    (toc, af0, af1, af2, toe, root, e, m0, delta_n, i0, i_dot, omega, omega0, omega_dot,
     cuc, cus, crc, crs, cic, cis) = np.moveaxis(elements, -1, 0)  # fmt: skip
    since = t - toe
    A = root**2
    mean_motion = np.sqrt(GRAVITATION / A**3) + delta_n
    E = _eccentric_anomaly(m0 + mean_motion * since, e)
    E_dot = mean_motion / (1 - e * np.cos(E))
    ratio = np.sqrt(1 - e**2)
    true = np.arctan2(ratio * np.sin(E), np.cos(E) - e)
    true_dot = ratio * E_dot / (1 - e * np.cos(E))

    # Second harmonics of the argument of latitude correct it, the radius and the inclination.
    sin2, cos2 = np.sin(2 * (true + omega)), np.cos(2 * (true + omega))
    u = true + omega + cus * sin2 + cuc * cos2
    r = A * (1 - e * np.cos(E)) + crs * sin2 + crc * cos2
    i = i0 + i_dot * since + cis * sin2 + cic * cos2
    u_dot = true_dot * (1 + 2 * (cus * cos2 - cuc * sin2))
    r_dot = A * e * np.sin(E) * E_dot + 2 * true_dot * (crs * cos2 - crc * sin2)
    tilt = i_dot + 2 * true_dot * (cis * cos2 - cic * sin2)

    p, q = r * np.cos(u), r * np.sin(u)  # in the plane of the orbit, p to its ascending node
    p_dot, q_dot = r_dot * np.cos(u) - q * u_dot, r_dot * np.sin(u) + p * u_dot
    turning = omega_dot - EARTH_RATE
    node = omega0 + turning * since - EARTH_RATE * (toe % WEEK)
    level, height = q * np.cos(i), q * np.sin(i)
    level_dot = q_dot * np.cos(i) - height * tilt
    height_dot = q_dot * np.sin(i) + level * tilt
    c, s = np.cos(node), np.sin(node)
    x, y = p * c - level * s, p * s + level * c
    v_x = p_dot * c - level_dot * s - turning * y
    v_y = p_dot * s + level_dot * c + turning * x
    state = np.stack(np.broadcast_arrays(x, y, height, v_x, v_y, height_dot), axis=-1)

    since = t - toc
    bend = RELATIVITY * e * root
    clock = af0 + (af1 + af2 * since) * since + bend * np.sin(E)
    clock_rate = af1 + 2 * af2 * since + bend * np.cos(E) * E_dot
    there = ~np.isnan(np.broadcast_to(elements[..., 0], clock.shape))
    for result in (state, clock, clock_rate):
        _checks.estimates("elements, t", result[there])
    return state, clock, clock_rate


def _sets(satellites, elements):
    """Return names and a copy of the elements, or raise unless each name has a row."""
    satellites = tuple(_checks.iterable("satellites", satellites, "satellite names"))
    for name in satellites:
        _checks.text("satellites", name)
    elements = _checks.moderate("elements", elements, (len(ELEMENTS),)).copy()
    shape = (len(satellites), len(ELEMENTS))
    return satellites, _checks.exact_shape("elements", elements, shape)


def _elements(elements):
    """Return elements as floats; where one of a set is missing, all of it is."""
    elements = _checks.measured("elements", elements, (len(ELEMENTS),))
    gone = np.isnan(elements).any(axis=-1, keepdims=True)
    shaped(len(ELEMENTS))("elements", np.where(gone, 0.0, elements))
    return np.where(gone, np.nan, elements)


def _eccentric_anomaly(M, e):
    """Return E of Kepler's equation E - e sin E = M by Newton's method."""
    E = M + e * np.sin(M)
    for _ in range(_TURNS):
        step = (E - e * np.sin(E) - M) / (1 - e * np.cos(E))
        E = E - step
        if not (np.abs(step) > 1e-14).any():
            break
    return E
