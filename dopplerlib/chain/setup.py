"""Setup of an own array, from a file, and the steps from its recording to a track."""

import pathlib
import re
import tomllib
from collections.abc import Iterable
from dataclasses import replace
from os import PathLike
from typing import Annotated, Literal

from .. import _checks, _toml
from .._hints import AboveZero, Count, Positive, Real, checked, exactly
from .._records import record
from .._typing import ArrayLike, FileSource, FloatArray
from ..model.radar_array import RadarArray
from ..signal.real_tone import ml_frequency_real
from ..signal.recording import Recording, read_npy, read_sigmf, read_wav
from ._box import bounds
from .baseband import Baseband
from .track import IqTrack, track_iq

Path = str | PathLike[str]
# A file with all entries; an error about one that is missing shows its line.
EXAMPLE = """\
# An array, the place before it, and how it is watched. In m, s, Hz, m/s.

[array]
carrier = 10.525e9            # Hz; or wavelength, in m
positions = [                 # m, in the order of the channels
  [0, 0.5, 1], [0, 1.5, 2], [0, 2.5, 1], [0, 3.5, 2], [0, 4.5, 1],
]

[target]
lower = [0, 0, 1.2]           # m: corners of the box of the target at first;
upper = [6, 5, 1.2]           # what is equal is known, here the height
speed_limit = 2.5             # m/s
velocity_random_walk = 0.01   # m/s: wandering of each velocity in 1 s

[tracker]
window = 0.05                 # s: the shift changes by < 1 / window in it
start = 0.5                   # s that the first estimate takes
hop = 0.05                    # s from window to window; else a window
noise = "horizontal"          # x and y wander; "per_axis": z, too
# lines = [50, 100]           # Hz: hum to remove; 0: a drifting constant
# dc_until = 0.2              # s: of so much the mean is DC; else of all

[recording]                   # what a file may not state, with defaults
layout = "iq"                 # or "qi" (Q first), or "real" (without Q)
delay = 0.0                   # s: of all filters before the converter
factor = 4                    # one sample in so many, behind a low-pass
fs = 4000                     # Hz: of .npy, which cannot state it

[alarm]                       # if there is to be one
point = [0, 2.5, 1.2]         # m: what must not be reached
distance = 2.5                # m: nearer to it is too near
"""
# Tables, and which of their entries must be there.
_TABLES = {
    "array": ("positions",),
    "target": ("lower", "upper", "speed_limit", "velocity_random_walk"),
    "tracker": ("window", "start"),
    "recording": (),
    "alarm": ("point", "distance"),
}
_OPTIONAL = {
    "array": ("carrier", "wavelength"),
    "tracker": (
        "hop",
        "dc_until",
        "remove_dc",
        "balance",
        "least_snr",
        "variance_inflation",
        "search",
        "noise",
        "lines",
        "line_width",
    ),
    "recording": ("layout", "delay", "factor", "fs"),
}
_LEAST_CARRIER = 1e6  # Hz: below it, the number is one of GHz or MHz, or the wave is one of sound
_SOUND = (".wav", ".wave", ".flac", ".rf64", ".bw64")
_SIGMF = (".sigmf", ".sigmf-meta", ".sigmf-data", ".gz", ".xz", ".zip", "")


