"""Scenarios: sensors, a target's path, sampling and noise, read from a file."""

from inspect import signature
from typing import TYPE_CHECKING

import numpy as np

from .. import _checks, _toml
from .._records import record
from .._typing import ArrayLike, FileSource, FloatArray
from .doppler import check_clear_of_sensors
from .radar_array import RadarArray

_SHAPES = {"ring": RadarArray.ring, "linear": RadarArray.linear, "positions": RadarArray}
_ENTRIES = {
    "target": ("x0",),
    "sampling": ("T", "samples", "sigma_f"),
    "tracker": ("sigma_a", "P0_diagonal"),
}


@record
class Scenario:
    """One target on a straight path in front of an array, and the settings of its tracker.

    Parameters
    ----------
    array : RadarArray
        The N sensors.
    x0 : array_like, shape (6,)
        True state at the first sample, in m and m/s.
    T : float
        Sampling interval in s.
    samples : int
        Number of samples K.
    sigma_f : float
        Standard deviation of a Doppler measurement in Hz.
    sigma_a : float
        Standard deviation of the acceleration that the tracker assumes, in m/s^2.
    P0 : array_like, shape (6, 6)
        Covariance with which the tracker starts.

    Raises
    ------
    ValueError
        If a field has the wrong shape, is not finite or not positive where it has to be, or if
        the target starts on a sensor.

    Examples
    --------
    From 0.8 m in front of a ring, straight towards it, for a second:

    >>> scenario = Scenario(
    ...     RadarArray.ring(6, 0.2), x0=[0.8, 0, 0, -0.7, 0, 0],
    ...     T=0.001, samples=1001, sigma_f=0.4, sigma_a=0.4, P0=0.1 * np.eye(6),
    ... )
    >>> round(float(scenario.time[-1]), 3), round(float(scenario.truth[-1, 0]), 3)
    (1.0, 0.1)
    """

    array: RadarArray
    x0: np.ndarray
    T: float
    samples: int
    sigma_f: float
    sigma_a: float
    P0: np.ndarray

    if TYPE_CHECKING:  # what a field holds is an array, what makes it need not be

        def __init__(
            self,
            array: RadarArray,
            x0: ArrayLike,
            T: float,
            samples: int,
            sigma_f: float,
            sigma_a: float,
            P0: ArrayLike,
        ) -> None: ...

    def __post_init__(self):
        """Check the fields."""
        x0 = _checks.moderate("x0", self.x0, (6,)).copy()
        P0 = _checks.covariance("P0", self.P0, 6).copy()
        _checks.instance("array", self.array, RadarArray)
        _checks.exact_shape("x0", x0, (6,))
        _checks.exact_shape("P0", P0, (6, 6))
        check_clear_of_sensors("x0", x0, self.array)
        samples = _checks.whole_number("samples", self.samples)
        numbers = ("T", "sigma_f", "sigma_a")
        numbers = {name: _checks.moderate_number(name, getattr(self, name)) for name in numbers}
        return {"x0": x0, "P0": P0, "samples": samples, **numbers}

    @property
    def time(self) -> FloatArray:
        """Time of each sample in s, shape (K,); the first is 0."""
        return np.arange(self.samples) * self.T

    @property
    def truth(self) -> FloatArray:
        """True states at the samples, shape (K, 6), on a straight path at constant velocity."""
        path = np.tile(self.x0, (self.samples, 1))
        path[:, :3] += self.time[:, None] * self.x0[3:]
        return path

    @classmethod
    def from_toml(cls, path: FileSource) -> "Scenario":
        """Read a scenario from a TOML file.

        Parameters
        ----------
        path : path-like or Traversable
            File with the tables ``array``, ``target``, ``sampling`` and ``tracker``, as in
            ``data/mittermaier2016/scenario.toml``.

        Returns
        -------
        Scenario

        Raises
        ------
        ValueError
            If the file cannot be read or is not TOML, a table or entry is missing or unknown, or an
            entry has a value that `Scenario` or `RadarArray` refuses. The message names the file
            and the entry.

        Examples
        --------
        >>> from dopplerlib._data import data
        >>> Scenario.from_toml(data("mittermaier2016", "scenario.toml")).samples
        1001
        """
        with _toml.tables(path) as tables:
            return cls(**_fields(tables))


def _fields(tables):
    """Return the fields of a scenario that the tables of a file describe."""
    _toml.check_names("the file", tables, ("array", "target", "sampling", "tracker"))
    for name, entries in _ENTRIES.items():
        _toml.check_names(f"[{name}]", tables[name], entries)
    sampling, tracker = tables["sampling"], tables["tracker"]
    return {
        "array": _array(tables["array"]),
        "x0": tables["target"]["x0"],
        **sampling,
        "sigma_a": tracker["sigma_a"],
        "P0": np.diag(_checks.positive("P0_diagonal", tracker["P0_diagonal"], (6,))),
    }


def _array(table):
    _toml.check_names("[array]", table, ("shape",), others=None)
    make = _SHAPES[_checks.one_of("shape in [array]", table["shape"], tuple(_SHAPES))]
    settings = {name: value for name, value in table.items() if name != "shape"}
    parameters = signature(make).parameters.values()
    needed = [p.name for p in parameters if p.default is p.empty]
    _toml.check_names("[array]", settings, needed, others=[p.name for p in parameters])
    return make(**settings)
