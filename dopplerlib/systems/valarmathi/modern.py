"""What is done today with two sensors: fusion that knows, or owns not to know, what is common."""

from types import SimpleNamespace

import numpy as np

from ... import _checks
from ...evaluation.consistency import nees
from ...evaluation.whiteness import innovation_whiteness
from ...tracking.fusion import covariance_intersection, fuse_measurements, fuse_state_vectors
from .doppler_filter import FilteredDoppler, measurement_variance
from .filters import filter_velocity
from .published import chosen, stated


def merged_doppler(doppler, snr_db):
    """Return the measurements of two equally good sensors fused into those of one.

    Parameters
    ----------
    doppler : FilteredDoppler
        ``v`` of shape (W, runs, 2, K).
    snr_db : float
        Signal-to-noise ratio of both.

    Returns
    -------
    FilteredDoppler
        One sensor.
    variance_ratio : float
        Variance of its measurements over that of one of the two.
    """
    _checks.instance("doppler", doppler, FilteredDoppler)
    R = measurement_variance(doppler.windows, snr_db).reshape(-1, 1, 1, 1, 1)
    z, both = fuse_measurements(doppler.v[:, :, 0, :, None], R, doppler.v[:, :, 1, :, None], R)
    seen = doppler.snr_db.mean(axis=2, keepdims=True)
    merged = FilteredDoppler(doppler.windows, doppler.first, z[:, :, None, :, 0], seen)
    return merged, float(both.flat[0] / R.flat[0])


