"""Current practice for two sensors: track fusion with known and with unknown cross-covariance."""

from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Count, Index, Real, Runs, checked, exactly, shaped
from ..._records import record
from ..._typing import FloatArray, IntArray
from ...estimation.track import Track
from ...evaluation.consistency import nees
from ...evaluation.whiteness import innovation_whiteness
from ...tracking.fusion import covariance_intersection, fuse_measurements, fuse_state_vectors
from .published import reported
from .velocity_filter import VelocityTrack, _decibels, filter_velocity
from .velocity_paths import VelocityPath
from .window_transform import FilteredDoppler, measurement_variance


def _samples(name, value):
    array = _checks.finite(name, value, (None,))
    if array.ndim != 1 or (array < 0).any() or (array % 1 != 0).any() or (array > 1e9).any():
        raise ValueError(f"{name} must be numbers of samples, got {array.tolist()}")
    return array.astype(int)


Decibels = Annotated[float, _decibels]


@checked
@record
class FusedTrack:
    """Estimates by one way of fusing two sensors.

    x (runs, K, 2): Velocity and acceleration in m/s and m/s^2.
    P (1, K, 2, 2): Their covariances, which are the same for all runs.
    sample (K,): Numbers of the samples that they belong to.

    Examples
    --------
    >>> FusedTrack(np.zeros((3, 1, 2)), np.eye(2)[None, None], [0]).x.shape
    (3, 1, 2)
    """

    x: Annotated[FloatArray, exactly(None, None, 2)]
    P: Annotated[FloatArray, exactly(None, None, 2, 2)]
    sample: Annotated[IntArray, _samples]

    def __post_init__(self):
        """Check that the fields have one number of estimates."""
        if not self.x.shape[1] == self.P.shape[1] == len(self.sample):
            raise ValueError(
                f"sample must be {self.x.shape[1]} as estimates, got {len(self.sample)}"
            )


@checked
def merged_doppler(doppler: FilteredDoppler, snr_db: Decibels) -> tuple[FilteredDoppler, float]:
    """Return the measurements of two equally good sensors fused into those of one.

    doppler: ``v`` of shape (W, runs, 2, K).
    snr_db: Signal-to-noise ratio of both.
    Returns: One sensor.
        variance_ratio: Variance of its measurements over that of one of the two.

    Examples
    --------
    >>> truth, doppler = matched_model(2, 110, 15.0, rng=np.random.default_rng(1))
    >>> merged, ratio = merged_doppler(doppler, 15.0)
    >>> merged.v.shape, round(ratio, 3)
    ((1, 2, 1, 110), 0.5)
    """
    _two_sensors(doppler)
    R = measurement_variance(doppler.windows, snr_db).reshape(-1, 1, 1, 1, 1)
    z, both = fuse_measurements(doppler.v[:, :, 0, :, None], R, doppler.v[:, :, 1, :, None], R)
    seen = doppler.snr_db.mean(axis=2, keepdims=True)
    merged = FilteredDoppler(doppler.windows, doppler.first, z[:, :, None, :, 0], seen)
    return merged, float(both.flat[0] / R.flat[0])


