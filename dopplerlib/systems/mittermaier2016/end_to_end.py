"""The whole chain on the track of Table 2: from IQ samples to a position, every stage a switch."""

from dataclasses import replace
from functools import cache
from typing import Any, Literal

import numpy as np

from ... import _checks
from ..._hints import Positive, checked
from ...chain import track
from ...chain.baseband import Baseband
from ...chain.track import IqTrack
from .published import reported
from .start import start_box

_SEARCHES = {"quarters": "parts", "room": "whole"}


@checked
def track_iq(
    iq: Baseband,
    *,
    window: Positive = 0.025,
    timestamp: Literal["center", "end"] = "center",
    subtract_delay: bool = True,
    start: Positive = 0.3,
    sigma_a: Positive | None = None,
    search: Literal["quarters", "room"] = "quarters",
    **settings: Any,
) -> IqTrack:
    """Find and track the target of Table 2 from IQ samples.

    iq: Samples of the paper's array.
    window, start: See `dopplerlib.chain.track.track_iq`.
    timestamp: To which moment of its window a Doppler shift is taken to belong.
    subtract_delay: Whether the group delay of the low-pass is taken off the times.
    sigma_a: Standard deviation of the acceleration in m/s^2, for one millisecond; that of the
        scenario if None. For another hop it is scaled, so that the velocity wanders as far in a
        second.
    search: Where hypotheses about the start come from: from each quarter of the room, by the signs
        of y and z, or from the whole.
    **settings: Others of `dopplerlib.chain.track.track_iq`.
    Raises ValueError if an argument is refused by `dopplerlib.chain.track.track_iq`.
    Warns ImplausibleStart: See `dopplerlib.chain.track.track_iq`.

    Notes
    -----
    The box is `start_box`, and the speed limit that of the drives. Wrong times are those of samples
    that are delayed by less than they are.

    Examples
    --------
    >>> from dopplerlib.systems.mittermaier2016 import read_simulated_iq
    >>> iq, time, truth = read_simulated_iq()
    >>> x, P, _ = track_iq(iq).at(1.0)
    >>> bool(np.linalg.norm(x[0, :3] - truth[-1, :3]) < 0.05)
    True
    """
    s = reported().scenario
    limit = reported().signal_chain.speed_limit_m_s
    if limit * iq.array.doppler_per_speed > iq.fs / 2:
        raise ValueError(f"iq must be sampled so fast that {limit} m/s is not aliased, got {iq.fs}")
    delay = iq.delay if subtract_delay else 0.0
    if timestamp == "end":
        delay -= (round(window * iq.fs) - 1) / 2 / iq.fs
    return track.track_iq(
        replace(iq, delay=delay),
        _room(),
        speed_limit=limit,
        velocity_random_walk=_checks.positive_number(
            "sigma_a", s.sigma_a if sigma_a is None else sigma_a
        )
        * np.sqrt(s.T),
        window=window,
        start=start,
        search=_SEARCHES[search],
        **settings,
    )


@cache
def _room():
    """Return the box of the start, which takes longer to read than a record to track."""
    return start_box()
