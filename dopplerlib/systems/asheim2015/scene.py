"""Tracks, what both radars measure of them, and the noise (Chapter 5)."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, Literal

import numpy as np

from ... import _checks
from ..._hints import Count, Positive, Probability, Real, Runs, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...model.range_rate import range_rate
from ...model.ranging_noise import detection_probability
from .noise import Law, _near, noise_std, snr
from .published import reported


def _within(name, value, shape=()):
    return _checks.bounded(name, _checks.finite(name, value, shape), (), 2 * LONGEST)


def _short(name, value):
    return _checks.bounded(name, _checks.finite(name, value), (), 20.0)


def _baseline(name, value):
    return _checks.positive_number(name, _checks.one_number(name, value, _short))


Baseline = Annotated[float, _baseline]  # distance of the radars in m
LONGEST = 100.0  # s: then the person is 14 m away, and what is measured is noise
Times = Annotated[FloatArray, exactly(None, check=_within)]
Offset = Annotated[float, partial(_checks.one_number, check=_short)]


@checked
@record
class RadarRecords:
    """Simulated records of both radars.

    time (K,): Time of each scan in s.
    truth (K, 4): True states [x, y, v_x, v_y] in m and m/s.
    sensors (2, 2): Positions of the radars in m.
    ranges (2, K, 2): True range and range rate for each radar, at the times when it measures.
    z (runs, 2, K, 2): Measured range in m and range rate in m/s; NaN where nothing was detected.
    offset: How much later than the first radar the second one measures, in s.
    Raises ValueError if a field is not of the kind described, or their lengths do not agree.

    Examples
    --------
    >>> records = simulate_radars(2, rng=np.random.default_rng(1), duration=1.0)
    >>> records.first(1).until(0.5).with_offset(0.05).z.shape
    (1, 2, 6, 2)
    >>> records.baseline, round(float(records.distance[-1]), 2)
    (1.0, 0.14)
    """

    time: Times
    truth: Annotated[FloatArray, exactly(None, 4, check=_near)]
    sensors: Annotated[FloatArray, exactly(2, 2, check=_near)]
    ranges: Annotated[FloatArray, exactly(2, None, 2, check=_near)]
    z: Annotated[FloatArray, exactly(None, 2, None, 2, check=_checks.bounded)]
    offset: Offset

    def __post_init__(self):
        """Check that the fields have one number of scans."""
        K = len(self.time)
        if not (np.diff(self.time) > 0).all():
            raise ValueError(f"time must rise, got {self.time.tolist()}")
        if not self.baseline > 0:
            raise ValueError(f"sensors must have x rising, got {self.sensors.tolist()}")
        for name, length in (
            ("truth", len(self.truth)), ("ranges", self.ranges.shape[1]), ("z", self.z.shape[2])
        ):  # fmt: skip
            if length != K:
                raise ValueError(f"{name} must have {K} scans as time has, got {length}")

    @checked
    def first(self, runs: Count) -> "RadarRecords":
        """Return the records of the first `runs` runs."""
        return replace(self, z=self.z[:runs])

    @checked
    def until(self, end: Real) -> "RadarRecords":
        """Return the records up to the time `end` in s, which must not be before the first."""
        scans = int(np.sum(self.time <= end + 1e-9))
        return replace(
            self,
            time=self.time[:scans],
            truth=self.truth[:scans],
            ranges=self.ranges[:, :scans],
            z=self.z[:, :, :scans],
        )

    def with_offset(self, offset: Real) -> "RadarRecords":
        """Return the records with another assumed offset in s, and the same measurements."""
        return replace(self, offset=offset)

    @property
    def baseline(self) -> float:
        """Distance between the radars in m."""
        return float(self.sensors[1, 0] - self.sensors[0, 0])

    @property
    def distance(self) -> FloatArray:
        """True distance from the origin at each scan in m, shape (K,)."""
        return np.hypot(self.truth[:, 0], self.truth[:, 1])


@checked
def radar_positions(baseline: Baseline | None = None) -> FloatArray:
    """Return the positions of the two radars on the x axis.

    baseline: Their distance in m; that of the simulation, 1 m, if None.
    Returns (2, 2)
    Raises ValueError if `baseline` is not positive, or beyond 20 m.

    Examples
    --------
    >>> radar_positions(0.6).tolist()
    [[-0.3, 0.0], [0.3, 0.0]]
    """
    b = reported().scenario.radars.baseline if baseline is None else baseline
    return np.array([[-b / 2, 0.0], [b / 2, 0.0]])


@checked
def straight_track(time: Times) -> FloatArray:
    """Return the states on the straight track of Fig 5.1(a).

    time (K,): Times in s.
    Returns (K, 4)
    Raises ValueError if a time is not finite or beyond 1e60.

    Examples
    --------
    >>> straight_track([0.0, 10.0]).round(1).tolist()
    [[0.0, 0.0, 0.1, 0.1], [1.0, 1.0, 0.1, 0.1]]
    """
    s, t = reported().scenario.tracks, time[:, None]
    return np.hstack([s.start + t * s.velocity, np.broadcast_to(s.velocity, (len(t), 2))])


@checked
def maneuver_track(time: Times, turn: tuple[Real, Real] | None = None) -> FloatArray:
    """Return the states on the track with a turn of 120 degrees, Fig 5.1(b).

    Of the code only the parameters are in our text: a counter-clockwise turn between 10 and 20 s.
    That its rate is constant is an inference.

    time (K,): Times in s.
    turn: When the turn begins and ends in s; the parameters of the code if None.
    Returns (K, 4)
    Raises ValueError if a time is not finite or beyond 1e60, or the turn does not begin before it
        ends.

    Examples
    --------
    >>> maneuver_track([30.0])[0, 2:].round(2).tolist()
    [-0.14, 0.04]
    """
    t, s = time, reported().scenario.tracks
    v = s.velocity
    speed, heading = np.hypot(*v), np.arctan2(v[1], v[0])
    begin, end = (s.turn_start, s.turn_stop) if turn is None else turn
    if not 0 <= begin < end:
        raise ValueError(f"turn must begin at 0 or later and before it ends, got {turn}")
    rate = np.deg2rad(s.turn) / (end - begin)
    inside = np.clip(t - begin, 0, end - begin)
    angle = heading + rate * inside
    straight = np.minimum(t, begin)[:, None] * v
    arc = (
        speed
        / rate
        * np.stack([np.sin(angle) - np.sin(heading), np.cos(heading) - np.cos(angle)], axis=-1)
    )
    direction = speed * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    p = s.start + straight + arc + np.maximum(t - end, 0)[:, None] * direction
    return np.hstack([p, direction])


@checked
def scan_times(T: Positive | None = None, duration: Positive | None = None) -> FloatArray:
    """Return the times of all scans of the simulation.

    T: Sampling interval in s; that of the thesis if None.
    duration: Time of the last scan in s; that of the thesis if None.
    Returns (K,)
    Raises ValueError if the record is shorter than one interval, longer than 100 s, or has more
        than a million scans.

    Examples
    --------
    >>> scan_times(0.5, 1.0).tolist()
    [0.0, 0.5, 1.0]
    """
    s = reported().scenario.tracks
    T = s.T if T is None else T
    duration = s.duration if duration is None else duration
    if not T <= duration <= min(1e6 * T, LONGEST):
        raise ValueError(
            f"duration must be at least the interval of {T} s, and at most {LONGEST:g} s or a "
            f"million intervals, got {duration}"
        )
    return np.arange(round(duration / T) + 1) * T


@checked
def simulate_radars(
    runs: Runs,
    *,
    rng: np.random.Generator,
    track: Callable[..., Any] = straight_track,
    T: Positive | None = None,
    duration: Positive | None = None,
    baseline: Baseline | None = None,
    law: Law | None = None,
    rate: Literal["difference", "exact"] = "difference",
    correlated: Runs = 1,
    offset: Offset = 0.0,
    false_alarm: Probability | None = None,
) -> RadarRecords:
    """Return records of both radars, as Appendix A simulates them.

    runs: Number of independent records.
    rng: Source of the noise; every run draws from a child of its own.
    track: States (K, 4) as a function of times (K,).
    T: Sampling interval in s; 0.1 s if None.
    duration: Length of the record in s; 50 s if None.
    baseline: Distance between the radars in m; 1 m if None.
    law: Signal-to-noise ratio in dB as a function of the range; Eq 5.1 if None.
    rate: "difference": the range rate is the difference of the range to the next scan over T, as in
        Appendix A.3; "exact": it is that of the instant.
    correlated: Number of scans that an integration spans: neighboring scans have the noise of the
        overlap in common. 1 is white noise.
    offset: How much later than the first radar the second one measures, in s.
    false_alarm: If given, a scan has a detection only with the probability that a threshold with
        this probability of a false alarm leaves at the signal-to-noise ratio there, and is NaN
        otherwise. If None, as in the thesis, each scan has one, however weak the echo.
    Raises ValueError if an argument is not of the kind described, or the records would have more
        than ten million scans.

    Examples
    --------
    >>> simulate_radars(2, rng=np.random.default_rng(1), duration=1.0).z.shape
    (2, 2, 11, 2)
    """
    time, sensors = scan_times(T, duration), radar_positions(baseline)
    _checks.count("runs times scans", runs * (len(time) + correlated), 10**7)
    step = time[1] - time[0]
    ranges = []
    for n, delay in enumerate((0.0, offset)):
        states = _near("track(time)", _checks.called("track", track, time + delay), (4,))
        _checks.check_shape("track(time)", states, (len(time), 4))
        d = range_rate(states, sensors[n : n + 1])[:, 0]
        if rate == "difference":
            forward = np.diff(d[:, 0]) / step
            d[:, 1] = np.append(forward, forward[-1])
        ranges.append(d)
    ranges = np.stack(ranges)
    sigma = noise_std(ranges[..., 0], law)
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
    return RadarRecords(time, track(time), sensors, ranges, z, offset)


@checked
def noisy_positions(
    track: Callable[..., Any],
    T: Positive | None = None,
    *,
    rng: np.random.Generator,
    same: bool = False,
) -> tuple[FloatArray, FloatArray]:
    """Return a track with the noise of Eq 5.7, whose size depends on the distance from the origin.

    track: States (K, 4) as a function of times (K,).
    T: Sampling interval in s; 0.1 s if None.
    rng: Source of the noise.
    same: Whether x and y get the same random number, as in the published Eq 5.7, or one each.
    Returns truth, noisy (K, 2): In m.

    Examples
    --------
    >>> truth, noisy = noisy_positions(straight_track, 5.0, rng=np.random.default_rng(1))
    >>> noisy.shape
    (11, 2)
    """
    states = _checks.called("track", track, scan_times(T))
    p = _near("track(time)", states, (4,))[:, :2]
    sigma = noise_std(np.hypot(p[:, 0], p[:, 1]))[:, :1]
    return p, p + sigma * rng.standard_normal((len(p), 1 if same else 2))
