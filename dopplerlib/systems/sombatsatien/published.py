"""What the report states, from ``data/sombatsatien``."""

from functools import partial

import numpy as np

from ... import _checks
from ..._data import data, read_toml
from ..._records import record
from ...model.doppler import doppler_shift
from ...model.radar_array import RadarArray
from ...model.scenario import Scenario

data_file = partial(data, "sombatsatien")


@record
class StartSettings:
    """How the report finds a start, and the start that it found.

    Attributes
    ----------
    samples : int
        Number of first samples whose average is explained.
    guess : ndarray, shape (6,)
        Where the one search begins.
    box : tuple of ndarray, shape (6,)
        Lower and upper bounds of the state.
    estimate : ndarray, shape (6,)
        The start that is printed.
    """

    samples: int
    guess: np.ndarray
    box: tuple
    estimate: np.ndarray


def scenario(plane="z"):
    """Return the simulation.

    Parameters
    ----------
    plane : {"z", "x"}
        Plane of the ring: z = 0 as in the report, or x = 0 as in the paper that it replicates,
        with the first sensor on +y.

    Returns
    -------
    Scenario

    Raises
    ------
    ValueError
        If `plane` is neither.
    """
    _checks.one_of("plane", plane, ("z", "x"))
    s = Scenario.from_toml(data_file("scenario.toml"))
    if plane == "z":
        return s
    radius = float(np.linalg.norm(s.array.positions[0]))
    array = RadarArray.ring(len(s.array), radius, normal="x", wavelength=s.array.wavelength)
    return Scenario(array, s.x0, s.T, s.samples, s.sigma_f, s.sigma_a, s.P0)


def start_settings():
    """Return the settings of the report's start.

    Returns
    -------
    StartSettings
    """
    start = _tables()["start"]
    return StartSettings(
        start["samples"],
        np.array(start["guess"]),
        (np.array(start["lower"]), np.array(start["upper"])),
        np.array(start["estimate"]),
    )


def reported():
    """Return the results of the report, by name.

    Returns
    -------
    dict
        In m and m/s; see ``data/sombatsatien/README.md``.
    """
    return _tables()["result"]


def reported_outcomes():
    """Return the results of the report under the names that `outcomes` uses for ours.

    Returns
    -------
    dict of str to float
        By name and unit.
    """
    told = reported()
    return {
        "position RMSE (m)": told["position_rmse"],
        "velocity RMSE (m/s)": told["velocity_rmse"],
        "final position error (m)": told["final_position_error"],
        "final x (m)": told["final_x"],
        **{f"final v_{c} (m/s)": v for c, v in zip("xyz", told["final_velocity"], strict=True)},
    }


def reported_record():
    """Return the measurements of the report's one run, noise included.

    Returns
    -------
    ndarray, shape (1000, 6)
        Doppler measurements in Hz.

    Notes
    -----
    The notebook fixes the seed of NumPy's legacy generator, whose numbers never change.
    """
    s = scenario()
    noise = np.random.RandomState(_tables()["noise"]["seed"])
    noise = noise.standard_normal((s.samples, len(s.array)))
    return doppler_shift(s.truth, s.array) + s.sigma_f * noise


def _tables():
    return read_toml("sombatsatien", "reported.toml")
