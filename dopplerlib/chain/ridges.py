"""Ridges: tones followed from window to window, through misses and crossings."""

from typing import Literal

import numpy as np

from .. import _checks
from .._hints import Count, Index, Positive, Probability, checked
from .._records import record
from .._typing import FloatArray
from ..model.motion import cwna_process_noise, ncv_transition
from ..signal.detections import Detections
from ..signal.scatter import BoundTest, bound_test, frequency_scatter
from ..tracking.management import TrackManager
from ..tracking.multi_target import track_scans

_LOST = 4.0  # bins: a target that may be further off from where it is expected is lost
_FADING = 5.6  # dB: deviation of the power of an echo of many parts, which is exponential
_SWELL = 20.0  # dB: how much the mean power of an echo wanders in a second
_NEAR = 2.0  # bins: nearer tones are one peak


@checked
@record
class Ridge:
    """The frequency of one target, window by window.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time of each window in s, without gaps.
    frequency : ndarray, shape (K,)
        Measured frequencies in Hz; NaN where the target was not detected. Without signs in the
        detections that of the first one is positive, and it changes where the ridge goes through 0.
    std : ndarray, shape (K,)
        Their standard deviations in Hz from the data, see `frequency_scatter`, or `bound` where
        that is larger; NaN where there is no frequency, and throughout a ridge too short to tell.
    bound : ndarray, shape (K,)
        Their standard deviations in Hz if the target gave a pure tone.
    window : int
        Samples of a window.
    hop : int
        Samples from one window to the next.
    taper : {"hann", "rectangular"}
    """

    time: np.ndarray
    frequency: np.ndarray
    std: np.ndarray
    bound: np.ndarray
    window: Count
    hop: Count
    taper: Literal["hann", "rectangular"]

    def __post_init__(self):
        """Check the fields."""
        time = _checks.one_row("time", self.time)
        values = {
            name: _checks.exact_shape(
                name, _checks.measured(name, getattr(self, name), ()), time.shape
            )
            for name in ("frequency", "std", "bound")
        }
        return {"time": time, **values}

    def measurements(self) -> tuple[FloatArray, FloatArray]:
        """Return frequencies and standard deviations as `ekf` and `ml_initialize` take them.

        Returns
        -------
        z : ndarray, shape (K, 1)
            `frequency` in Hz, NaN, which means missing, where `std` is not known.
        sigma_f : ndarray, shape (K, 1)
            `std` in Hz; 1 where `z` is NaN.

        Notes
        -----
        A ridge of samples without Q begins with a positive frequency: that of a vehicle that goes
        away, whose absolute value rises, needs the other sign, ``-z``.

        The errors of a body last longer than windows overlap, and are not those of a tone in noise:
        for `ml_initialize` take ``loss="bisquare"``, ``scale="estimated"`` and
        ``covariance="sandwich"``, and no `correlation`. Even so a distance may be off by twice what
        is claimed, since the place on the body that reflects is one error for the whole passage.
        """
        known = ~np.isnan(self.std)
        z, std = np.where(known, self.frequency, np.nan), np.where(known, self.std, 1.0)
        return z[:, None], std[:, None]

    def bound_test(self) -> BoundTest:
        """Test whether the target is more than a pure tone: see `dopplerlib.signal.scatter`.

        Returns
        -------
        BoundTest
        """
        return bound_test(self.frequency, self.bound, self.window, self.hop, taper=self.taper)


