"""Probability that a target enters a ball on a straight line, from a tracker's estimate."""

from functools import cache
from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Positive, checked, exactly, up_to
from .._typing import ArrayLike, FloatArray
from ..estimation import covariances

_DRAWN = 2**14  # states at a time, which fit into the cache of a processor


def _not_negative(name, value):
    """Return `value` as an array of numbers, infinite ones allowed, or raise."""
    array = _checks.real(name, value)
    if not (array >= 0).all():
        raise ValueError(f"{name} must not be negative, got {array[~(array >= 0)].flat[0]}")
    return array


@checked
@_checks.quiet
def collision_probability(
    x: ArrayLike,
    P: ArrayLike,
    radius: Positive,
    within: Annotated[FloatArray, _not_negative],
    *,
    weights: ArrayLike | None = None,
    center: Annotated[ArrayLike, exactly(3)] = (0.0, 0.0, 0.0),
    deceleration: Annotated[ArrayLike, _not_negative] = np.inf,
    points: Annotated[int, up_to(10**5)] = 128,
) -> FloatArray:
    """Return the probability that a target enters a ball within a time, if it goes straight on.

    Parameters
    ----------
    x : array_like, shape (..., 6)
        Mean of the state in m and m/s; NaN where there is no estimate. Of a mixture
        (..., M, 6), as the `means` of a `GaussianSumTrack`.
    P : array_like, shape (..., 6, 6)
        Covariance; it may be singular. Of a mixture (..., M, 6, 6).
    radius : float
        Radius of the ball in m. The target is a point: add its own radius.
    within : array_like, scalar or shape (H,)
        Time ahead in s, zero or more; infinite: ever.
    weights : array_like, shape (..., M), optional
        Weights of the Gaussians of a mixture. They are divided by their sum; one of weight zero
        may be NaN.
    center : array_like, shape (3,)
        Center of the ball in m.
    deceleration : array_like, scalar or shape (H,)
        Of a machine that brakes from the speed of the target, in m/s^2: the time ahead is longer
        by speed / (2 deceleration), each possible state's own. So much earlier than the target
        would arrive at full speed has braking to begin.
    points : int
        States that are tried of each Gaussian.

    Returns
    -------
    ndarray, shape (...) or (..., H)
        NaN where there is no estimate.

    Raises
    ------
    ValueError
        If an argument has the wrong shape or value, or `P` is not a covariance.

    Notes
    -----
    The share of `points` states whose straight line enters the ball. They are no random draws but
    a Kronecker sequence, frac(k a^-j) in dimension j with a^7 = a + 1, made normal: more even than
    random ones, and the same in every call, so that probabilities over time do not jitter. Against
    integration, where the probability lies between 0.02 and 0.98, the error is 0.013 (RMS) for
    what a tracker knows of a target, 0.009 with 256 points, and 0.02 with 192 random draws; if all
    six components are as uncertain as each other it is twice that.

    Examples
    --------
    At one meter, coming in at 1 m/s straight on, or past the center at 0.1 m, known to 5 cm:

    >>> x = [[1.0, 0, 0, -1, 0, 0], [1.0, 0.1, 0, -1, 0, 0]]
    >>> P = np.diag([0.05, 0.05, 0.05, 0, 0, 0]) ** 2
    >>> collision_probability(x, P, 0.1, within=[0.5, 2.0]).round(1).tolist()
    [[0.0, 0.9], [0.0, 0.4]]
    """
    x, P = _checks.bounded("x", x, (6,)), _checks.bounded("P", P, (6, 6))
    _checks.check_leading(x=(x, 1), P=(P, 2))
    lead = np.broadcast_shapes(x.shape[:-1], P.shape[:-2])
    deceleration = np.asarray(deceleration)
    if within.ndim > 1:
        raise ValueError(f"within must be one number or of shape (H,), got shape {within.shape}")
    if deceleration.shape not in ((), within.shape):
        raise ValueError(
            f"deceleration must be one number or have the shape of within, {within.shape}, got "
            f"shape {deceleration.shape}"
        )
    deceleration = np.broadcast_to(deceleration, within.shape)
    weight = np.ones(lead)
    if weights is not None:
        _checks.check_shape("weights", _not_negative("weights", weights), (None,))
        weight = _checks.each_run("weights", _checks.real("weights", weights), lead, ())

    there = np.isfinite(x).all(axis=-1) & np.isfinite(P).all(axis=(-2, -1)) & (weight > 0)
    x = np.broadcast_to(x, (*lead, 6))[there] - np.pad(np.asarray(center), (0, 3))
    P = _checks.covariance("P", np.broadcast_to(P, (*lead, 6, 6))[there], 6, definite=False)
    normal, size = _normal(points), max(_DRAWN // points, 1)
    found = np.full((*lead, *within.shape), np.nan)
    found[there] = np.concatenate(
        [
            _shares(x[i : i + size], P[i : i + size], normal, radius, within, deceleration)
            for i in range(0, max(len(x), 1), size)
        ]
    )
    if weights is None:
        return found
    axis = len(lead) - 1
    weight = np.where(there, weight, 0.0).reshape(*lead, *(1,) * within.ndim)
    total = weight.sum(axis=axis)
    return np.where(weight > 0, weight * found, 0.0).sum(axis=axis) / total


def _shares(x, P, normal, radius, within, deceleration):
    """Return the shares (G, ...) of the states of G Gaussians that come nearer than the radius."""
    states = x[:, :, None] + covariances.square_root(P) @ normal
    q, v = states[:, :3], states[:, 3:]
    qq, qv, vv = (np.einsum("gin,gin->gn", a, b) for a, b in ((q, q), (q, v), (v, v)))
    nearest = np.where(qv < 0, -qv / vv, 0.0)  # time of the closest approach
    shares = np.empty((len(x), *within.shape))
    for h in np.ndindex(within.shape):
        ahead = np.minimum(nearest, within[h] + np.sqrt(vv) / (2 * deceleration[h]))
        shares[:, *h] = (qq + ahead * (2 * qv + ahead * vv) < radius**2).mean(axis=-1)
    return shares


@cache
def _normal(points):
    """Return evenly spread standard normal vectors (6, points), as columns."""
    from scipy.special import ndtri

    a = 1.0
    for _ in range(20):  # to the root of a^7 = a + 1: each step divides the error by 13
        a = (1 + a) ** (1 / 7)
    places = 0.5 + np.arange(1, points + 1) * a ** -np.arange(1.0, 7)[:, None]
    normal = ndtri(places % 1)
    normal.flags.writeable = False
    return normal
