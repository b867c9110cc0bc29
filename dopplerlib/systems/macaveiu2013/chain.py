"""The processing scheme of Fig 6: from raw detections to tracks."""

import numpy as np

from ... import _checks
from ..._records import record
from ...model.motion import ncv_transition
from ...model.polar_radar import polar_radar_h, polar_radar_jacobian
from ...tracking.association import greedy_assign
from ...tracking.gates import fixed_box_gate
from ...tracking.management import TrackManager
from ...tracking.multi_target import track_scans
from . import polar
from .published import settings

TARGET, CLUTTER, FALSE = 0, 1, 2  # where a detection comes from

# All of these are ours: the document has no numbers for its scheme.
LENGTH = 3.0  # m: reflection points of the target lie along its heading, over this length
POINTS = 3
DETECTED = 0.9  # probability that a reflection point is detected in a scan
OBJECTS = 12  # trees, signs
OBJECT_DETECTED = 0.7
FALSE_ALARMS = 0.3  # mean number a scan
BOX = (4.5, 0.25, 0.5)  # m, rad, m/s: half-widths of the gate around an object; a car fits in
# Of an object: the noise of its detections, and that of the point of the target that it stands for.
OBJECT_NOISE = np.diag([0.6, 0.04, 0.15]) ** 2
MANAGER = TrackManager(hits=4, window=6, delete_after=13)  # half a second without detection


@record
class Scan:
    """Detections of one measurement.

    Attributes
    ----------
    z : ndarray, shape (detections, 3)
        Range in m, azimuth in rad, range rate in m/s.
    source : ndarray of int, shape (detections,)
        `TARGET`, `CLUTTER` or `FALSE`; known in a simulation only.
    """

    z: np.ndarray
    source: np.ndarray


def simulate(truth, *, rng, points=POINTS):
    """Return scans of a target with several reflection points among things that stand still.

    Parameters
    ----------
    truth : ndarray, shape (K, 4)
        True states of the middle of the target.
    rng : numpy.random.Generator
        Source of all randomness.
    points : int
        Number of the reflection points. A target with one is at its middle: a pedestrian.

    Returns
    -------
    list of Scan

    Raises
    ------
    ValueError
        If `rng` is not a generator, or `points` is not a positive whole number.
    """
    _checks.generator("rng", rng)
    points = _checks.whole_number("points", points)
    deviation = np.sqrt(np.diag(polar.noise()))
    place = np.zeros((OBJECTS, 4))
    place[:, 0], place[:, 2] = rng.uniform(-15, 15, OBJECTS), rng.uniform(4, 60, OBJECTS)
    still = polar_radar_h(place)
    moving = polar_radar_h(reflection_points(truth, points))
    scans = []
    for seen in moving:
        target = seen[rng.random(points) < DETECTED]
        clutter = still[rng.random(OBJECTS) < OBJECT_DETECTED]
        count = rng.poisson(FALSE_ALARMS)
        false = rng.uniform([2, -0.8, -5], [60, 0.8, 5], size=(count, 3))
        z = np.concatenate([target, clutter])
        z = z + rng.standard_normal(z.shape) * deviation
        parts = (len(target), len(clutter), count)
        source = np.repeat([TARGET, CLUTTER, FALSE], parts)
        scans.append(Scan(np.concatenate([z, false]), source))
    return scans


def reflection_points(truth, points=POINTS):
    """Return the states of the points of the target that reflect.

    Parameters
    ----------
    truth : ndarray, shape (K, 4)
        True states of its middle.
    points : int
        Their number.

    Returns
    -------
    ndarray, shape (K, points, 4)
        In a row of `LENGTH` along the heading; all have the velocity of the middle. A target that
        stands heads where it moved last, or where it will move first; one that never moves, along
        y.
    """
    heading = _heading(truth[:, 1::2])
    along = np.linspace(-LENGTH / 2, LENGTH / 2, points) if points > 1 else np.zeros(1)
    states = np.repeat(truth[:, None], points, axis=1)
    states[..., ::2] += along[:, None] * heading[:, None, :]
    return states