def fusions(doppler, snr_db, *, delayed=True, hop=1):
    """Fuse what two sensors with a fixed window see, in every way.

    Parameters
    ----------
    doppler : FilteredDoppler
        Measurements, ``v`` of shape (W, runs, 2, K).
    snr_db : float
        Signal-to-noise ratio of both.
    delayed, hop
        See `filter_velocity`.

    Returns
    -------
    dict of str to types.SimpleNamespace
        For each way states ``x (runs, K, 2)``, covariances ``P (1, K, 2, 2)``, which are the
        same for all runs, and the numbers ``sample (K,)`` of the samples that they belong to. The
        first estimates, up to the first scored sample, are left out.
    """
    _checks.instance("doppler", doppler, FilteredDoppler)
    settings = dict(delayed=delayed, hop=hop)
    track = filter_velocity(doppler, snr_db, **settings)
    merged, ratio = merged_doppler(doppler, snr_db)
    center = filter_velocity(merged, snr_db, scale=ratio, **settings)
    late = slice(-(-(chosen().scored - chosen().first) // hop), None)
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
    return {name: SimpleNamespace(x=x, P=P, sample=sample) for name, (x, P) in ways.items()}


def supposed_world(runs, samples, snr_db, *, rng):
    """Make a target and measurements that are exactly as the filters suppose.

    Parameters
    ----------
    runs, samples : int
        Number of targets, and of samples of each.
    snr_db : float
        Signal-to-noise ratio that the variance of the measurements belongs to, with the fixed
        window.
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    truth : ndarray, shape (runs, samples, 2)
        Velocity and acceleration, driven by white jerk.
    doppler : FilteredDoppler
        White measurements of two sensors at every sample.
    """
    own, T = chosen(), stated().T
    F = np.array([[1, T], [0, 1]])
    Q = own.q * np.array([[T**3 / 3, T**2 / 2], [T**2 / 2, T]])
    steps = rng.standard_normal((runs, samples, 2)) @ np.linalg.cholesky(Q).T
    truth = np.empty((runs, samples, 2))
    truth[:, 0] = np.array([stated().v_before, 0]) + rng.standard_normal((runs, 1)) * np.array(
        [0, own.acceleration_std]
    )
    for k in range(1, samples):
        truth[:, k] = truth[:, k - 1] @ F.T + steps[:, k]
    R = measurement_variance(own.fixed_window, snr_db)
    noise = rng.standard_normal((runs, 2, samples)) * np.sqrt(R)
    v = truth[None, :, None, :, 0] + noise
    seen = np.full(v.shape, float(snr_db))
    return truth, FilteredDoppler(np.array([own.fixed_window]), 0, v, seen)


def fusion_summary(ways, truth):
    """Return errors and NEES of each run, by the way of fusing and by what they are.

    Parameters
    ----------
    ways : dict of str to types.SimpleNamespace
        As `fusions` returns it.
    truth : ndarray, shape (..., K, 2)
        True velocity and acceleration; its last samples are those of the estimates.

    Returns
    -------
    dict of str to dict of str to ndarray, shape (runs,)
        Root mean square errors, and the mean of NEES over the record, which should be 2.
    """
    rows = {}
    for name, one in ways.items():
        late = truth[..., -one.x.shape[1] :, :]
        rmse = np.sqrt(np.mean((one.x - late) ** 2, axis=-2))
        rows[name] = {
            "velocity (m/s)": rmse[:, 0],
            "acceleration (m/s²)": rmse[:, 1],
            "NEES": nees(one, late).mean(axis=-1),
        }
    return rows


def fusion_errors(ways, path):
    """Return the errors of the velocity of each run on a path, by the way of fusing and phase.

    Parameters
    ----------
    ways : dict of str to types.SimpleNamespace
        As `fusions` returns it.
    path : VelocityPath
        The truth.

    Returns
    -------
    dict of str to dict of str to ndarray, shape (runs,)
        Root mean squares in m/s.
    """
    phases = {"maneuver (m/s)": path.maneuver, "constant velocity (m/s)": path.constant}
    rows = {}
    for name, one in ways.items():
        square = (one.x[..., 0] - path.v[one.sample]) ** 2
        rows[name] = {
            phase: np.sqrt(square[:, part[one.sample]].mean(axis=-1))
            for phase, part in phases.items()
        }
    return rows


def gains(doppler, snr_db, path):
    """Return what each step from the document's first algorithm on gains, alone and together.

    Parameters
    ----------
    doppler : FilteredDoppler
        Measurements on a path, ``v`` of shape (W, runs, 2, K).
    snr_db : float
        Signal-to-noise ratio of both sensors.
    path : VelocityPath
        The truth.

    Returns
    -------
    dict of str to dict of str to ndarray, shape (runs,)
        By the step, root mean square errors in m/s in the maneuver and at constant velocity, and
        beside each the error of one sensor with a fixed window over it, in the same run.
    """
    _checks.instance("doppler", doppler, FilteredDoppler)
    rows = {}
    for delayed, hop in ((False, 1), (False, chosen().fixed_window), (True, 1),
                         (True, chosen().fixed_window)):  # fmt: skip
        told = ["delay in H"] * delayed + ["one measurement a window"] * (hop > 1)
        for way, errors in fusion_errors(
            fusions(doppler, snr_db, delayed=delayed, hop=hop), path
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


def honesty(track, v, skip):
    """Compare what one sensor's filter claims with what it does, at a constant velocity.

    Parameters
    ----------
    track : VelocityTrack
        Of a target at constant velocity.
    v : float
        That velocity in m/s.
    skip : int
        Samples to leave out at the start.

    Returns
    -------
    dict of str to ndarray, shape (runs,)
        Error and claimed error in m/s, the mean of NIS, which should be 1, and the correlation of
        successive innovations, which should be 0.
    """
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


def error_correlation(doppler, v, lags):
    """Return the autocorrelation of the measurement errors, at a constant velocity.

    Parameters
    ----------
    doppler : FilteredDoppler
        Measurements of a target at constant velocity, with one window.
    v : float
        That velocity in m/s.
    lags : int
        Number of lags in samples.

    Returns
    -------
    ndarray, shape (lags + 1,)
        Mean over the runs and sensors, from lag 0 on; see `overlap_correlation_discrete`.
    """
    _checks.instance("doppler", doppler, FilteredDoppler)
    error = (doppler.v[0] - v).reshape(-1, doppler.v.shape[-1])
    count = error.shape[-1]
    products = [np.mean(error[:, : count - lag] * error[:, lag:]) for lag in range(lags + 1)]
    return np.array(products) / products[0]