@checked
@record
class Setup:
    """An array, the place that it watches, and the settings of its tracker.

    Attributes
    ----------
    array : RadarArray
        The N sensors, in the order of the channels.
    box : pair of array_like, shape (3,) or (6,)
        See `track_iq`, as for the other settings up to `line_width`.
    speed_limit, velocity_random_walk, window, start : float
    hop, dc_until : float, optional
    remove_dc, balance : bool
    least_snr, variance_inflation : float
    search : {"parts", "whole"}
    noise : {"shared", "per_axis", "horizontal"}
    lines : array_like, shape (L,)
    line_width : float
    layout : {"iq", "qi", "real"}, optional
        Order of the channels of a file, see `read_wav`.
    delay : float
        Group delay in s of all filters before the converter.
    factor : int
        Every how many samples one is kept, see `Baseband.from_recording`.
    fs : float, optional
        Sampling rate in Hz of files that do not state it, see `read_npy`.
    point : array_like, shape (3,), optional
        Position in m that a target must not come near.
    distance : float, optional
        Distance in m that is too near.

    Examples
    --------
    >>> array = RadarArray([[0, 0, 1], [6, 0, 1]], wavelength=0.0285)
    >>> box = [0, 0, 1], [6, 5, 1]
    >>> setup = Setup(array, box, 2.5, 0.05, window=0.05, start=0.5)
    >>> setup.factor, setup.layout
    (1, None)
    """

    array: RadarArray
    box: Annotated[tuple[ArrayLike, ArrayLike], bounds]
    speed_limit: Positive
    velocity_random_walk: Positive
    window: Positive
    start: AboveZero
    hop: Positive | None = None
    dc_until: Real | None = None
    remove_dc: bool = True
    balance: bool = True
    least_snr: Positive = 20.0
    variance_inflation: Positive = 1.0
    search: Literal["parts", "whole"] = "parts"
    noise: Literal["shared", "per_axis", "horizontal"] = "per_axis"
    lines: Annotated[ArrayLike, _checks.moderate] = ()
    line_width: Positive = 4.0
    layout: Literal["iq", "qi", "real"] | None = None
    delay: Real = 0.0
    factor: Count = 1
    fs: AboveZero | None = None
    point: Annotated[FloatArray, exactly(3)] | None = None
    distance: Positive | None = None

    @classmethod
    def from_toml(cls, path: FileSource) -> "Setup":
        """Read a setup from a TOML file.

        Parameters
        ----------
        path : path-like or Traversable
            File with the tables ``array``, ``target`` and ``tracker``, and perhaps ``recording``
            and ``alarm``: `EXAMPLE` has all entries.

        Returns
        -------
        Setup

        Raises
        ------
        ValueError
            If the file cannot be read or is not TOML, a table or entry is missing or unknown, or an
            entry has a value that does not fit. The message names the file and the entry, and
            shows the line of `EXAMPLE` for one that is missing.

        Examples
        --------
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> path = Path(mkdtemp()) / "room.toml"
        >>> _ = path.write_text(EXAMPLE)
        >>> setup = Setup.from_toml(path)
        >>> len(setup.array), setup.window, setup.distance
        (5, 0.05, 2.5)
        """
        with _toml.tables(path) as tables:
            return cls(**_fields(tables))

    @property
    def carrier(self) -> float:
        """Carrier frequency in Hz, in vacuum."""
        from scipy.constants import speed_of_light

        return speed_of_light / self.array.wavelength

    def read(
        self, paths: Path | Iterable[Path], *, first: int = 0, count: int | None = None
    ) -> Recording:
        """Read a recording in the format that the names of its files state.

        Parameters
        ----------
        paths : path-like or sequence of path-like
            WAV, FLAC, SigMF or .npy: one file with all sensors, or one for each, in their order.
        first, count : int, optional
            Which samples to read, see `read_wav`.

        Returns
        -------
        Recording

        Raises
        ------
        ValueError
            If the names have no known ending, or not all the same; if .npy is read without `fs`; or
            if the files are refused by `read_wav`, `read_sigmf` or `read_npy`.
        ModuleNotFoundError
            If the package that reads them is not installed.

        Examples
        --------
        >>> import numpy as np
        >>> from pathlib import Path
        >>> from tempfile import mkdtemp
        >>> path = Path(mkdtemp()) / "room.npy"
        >>> np.save(path, np.ones((5, 9), complex))
        >>> recording = example().read(path, count=2)
        >>> recording.x.shape, recording.fs
        ((5, 2), 4000.0)
        """
        one = isinstance(paths, (str, PathLike))
        given = [paths] if one else list(_checks.iterable("paths", paths, "paths of files"))
        for path in given:
            if not isinstance(path, (str, PathLike)):
                raise ValueError(f"paths must be a path or a sequence of paths, got {path!r}")
        readers = {_reader(pathlib.Path(path)) for path in given}
        if len(readers) > 1:
            raise ValueError(f"paths must be files of one format, got {', '.join(map(str, given))}")
        part = {"layout": self.layout, "first": first, "count": count}
        if readers == {"npy"}:
            if self.fs is None:
                raise ValueError(
                    f"fs must be given for .npy, which has no place for it: {_line('fs')}, got None"
                )
            return read_npy(given, self.fs, self.carrier, **part)
        if readers == {"wav"}:
            return read_wav(given, self.carrier, **part)
        try:
            return read_sigmf(given, **part)
        except ValueError as error:
            if "carrier" not in str(error) or "None" not in str(error):
                raise
        return read_sigmf(given, self.carrier, **part)

    @checked
    def baseband(self, recording: Recording) -> Baseband:
        """Low-pass filter and decimate a recording of the array.

        Parameters
        ----------
        recording : Recording
            Of as many sensors, with the carrier of the array.

        Returns
        -------
        Baseband
            Its `delay` is that of the low-pass and `delay`.

        Raises
        ------
        ValueError
            See `Baseband.from_recording`.

        Examples
        --------
        >>> import numpy as np
        >>> array = RadarArray([[0, 0, 1], [6, 0, 1]], wavelength=0.0285)
        >>> setup = Setup(array, ([0, 0, 1], [6, 5, 1]), 2.5, 0.05, 0.05, 0.5, delay=0.002)
        >>> x = np.random.default_rng(1).standard_normal((2, 500, 2)) @ [1, 1j]
        >>> setup.baseband(Recording(x, 1e3, setup.carrier)).delay
        0.002
        """
        iq = Baseband.from_recording(recording, self.array, factor=self.factor)
        return replace(iq, delay=iq.delay + self.delay)

    @checked
    def track(self, iq: Baseband) -> IqTrack:
        """Detect and track a target with these settings.

        For modules without Q, the signs of Doppler shifts are those of straight flight.

        Parameters
        ----------
        iq : Baseband
            Samples of the array.

        Returns
        -------
        IqTrack

        Raises
        ------
        ValueError
            See `track_iq`.

        Warns
        -----
        ImplausibleStart
            See `track_iq`.

        Examples
        --------
        >>> import numpy as np
        >>> from dopplerlib import iq_from_geometry
        >>> places = [[0, 0, 2], [6, 0, 2.2], [6, 5, 2], [0, 5, 2.2], [3, 0, 1.8]]
        >>> box = [0, 0, 1], [6, 5, 1]
        >>> setup = Setup(RadarArray(places, 0.0285), box, 2, 0.1, 0.05, 0.5, noise="horizontal")
        >>> path = [1.5, 2.5, 1] + np.arange(2000)[:, None] / 1e3 * [1, 0.3, 0]
        >>> x = iq_from_geometry(path, setup.array, 20, rng=np.random.default_rng(1))
        >>> found = setup.track(Baseband(x, 1e3, setup.array))
        >>> found.at(1.999)[0].round(1).tolist()
        [3.5, 3.1, 1.0, 1.0, 0.3, 0.0]
        """
        names = "box speed_limit velocity_random_walk window start hop dc_until remove_dc balance"
        names = [
            *names.split(),
            "least_snr",
            "variance_inflation",
            "search",
            "noise",
            "lines",
            "line_width",
        ]
        settings = {name: getattr(self, name) for name in names}
        if iq.without_q:
            settings |= {"estimator": ml_frequency_real, "signs": "straight"}
        return track_iq(iq, **settings)


