"""Doppler shifts of GPS satellites, read from RINEX, the common text format of receivers."""

import os
from collections.abc import Iterable
from dataclasses import replace
from typing import Literal

import numpy as np

from .. import _checks
from .._data import data, on_disk, read_toml
from .._hints import Count, Index, checked
from .._records import record
from .._typing import FloatArray
from ..model.broadcast_orbit import BroadcastOrbits
from ._rinex import navigated, observed

_COLUMNS = ("doppler", "cn0", "pseudorange", "count")  # fields of shape (K, S)


@record
class SatelliteShifts:
    """Doppler shifts of GPS satellites at one receiver, and what their orbits are made from.

    Attributes
    ----------
    satellites : tuple of str, length S
        Names: G01 ... G32.
    times : ndarray, shape (K,)
        Times of the epochs by the receiver's clock, in s since GPS time began, 6 January 1980.
    doppler : ndarray, shape (K, S)
        Shift of the carrier L1 in Hz, positive when satellite and receiver approach; NaN where
        there is none.
    cn0 : ndarray, shape (K, S)
        Carrier power over noise density in dB-Hz; NaN where the receiver does not tell it.
    pseudorange : ndarray, shape (K, S)
        Range by the code in m, the receiver's clock in it; NaN where there is none.
    count : ndarray, shape (K, S)
        Cycles of Doppler shift counted since the epoch before, which is the integral of the shift;
        NaN where the receiver lost count.
    orbits : BroadcastOrbits
        Broadcast elements.
    position : ndarray, shape (3,)
        What the file says of the receiver's place, in m in the frame of the earth; NaN if nothing.

    Raises
    ------
    ValueError
        If the shapes do not suit each other, a satellite occurs twice, the times do not increase,
        or there are neither shifts nor counts.
    """

    satellites: tuple[str, ...]
    times: np.ndarray
    doppler: np.ndarray
    cn0: np.ndarray
    pseudorange: np.ndarray
    count: np.ndarray
    orbits: BroadcastOrbits
    position: np.ndarray

    def __post_init__(self):
        satellites = tuple(_checks.iterable("satellites", self.satellites, "satellite names"))
        for name in satellites:
            _checks.text("satellites", name)
        if len(set(satellites)) < len(satellites):
            raise ValueError(f"satellites must differ from one another, got {satellites}")
        times = _checks.one_row("times", _checks.moderate("times", self.times))
        if (np.diff(times) <= 0).any():
            raise ValueError("times must increase, got two that do not")
        fields = {"satellites": satellites, "times": times}
        shape = (len(times), len(satellites))
        for name in _COLUMNS:
            values = _checks.measured(name, getattr(self, name), shape)
            fields[name] = _checks.exact_shape(name, values, shape)
        if np.isnan(fields["doppler"]).all() and np.isnan(fields["count"]).all():
            raise ValueError("doppler must hold a shift if there is no count, got none")
        _checks.instance("orbits", self.orbits, BroadcastOrbits)
        position = _checks.measured("position", self.position, (3,))
        return fields | {"position": _checks.exact_shape("position", position, (3,))}

    @checked
    def part(self, first: Index, count: Count) -> "SatelliteShifts":
        """Return a number of epochs from one of them on.

        Parameters
        ----------
        first, count : int
            The first epoch, from 0 on, and their number.

        Examples
        --------
        >>> len(recorded_receiver("novatel")[0].part(10, 5).times)
        5
        """
        if first >= len(self.times):
            raise ValueError(f"first must be below {len(self.times)}, the epochs, got {first}")
        rows = slice(first, first + count)
        return replace(self, **{name: getattr(self, name)[rows] for name in ("times", *_COLUMNS)})

    @checked
    def without(self, satellites: Iterable[str]) -> "SatelliteShifts":
        """Return the recording as if some satellites had not been heard.

        Parameters
        ----------
        satellites : collection of str
            Their names.

        Examples
        --------
        >>> len(recorded_receiver("novatel")[0].without(["G03", "G22"]).satellites)
        7
        """
        gone = _checks.some_of("satellites", satellites, self.satellites)
        kept = [name not in gone for name in self.satellites]
        names = tuple(name for name in self.satellites if name not in gone)
        columns = {name: getattr(self, name)[:, kept] for name in _COLUMNS}
        return replace(self, satellites=names, **columns)

    @checked
    def counted(self, epochs: Count = 1) -> "SatelliteShifts":
        """Return the mean shifts over parts of the recording by the cycles counted in them.

        Parameters
        ----------
        epochs : int
            Intervals between epochs that a part has.

        Returns
        -------
        SatelliteShifts
            Each epoch is in the middle of a part; parts follow on. Where the receiver lost count
            there is no shift. The mean is that in the middle to 0.1 mm/s in parts of 10 s, and to
            a hundred times that in parts of 100 s.

        Examples
        --------
        >>> recorded_receiver("novatel")[0].counted(5).doppler.shape
        (9, 9)
        """
        parts = (len(self.times) - 1) // epochs
        if not parts:
            most = len(self.times) - 1
            raise ValueError(
                f"epochs must be at most {most}, the intervals there are, got {epochs}"
            )
        ends = np.arange(parts + 1) * epochs
        cycles = self.count[1 : ends[-1] + 1].reshape(parts, epochs, -1).sum(axis=1)
        cn0 = self.cn0[1 : ends[-1] + 1].reshape(parts, epochs, -1).mean(axis=1)
        blank = np.full_like(cycles, np.nan)
        return replace(
            self,
            times=(self.times[ends[1:]] + self.times[ends[:-1]]) / 2,
            doppler=cycles / np.diff(self.times[ends])[:, None],
            cn0=cn0,
            pseudorange=blank,
            count=blank,
        )


