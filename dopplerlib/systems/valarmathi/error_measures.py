"""Errors and delay of estimated velocities, by which the algorithms are compared."""

from typing import Annotated

import numpy as np

from ..._hints import checked, exactly
from ..._typing import FloatArray
from .published import reported
from .velocity_paths import VelocityPath

MEASURES = ("whole", "maneuver", "constant", "cee", "delay", "late")


@checked
def run_measures(
    path: VelocityPath, velocity: Annotated[FloatArray, exactly(None, None)]
) -> dict[str, FloatArray]:
    """Return the measures of every run.

    path: The truth.
    velocity (runs, K): Estimates in m/s at the last K samples of the path; all that are scored
        among them.
    Returns (runs,): Root mean square errors in m/s of the "whole" record, of the "maneuver" and at
        "constant" velocity; the document's "cee" of the record in percent; the "delay" in a steady
        maneuver in ms; and the fraction of the squared error there that this delay explains,
        "late".
    Raises ValueError if an argument is not of the kind described.

    Notes
    -----
    A velocity that is late by d errs by -a d while the acceleration is a: d is the one of least
    squares.

    Examples
    --------
    >>> from dopplerlib.systems.valarmathi import velocity_path
    >>> path = velocity_path("path 2")
    >>> late = path.v - 0.01 * path.a
    >>> {name: one.round(2).item() for name, one in run_measures(path, late[None]).items()}
    {'whole': 0.26, 'maneuver': 0.37, 'constant': 0.0, 'cee': 0.11, 'delay': 10.0, 'late': 1.0}
    """
    count = velocity.shape[-1]
    skipped = len(path.time) - count
    if skipped < 0 or path.scored[:skipped].any():
        raise ValueError(f"velocity must be of all scored samples, got {count}")
    truth, a, steady, scored = (one[skipped:] for one in (path.v, path.a, path.steady, path.scored))
    error = velocity - truth
    measures = {
        name: np.sqrt(np.mean(error[:, mask[skipped:]] ** 2, axis=-1))
        for name, mask in (
            ("whole", path.scored),
            ("maneuver", path.maneuver),
            ("constant", path.constant),
        )
    }
    measures["cee"] = 100 * np.mean(np.abs(error[:, scored]) / truth[scored], axis=-1)
    a, error = a[steady], error[:, steady]
    delay = -error @ a / (a @ a)
    measures["delay"] = 1e3 * delay
    rest = np.mean((error + delay[:, None] * a) ** 2, axis=-1)
    power = np.mean(error**2, axis=-1)
    measures["late"] = 1 - np.divide(rest, power, out=np.ones_like(rest), where=power > 0)
    return measures


def _titled(measures):
    """Return those of a table by their titles, delays in halves of the fixed window."""
    half = 1e3 * (reported().chosen.fixed_window - 1) / 2 * reported().stated.T
    return {
        "maneuver (m/s)": measures["maneuver"],
        "constant velocity (m/s)": measures["constant"],
        "whole record (m/s)": measures["whole"],
        "delay (half windows)": measures["delay"] / half,
    }
