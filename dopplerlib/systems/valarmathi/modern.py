"""What is done today with two sensors: fusion that knows, or owns not to know, what is common."""

from types import SimpleNamespace

import numpy as np

from ...evaluation.consistency import nees
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
        For each way states ``x (runs, K, 2)`` and covariances ``P (1, K, 2, 2)``, which are the
        same for all runs. The first estimates, up to the first scored sample, are left out.
    """
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
    return {name: SimpleNamespace(x=x, P=P) for name, (x, P) in ways.items()}


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


def mean_nees(fused, truth):
    """Return the mean of NEES over each run, shape (runs,).

    Parameters
    ----------
    fused : types.SimpleNamespace
        One of `fusions`.
    truth : ndarray, shape (..., K, 2)
        True velocity and acceleration at the same times; 2 would be right.

    Returns
    -------
    ndarray, shape (runs,)
    """
    return nees(fused, truth).mean(axis=-1)
