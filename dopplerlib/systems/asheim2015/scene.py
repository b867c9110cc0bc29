"""Tracks, what both radars measure of them, and the noise (Chapter 5)."""

from dataclasses import replace

import numpy as np

from ... import _checks
from ..._records import record
from ...model.range_rate import range_rate
from ...model.ranging_noise import detection_probability
from .published import deviations, scenario, snr


@record
class Records:
    """Simulated records of both radars.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time of each scan in s.
    truth : ndarray, shape (K, 4)
        True states [x, y, v_x, v_y] in m and m/s.
    sensors : ndarray, shape (2, 2)
        Positions of the radars in m.
    ranges : ndarray, shape (2, K, 2)
        True range and range rate for each radar, at the times when it measures.
    z : ndarray, shape (runs, 2, K, 2)
        Measured range in m and range rate in m/s; NaN where nothing was detected.
    offset : float
        How much later than the first radar the second one measures, in s.
    """

    time: np.ndarray
    truth: np.ndarray
    sensors: np.ndarray
    ranges: np.ndarray
    z: np.ndarray
    offset: float

    def first(self, runs):
        """Return the records of the first `runs` runs."""
        return replace(self, z=self.z[:runs])

    def until(self, end):
        """Return the records up to the time `end` in s."""
        scans = int(np.sum(self.time <= end + 1e-9))
        return replace(
            self,
            time=self.time[:scans],
            truth=self.truth[:scans],
            ranges=self.ranges[:, :scans],
            z=self.z[:, :, :scans],
        )

    def with_offset(self, offset):
        """Return the records as they look to whoever believes in another offset, in s."""
        return replace(self, offset=offset)

    @property
    def baseline(self):
        """Distance between the radars in m."""
        return float(self.sensors[1, 0] - self.sensors[0, 0])

    @property
    def distance(self):
        """True distance from the origin at each scan in m, shape (K,)."""
        return np.hypot(self.truth[:, 0], self.truth[:, 1])


def radars(baseline=None):
    """Return the positions of the two radars on the x axis.

    Parameters
    ----------
    baseline : float, optional
        Their distance in m; that of the simulation, 1 m, if None.

    Returns
    -------
    ndarray, shape (2, 2)
    """
    b = scenario()["radars"]["baseline"] if baseline is None else baseline
    b = _checks.positive_number("baseline", b)
    return np.array([[-b / 2, 0.0], [b / 2, 0.0]])


def straight_track(time):
    """Return the states on the straight track of Fig 5.1(a).

    Parameters
    ----------
    time : array_like, shape (K,)
        Times in s.

    Returns
    -------
    ndarray, shape (K, 4)
    """
    t = _checks.finite("time", time)[:, None]
    s = scenario()["tracks"]
    p, v = np.array(s["start"]), np.array(s["velocity"])
    return np.hstack([p + t * v, np.broadcast_to(v, (len(t), 2))])


def maneuver_track(time):
    """Return the states on the track with a turn of 120 degrees, Fig 5.1(b).

    The turn has a constant rate and is counter-clockwise, as the code has it.

    Parameters
    ----------
    time : array_like, shape (K,)
        Times in s.

    Returns
    -------
    ndarray, shape (K, 4)
    """
    t = _checks.finite("time", time)
    s = scenario()["tracks"]
    v = np.array(s["velocity"])
    speed, heading = np.hypot(*v), np.arctan2(v[1], v[0])
    begin, end = s["turn_start"], s["turn_stop"]
    rate = np.deg2rad(s["turn"]) / (end - begin)
    inside = np.clip(t - begin, 0, end - begin)
    angle = heading + rate * inside
    straight = np.minimum(t, begin)[:, None] * v
    arc = (
        speed
        / rate
        * np.stack([np.sin(angle) - np.sin(heading), np.cos(heading) - np.cos(angle)], axis=-1)
    )
    direction = speed * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    p = np.array(s["start"]) + straight + arc + np.maximum(t - end, 0)[:, None] * direction
    return np.hstack([p, direction])


