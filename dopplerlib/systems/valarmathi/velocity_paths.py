"""Velocities over time, from values that the document states and those that this book fills in."""

from typing import Annotated, Literal

import numpy as np

from ..._hints import Booleans, Positive, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...signal.synthesis import velocity_profile
from .published import reported

PATHS = ("path 1", "path 2", "fighter")
PathName = Literal["path 1", "path 2", "fighter"]
Samples = Annotated[FloatArray, exactly(None)]


@checked
@record
class VelocityPath:
    """Velocity of a target over time, and the samples of each phase.

    name: One of "path 1", "path 2" and "fighter".
    time (n,): In s.
    v (n,): Speed of approach in m/s.
    a (n,): Its derivative in m/s^2.
    scored (n,): Samples whose errors count.
    maneuver (n,): Those with an acceleration.
    constant (n,): Those without one, for some time already.
    steady (n,): Those with one, for some time already.
    """

    name: PathName
    time: Samples
    v: Samples
    a: Samples
    scored: Booleans
    maneuver: Booleans
    constant: Booleans
    steady: Booleans

    def __post_init__(self):
        """Check that all fields have one number of samples."""
        for name in ("v", "a", "scored", "maneuver", "constant", "steady"):
            if getattr(self, name).shape != self.time.shape:
                raise ValueError(
                    f"{name} must have shape {self.time.shape}, got {getattr(self, name).shape}"
                )


@checked
def velocity_path(name: PathName, gentle: Positive | None = None) -> VelocityPath:
    """Return one of the courses of velocity.

    name: "path 2" is the fast maneuver whose numbers the document states. "path 1", which it does
        not define, has a gentle acceleration instead. "fighter" begins at the Mach number and has
        the accelerations that the document claims and does not simulate.
    gentle: Acceleration of path 1 in m/s^2; that of `chosen` if None.
    Raises ValueError if `name` is none of the three, or the target would turn back on path 1.

    Examples
    --------
    >>> path = velocity_path("path 2")
    >>> path.v[[0, 3000]].round(1).tolist()
    [250.0, 116.6]
    """
    said, own = reported().stated, reported().chosen
    rate = (said.v_before - said.v_after) / said.maneuver
    gentle = own.gentle_acceleration if gentle is None else gentle
    if gentle * said.maneuver >= said.v_before:
        raise ValueError(f"gentle must leave a velocity after {said.maneuver} s, got {gentle}")
    v0, down, up = {
        "path 1": (said.v_before, gentle, gentle),
        "path 2": (said.v_before, rate, rate),
        "fighter": (
            said.mach * own.speed_of_sound,
            said.g_positive * own.g,
            -said.g_negative * own.g,
        ),
    }[name]
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
