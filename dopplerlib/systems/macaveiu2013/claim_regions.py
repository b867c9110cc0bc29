"""Regions of noise in which the claims of Section IV hold; the document does not state it."""

from itertools import pairwise
from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Positive, Reals, Runs, checked, exactly
from ..._records import record
from ..._typing import BoolArray, FloatArray, IntArray
from ...evaluation.intervals import proportion_interval
from ...model.motion import ncv_transition
from .linear_filter import gain_sequence, measure_vehicle
from .settings import AutomotiveSettings, automotive_settings
from .truth import vehicle_paths

MUCH_SMALLER = 0.5  # our reading of "much smaller than 1 m": less than half of it
MOST = 0.9  # a claim on every record holds where it is true in this fraction of them
CLAIMS = (
    "1  away: error far below 1 m",
    "2  all paths: error below 1 m",
    "3  bends: larger speed errors",
    "all three",
)
Largest = Annotated[FloatArray, exactly(None, None)]
Axis = tuple[Literal["sigma_x", "sigma_v", "w"], Annotated[FloatArray, exactly(None)]]


@checked
@record
class PathScores:
    """Errors of the filter on the five paths, in every run.

    figures: Numbers of the figures, in the order of the arrays.
    settled (paths, runs): Largest position error after the first second, in m.
    whole (paths, runs): Largest position error of the whole record, in m.
    speed (paths, runs, 2): Root mean square of the errors of v_x and v_y after the first second, in
        m/s.
    resolution: Range resolution in m, the measure of the claims.

    Examples
    --------
    >>> scores = score_paths(2, rng=np.random.default_rng(1))
    >>> [scores.by_claim()[name].shape for name in CLAIMS]
    [(2,), (2,), (2,), (2,)]
    """

    figures: tuple[int, ...]
    settled: Largest
    whole: Largest
    speed: Annotated[FloatArray, exactly(None, None, 2)]
    resolution: Positive

    def __post_init__(self):
        """Check that the five figures are there."""
        if not {7, 8, 9, 10, 11} <= set(self.figures):
            raise ValueError(f"figures must be those from 7 to 11, got {self.figures}")
        shape = len(self.figures), self.settled.shape[1]
        for name in ("settled", "whole", "speed"):
            if getattr(self, name).shape[:2] != shape:
                raise ValueError(f"{name} must have shape {shape}, got {getattr(self, name).shape}")

    def small_in_figure_7(self) -> BoolArray:
        """Return in which runs the error of Fig 7 is much smaller than the resolution, (runs,)."""
        return self.settled[self.figures.index(7)] < MUCH_SMALLER * self.resolution

    def below_resolution(self) -> BoolArray:
        """Return in which runs all five paths stay below the resolution, shape (runs,)."""
        return self.settled.max(axis=0) < self.resolution

    def speed_worse_when_it_varies(self) -> BoolArray:
        """Return in which runs Figs 10b and 11c are worse than all of Figs 7 to 9, (runs,)."""
        row = {figure: self.speed[i] for i, figure in enumerate(self.figures)}
        steady = np.maximum.reduce([row[7], row[8], row[9]])
        return (row[10][:, 0] > steady[:, 0]) & (row[11][:, 1] > steady[:, 1])

    def by_claim(self) -> dict[str, BoolArray]:
        """Return in which runs each of `CLAIMS` is true, as a dict of arrays of shape (runs,)."""
        three = (
            self.small_in_figure_7(),
            self.below_resolution(),
            self.speed_worse_when_it_varies(),
        )
        return dict(zip(CLAIMS, (*three, np.all(three, axis=0)), strict=True))


@checked
def score_paths(
    runs: Runs, *, rng: np.random.Generator, s: AutomotiveSettings | None = None
) -> PathScores:
    """Run all five paths and score them.

    runs: Number of independent records of each path.
    rng: Source of the measurement noise.
    s: Those of the data file if None.

    Examples
    --------
    >>> score_paths(2, rng=np.random.default_rng(1)).settled.shape
    (5, 2)
    """
    s = automotive_settings() if s is None else s
    return _scores(_unit_noise(runs, rng, s), s)


def _unit_noise(runs, rng, s):
    """Return unit-variance noise for every path, (K, position and velocity, paths, runs, axis).

    Time first, so that a step of the filter works on contiguous memory.
    """
    one, nothing = s.with_(sigma_x=1.0, sigma_v=1.0), np.zeros((s.samples, 4))
    children = rng.spawn(len(vehicle_paths()))
    noise = np.stack([measure_vehicle(nothing, runs, rng=child, s=one) for child in children])
    noise = noise.reshape(*noise.shape[:-1], 2, 2)
    return np.ascontiguousarray(np.moveaxis(noise, (2, 4), (0, 1)))


