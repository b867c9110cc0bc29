"""The report's system, run as often as wanted, with each cause of failure repaired or not."""

from dataclasses import replace

import numpy as np

from ... import _checks
from ..._records import record
from ...estimation.extended_kalman import ekf
from ...estimation.maximum_likelihood import ml_initialize
from ...estimation.track import Track
from ...evaluation.bounds import crlb
from ...evaluation.consistency import nees
from ...model.doppler import doppler_shift
from ...model.simulation import simulate
from ...model.twin import planar_twin
from .local_start import local_start
from .published import scenario, start_settings
from .student_filter import JACOBIANS, student_ekf

STARTS = ("as reported", "global", "long", "truth")
LONG = 100  # samples of the "long" start: a tenth of the record


@record
class PostMortem:
    """Runs of one variant of the report's system.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Times of the tracked samples in s; the first ones went into the start.
    truth : ndarray, shape (K, 6)
        True states.
    true_start : ndarray, shape (6,)
        True state one interval before the first tracked sample, where the filter starts.
    start : ndarray, shape (runs, 6)
        Estimates with which the filter starts.
    track : Track
        What the filter made of them, leading axis ``runs``.
    position_error, velocity_error : ndarray, shape (runs, K)
        Distances to the truth in m and m/s.
    """

    time: np.ndarray
    truth: np.ndarray
    true_start: np.ndarray
    start: np.ndarray
    track: Track
    position_error: np.ndarray
    velocity_error: np.ndarray

    @property
    def position_rmse(self):
        """Root mean square position error of each run in m, shape (runs,)."""
        return np.sqrt(np.mean(self.position_error**2, axis=-1))

    @property
    def velocity_rmse(self):
        """Root mean square velocity error of each run in m/s, shape (runs,)."""
        return np.sqrt(np.mean(self.velocity_error**2, axis=-1))


def post_mortem(
    runs, *, rng, jacobian="as reported", plane="z", start="as reported", P0=None, z=None
):
    """Run the report's system, or a repaired one.

    Parameters
    ----------
    runs : int
        Number of independent records.
    rng : numpy.random.Generator
        Source of the measurement noise, see `simulate`.
    jacobian : {"as reported", "derived"}
        See `student_jacobian`.
    plane : {"z", "x"}
        Plane of the ring, see `scenario`.
    start : {"as reported", "global", "long", "truth"} or array_like, shape (6,) or (runs, 6)
        "as reported": one descent, see `local_start`. "global": `ml_initialize` in the same box, on
        the same ten samples, for a target that moves. "long": the same on a hundred samples, and
        `P0` is its covariance. "truth": the true state. Or states of one's own.
    P0 : array_like, shape (6, 6), optional
        Covariance of the start; that of the report, 0.1 I, if None and the start brings none.
    z : array_like, shape (runs, 1000, 6), optional
        Measurements of one's own in Hz; `rng` is not used then.

    Returns
    -------
    PostMortem

    Raises
    ------
    ValueError
        If an argument is not one of those above, or is refused by `simulate` or the filter.

    Notes
    -----
    With the derived Jacobian the filter is `dopplerlib.ekf`, which is the same and faster; a test
    compares it with `student_ekf`.
    """
    s, settings = scenario(plane), start_settings()
    _checks.one_of("jacobian", jacobian, JACOBIANS)
    if z is None:
        _, z = simulate(s, runs, rng=rng)
    used = LONG if isinstance(start, str) and start == "long" else settings.samples
    first, rest = np.split(np.asarray(z, float), [used], axis=1)
    true_start, truth = s.truth[used - 1], s.truth[used:]
    own = s.P0
    if isinstance(start, str):
        start, own = _start(_checks.one_of("start", start, STARTS), first, s, settings, true_start)
    start = np.broadcast_to(start, (len(rest), 6))
    track = (student_ekf if jacobian == "as reported" else ekf)(
        rest, s.array, start, own if P0 is None else P0, s.T, s.sigma_a, s.sigma_f
    )
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