def _heading(v):
    speed = np.linalg.norm(v, axis=1)
    moving = np.flatnonzero(speed > 0)
    if not len(moving):
        return np.tile([0.0, 1.0], (len(v), 1))
    last = np.maximum(np.searchsorted(moving, np.arange(len(v)), side="right") - 1, 0)
    return v[moving[last]] / speed[moving[last], None]


def moves(z):
    """Return which detections move: the clutter rule.

    Parameters
    ----------
    z : ndarray, shape (..., 3)
        Range in m, azimuth in rad, range rate in m/s.

    Returns
    -------
    ndarray of bool, shape (...)
        False for clutter: whatever has a range rate below that of one resolution cell.
    """
    return np.abs(z[..., 2]) >= polar.sensor()["v_min"]


def after_rule(scans, rule="always"):
    """Return the scans with the detections that are made into objects.

    Parameters
    ----------
    scans : sequence of Scan
        From `simulate`.
    rule : {"always", "new tracks only", "never"}
        See `run`.

    Returns
    -------
    list of Scan
        Without what stands still if the rule is for all detections; else as they are.
    """
    scans = _checks.records("scans", scans, Scan)
    if rule != "always":
        return list(scans)
    return [Scan(scan.z[moves(scan.z)], scan.source[moves(scan.z)]) for scan in scans]


def objects(z):
    """Return the objects that detections make up: the detection-to-object association.

    Parameters
    ----------
    z : ndarray, shape (detections, 3)
        Detections.

    Returns
    -------
    mean : ndarray, shape (objects, 3)
        Mean of the detections of each object.
    member : ndarray of int, shape (detections,)
        Object of each detection.

    Notes
    -----
    The nearest detection that has no object yet is the next one's middle; a box around it in range,
    azimuth and range rate says what belongs to it.
    """
    member = np.full(len(z), -1)
    near = fixed_box_gate(z[:, None] - z, BOX)
    means = []
    for i in np.argsort(z[:, 0]):
        if member[i] < 0:
            inside = (member < 0) & near[i]
            member[inside] = len(means)
            means.append(z[inside].mean(axis=0))
    return np.array(means).reshape(-1, 3), member


def run(scans, rule="always", assign=greedy_assign, manager=MANAGER):
    """Track through the whole scheme.

    Parameters
    ----------
    scans : sequence of Scan
        From `simulate`.
    rule : {"always", "new tracks only", "never"}
        Where the clutter rule is applied: to all detections, as in Fig 6; only until a track is
        confirmed; or nowhere.
    assign : callable
        See `track_scans`. The default is nearest neighbor.
    manager : TrackManager
        When a track is confirmed, and when deleted.

    Returns
    -------
    list of ManagedTrack
        Their filter is the extended one, on the polar measurements of the objects.

    Raises
    ------
    ValueError
        If `rule` is not one of the three.

    Notes
    -----
    Macaveiu et al. (2013), Fig 6. The clutter rule there uses the range rate, since the radar
    stands still.
    """
    _checks.instance("manager", manager, TrackManager)
    scans = _checks.records("scans", scans, Scan)
    _checks.one_of("rule", rule, ("always", "new tracks only", "never"))
    s = settings()
    return track_scans(
        [objects(scan.z)[0] for scan in after_rule(scans, rule)],
        ncv_transition(s.T),
        s.with_(w=0.03).E_x,  # agile enough for Figs 10 and 11
        polar_radar_h,
        polar_radar_jacobian,
        OBJECT_NOISE,
        polar.start,
        manager,
        assign=assign,
        wrap=(1,),
        new=moves if rule == "new tracks only" else None,
    )


def hidden(truth):
    """Return where the clutter rule deletes the target itself, were there no noise.

    Parameters
    ----------
    truth : ndarray, shape (K, 4)
        True states.

    Returns
    -------
    ndarray of bool, shape (K,)
    """
    return ~moves(polar_radar_h(truth))


def longest_gap(seen):
    """Return the largest number of scans in a row without a detection.

    Parameters
    ----------
    seen : ndarray of bool, shape (runs, K)
        Whether the target is detected in a scan.

    Returns
    -------
    ndarray of int, shape (runs,)
    """
    longest = np.zeros(len(seen), int)
    current = np.zeros(len(seen), int)
    for column in seen.T:
        current = np.where(column, 0, current + 1)
        longest = np.maximum(longest, current)
    return longest