def read_rinex(
    observations: str | os.PathLike[str], navigation: str | os.PathLike[str]
) -> SatelliteShifts:
    """Read the Doppler shifts of GPS satellites and their broadcast elements.

    Parameters
    ----------
    observations : path-like
        RINEX observation file of version 2, 3 or 4, as plain text. Of GPS the signal on L1 is
        read, the one with the code C/A if there are several; other systems are left out. Of a
        file with phases alone take `SatelliteShifts.counted`.
    navigation : path-like
        RINEX navigation file of the same hours. Elements that a satellite marks as unhealthy are
        left out.

    Returns
    -------
    SatelliteShifts
        Satellites without elements are in it, too.

    Raises
    ------
    ValueError
        If a file cannot be read, is no RINEX file of its kind and of these versions, is compressed
        or cut off, has another time than that of GPS; or if it holds neither Doppler shifts nor
        phases, or no elements, of GPS satellites.

    Notes
    -----
    International GNSS Service, RINEX 2.11, 3.02 and 4.00. A converter as `convbin` of RTKLIB makes
    such files of the logs of most receivers.
    """
    satellites, times, values, position = observed("observations", observations)
    names, elements = navigated("navigation", navigation)
    if not names:
        raise ValueError(
            "navigation must hold elements of healthy GPS satellites, got none in "
            f"{str(navigation)!r}"
        )
    orbits = BroadcastOrbits(names, np.array(elements))
    doppler, cn0, pseudorange, count = np.moveaxis(values, -1, 0)
    return SatelliteShifts(satellites, times, doppler, cn0, pseudorange, count, orbits, position)


@checked
def recorded_receiver(
    name: Literal["ublox", "novatel", "javad"],
) -> tuple[SatelliteShifts, FloatArray]:
    """Return the recording of a receiver that stood still, and where it stood by its code ranges.

    Parameters
    ----------
    name : {"ublox", "novatel", "javad"}
        Maker of the receiver: 237 s of 2008, 46 s of 2009, or 130 s of 2011.

    Returns
    -------
    recording : SatelliteShifts
        One epoch a second. What the last of them says of its place is wrong.
    position : ndarray, shape (3,)
        Place in m by another program from code ranges, good to some 5 m along each axis.

    Notes
    -----
    Logs of RTKLIB, see ``data/gnss``.

    Examples
    --------
    >>> recording, position = recorded_receiver("novatel")
    >>> recording.doppler.shape
    (46, 9)
    """
    names = f"{name}.obs", f"{name}.nav"
    with on_disk(data("gnss"), *names) as folder:
        recording = read_rinex(*(folder / one for one in names))
    return recording, np.array(read_toml("gnss", "reference.toml")[name]["position"])
