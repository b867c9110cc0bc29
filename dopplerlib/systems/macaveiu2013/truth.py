"""The five paths of Section IV, and one that is not in the document."""

from typing import Annotated

import numpy as np

from ..._hints import Index, Positive, checked, exactly
from ..._records import record
from ..._typing import BoolArray, FloatArray
from .published import KMH, reported
from .settings import automotive_settings

Truth = Annotated[FloatArray, exactly(None, 4)]  # states [x, v_x, y, v_y] at all samples


@checked
@record
class VehiclePath:
    """One true path.

    figure: Number of the document's figure; 0 for a path that is not in it.
    title: What the target does.
    truth (K, 4): States [x, v_x, y, v_y] in m and m/s. The radar is at the origin and looks along
        +y.

    Examples
    --------
    >>> VehiclePath(0, "at rest", [[0.0, 0.0, 5.0, 0.0]]).truth.shape
    (1, 4)
    """

    figure: Index
    title: str
    truth: Truth


def vehicle_paths() -> dict[int, VehiclePath]:
    """Return the five paths by the number of their figure.

    Examples
    --------
    >>> {figure: path.title for figure, path in vehicle_paths().items()}[9]
    'diagonal'
    """
    made = {}
    for path in reported().scenario.path:
        columns = []
        for start, law in zip(path.start, (path.v_x, path.v_y), strict=True):
            way, velocity = _axis(law)
            columns += [start + way, velocity]
        made[path.figure] = VehiclePath(path.figure, path.title, np.stack(columns, axis=-1))
    return made


def _axis(law):
    """Return way and velocity of one axis at the sample times: each law integrated by hand."""
    s = automotive_settings()
    t, total = s.time, s.samples * s.T
    if law.law == "constant":
        return law.value * KMH * t, np.full(len(t), law.value * KMH)
    if law.law == "linear":
        v, a = law.first * KMH, (law.last - law.first) * KMH / total
        return v * t + a * t**2 / 2, v + a * t
    amplitude, rate = law.amplitude * KMH, 2 * np.pi * law.periods / total
    return amplitude * (1 - np.cos(rate * t)) / rate, amplitude * np.sin(rate * t)


@checked
def hard_turn(duration: Positive | None = None) -> tuple[VehiclePath, BoolArray]:
    """Return a path that is not in the document: straight, a quarter of a circle, straight.

    duration: Of the turn in s, up to the end of the record; that of the data file if None.
    Returns turning (K,): When the target turns.

    Examples
    --------
    >>> path, turning = hard_turn()
    >>> int(turning.sum())
    79
    """
    turn, t = reported().scenario.hard_turn, automotive_settings().time
    duration = turn.duration if duration is None else duration
    speed, rate = turn.speed * KMH, turn.angle / duration
    since = np.clip(t - turn.start, 0, duration)
    after = np.maximum(t - turn.start - duration, 0)
    heading = rate * since  # from +y towards +x
    v_x, v_y = speed * np.sin(heading), speed * np.cos(heading)
    x = speed * (1 - np.cos(heading)) / rate + v_x * after
    y = speed * (np.minimum(t, turn.start) + np.sin(heading) / rate) + v_y * after
    turning = (t > turn.start) & (t < turn.start + duration)
    return VehiclePath(0, "hard turn", np.stack([x, v_x, y + 5.0, v_y], axis=-1)), turning
