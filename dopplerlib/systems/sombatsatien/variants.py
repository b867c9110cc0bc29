"""The report's system in any number of runs, with each cause of failure repaired or not."""

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Covariance, Measurements, Runs, State, States, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...estimation.extended_kalman import ekf
from ...estimation.maximum_likelihood import ml_initialize
from ...model.doppler import doppler_shift
from ...model.radar_array import RadarArray
from ...model.scenario import Scenario
from ...model.simulation import simulate
from .._tracks import Tracks
from .descent import local_start
from .published import reported
from .student_filter import Jacobian, student_ekf

Plane = Literal["z", "x"]
LONG = 100  # a tenth of the record


@checked
@record
class PostMortem:
    """Runs of one variant of the report's system.

    time (K,): Times of the tracked samples in s; the first ones went into the start.
    truth (K, 6): True states.
    true_start (6,): True state one interval before the first tracked sample, where the filter
        starts.
    start (runs, 6): Estimates with which the filter starts.
    track: What the filter made of them, leading axis ``runs``.
    position_error, velocity_error (runs, K): Distances to the truth in m and m/s.
    """

    time: Annotated[FloatArray, exactly(None)]
    truth: Annotated[FloatArray, exactly(None, 6)]
    true_start: State
    start: Annotated[FloatArray, exactly(None, 6)]
    track: Tracks
    position_error: Annotated[FloatArray, exactly(None, None)]
    velocity_error: Annotated[FloatArray, exactly(None, None)]

    @property
    def position_rmse(self) -> FloatArray:
        """Root mean square position error of each run in m, shape (runs,)."""
        return np.sqrt(np.mean(self.position_error**2, axis=-1))

    @property
    def velocity_rmse(self) -> FloatArray:
        """Root mean square velocity error of each run in m/s, shape (runs,)."""
        return np.sqrt(np.mean(self.velocity_error**2, axis=-1))


@checked
def ring_scenario(plane: Plane) -> Scenario:
    """Return the simulation of the report with the ring in either plane.

    plane: z = 0 as in the report, or x = 0 as in the paper that it replicates, with the first
        sensor on +y.

    Examples
    --------
    >>> ring_scenario("x").array.positions[0].round(3).tolist()
    [0.0, 0.2, 0.0]
    """
    s = reported().scenario
    if plane == "z":
        return s
    radius = float(np.linalg.norm(s.array.positions[0]))
    array = RadarArray.ring(len(s.array), radius, normal="x", wavelength=s.array.wavelength)
    return replace(s, array=array)


def reported_record() -> FloatArray:
    """Return the measurements of the report's one run, noise included.

    Returns (1000, 6): Doppler measurements in Hz.

    Notes
    -----
    The notebook fixes the seed of NumPy's legacy generator, whose numbers never change.
    """
    s = reported().scenario
    noise = np.random.RandomState(reported().noise.seed).standard_normal((s.samples, len(s.array)))
    return doppler_shift(s.truth, s.array) + s.sigma_f * noise


