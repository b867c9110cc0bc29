"""What the thesis prints: settings of its text and of its code, from ``data/asheim2015``."""

from functools import cache, partial

import numpy as np

from ... import _checks
from ..._data import data, read_toml
from ..._records import record
from ...model.motion import cwna_process_noise
from ...model.ranging_noise import linear_snr, range_std

data_file = partial(data, "asheim2015")
SETTINGS = ("text", "code", "modern")


@record
class Settings:
    """How the filter of one radar is set.

    Attributes
    ----------
    name : str
        "text", "code" or "modern".
    T : float
        Sampling interval in s.
    Q : ndarray, shape (2, 2)
        Covariance of the process noise of [range, velocity].
    variances : tuple of float, or None
        Variances of range in m^2 and velocity in m^2/s^2; those of the noise law at the predicted
        range if None.
    floor : tuple of float
        Least standard deviations in m and m/s, added in squares to those of the law.
    box : tuple of float
        Half-widths of the fixed gate in m and m/s.
    gate : {"box", "nis", None}
        Which gate is used.
    gate_probability : float
        Chance of a detection of the target to be inside the gate on NIS.
    P0 : ndarray, shape (2, 2)
        Covariance with which the filter starts.
    """

    name: str
    T: float
    Q: np.ndarray
    variances: tuple | None
    floor: tuple
    box: tuple
    gate: str | None
    gate_probability: float
    P0: np.ndarray

    def R(self, d):
        """Return variances of range and velocity at the ranges `d` (...), shape (..., 2)."""
        if self.variances is not None:
            return np.broadcast_to(np.array(self.variances), (*np.shape(d), 2))
        return deviations(d) ** 2 + np.square(self.floor)


def scenario():
    """Return the tables of ``data/asheim2015/scenario.toml``, as they are.

    Returns
    -------
    dict
    """
    return read_toml("asheim2015", "scenario.toml")


def quoted():
    """Return the tables of ``data/asheim2015/quoted.toml``: what the thesis says in numbers.

    Returns
    -------
    dict
    """
    return read_toml("asheim2015", "quoted.toml")


def resolutions():
    """Return the resolutions in range and in velocity, Eqs 5.3 and 5.5 with correct exponents.

    Returns
    -------
    range_resolution : float
        c T_pulse / 2 in m.
    velocity_resolution : float
        Half a wavelength over the time of integration in m/s.
    """
    n = scenario()["noise"]
    wavelength = n["speed_of_light"] / n["frequency"]
    return n["speed_of_light"] * n["pulse"] / 2, wavelength / (2 * n["integration"])


def snr(d):
    """Return the signal-to-noise ratio at the range `d`, Eq 5.1.

    Parameters
    ----------
    d : array_like, shape (...)
        Range in m.

    Returns
    -------
    ndarray, shape (...)
        In dB.
    """
    n = _noise()
    return linear_snr(d, n["snr_at_zero"], n["snr_slope"])


def deviations(d, law=None):
    """Return the standard deviations of range and velocity at the range `d`, Eqs 5.4 and 5.6.

    Parameters
    ----------
    d : array_like, shape (...)
        Range in m.
    law : callable, optional
        Signal-to-noise ratio in dB as a function of the range; that of Eq 5.1 if None.

    Returns
    -------
    ndarray, shape (..., 2)
        In m and m/s.
    """
    snr_db = (law or snr)(d)
    return np.stack([range_std(res, snr_db) for res in _resolutions()], axis=-1)


def settings(name, T=None, *, q=None, floor=None, gate="own"):
    """Return how the filter of one radar is set.

    Parameters
    ----------
    name : {"text", "code", "modern"}
        The settings of the thesis's text (Sec 5.5.1), those of its code (Appendix A), or ours.
    T : float, optional
        Sampling interval in s; that of the simulation, 0.1 s, if None.
    q : float, optional
        For "modern": spectral density of the acceleration in m^2/s^3.
    floor : tuple of float, optional
        For "modern": least standard deviations in m and m/s; (0, 0) for none.
    gate : {"own", "box", "nis", None}
        Another gate than the settings' own, which is the box for text and code.

    Returns
    -------
    Settings

    Raises
    ------
    ValueError
        If a name is not known or a number not positive.

    Notes
    -----
    Text and code compare a squared innovation over S with a bound over S, so that S cancels: both
    gates are the box sqrt(c sigma). The code adds sigma of the range where its square belongs.
    """
    _checks.one_of("name", name, SETTINGS)
    if gate is not None:
        _checks.one_of("gate", gate, ("own", "box", "nis"))
    s = scenario()
    f = s["filter"]
    T = s["tracks"]["T"] if T is None else _checks.positive_number("T", T)
    own = f[name]
    box = tuple(np.sqrt(f["c"] * f[sigma]) for sigma in ("sigma_range", "sigma_velocity"))
    if name == "modern":
        Q = cwna_process_noise(T, own["q"] if q is None else q, dim=1)
        variances = None
        floor = (own["floor_range"], own["floor_velocity"]) if floor is None else floor
    else:
        variances, floor = (own["range_variance"], own["velocity_variance"]), (0.0, 0.0)
        if name == "text":
            Q = np.diag(own["Q_diagonal"])
        else:
            Q = own["Q_factor"] * np.array([[T**2 / 3, T / 2], [T / 2, 1]])
    if gate == "own":
        gate = "nis" if name == "modern" else "box"
    P0 = f["start_covariance"] * np.eye(2)
    return Settings(name, T, Q, variances, floor, box, gate, f["modern"]["gate_probability"], P0)


# A filter asks for these at every scan.
@cache
def _noise():
    return scenario()["noise"]


_resolutions = cache(resolutions)
