"""What the document states: its five paths and its settings, from ``data/macaveiu2013``."""

from dataclasses import replace
from functools import cache, partial

import numpy as np

from ..._data import data, read_toml
from ..._records import record
from ...signal.waveforms import ChirpRadar

data_file = partial(data, "macaveiu2013")
KMH = 1 / 3.6  # m/s


@record
class Settings:
    """Sampling, noise and filter; what the document leaves open is our choice.

    Attributes
    ----------
    T : float
        Sampling interval in s.
    samples : int
        Number of samples K.
    skip : int
        Samples at the start that the scores leave out.
    sigma_p, sigma_v : float
        Deviation of a measured position in m and of a measured velocity in m/s, on each axis.
    w : float
        Deviation of the velocity step that the filter assumes, on each axis, in m/s.
    carrier, bandwidth : float
        Of the radar, in Hz.
    range_resolution : float
        In m.
    """

    T: float
    samples: int
    skip: int
    sigma_p: float
    sigma_v: float
    w: float
    carrier: float
    bandwidth: float
    range_resolution: float

    @property
    def time(self):
        """Time of each sample in s, shape (K,); the first is 0."""
        return np.arange(self.samples) * self.T

    @property
    def radar(self):
        """The radar, as `dopplerlib.signal.waveforms` takes it; one measurement takes T."""
        return ChirpRadar(self.carrier, self.bandwidth, self.T)

    @property
    def wavelength(self):
        """Wavelength of the radar in m."""
        return self.radar.wavelength

    @property
    def E_z(self):
        """Covariance of the measurement noise, shape (4, 4)."""
        return np.diag([self.sigma_p, self.sigma_v] * 2) ** 2

    @property
    def E_x(self):
        """Covariance of the state noise on the velocities, shape (4, 4)."""
        return np.diag([0.0, self.w] * 2) ** 2

    def with_(self, **changes):
        """Return these settings with some changed."""
        return replace(self, **changes)


@record
class Path2D:
    """One true path.

    Attributes
    ----------
    figure : int
        Number of the document's figure; 0 for a path that is not in it.
    title : str
        What the target does.
    truth : ndarray, shape (K, 4)
        States [x, v_x, y, v_y] in m and m/s. The radar is at the origin and looks along +y.
    """

    figure: int
    title: str
    truth: np.ndarray


@cache
def _file():
    return read_toml("macaveiu2013", "scenario.toml")


def settings():
    """Return the settings of the simulations.

    Returns
    -------
    Settings
    """
    file = _file()
    radar = file["radar"]
    return Settings(**file["sampling"], **file["noise"], **file["filter"], **file["score"], **radar)


def sensor():
    """Return the noise of the polar sensor and its clutter rule, by name; all are ours.

    Returns
    -------
    dict
        ``sigma_r`` in m, ``sigma_phi`` in rad, ``sigma_rate`` and ``v_min`` in m/s.
    """
    return dict(_file()["polar"])


def paths():
    """Return the five paths by the number of their figure.

    Returns
    -------
    dict of int to Path2D
    """
    made = {}
    for path in _file()["path"]:
        columns = []
        for start, law in zip(path["start"], (path["v_x"], path["v_y"]), strict=True):
            way, velocity = _axis(law)
            columns += [start + way, velocity]
        truth = np.stack(columns, axis=-1)
        made[path["figure"]] = Path2D(path["figure"], path["title"], truth)
    return made


def _axis(law):
    """Return way and velocity of one axis at the sample times: each law integrated by hand."""
    s = settings()
    t, total = s.time, s.samples * s.T
    if law["law"] == "constant":
        return law["value"] * KMH * t, np.full(len(t), law["value"] * KMH)
    if law["law"] == "linear":
        v, a = law["first"] * KMH, (law["last"] - law["first"]) * KMH / total
        return v * t + a * t**2 / 2, v + a * t
    amplitude, rate = law["amplitude"] * KMH, 2 * np.pi * law["periods"] / total
    return amplitude * (1 - np.cos(rate * t)) / rate, amplitude * np.sin(rate * t)


def hard_turn():
    """Return a path that is not in the document: straight, a quarter of a circle, straight.

    Returns
    -------
    Path2D
    turning : ndarray of bool, shape (K,)
        When the target turns.
    """
    turn, t = _file()["hard_turn"], settings().time
    speed, rate = turn["speed"] * KMH, turn["angle"] / turn["duration"]
    since = np.clip(t - turn["start"], 0, turn["duration"])
    after = np.maximum(t - turn["start"] - turn["duration"], 0)
    heading = rate * since  # from +y towards +x
    v_x, v_y = speed * np.sin(heading), speed * np.cos(heading)
    x = speed * (1 - np.cos(heading)) / rate + v_x * after
    y = speed * (np.minimum(t, turn["start"]) + np.sin(heading) / rate) + v_y * after
    turning = (t > turn["start"]) & (t < turn["start"] + turn["duration"])
    return Path2D(0, "hard turn", np.stack([x, v_x, y + 5.0, v_y], axis=-1)), turning