@checked
def fuse_all(
    doppler: FilteredDoppler, snr_db: Decibels, *, delayed: bool = True, hop: Count = 1
) -> dict[str, FusedTrack]:
    """Fuse two sensors with a fixed window, in every way.

    doppler: Measurements, ``v`` of shape (W, runs, 2, K).
    snr_db: Signal-to-noise ratio of both.
    delayed, hop: See `filter_velocity`.
    Returns: For each way. The first estimates, up to the first scored sample, are left out.

    Examples
    --------
    >>> truth, doppler = matched_model(2, 110, 15.0, rng=np.random.default_rng(1))
    >>> {track.x.shape for track in fuse_all(doppler, 15.0).values()}
    {(2, 10, 2)}
    """
    _two_sensors(doppler)
    settings = dict(delayed=delayed, hop=hop)
    track = filter_velocity(doppler, snr_db, **settings)
    merged, ratio = merged_doppler(doppler, snr_db)
    center = filter_velocity(merged, snr_db, scale=ratio, **settings)
    late = slice(-(-(reported().chosen.scored - reported().chosen.first) // hop), None)
    (x1, x2), (P1, P2) = (
        np.moveaxis(track.x[:, :, late], 1, 0),
        np.moveaxis(track.P[:1, :, late], 1, 0),
    )
    ways = {
        "one sensor": (x1, P1),
        "naive": fuse_state_vectors(x1, P1, x2, P2),
        "covariance intersection": covariance_intersection(x1, P1, x2, P2),
        "Bar-Shalom and Campo": fuse_state_vectors(x1, P1, x2, P2, track.P12[:1, late]),
        "measurement fusion": (center.x[:, 0, late], center.P[:1, 0, late]),
    }
    sample = (doppler.first + hop * np.arange(track.x.shape[2]))[late]
    if not len(sample):
        raise ValueError(f"doppler must go on after the first scored sample, got {doppler.v.shape}")
    return {name: FusedTrack(x, P, sample) for name, (x, P) in ways.items()}


@checked
def matched_model(
    runs: Runs, samples: Runs, snr_db: Decibels, *, rng: np.random.Generator
) -> tuple[FloatArray, FilteredDoppler]:
    """Simulate a target and measurements that match the model of the filters exactly.

    runs, samples: Number of targets, and of samples of each.
    snr_db: Signal-to-noise ratio that the variance of the measurements belongs to, with the fixed
        window.
    rng: Source of randomness.
    Returns truth (runs, samples, 2): Velocity and acceleration, driven by white jerk.
        doppler: White measurements of two sensors at every sample.
    Raises ValueError if an argument is not of the kind described, or there would be more than ten
        million samples.

    Examples
    --------
    >>> truth, doppler = matched_model(2, 3, 15.0, rng=np.random.default_rng(1))
    >>> truth.shape, doppler.v.shape
    ((2, 3, 2), (1, 2, 2, 3))
    """
    _checks.count("runs times samples", runs * samples, 10**7)
    own, T = reported().chosen, reported().stated.T
    F = np.array([[1, T], [0, 1]])
    Q = own.q * np.array([[T**3 / 3, T**2 / 2], [T**2 / 2, T]])
    steps = rng.standard_normal((runs, samples, 2)) @ np.linalg.cholesky(Q).T
    truth = np.empty((runs, samples, 2))
    truth[:, 0] = np.array([reported().stated.v_before, 0]) + rng.standard_normal(
        (runs, 1)
    ) * np.array([0, own.acceleration_std])
    for k in range(1, samples):
        truth[:, k] = truth[:, k - 1] @ F.T + steps[:, k]
    R = measurement_variance(own.fixed_window, snr_db)
    noise = rng.standard_normal((runs, 2, samples)) * np.sqrt(R)
    v = truth[None, :, None, :, 0] + noise
    seen = np.full(v.shape, float(snr_db))
    return truth, FilteredDoppler(np.array([own.fixed_window]), 0, v, seen)


@checked
def fusion_summary(
    ways: dict[str, FusedTrack], truth: Annotated[FloatArray, shaped(None, 2)]
) -> dict[str, dict[str, FloatArray]]:
    """Return errors and NEES of each run, by the way of fusing and by what they are.

    ways: As `fuse_all` returns it.
    truth (..., K, 2): True velocity and acceleration; its last samples are those of the estimates.
    Returns (runs,): Root mean square errors, and the mean of NEES over the record, which should be
        2.
    Raises ValueError if an argument is not of the kind described, or the truth is shorter than the
        estimates.

    Examples
    --------
    >>> truth, doppler = matched_model(2, 110, 15.0, rng=np.random.default_rng(1))
    >>> fusion_summary(fuse_all(doppler, 15.0), truth)["naive"]["NEES"].shape
    (2,)
    """
    rows = {}
    for name, one in ways.items():
        _checks.check_shape("truth", truth[..., -one.x.shape[1] :, :], one.x.shape[1:])
        late = truth[..., -one.x.shape[1] :, :]
        rmse = np.sqrt(np.mean((one.x - late) ** 2, axis=-2))
        rows[name] = {
            "velocity (m/s)": rmse[:, 0],
            "acceleration (m/s²)": rmse[:, 1],
            "NEES": nees(Track(one.x, one.P, None, None, None, None), late).mean(axis=-1),
        }
    return rows


@checked
def fusion_errors(
    ways: dict[str, FusedTrack], path: VelocityPath
) -> dict[str, dict[str, FloatArray]]:
    """Return the errors of the velocity of each run on a path, by the way of fusing and phase.

    ways: As `fuse_all` returns it.
    path: The truth.
    Returns (runs,): Root mean squares in m/s.
    Raises ValueError if an argument is not of the kind described, or the estimates go beyond the
        path or hold none of a phase.

    Examples
    --------
    >>> from dopplerlib.systems.valarmathi import velocity_path
    >>> path = velocity_path("path 1")
    >>> way = FusedTrack(np.zeros((2, 2000, 2)), np.tile(np.eye(2), (1, 2000, 1, 1)), range(2000))
    >>> list(fusion_errors({"naive": way}, path)["naive"])
    ['maneuver (m/s)', 'constant velocity (m/s)']
    """
    phases = {"maneuver (m/s)": path.maneuver, "constant velocity (m/s)": path.constant}
    rows = {}
    for name, one in ways.items():
        inside = one.sample.max() < len(path.v)
        if not (inside and all(part[one.sample].any() for part in phases.values())):
            raise ValueError(f"ways[{name!r}].sample must be samples of all phases of the path")
        square = (one.x[..., 0] - path.v[one.sample]) ** 2
        rows[name] = {
            phase: np.sqrt(square[:, part[one.sample]].mean(axis=-1))
            for phase, part in phases.items()
        }
    return rows


@checked
def ablation(
    doppler: FilteredDoppler, snr_db: Decibels, path: VelocityPath
) -> dict[str, dict[str, FloatArray]]:
    """Return the gain of each step beyond the document's first algorithm, alone and together.

    doppler: Measurements on a path, ``v`` of shape (W, runs, 2, K).
    snr_db: Signal-to-noise ratio of both sensors.
    path: The truth.
    Returns (runs,): By the step, root mean square errors in m/s in the maneuver and at constant
        velocity, and beside each the error of one sensor with a fixed window over it, in the same
        run.

    Examples
    --------
    >>> from dopplerlib.systems.valarmathi import velocity_path
    >>> _, doppler = matched_model(2, 2000, 15.0, rng=np.random.default_rng(1))
    >>> len(ablation(doppler, 15.0, velocity_path("path 1")))
    14
    """
    rows = {}
    for delayed, hop in ((False, 1), (False, reported().chosen.fixed_window), (True, 1),
                         (True, reported().chosen.fixed_window)):  # fmt: skip
        told = ["delay in H"] * delayed + ["one measurement a window"] * (hop > 1)
        for way, errors in fusion_errors(
            fuse_all(doppler, snr_db, delayed=delayed, hop=hop), path
        ).items():
            if hop > 1 and way not in ("one sensor", "measurement fusion"):
                continue  # as without
            name = ", ".join(told + [way] * (way != "one sensor"))
            rows[name or "one sensor, fixed window"] = errors
    start = rows["one sensor, fixed window"]
    return {
        name: {
            key: value
            for phase in start
            for key, value in (
                (phase, errors[phase]),
                (f"gain, {phase.partition(' (')[0]}", start[phase] / errors[phase]),
            )
        }
        for name, errors in rows.items()
    }


@checked
def calibration(track: VelocityTrack, v: Real, skip: Index) -> dict[str, FloatArray]:
    """Compare the errors of one sensor's filter with those that it reports, at constant velocity.

    track: Of a target at constant velocity.
    v: That velocity in m/s.
    skip: Samples to leave out at the start.
    Returns (runs,): Error and claimed error in m/s, the mean of NIS, which should be 1, and the
        correlation of successive innovations, which should be 0. NIS is NaN if the start, where
        there is no innovation, is not left out.
    Raises ValueError if an argument is not of the kind described, or nothing is left after the
        start.

    Examples
    --------
    >>> truth, doppler = matched_model(2, 110, 15.0, rng=np.random.default_rng(1))
    >>> sorted(calibration(filter_velocity(doppler, 15.0), 250.0, 50))
    ['claimed (m/s)', 'error (m/s)', 'innovations, lag 1', 'mean NIS']
    """
    if -(-skip // track.hop) + 3 > track.x.shape[2]:
        raise ValueError(f"skip must leave three estimates of {track.x.shape[2]}, got {skip}")
    late = slice(-(-skip // track.hop), None)
    error = track.x[:, 0, late, 0] - v
    nu, S = track.innovation[:, 0, late], track.S[:, 0, late]
    white = innovation_whiteness(nu[..., None], S[..., None, None], lags=1)
    return {
        "error (m/s)": np.sqrt(np.mean(error**2, axis=-1)),
        "claimed (m/s)": np.sqrt(track.P[:, 0, -1, 0, 0]),
        "mean NIS": np.mean(nu**2 / S, axis=-1),
        "innovations, lag 1": white.autocorrelation[..., 0, 0],
    }


@checked
def error_correlation(doppler: FilteredDoppler, v: Real, lags: Index) -> FloatArray:
    """Return the autocorrelation of the measurement errors, at a constant velocity.

    doppler: Measurements of a target at constant velocity, with one window.
    v: That velocity in m/s.
    lags: Number of lags in samples.
    Returns (lags + 1,): Mean over the runs and sensors, from lag 0 on; see
        `overlap_correlation_discrete`.
    Raises ValueError if an argument is not of the kind described, or there are no more samples than
        lags.

    Examples
    --------
    >>> truth, doppler = matched_model(2, 110, 15.0, rng=np.random.default_rng(1))
    >>> error_correlation(doppler, 250.0, 2).shape
    (3,)
    """
    _checks.count("lags", lags, doppler.v.shape[-1] - 1, least=0)
    error = (doppler.v[0] - v).reshape(-1, doppler.v.shape[-1])
    count = error.shape[-1]
    products = [np.mean(error[:, : count - lag] * error[:, lag:]) for lag in range(lags + 1)]
    return np.array(products) / products[0]


def _two_sensors(doppler):
    if doppler.v.ndim != 4 or doppler.v.shape[2] != 2:
        raise ValueError(f"doppler must have v of shape (W, runs, 2, K), got {doppler.v.shape}")
