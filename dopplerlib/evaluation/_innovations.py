"""Common parts of consistency tests: innovations, of which some are missing, and states."""

import warnings

import numpy as np

from .. import _checks
from ..estimation.track import Track


def measured(innovation, S, record=False, of=""):
    """Check innovations and their covariances, and set missing ones apart.

    Where a component of an innovation is NaN it was not measured, as a `Track` has it: there the
    innovation becomes 0, and the row and column of S those of a unit matrix. Then the quadratic
    form is that of the components that are there, and so is each of their Cholesky factors.

    innovation (..., m): In a record (..., K, m).
    S (..., m, m): Covariances; what belongs to a missing component does not matter. In a record
        (..., K, m, m).
    record: Whether there is an axis of time, which S must have too.
    of: Prefix of both names in an error.
    Returns innovation, S
        there (..., m): Where a component was measured.
    Raises ValueError if the shapes do not fit, an innovation is infinite, or S is no covariance of
        what is there.
    """
    names = f"{of}innovation", f"{of}S"
    innovation = _checks.measured(names[0], innovation, (None, None) if record else (None,))
    own = innovation.shape[-2:] if record else innovation.shape[-1:]
    S = _checks.real(names[1], S)
    _checks.check_shape(names[1], S, (own[-1], own[-1]))
    _checks.check_shape(names[1], S, (*own, own[-1]))
    leading = innovation.shape[: -len(own)]
    _checks.check_broadcast(names[0], leading, names[1], S.shape[: -len(own) - 1])
    there = ~np.isnan(innovation)
    if not there.all():
        innovation = np.where(there, innovation, 0.0)
        pairs = there[..., :, None] & there[..., None, :]
        S = np.where(pairs, S, np.eye(own[-1]))
    return innovation, _checks.covariance(names[1], S, own[-1]), there


def of_track(track):
    """Return innovations (..., K, m), S and where there is a value, of a track that has them.

    Raises ValueError if it has none, they are refused by `measured`, or a record holds no
        measurement at all: a test of which would be passed by a filter that has failed.
    """
    _checks.instance("track", track, Track)
    for name in ("innovation", "S"):
        if getattr(track, name) is None:
            raise ValueError(f'track must hold {name}, got None: keep "{name}" when filtering')
    innovation, S, there = measured(track.innovation, track.S, record=True, of="track.")
    if not there.any(axis=(-2, -1)).all():
        raise ValueError("track.innovation must hold a value in each record, got only NaN")
    return innovation, S, there


def estimates(track):
    """Return states, covariances and their Cholesky factors of a track.

    Factors are None if a covariance is singular.
    Raises ValueError if it has none that can be judged.
    """
    if not (hasattr(track, "x") and hasattr(track, "P")):  # an ImmTrack has them as well
        _checks.instance("track", track, Track)
    if track.P is None:
        raise ValueError('track must hold P, got None: ask ekf for it with keep=("P",)')
    x = _checks.finite("track.x", track.x, (None, None))
    P, factor = _checks.factored("track.P", track.P, x.shape[-1], definite=False)
    _checks.check_shape("track.P", P, (*x.shape[-2:], x.shape[-1]))
    _checks.check_broadcast("track.P", P.shape[:-3], "track.x", x.shape[:-2])
    return x, P, factor


def whiten(vector, S, names="innovation, S", factor=None):
    """Return L^-1 vector with S = L L': independent values of variance 1 if all is right.

    Factors L that all runs share are used once for all of them. What is further off than 1e60
    deviations is refused, for sums of squares could not hold it.

    factor: L, if it is known.
    """
    L = np.linalg.cholesky(S) if factor is None else factor
    with np.errstate(all="ignore"):
        if vector.ndim > 2 and L.size == np.prod(L.shape[-3:]):
            runs = vector.reshape(-1, *vector.shape[-2:])
            columns = np.linalg.solve(L.reshape(L.shape[-3:]), np.moveaxis(runs, 0, -1))
            white = np.moveaxis(columns, -1, 0).reshape(vector.shape)
        else:
            white = np.linalg.solve(L, vector[..., None])[..., 0]
    if not (np.abs(white) <= 1e60).all():
        raise ValueError(
            f"{names} must belong together, got an error of over 1e60 standard deviations"
        )
    return white


def chi2_tail(statistic, dof):
    """Return the probability of a larger chi-square; NaN without any degree of freedom."""
    from scipy.special import chdtrc

    return np.where(dof > 0, chdtrc(np.maximum(dof, 1), statistic), np.nan)[()]


def winsorized(white, there, limit):
    """Return values (..., K, m) no farther from their median than `limit` standard deviations.

    The standard deviation is that of Gaussian values with the same median absolute deviation; a
    component of which more than half are equal stays as it is.
    """
    values = np.where(there, white, np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a component that is missing throughout
        middle = np.nanmedian(values, axis=-2, keepdims=True)
        spread = 1.4826 * np.nanmedian(np.abs(values - middle), axis=-2, keepdims=True)
    bounds = (np.where(spread > 0, middle + sign * limit * spread, white) for sign in (-1, 1))
    return np.where(there, np.clip(white, *bounds), white)


def ljung_box(white, there, lags, least=None):
    """Return the fields of a `Whiteness` for values of variance 1; nothing is checked.

    white (..., K, m): Zero where a value is missing.
    there (..., K, m): Which values are not missing.
    lags: Number of lags.
    least: Components with fewer values than that are left out; more than `lags` if None.
    """
    samples = white.shape[-2]
    n = there.sum(axis=-2)
    used = n >= (lags + 1 if least is None else least)
    highest = np.where(there, white, -np.inf).max(axis=-2)
    if (used & (highest == np.where(there, white, np.inf).min(axis=-2))).any():
        raise ValueError("innovation must vary in time, got a component that is constant")
    n = np.where(used, n, 1)
    white = np.where(there, white - (white.sum(axis=-2) / n)[..., None, :], 0.0)
    # The unit does not matter; a power of two changes no digit, and no square is zero or infinite.
    white = np.ldexp(white, -np.frexp(np.abs(white).max(axis=-2, keepdims=True))[1])
    power = np.where(used, np.sum(white**2, axis=-2), 1.0)
    found = zip(*(_lag(white, there, lag) for lag in range(1, lags + 1)), strict=True)
    products, pairs = (np.stack(one, axis=-2) for one in found)
    known = used[..., None, :] & (pairs > 0)
    pairs = np.where(known, pairs, 1)
    n, ratio = n[..., None, :], products / power[..., None, :]
    statistic = np.sum(np.where(known, n * (n + 2) / pairs * ratio**2, 0.0), axis=(-2, -1))
    # The sum of products goes with the number of pairs, that of squares with the number of values.
    whole = (samples - np.arange(1, lags + 1))[:, None] * n / (pairs * samples)
    dof = known.sum(axis=(-2, -1))
    return (
        np.where(known, ratio * whole, np.nan),
        statistic,
        lags * white.shape[-1] if known.all() else dof,
        chi2_tail(statistic, dof),
    )


def _lag(white, there, lag):
    """Return the sums of the products of values `lag` apart, and their number."""
    products = np.sum(white[..., lag:, :] * white[..., :-lag, :], axis=-2)
    return products, np.sum(there[..., lag:, :] & there[..., :-lag, :], axis=-2)