@checked
def post_mortem(
    runs: Runs,
    *,
    rng: np.random.Generator | None,
    jacobian: Jacobian = "as reported",
    plane: Plane = "z",
    start: Literal["as reported", "global", "long", "truth"] | States = "as reported",
    P0: Covariance | None = None,
    z: Measurements | None = None,
    long: Runs = LONG,
) -> PostMortem:
    """Run the report's system, or a repaired one.

    runs: Number of independent records.
    rng: Source of the measurement noise, see `simulate`. Not needed with `z`.
    jacobian: See `student_jacobian`.
    plane: Plane of the ring, see `ring_scenario`.
    start (6,) or (runs, 6): "as reported": one descent, see `local_start`. "global":
        `ml_initialize` in the same box, on the same ten samples, for a target that moves. "long":
        the same on `long` samples, and `P0` is its covariance. "truth": the true state. Or
        states of one's own.
    P0 (6, 6): Covariance of the start; that of the report, 0.1 I, if None and the start brings
        none.
    z (runs, 1000, 6): Measurements in Hz, for what would be simulated.
    long: Samples of the "long" start, fewer than the record has.
    Raises ValueError if an argument is not one of those above, or is refused by `simulate` or the
        filter.

    Notes
    -----
    With the derived Jacobian the filter is `dopplerlib.ekf`, which is the same and faster; a test
    compares it with `student_ekf`.

    Examples
    --------
    >>> result = post_mortem(1, rng=np.random.default_rng(1), start="truth")
    >>> result.track.x.shape
    (1, 990, 6)
    """
    s, settings = ring_scenario(plane), reported().start
    if z is None:
        _, z = simulate(s, runs, rng=rng)
    else:
        _checks.exact_shape("z", z, (runs, s.samples, len(s.array)))
    if long >= s.samples:
        raise ValueError(f"long must be less than the {s.samples} samples, got {long}")
    used = long if isinstance(start, str) and start == "long" else settings.samples
    first, rest = np.split(z, [used], axis=1)
    true_start, truth = s.truth[used - 1], s.truth[used:]
    own = s.P0
    if isinstance(start, str):
        start, own = _start(start, first, s, settings, true_start)
    start = _checks.each_run("start", start, (runs,), (6,))
    given = rest, s.array, start, own if P0 is None else P0, s.T, s.sigma_a, s.sigma_f
    track = ekf(*given) if jacobian == "derived" else student_ekf(*given, jacobian)
    error = track.x - truth
    return PostMortem(
        s.time[used:],
        truth,
        true_start,
        start,
        track,
        np.linalg.norm(error[..., :3], axis=-1),
        np.linalg.norm(error[..., 3:], axis=-1),
    )


@checked
def repairs(runs: Runs, *, rng: np.random.Generator) -> dict[str, PostMortem]:
    """Run every combination of repairs on the same noise.

    runs: Number of independent records.
    rng: Source of the measurement noise.
    Returns: By what is repaired: the "sign" of the Jacobian, the "geometry" of the ring, the
        "start" by a global search. The first is "as reported"; the last is "all, longer start", see
        `post_mortem`.

    Examples
    --------
    >>> list(repairs(1, rng=np.random.default_rng(1)))[:4]
    ['as reported', 'start', 'geometry', 'geometry + start']
    """
    truth, z = simulate(reported().scenario, runs, rng=rng)
    noise = z - doppler_shift(truth, reported().scenario.array)
    z = {plane: doppler_shift(truth, ring_scenario(plane).array) + noise for plane in "zx"}
    derived = {
        (plane, start): post_mortem(
            runs, rng=None, jacobian="derived", plane=plane, start=start, z=z[plane]
        )
        for plane in "zx"
        for start in ("as reported", "global")
    }
    # A start takes as long as a run of the filter, so it is found once only.
    wrong = {
        (plane, start): post_mortem(runs, rng=None, plane=plane, start=one.start, z=z[plane])
        for (plane, start), one in derived.items()
    }
    results = {}
    for results_of, sign in ((wrong, []), (derived, ["sign"])):
        for (plane, start), one in results_of.items():
            done = [*sign, *["geometry"] * (plane == "x"), *["start"] * (start == "global")]
            results[" + ".join(done) or "as reported"] = one
    results["all, longer start"] = post_mortem(
        runs, rng=None, jacobian="derived", plane="x", start="long", z=z["x"]
    )
    return results


@checked
def consistent_runs(runs: Runs, *, rng: np.random.Generator) -> PostMortem:
    """Run the repaired filter from unbiased starts with errors of the covariance that it assumes.

    runs: Number of independent records.
    rng: Source of randomness.
    Returns: Runs of a filter with which nothing is wrong.
    Raises ValueError if `runs` is not a positive whole number, or `rng` is not a generator.

    Examples
    --------
    >>> consistent_runs(1, rng=np.random.default_rng(1)).position_rmse.shape
    (1,)
    """
    s = ring_scenario("x")
    error = 0.01 * rng.standard_normal((runs, 6))
    start = s.truth[reported().start.samples - 1] + error
    P0 = 0.01**2 * np.eye(6)
    return post_mortem(runs, rng=rng, jacobian="derived", plane="x", start=start, P0=P0)


def _start(name, z, s, settings, true_start):
    """Return the start of that name and its covariance."""
    if name == "truth":
        return true_start, s.P0
    if name == "as reported":
        return local_start(z, s.array, settings.guess, (settings.lower, settings.upper))[0], s.P0
    found = ml_initialize(z, s.array, s.sigma_f, s.T, (settings.lower, settings.upper), at="last")
    return found.x, found.P if name == "long" else s.P0
