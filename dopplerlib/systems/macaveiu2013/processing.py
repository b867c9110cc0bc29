"""The processing scheme of Fig 6: from raw detections to tracks."""

from collections.abc import Callable, Iterable
from typing import Annotated, Any, Literal

import numpy as np

from ... import _checks
from ..._hints import Count, Positive, checked, exactly, shaped
from ..._records import record
from ..._typing import BoolArray, FloatArray, IntArray
from ...model.motion import ncv_transition
from ...model.polar_radar import polar_radar_h, polar_radar_jacobian
from ...tracking.association import greedy_assign
from ...tracking.gates import fixed_box_gate
from ...tracking.management import TrackManager
from ...tracking.multi_target import ManagedTrack, track_scans
from .polar_filters import polar_noise, start_polar
from .published import reported
from .settings import automotive_settings
from .truth import Truth

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
Detections = Annotated[FloatArray, shaped(None, 3)]
Rule = Literal["always", "new tracks only", "never"]
MANAGER = TrackManager(hits=4, window=6, delete_after=13)  # half a second without detection


@checked
@record
class VehicleScan:
    """Detections of one measurement.

    z (detections, 3): Range in m, azimuth in rad, range rate in m/s.
    source (detections,): `TARGET`, `CLUTTER` or `FALSE`; known in a simulation only.

    Examples
    --------
    >>> len(VehicleScan([[5.0, 0.0, 1.0]], [TARGET]).z)
    1
    """

    z: Annotated[FloatArray, shaped(None, 3)]
    source: Annotated[IntArray, _checks.finite]

    def __post_init__(self):
        """Check that each detection has a source."""
        if self.z.ndim != 2 or self.source.shape != (len(self.z),):
            raise ValueError(f"source must have shape {(len(self.z),)}, got {self.source.shape}")
        if not np.isin(self.source, (TARGET, CLUTTER, FALSE)).all():
            raise ValueError(f"source must be 0, 1 or 2, got {self.source.tolist()}")
        object.__setattr__(self, "source", self.source.astype(int))


@checked
def simulate_scans(
    truth: Truth, *, rng: np.random.Generator, points: Count = POINTS
) -> list[VehicleScan]:
    """Return scans of a target with several reflection points among things that stand still.

    truth (K, 4): True states of the middle of the target.
    rng: Source of all randomness.
    points: Number of the reflection points. A target with one is at its middle: a pedestrian.
    Raises ValueError if an argument is not of the kind described, or a point is on the radar.

    Examples
    --------
    >>> len(simulate_scans([[0.0, 0.0, 5.0, 1.0]] * 4, rng=np.random.default_rng(1)))
    4
    """
    deviation = np.sqrt(np.diag(polar_noise()))
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
        scans.append(VehicleScan(np.concatenate([z, false]), source))
    return scans


@checked
def reflection_points(truth: Truth, points: Count = POINTS) -> FloatArray:
    """Return the states of the points of the target that reflect.

    truth (K, 4): True states of its middle.
    points: Their number.
    Returns (K, points, 4): In a row of `LENGTH` along the heading; all have the velocity of the
        middle. A target that stands heads where it moved last, or where it will move first; one
        that never moves, along y.
    Raises ValueError if an argument is not of the kind described, or there are more than a hundred
        points.

    Examples
    --------
    >>> reflection_points([[0.0, 0.0, 5.0, 1.0]])[0, :, 2].tolist()
    [3.5, 5.0, 6.5]
    """
    points = _checks.count("points", points, 100)
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


@checked
def is_moving(
    z: Annotated[FloatArray, shaped(3, check=_checks.measured)], limit: Positive | None = None
) -> BoolArray:
    """Return which detections move: the clutter rule.

    z (..., 3): Range in m, azimuth in rad, range rate in m/s.
    limit: Range rate in m/s below which a detection is clutter; one resolution cell if None.
    Returns (...): False for clutter.

    Examples
    --------
    >>> is_moving([[5.0, 0.0, 1.0], [5.0, 0.0, 0.1]]).tolist()
    [True, False]
    """
    return np.abs(z[..., 2]) >= (reported().scenario.polar.v_min if limit is None else limit)


