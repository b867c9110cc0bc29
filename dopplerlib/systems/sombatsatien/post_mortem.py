"""The report's system, run as often as wanted, with each cause of failure repaired or not."""

from dataclasses import dataclass

import numpy as np

from ... import _checks
from ...estimation.extended_kalman import ekf
from ...estimation.maximum_likelihood import ml_start
from ...estimation.track import Track
from ...model.doppler import doppler_shift
from ...model.simulation import simulate
from .local_start import local_start
from .published import scenario, start_settings
from .student_filter import JACOBIANS, student_ekf

STARTS = ("as reported", "global", "long", "truth")
LONG = 100  # samples of the "long" start: a tenth of the record


@dataclass(frozen=True)
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
        "as reported": one descent, see `local_start`. "global": `ml_start` in the same box, on the
        same ten samples, for a target that moves. "long": the same on a hundred samples, and `P0`
        is its covariance. "truth": the true state. Or states of one's own.
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
        rest, s.array, start, own if P0 is None else P0, s.T, s.sigma_p, s.sigma_f
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


def repairs(runs, *, rng, starts=("as reported", "global")):
    """Run every combination of what is repaired and what is not, on the same records.

    Parameters
    ----------
    runs : int
        Number of independent records.
    rng : numpy.random.Generator
        Source of the measurement noise. The noise is the same for both planes of the ring.
    starts : sequence of str
        Starts to try, see `post_mortem`.

    Returns
    -------
    dict of tuple to PostMortem
        By (jacobian, plane, start).
    """
    s, results = scenario(), {}
    truth, z = simulate(s, runs, rng=rng)
    noise = z - doppler_shift(truth, s.array)
    for plane in ("z", "x"):
        z = doppler_shift(truth, scenario(plane).array) + noise
        for start in starts:
            derived = post_mortem(runs, rng=None, jacobian="derived", plane=plane, start=start, z=z)
            # A start takes as long as a run of the filter, so it is found once only.
            x0 = derived.start if start == "as reported" else start
            results["as reported", plane, start] = post_mortem(
                runs, rng=None, plane=plane, start=x0, z=z
            )
            results["derived", plane, start] = derived
    return results


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
    found = ml_start(z, s.array, s.sigma_f, s.T, settings.box, at="last")
    return found.x, found.P if name == "long" else s.P0