def repairs(runs, *, rng):
    """Run every combination of what is repaired and what is not, on the same noise.

    Parameters
    ----------
    runs : int
        Number of independent records.
    rng : numpy.random.Generator
        Source of the measurement noise.

    Returns
    -------
    dict of str to PostMortem
        By what is repaired: the "sign" of the Jacobian, the "geometry" of the ring, the "start" by
        a global search. The first is "as reported"; the last is "all, longer start", see
        `post_mortem`.
    """
    truth, z = simulate(scenario(), runs, rng=rng)
    noise = z - doppler_shift(truth, scenario().array)
    z = {plane: doppler_shift(truth, scenario(plane).array) + noise for plane in "zx"}
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


def consistent_runs(runs, *, rng):
    """Run the repaired filter from starts that err as it believes: by a centimeter, unbiased.

    Parameters
    ----------
    runs : int
        Number of independent records.
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    PostMortem
        Runs of a filter with which nothing is wrong.

    Raises
    ------
    ValueError
        If `runs` is not a positive whole number, or `rng` is not a generator.
    """
    runs = _checks.whole_number("runs", runs)
    _checks.generator("rng", rng)
    s, settings = scenario("x"), start_settings()
    error = 0.01 * rng.standard_normal((runs, 6))
    start = s.truth[settings.samples - 1] + error
    P0 = 0.01**2 * np.eye(6)
    return post_mortem(runs, rng=rng, jacobian="derived", plane="x", start=start, P0=P0)


def nearer_to_twin(result):
    """Return which runs started nearer to the twin of the true state than to the state itself.

    Parameters
    ----------
    result : PostMortem
        Runs with the ring in the plane x = 0; see `planar_twin`.

    Returns
    -------
    ndarray of bool, shape (runs,)
    """
    _checks.instance("result", result, PostMortem)
    distance = [
        np.linalg.norm((result.start - x)[:, :3], axis=-1)
        for x in (planar_twin(result.true_start), result.true_start)
    ]
    return distance[0] < distance[1]


def final_bound(plane):
    """Return the least root mean square error of the final position, given the whole record.

    Parameters
    ----------
    plane : {"z", "x"}
        Plane of the ring.

    Returns
    -------
    float
        In m: the Cramér-Rao bound for a target at constant velocity.
    """
    s = scenario(plane)
    P = crlb(s.x0, s.array, s.sigma_f, s.samples, s.T, "constant_velocity")
    F = np.eye(6)
    F[:3, 3:] = (s.samples - 1) * s.T * np.eye(3)
    return float(np.sqrt(np.trace((F @ P @ F.T)[:3, :3])))


def measures(result):
    """Return four numbers for each run: two of error, two of consistency.

    Parameters
    ----------
    result : PostMortem
        Runs of one variant.

    Returns
    -------
    dict of str to ndarray, shape (runs,)
        By name and unit.
    """
    _checks.instance("result", result, PostMortem)
    last = replace(result.track, x=result.track.x[:, -1:], P=result.track.P[:, -1:])
    return {
        "position RMSE (m)": result.position_rmse,
        "final error (m)": result.position_error[:, -1],
        "average NIS": result.track.nis.mean(axis=-1),
        "final NEES": nees(last, result.truth[-1:])[:, 0],
    }


def outcomes(result):
    """Return what the report prints of its own run, for each of these runs.

    Parameters
    ----------
    result : PostMortem
        Runs of the report's system.

    Returns
    -------
    dict of str to ndarray, shape (runs,)
        By name and unit; `reported_outcomes` has the report's.
    """
    _checks.instance("result", result, PostMortem)
    final = result.track.x[:, -1]
    return {
        "position RMSE (m)": result.position_rmse,
        "velocity RMSE (m/s)": result.velocity_rmse,
        "final position error (m)": result.position_error[:, -1],
        "final x (m)": final[:, 0],
        **{f"final v_{c} (m/s)": final[:, 3 + i] for i, c in enumerate("xyz")},
    }


def mirrored(x):
    """Return states mirrored at the plane z = 0: a ring in that plane sees no difference.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        States in m and m/s.

    Returns
    -------
    ndarray, shape (..., 6)
    """
    return np.asarray(x) * [1, 1, -1, 1, 1, -1]


def _start(name, z, s, settings, true_start):
    """Return the start of that name and its covariance."""
    if name == "truth":
        return true_start, s.P0
    if name == "as reported":
        return local_start(z, s.array, settings.guess, settings.box)[0], s.P0
    found = ml_initialize(z, s.array, s.sigma_f, s.T, settings.box, at="last")
    return found.x, found.P if name == "long" else s.P0