@checked
def after_clutter_rule(scans: Iterable[VehicleScan], rule: Rule = "always") -> list[VehicleScan]:
    """Return the scans with the detections that are made into objects.

    scans: From `simulate_scans`.
    rule: See `track_objects`.
    Returns: Without what stands still if the rule is for all detections; else as they are.

    Examples
    --------
    >>> scan = VehicleScan([[5.0, 0.0, 1.0], [5.0, 0.0, 0.1]], [TARGET, CLUTTER])
    >>> len(after_clutter_rule([scan])[0].z)
    1
    """
    if rule != "always":
        return list(scans)
    kept = [(scan, is_moving(scan.z)) for scan in scans]
    return [VehicleScan(scan.z[moving], scan.source[moving]) for scan, moving in kept]


@checked
def group_detections(
    z: Annotated[FloatArray, shaped(None, 3)],
    box: tuple[Positive, Positive, Positive] = BOX,
) -> tuple[FloatArray, IntArray]:
    """Return the objects that detections make up: the detection-to-object association.

    z (detections, 3): Detections.
    box: Half-widths of the gate around an object in m, rad and m/s.
    Returns mean (objects, 3): Mean of the detections of each object.
        member (detections,): Object of each detection.

    Notes
    -----
    The nearest detection that has no object yet is the next one's middle; a box around it in range,
    azimuth and range rate says what belongs to it.

    Examples
    --------
    >>> means, member = group_detections([[5.0, 0.0, 1.0], [7.0, 0.0, 1.0], [30.0, 0.0, 1.0]])
    >>> means[:, 0].tolist(), member.tolist()
    ([6.0, 30.0], [0, 0, 1])
    """
    z = _checks.one_matrix("z", z)
    member = np.full(len(z), -1)
    near = fixed_box_gate(z[:, None] - z, box)
    means = []
    for i in np.argsort(z[:, 0]):
        if member[i] < 0:
            inside = (member < 0) & near[i]
            member[inside] = len(means)
            means.append(z[inside].mean(axis=0))
    return np.array(means).reshape(-1, 3), member


@checked
def track_objects(
    scans: Iterable[VehicleScan],
    rule: Rule = "always",
    assign: Callable[..., Any] = greedy_assign,
    manager: TrackManager = MANAGER,
) -> list[ManagedTrack]:
    """Track through the whole scheme.

    scans: From `simulate_scans`.
    rule: Where the clutter rule is applied: to all detections, as in Fig 6; only until a track is
        confirmed; or nowhere.
    assign: See `track_scans`. The default is nearest neighbor.
    manager: When a track is confirmed, and when deleted.
    Returns: Their filter is the extended one, on the polar measurements of the objects.

    Notes
    -----
    Macaveiu et al. (2013), Fig 6. The clutter rule there uses the range rate, since the radar
    stands still.

    Examples
    --------
    >>> truth = np.linspace([0.0, 0.0, 5.0, 2.0], [0.0, 0.0, 5.8, 2.0], 11)
    >>> tracks = track_objects(simulate_scans(truth, rng=np.random.default_rng(1)))
    >>> sum(bool(track.confirmed.any()) for track in tracks)
    1
    """
    s = automotive_settings()
    return track_scans(
        [group_detections(scan.z)[0] for scan in after_clutter_rule(scans, rule)],
        ncv_transition(s.T),
        s.with_(w=0.03).E_x,  # agile enough for Figs 10 and 11
        polar_radar_h,
        polar_radar_jacobian,
        OBJECT_NOISE,
        start_polar,
        manager,
        assign=assign,
        wrap=(1,),
        new=is_moving if rule == "new tracks only" else None,
    )


@checked
def hidden_scans(truth: Truth, limit: Positive | None = None) -> BoolArray:
    """Return whether the clutter rule deletes the target itself at each scan, without noise.

    truth (K, 4): True states.
    limit: See `is_moving`.
    Returns (K,)
    Raises ValueError if `truth` is not of the kind described, or on the radar.

    Examples
    --------
    >>> hidden_scans([[0.0, 1.0, 5.0, 0.0], [0.0, 0.0, 5.0, 1.0]]).tolist()
    [True, False]
    """
    return ~is_moving(polar_radar_h(truth), limit)


@checked
def longest_gap(
    seen: Annotated[BoolArray, exactly(None, None, check=_checks.booleans)],
) -> IntArray:
    """Return the largest number of scans in a row without a detection.

    seen (runs, K): Whether the target is detected in a scan.
    Returns (runs,)

    Examples
    --------
    >>> longest_gap([[True, False, False, True, False]]).tolist()
    [2]
    """
    longest = np.zeros(len(seen), int)
    current = np.zeros(len(seen), int)
    for column in seen.T:
        current = np.where(column, 0, current + 1)
        longest = np.maximum(longest, current)
    return longest
