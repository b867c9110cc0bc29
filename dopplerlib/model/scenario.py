"""A scenario: sensors, a target's path, and how it is sampled, as a file describes them."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import _checks
from .doppler import check_clear_of_sensors
from .radar_array import RadarArray


@dataclass(frozen=True)
class Scenario:
    """One target on a straight path before an array, and the settings of its tracker.

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
    sigma_p : float
        Standard deviation of the acceleration that the tracker assumes, in m/s^2.
    P0 : array_like, shape (6, 6)
        Covariance with which the tracker starts.

    Raises
    ------
    ValueError
        If a field has the wrong shape, is not finite or not positive where it has to be, or if
        the target starts on a sensor.
    """

    array: RadarArray
    x0: np.ndarray
    T: float
    samples: int
    sigma_f: float
    sigma_p: float
    P0: np.ndarray

    def __post_init__(self):
        """Check and freeze the fields."""
        x0 = _checks.finite("x0", self.x0, (6,)).copy()
        if x0.ndim != 1:
            raise ValueError(f"x0 must have shape (6,), got {x0.shape}")
        check_clear_of_sensors("x0", x0, self.array)
        P0 = _checks.covariance("P0", self.P0, 6).copy()
        x0.flags.writeable = P0.flags.writeable = False
        object.__setattr__(self, "x0", x0)
        object.__setattr__(self, "P0", P0)
        object.__setattr__(self, "samples", _checks.whole_number("samples", self.samples))
        for name in ("T", "sigma_f", "sigma_p"):
            object.__setattr__(self, name, _checks.positive_number(name, getattr(self, name)))

    @property
    def time(self):
        """Time of each sample in s, shape (K,); the first is 0."""
        return np.arange(self.samples) * self.T

    @property
    def truth(self):
        """True states at the samples, shape (K, 6): a straight path at constant velocity."""
        path = np.tile(self.x0, (self.samples, 1))
        path[:, :3] += self.time[:, None] * self.x0[3:]
        return path

    @classmethod
    def from_toml(cls, path):
        """Read a scenario from a TOML file.

        Parameters
        ----------
        path : str or pathlib.Path
            File with the tables ``array``, ``target``, ``sampling`` and ``tracker``, as in
            ``data/mittermaier2016/scenario.toml``.

        Raises
        ------
        ValueError
            If a table or entry is missing or unknown, or has a value that `Scenario` refuses.
        """
        tables = tomllib.loads(Path(path).read_text(encoding="utf-8"))
        try:
            geometry = dict(tables["array"])
            make = {"ring": RadarArray.ring, "linear": RadarArray.linear, "positions": RadarArray}[
                geometry.pop("shape")
            ]
            tracker = tables["tracker"]
            return cls(
                array=make(**geometry),
                x0=tables["target"]["x0"],
                T=tables["sampling"]["T"],
                samples=tables["sampling"]["samples"],
                sigma_f=tables["sampling"]["sigma_f"],
                sigma_p=tracker["sigma_p"],
                P0=np.diag(tracker["P0_diagonal"]),
            )
        except (KeyError, TypeError) as error:
            raise ValueError(f"{path} must describe a scenario: {error!r}") from error