def scan_times(T=None, duration=None):
    """Return the times of all scans of the simulation.

    Parameters
    ----------
    T : float, optional
        Sampling interval in s; that of the thesis if None.
    duration : float, optional
        Time of the last scan in s; that of the thesis if None.

    Returns
    -------
    ndarray, shape (K,)

    Raises
    ------
    ValueError
        If the record is shorter than one interval.
    """
    s = scenario()["tracks"]
    T = s["T"] if T is None else _checks.positive_number("T", T)
    duration = s["duration"] if duration is None else _checks.positive_number("duration", duration)
    if duration < T:
        raise ValueError(f"duration must be at least the interval of {T} s, got {duration}")
    return np.arange(round(duration / T) + 1) * T


def simulate(
    runs,
    *,
    rng,
    track=straight_track,
    T=None,
    duration=None,
    baseline=None,
    law=None,
    rate="difference",
    correlated=1,
    offset=0.0,
    false_alarm=None,
):
    """Return records of both radars, as Appendix A simulates them.

    Parameters
    ----------
    runs : int
        Number of independent records.
    rng : numpy.random.Generator
        Source of the noise; every run draws from a child of its own.
    track : callable
        States (K, 4) as a function of times (K,).
    T : float, optional
        Sampling interval in s; 0.1 s if None.
    duration : float, optional
        Length of the record in s; 50 s if None.
    baseline : float, optional
        Distance between the radars in m; 1 m if None.
    law : callable, optional
        Signal-to-noise ratio in dB as a function of the range; Eq 5.1 if None.
    rate : {"difference", "exact"}
        "difference": the range rate is the difference of the range to the next scan over T, as in
        Appendix A.3; "exact": it is that of the instant.
    correlated : int
        Number of scans that an integration spans: the noise of neighboring scans shares what they
        share of it. 1 is white noise.
    offset : float
        How much later than the first radar the second one measures, in s.
    false_alarm : float, optional
        If given, a scan has a detection only with the chance that a threshold with this probability
        of a false alarm leaves at the signal-to-noise ratio there, and is NaN otherwise. If None,
        as in the thesis, each scan has one, however weak the echo.

    Returns
    -------
    Records

    Raises
    ------
    ValueError
        If an argument is not of the kind described.
    """
    runs = _checks.whole_number("runs", runs)
    _checks.generator("rng", rng)
    _checks.one_of("rate", rate, ("difference", "exact"))
    correlated = _checks.whole_number("correlated", correlated)
    offset = _checks.one_number("offset", offset)
    time, sensors = scan_times(T, duration), radars(baseline)
    step = time[1] - time[0]
    ranges = []
    for n, delay in enumerate((0.0, offset)):
        d = range_rate(track(time + delay), sensors[n : n + 1])[:, 0]
        if rate == "difference":
            forward = np.diff(d[:, 0]) / step
            d[:, 1] = np.append(forward, forward[-1])
        ranges.append(d)
    ranges = np.stack(ranges)
    sigma = deviations(ranges[..., 0], law)
    shape = (2, len(time) + correlated - 1, 2)
    noise = np.stack([child.standard_normal(shape) for child in rng.spawn(runs)])
    if correlated > 1:
        total = np.cumsum(np.pad(noise, [(0, 0), (0, 0), (1, 0), (0, 0)]), axis=2)
        noise = (total[:, :, correlated:] - total[:, :, :-correlated]) / np.sqrt(correlated)
    z = ranges + sigma * noise
    if false_alarm is not None:
        chance = detection_probability((law or snr)(ranges[..., 0]), false_alarm)
        seen = np.stack([child.random(chance.shape) < chance for child in rng.spawn(runs)])
        z = np.where(seen[..., None], z, np.nan)
    return Records(time, track(time), sensors, ranges, z, offset)


def noisy_positions(track, T=None, *, rng, same=False):
    """Return a track with the noise of Eq 5.7, whose size depends on the distance from the origin.

    Parameters
    ----------
    track : callable
        States (K, 4) as a function of times (K,).
    T : float, optional
        Sampling interval in s; 0.1 s if None.
    rng : numpy.random.Generator
        Source of the noise.
    same : bool
        Whether x and y get the same random number, as Eq 5.7 is printed, or one each.

    Returns
    -------
    truth, noisy : ndarray, shape (K, 2)
        In m.
    """
    _checks.generator("rng", rng)
    p = track(scan_times(T))[:, :2]
    sigma = deviations(np.hypot(p[:, 0], p[:, 1]))[:, :1]
    return p, p + sigma * rng.standard_normal((len(p), 1 if same else 2))