def _scores(noise, s):
    """Score the paths with this noise, scaled to the settings.

    The error after a step is e_k = (I - K) (F e_{k-1} - push) + K n_k, where push is what the truth
    does beside the model: x_k = F x_{k-1} + push. The filter is linear and its gains depend on no
    measurement, so the errors need neither states nor measurements, and both axes share F and K of
    2 by 2. `e` (2, paths * runs * axes) holds position and velocity of all of them side by side,
    so that a step is one product of matrices. Only what is scored is kept.
    """
    five = vehicle_paths()
    truth = np.stack([path.truth for path in five.values()], axis=1)
    F = ncv_transition(s.T, dim=1)
    push = (truth[1:] - truth[:-1] @ ncv_transition(s.T).T).reshape(-1, len(five), 2, 2)
    K = gain_sequence(s)
    stay = np.eye(2) - K[1:]
    A, scaled = stay @ F, K * [s.sigma_x, s.sigma_v]
    pushed = np.einsum("kij,kfaj->kifa", stay, push)[..., None, :]
    shape, flat = noise.shape[1:], noise.reshape(*noise.shape[:2], -1)
    e = scaled[0] @ flat[0]  # the first state is the first measurement: its gain is the identity
    whole = np.sum(e[0].reshape(shape[1:]) ** 2, axis=-1)
    settled, speed = np.zeros_like(whole), np.zeros(shape[1:])
    for k in range(1, s.samples):
        e = (A[k - 1] @ e + scaled[k] @ flat[k]).reshape(shape) - pushed[k - 1]
        off = e[0, ..., 0] ** 2 + e[0, ..., 1] ** 2
        if k < s.skip:
            np.maximum(whole, off, out=whole)
        else:
            np.maximum(settled, off, out=settled)
            speed += e[1] ** 2
        e = e.reshape(2, -1)
    return PathScores(
        tuple(five),
        settled=np.sqrt(settled),
        whole=np.sqrt(np.maximum(whole, settled)),
        speed=np.sqrt(speed / (s.samples - s.skip)),
        resolution=s.range_resolution,
    )


@checked
def claim_map(
    rows: Axis,
    columns: Axis,
    runs: Runs,
    *,
    rng: np.random.Generator,
    s: AutomotiveSettings | None = None,
) -> dict[str, FloatArray]:
    """Return the fraction of runs in which each claim holds, over two settings.

    rows, columns: Name and values of a setting: "sigma_x", "sigma_v" or "w" of
        `AutomotiveSettings`.
    runs: Number of records of each path at each place of the map.
    rng: Source of the measurement noise. Every place gets the same draws, scaled: places differ by
        their settings alone.
    s: What is not varied; those of the data file if None.
    Returns (3, rows, columns): For each of `CLAIMS` the fraction of runs in which it is true, and
        the ends of its 95 % interval.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> shares = claim_map(("sigma_x", [0.5]), ("w", [0.01, 0.1]), 2, rng=rng)
    >>> shares["all three"].shape
    (3, 1, 2)
    """
    s = automotive_settings() if s is None else s
    (row, heights), (column, widths) = rows, columns
    noise = _unit_noise(runs, rng, s)
    shape = len(heights), len(widths)
    shares: dict[str, FloatArray] = {name: np.empty((3, *shape)) for name in CLAIMS}
    for i, j in np.ndindex(shape):
        here = s.with_(**{row: heights[i], column: widths[j]})
        for name, true in _scores(noise, here).by_claim().items():
            share = proportion_interval(true)
            shares[name][:, i, j] = share.value, share.low, share.high
    return shares


@checked
def decided_claims(shares: Reals) -> IntArray:
    """Return 1 where a claim holds in a fraction `MOST` of the runs, -1 where not, 0 if undecided.

    shares (3, ...): Shares and the ends of their intervals, from `claim_map`.
    Returns (...): 1 where the whole interval says so, -1 where it says the contrary, 0 where the
        runs are too few to tell.

    Examples
    --------
    >>> decided_claims([[1.0, 0.9, 0.2], [0.95, 0.7, 0.1], [1.0, 0.97, 0.3]]).tolist()
    [1, 0, -1]
    """
    if shares.shape[:1] != (3,):
        raise ValueError(f"shares must have 3 as its first axis, got shape {shares.shape}")
    return np.where(shares[1] >= MOST, 1, np.where(shares[2] < MOST, -1, 0))


@checked
def claim_borders(
    values: Annotated[FloatArray, exactly(None)], shares: Annotated[FloatArray, exactly(3, None)]
) -> list[tuple[float, float, bool]]:
    """Return the borders between the values of a setting at which a claim holds and does not.

    values (values,): Of the setting, in rising order.
    shares (3, values): A row or a column of what `claim_map` returns for a claim.
    Returns: The last value before and the first one after, both decided, and whether the claim
        holds after it.

    Examples
    --------
    >>> claim_borders([1, 2, 3], [[1.0, 0.9, 0.2], [0.95, 0.7, 0.1], [1.0, 0.97, 0.3]])
    [(1.0, 3.0, False)]
    """
    _checks.check_shape("shares", shares, (3, len(values)))
    verdicts = decided_claims(shares)
    told = [(value, one) for value, one in zip(values, verdicts, strict=True) if one]
    return [
        (float(before), float(after), bool(now > 0))
        for (before, was), (after, now) in pairwise(told)
        if was != now
    ]


@checked
def claim_borders_along(
    name: Literal["sigma_x", "sigma_v", "w"],
    values: Annotated[FloatArray, exactly(None)],
    runs: Runs,
    *,
    rng: np.random.Generator,
    s: AutomotiveSettings | None = None,
) -> dict[str, list[tuple[float, float, bool]]]:
    """Return the borders of every claim along one setting, see `claim_borders`.

    name: The setting.
    values (values,): In rising order.
    runs: Number of records of each path at each value.
    rng: Source of the measurement noise.
    s: What is not varied; those of the data file if None.
    Returns: For each of `CLAIMS`, see `claim_borders`.

    Examples
    --------
    >>> found = claim_borders_along("w", [0.001, 0.1], 2, rng=np.random.default_rng(1))
    >>> list(found) == list(CLAIMS)
    True
    """
    s = automotive_settings() if s is None else s
    other = "w" if name == "sigma_x" else "sigma_x"  # stays what it is
    shares = claim_map((name, values), (other, (getattr(s, other),)), runs, rng=rng, s=s)
    return {claim: claim_borders(values, share[..., 0]) for claim, share in shares.items()}
