"""Two pedestrians whose paths cross: nearest neighbor against the Hungarian algorithm."""

from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Booleans, Real, Runs, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...estimation import recursion
from ...model.motion import ncv_transition
from .linear_filter import gain_sequence, measure_vehicle
from .settings import AutomotiveSettings, automotive_settings

_SPEED = 1.4  # m/s; ours, as everything here: the document names the algorithm and shows nothing
RULES = ("each its nearest", "greedy", "Hungarian")
Pair = Annotated[FloatArray, exactly(2, None, 4)]  # states of two targets at all samples


@checked
@record
class Crossing:
    """Tracks of two crossing targets, and whether they were swapped or lost.

    truth (2, K, 4): True states.
    x (runs, 2, K, 4): Estimates.
    swapped (runs,): The tracks are nearer to each other's target at the end.
    lost (runs,): Both tracks follow one target at the end.
    """

    truth: Pair
    x: Annotated[FloatArray, exactly(None, 2, None, 4)]
    swapped: Booleans
    lost: Booleans


@checked
def crossing_paths(angle: Real, s: AutomotiveSettings | None = None) -> FloatArray:
    """Return two straight paths that meet half way, 10 m ahead of the radar.

    angle: Angle between the headings in rad.
    s: Those of the data file if None.
    Returns (2, K, 4)

    Examples
    --------
    >>> crossing_paths(0.5).shape
    (2, 500, 4)
    """
    s = automotive_settings() if s is None else s
    t = s.time - s.time.mean()
    truth = np.empty((2, len(t), 4))
    for one, sign in zip(truth, (1, -1), strict=True):
        v = _SPEED * np.array([np.cos(angle / 2), sign * np.sin(angle / 2)])
        one[:, 0], one[:, 1] = v[0] * t, v[0]
        one[:, 2], one[:, 3] = 10 + v[1] * t, v[1]
    return truth


@checked
def track_crossing(
    truth: Pair,
    rule: Literal["each its nearest", "greedy", "Hungarian"],
    runs: Runs,
    *,
    rng: np.random.Generator,
    velocity: bool = True,
    s: AutomotiveSettings | None = None,
) -> Crossing:
    """Track two targets whose detections come without names.

    truth (2, K, 4): True states.
    rule: Each track takes the detection with the smallest NIS, the other one's too; the best pair
        first, the rest for the other; or the two pairs with the smallest sum.
    runs: Number of independent records.
    rng: Source of the noise.
    velocity: Whether the association looks at the velocities, or at the positions alone.
    s: Those of the data file if None.

    Notes
    -----
    Both targets are detected in every scan and have the same covariance, so that its inverse weighs
    all pairs alike, and there are but two ways to make pairs.

    Examples
    --------
    >>> truth = crossing_paths(0.5)[:, :20]
    >>> track_crossing(truth, "Hungarian", 3, rng=np.random.default_rng(1)).x.shape
    (3, 2, 20, 4)
    """
    s = automotive_settings() if s is None else s
    children = zip(truth, rng.spawn(2), strict=True)
    z = np.stack([measure_vehicle(one, runs, rng=child, s=s) for one, child in children], axis=1)
    F, gains = ncv_transition(s.T), gain_sequence(s.with_(samples=truth.shape[1]))

    def step(k, state):
        state = state @ F.T
        # P + E_z = (I - K)^{-1} E_z, for each axis
        S = np.kron(np.eye(2), np.linalg.solve(np.eye(2) - gains[k], s.E_z[:2, :2]))
        nu = z[:, None, :, k] - state[:, :, None]  # (runs, track, detection, 4)
        part = slice(None) if velocity else slice(0, None, 2)
        weighted = nu[..., part] @ np.linalg.inv(S[part, part])
        cost = np.sum(weighted * nu[..., part], axis=-1)
        taken = np.take_along_axis(nu, _choice(cost, rule)[..., None, None], axis=2)[:, :, 0]
        state = state + taken @ np.kron(np.eye(2), gains[k]).T
        return state, (state,)

    begin = z[:, :, 0]
    (x,) = recursion.scan(step, begin, range(1, z.shape[2]), axis=2, first=(begin,))
    _checks.estimates("truth, s", x)
    off = np.linalg.norm(x[:, :, None, -1, ::2] - truth[:, -1, ::2], axis=-1)
    nearest = off.argmin(axis=-1)
    swapped = (nearest == [1, 0]).all(axis=1)
    return Crossing(truth, x, swapped, nearest[:, 0] == nearest[:, 1])


def _choice(cost, rule):
    """Return the detection of each track, (runs, 2), from costs (runs, track, detection)."""
    own = cost.argmin(axis=-1)
    if rule == "each its nearest":
        return own
    if rule == "greedy":
        best = cost.reshape(-1, 4).argmin(axis=1)
        crossed = (best == 1) | (best == 2)
    else:
        crossed = cost[:, 0, 1] + cost[:, 1, 0] < cost[:, 0, 0] + cost[:, 1, 1]
    return np.stack([crossed, ~crossed], axis=-1).astype(int)
