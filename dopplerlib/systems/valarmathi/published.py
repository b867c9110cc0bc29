"""What the document states, what this book fills in, and the paths that follow from both."""

from functools import partial
from types import SimpleNamespace

import numpy as np

from ... import _checks
from ..._data import data, read_toml
from ..._records import record
from ...signal.synthesis import velocity_profile

data_file = partial(data, "valarmathi")
PATHS = ("path 1", "path 2", "fighter")


@record
class VelocityPath:
    """The course of a target's velocity, and which samples count for what.

    Attributes
    ----------
    name : str
        One of "path 1", "path 2" and "fighter".
    time : ndarray, shape (n,)
        In s.
    v : ndarray, shape (n,)
        Speed of approach in m/s.
    a : ndarray, shape (n,)
        Its derivative in m/s^2.
    scored : ndarray of bool, shape (n,)
        Samples whose errors count.
    maneuver : ndarray of bool, shape (n,)
        Those with an acceleration.
    constant : ndarray of bool, shape (n,)
        Those without one, for some time already.
    steady : ndarray of bool, shape (n,)
        Those with one, for some time already.
    """

    name: str
    time: np.ndarray
    v: np.ndarray
    a: np.ndarray
    scored: np.ndarray
    maneuver: np.ndarray
    constant: np.ndarray
    steady: np.ndarray


def stated():
    """Return what the document prints, by name.

    Returns
    -------
    types.SimpleNamespace
        In SI units and dB; see ``data/valarmathi/README.md``.
    """
    return SimpleNamespace(**_tables()["stated"])


def chosen():
    """Return what the document leaves open and this book chooses, by name.

    Returns
    -------
    types.SimpleNamespace
        In SI units; see ``data/valarmathi/README.md``.
    """
    return SimpleNamespace(**_tables()["chosen"])


def velocity_path(name):
    """Return one of the courses of velocity.

    Parameters
    ----------
    name : {"path 1", "path 2", "fighter"}
        "path 2" is the fast maneuver whose numbers the document states. "path 1", which it does
        not define, has a gentle acceleration instead. "fighter" begins at the Mach number and
        has the accelerations that the document claims and does not simulate.

    Returns
    -------
    VelocityPath

    Raises
    ------
    ValueError
        If `name` is none of the three.

    Examples
    --------
    >>> path = velocity_path("path 2")
    >>> path.v[[0, 3000]].round(1).tolist()
    [250.0, 116.6]
    """
    said, own = stated(), chosen()
    rate = (said.v_before - said.v_after) / said.maneuver
    v0, down, up = {
        "path 1": (said.v_before, own.gentle_acceleration, own.gentle_acceleration),
        "path 2": (said.v_before, rate, rate),
        "fighter": (
            said.mach * own.speed_of_sound,
            said.g_positive * own.g,
            -said.g_negative * own.g,
        ),
    }[_checks.one_of("name", name, PATHS)]
    time = said.T * np.arange(said.samples)
    a, b, c, d = np.cumsum(own.timeline)
    v, acceleration = velocity_profile(time, v0, [(a, b, -down), (c, d, up)])
    scored = np.arange(said.samples) >= own.scored
    moving = acceleration != 0
    wait = round(own.settling / said.T)
    settled = np.ones(said.samples, bool)
    for change in np.flatnonzero(np.diff(acceleration)) + 1:
        settled[change : change + wait] = False
    return VelocityPath(
        name,
        time,
        v,
        acceleration,
        scored,
        scored & moving,
        scored & ~moving & settled,
        scored & moving & settled,
    )


def _tables():
    return read_toml("valarmathi", "scenario.toml")