@checked
def follow_ridges(
    found: Detections,
    *,
    chirp: Positive,
    chirp_walk: Positive,
    turn_rate: Positive,
    passage: float = 0.0,
    run: Index = 0,
    manager: TrackManager | None = None,
    gate_probability: Probability = 0.999,
) -> tuple[Ridge, ...]:
    """Follow detected tones from window to window: one ridge for each target.

    Parameters
    ----------
    found : Detections
        Tones of one sensor; of several records, see `run`.
    chirp : float
        Largest rate of change of a frequency in Hz/s. For a body that passes at speed v and
        distance d it is ``2 v^2 / (wavelength d)``.
    chirp_walk : float
        Standard deviation in Hz/s by which that rate wanders in a second on a steady ridge:
        ``2 / wavelength`` times the change of the acceleration.
    turn_rate : float
        Largest share by which a rate of change changes in a second, in 1/s: of a body that passes
        ``1.5 v / d``.
    passage : float
        Time in s that a body takes to pass a point, its length over its speed. It may reflect from
        anywhere along it, and from there for long: so a deviation of ``|df/dt| passage / sqrt(12)``
        is added in squares, which no scatter shows.
    run : int
        Which record, if there are several.
    manager : TrackManager, optional
        Rules of confirmation and deletion. If None, a ridge is confirmed by twice as many
        detections as windows overlap, among twice as many windows.
    gate_probability : float
        Probability of the gate.

    Returns
    -------
    tuple of Ridge
        Confirmed ridges in the order in which they begin, but those too short for a standard
        deviation, and those that are parts of another one.

    Raises
    ------
    ValueError
        If an argument is not of the kind described, or `run` is beyond the records.

    Notes
    -----
    `track_scans` with a state of frequency f, its rate of change, and the level of the echo in dB.
    The rate is driven by white noise of density ``chirp_walk^2 + turn_rate (df/dt)^2``, since the
    curve of a passing body bends where it is steep and hardly elsewhere. The noise of a frequency
    is half a bin, and what it changes in a quarter of a window. The level fades by 5.6 dB, as the
    power of an echo of many parts does, and wanders by 20 dB in a second: so a loud vehicle and a
    faint one are told from one another where they cross. A ridge without a detection coasts; when
    its deviation exceeds four bins it ends, and what is found after that is another ridge.

    Two ridges within two bins, or the `extent` of a target, are one peak. If they separate again
    each goes on as before: their targets crossed. If one ends there, they were one target, and the
    one that was seen more often before goes on.

    A ridge is a part of a longer one if it lies, in more than half of the windows that both have,
    within that distance of it and of what its frequency changes in the time `passage`: so far apart
    in frequency are the two ends of a body.

    Samples without Q give no signs: the state has one, its absolute value is compared with a
    detection, so that a ridge goes through zero and changes its sign.

    Examples
    --------
    Two tones that cross:

    >>> from dopplerlib.signal.peak_detection import detect_peaks
    >>> from dopplerlib.signal.synthesis import complex_noise
    >>> t = np.arange(8192) / 2e3
    >>> x = complex_noise(8192, 1.0, rng=np.random.default_rng(1))
    >>> x += np.exp(2j * np.pi * (300 * t + 25 * t**2)) + np.exp(2j * np.pi * (500 * t - 25 * t**2))
    >>> found = detect_peaks(x, 2e3, window=256, hop=64)
    >>> ridges = follow_ridges(found, chirp=100.0, chirp_walk=20.0, turn_rate=0.1)
    >>> [r.frequency[[0, -1]].round(-1).tolist() for r in ridges]
    [[300.0, 500.0], [500.0, 300.0]]
    """
    if not 0 <= passage <= 1e60:
        raise ValueError(f"passage must not be negative or beyond 1e60, got {passage:g}")
    rows = found.frequency.reshape(-1, *found.frequency.shape[-2:])
    if run >= len(rows):
        raise ValueError(f"run must be less than the {len(rows)} records of found, got {run}")
    frequency, bound, snr = (
        v.reshape(-1, *v.shape[-2:])[run] for v in (found.frequency, found.frequency_std, found.snr)
    )
    n, T = found.window, found.hop / found.fs
    resolution, length = found.fs / n, n / found.fs
    side_by_side = -(-n // found.hop)
    if manager is None:
        manager = TrackManager(2 * side_by_side, 4 * side_by_side, 64 * side_by_side)
    F, unit = np.eye(3), np.zeros((3, 3))
    F[:2, :2], unit[:2, :2] = ncv_transition(T, dim=1), cwna_process_noise(T, 1.0, dim=1)
    swell = np.diag([0.0, 0.0, _SWELL**2 * T])

    def slope(x):
        return np.clip(x[..., 1, None, None], -chirp, chirp)

    def Q(x):
        return (chirp_walk**2 + turn_rate * slope(x) ** 2) * unit + swell

    def R(x):
        off = (resolution / 2) ** 2 + (slope(x) * length / 4) ** 2
        return off * np.diag([1.0, 0.0]) + np.diag([0.0, _FADING**2])

    def h(x):
        return np.stack([x[..., 0] if found.signed else np.abs(x[..., 0]), x[..., 2]], axis=-1)

    def H(x):
        J = np.zeros((*x.shape[:-1], 2, 3))
        J[..., 0, 0] = 1.0 if found.signed else np.where(x[..., 0] < 0, -1.0, 1.0)
        J[..., 1, 2] = 1.0
        return J

    def start(z):
        x = np.stack([z[:, 0], np.zeros(len(z)), z[:, 1]], axis=-1)
        P = np.diag([(resolution / 2) ** 2, chirp**2, _FADING**2])
        return x, np.broadcast_to(P, (len(z), 3, 3))

    scans = np.stack([frequency, 10 * np.log10(snr)], axis=-1)
    tracks = track_scans(scans, F, Q, h, H, R, start, manager, gate_probability, exclusive=True)
    parts = [
        part
        for track in tracks
        if track.confirmed[-1]
        for part in _unlost(track, _LOST * resolution, manager.hits)
    ]
    ridges = []
    for scan, x, detection in _merged(parts, max(_NEAR * resolution, found.extent)):
        f = np.where(detection >= 0, frequency[scan, detection], np.nan)
        if not found.signed:
            f = np.where((x[:, 0] < 0) == (x[0, 0] < 0), f, -f)
        b = np.where(detection >= 0, bound[scan, detection], np.nan)
        std = np.maximum(frequency_scatter(f, n, found.hop, taper=found.taper), b)
        std = np.hypot(std, _slope(f, 2 * side_by_side) / T * passage / np.sqrt(12))
        ridges.append(Ridge(found.time[scan], f, std, b, n, found.hop, found.taper))
    near = max(_NEAR * resolution, found.extent)
    return tuple(sorted(_whole(ridges, near, passage), key=lambda ridge: ridge.time[0]))


def _whole(ridges, near, passage):
    """Return the ridges that can be measured, without those that are parts of a longer one."""
    kept = []
    measured = {id(ridge): np.flatnonzero(~np.isnan(ridge.std)) for ridge in ridges}
    for ridge in sorted(ridges, key=lambda ridge: -len(measured[id(ridge)])):
        k = measured[id(ridge)]
        if not len(k):
            continue
        time, f = ridge.time[k], np.abs(ridge.frequency[k])
        for other in kept:
            there = measured[id(other)]
            common = (time >= other.time[there[0]]) & (time <= other.time[there[-1]])
            curve = np.abs(other.frequency[there])
            slope = np.gradient(curve, other.time[there]) if len(there) > 1 else 0 * curve
            places = other.time[there]
            off = np.abs(f - np.interp(time, places, curve))
            reach = near + passage * np.abs(np.interp(time, places, slope))
            if common.any() and np.mean(off[common] < reach[common]) > 0.5:
                break
        else:
            kept.append(ridge)
    return kept


def _slope(f, lag):
    """Return the slopes (K,) a sample of frequencies (K,), by differences over twice the lag."""
    change = (f[2 * lag :] - f[: -2 * lag]) / (2 * lag) if len(f) > 2 * lag else np.empty(0)
    known = np.flatnonzero(~np.isnan(change))
    if not len(known):
        return np.zeros(len(f))
    return np.interp(np.arange(len(f)), known + lag, change[known])


def _unlost(track, limit, least):
    """Yield the parts of a track between which the target was lost, as (scan, x, detection)."""
    seen = track.detection >= 0
    lost = ~seen & (track.P[:, 0, 0] > limit**2)
    edges = np.flatnonzero(np.diff(lost.astype(int), prepend=1, append=1))
    for a, b in edges.reshape(-1, 2):
        places = a + np.flatnonzero(seen[a:b])
        if len(places) >= least:
            part = slice(places[0], places[-1] + 1)
            yield track.scan[part], track.x[part], track.detection[part].copy()


def _merged(tracks, near):
    """Return tracks of which those that run into one another for good are one from there on.

    A track is (scan, x, detection). The one that was seen more often before goes on.
    """
    tracks = sorted(tracks, key=lambda track: track[0][-1])
    done = []
    while tracks:
        mine = tracks.pop(0)
        joined = [(_joined(mine, other, near), i) for i, other in enumerate(tracks)]
        scan, i = min(((scan, i) for scan, i in joined if scan is not None), default=(None, None))
        if scan is None:
            done.append(mine)
            continue
        other = tracks[i]
        a, b = scan - mine[0][0], scan - other[0][0]
        common = slice(b, b + len(mine[0]) - a)
        if (
            mine[1][a, 0] * other[1][b, 0] < 0
        ):  # samples without Q do not tell one sign from another
            mine = mine[0], -mine[1], mine[2]
        detection = other[2].copy()
        detection[common] = np.where(detection[common] >= 0, detection[common], mine[2][a:])
        pasts = [tuple(v[:a] for v in mine), tuple(v[:b] for v in other)]
        pasts.sort(key=lambda past: np.sum(past[2] >= 0))
        future = scan + np.arange(len(detection) - b), other[1][b:], detection[b:]
        tracks[i] = tuple(np.concatenate(pair) for pair in zip(pasts[1], future, strict=True))
        seen = np.flatnonzero(pasts[0][2] >= 0)
        if len(seen):
            done.append(tuple(v[: seen[-1] + 1] for v in pasts[0]))
    return done


def _joined(mine, other, near):
    """Return the scan from which a track is as near to one that ends later, or None."""
    first, last = max(mine[0][0], other[0][0]), mine[0][-1]
    if last < first:
        return None
    a, b = (np.abs(t[1][first - t[0][0] : last + 1 - t[0][0], 0]) for t in (mine, other))
    apart = np.flatnonzero(np.abs(a - b) > near)
    start = first + (apart[-1] + 1 if len(apart) else 0)
    return None if start > last else start