def example() -> Setup:
    """Return the setup that `EXAMPLE` describes: five modules on the wall of a room.

    Examples
    --------
    >>> example().array.positions[1].tolist()
    [0.0, 1.5, 2.0]
    """
    return Setup(**_fields(tomllib.loads(EXAMPLE)))


def _reader(path):
    end = path.suffix.lower()
    if end in _SOUND:
        return "wav"
    if end == ".npy":
        return "npy"
    if end in _SIGMF:
        return "sigmf"
    raise ValueError(
        f"paths must end in .wav, .flac, .sigmf-meta, .sigmf or .npy, got {str(path)!r}: other "
        "samples become a .npy by numpy.save, as an array of shape (channels, samples)"
    )


def _fields(tables):
    """Return the fields of a setup that the tables of a file describe."""
    for name, needed in _TABLES.items():
        if name not in tables:
            if needed and name != "alarm":
                raise ValueError(
                    f"the file must have a table [{name}] with {', '.join(needed)}, got "
                    f"{', '.join(tables) or 'nothing'}; for example\n{_table(name)}"
                )
            continue
        _toml.check_names(f"[{name}]", tables[name], (), others=None)
        for entry in needed:
            if entry not in tables[name]:
                raise ValueError(
                    f"[{name}] must have {entry}, for example {_line(entry)}, got only "
                    f"{', '.join(tables[name]) or 'nothing'}"
                )
        _toml.check_names(f"[{name}]", tables[name], needed, _OPTIONAL.get(name, ()))
    _toml.check_names("the file", tables, (), tuple(_TABLES))
    target, alarm = dict(tables["target"]), tables.get("alarm", {})
    box = [_corner(name, target.pop(name)) for name in ("lower", "upper")]
    return {
        "array": _array(tables["array"]),
        "box": box,
        **target,
        **tables["tracker"],
        **tables.get("recording", {}),
        **alarm,
    }


def _corner(name, value):
    corner = _checks.moderate(name, value)
    if corner.shape not in ((3,), (6,)):
        raise ValueError(
            f"{name} must hold a position, or a position and a velocity, for example "
            f"{_line(name)}, got {value!r}"
        )
    return corner


def _array(table):
    waves = [name for name in ("carrier", "wavelength") if name in table]
    if len(waves) != 1:
        raise ValueError(
            f"[array] must have either carrier or wavelength, for example {_line('carrier')}, got "
            f"{' and '.join(waves) or 'neither'}"
        )
    wave = _checks.moderate_number(waves[0], table[waves[0]])
    if waves[0] == "carrier":
        if wave < _LEAST_CARRIER:
            raise ValueError(
                f"carrier must be that of a radio wave in Hz, for example {_line('carrier')}, got "
                f"{wave:g}; for sound give wavelength"
            )
        from scipy.constants import speed_of_light

        wave = speed_of_light / wave
    return RadarArray(table["positions"], wave)


def _line(entry):
    """Return the line of the example for an entry; of an array that takes several, its begin."""
    (line,) = re.findall(rf"^{entry} = (.*)$", EXAMPLE, flags=re.MULTILINE)
    value, _, about = line.partition("#")
    value = "[[0, 0.5, 1], [0, 1.5, 2]]" if value.strip() == "[" else value.strip()
    return f"`{entry} = {value}` ({about.strip()})"


def _table(name):
    (text,) = re.findall(rf"^\[{name}\].*?(?=\n\n|\Z)", EXAMPLE, flags=re.MULTILINE | re.DOTALL)
    return text
