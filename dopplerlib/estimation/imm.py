"""The interacting multiple model estimator: several Kalman filters that share one target."""

import numpy as np

from .. import _checks
from .._records import record
from .._typing import ArrayLike
from . import gaussian, recursion


@record
class ImmTrack:
    """Estimates of a record by several models, after the updates.

    Attributes
    ----------
    x : ndarray, shape (..., K, n)
        State estimates, the mean over the models.
    P : ndarray, shape (..., K, n, n)
        Their covariances, with the spread between the models.
    mode : ndarray, shape (..., K, M)
        Probability of each model.
    """

    x: np.ndarray
    P: np.ndarray
    mode: np.ndarray


@_checks.quiet
def imm(
    z: ArrayLike,
    F: ArrayLike,
    Q: ArrayLike,
    H: ArrayLike,
    R: ArrayLike,
    transition: ArrayLike,
    x0: ArrayLike,
    P0: ArrayLike,
    mode0: ArrayLike | None = None,
) -> ImmTrack:
    """Filter whole records with several linear models between which the target may switch.

    Every cycle mixes, predicts, then updates.

    Parameters
    ----------
    z : array_like, shape (..., K, m)
        Measurements; NaN says that a component is missing at this sample, see `kf`.
    F, Q : array_like, shape (M, n, n) or (K, M, n, n)
        Transition matrix and process noise of each model; all have the same state. At uneven times
        for each sample, those of the step which leads to it.
    H : array_like, shape (m, n)
        Measurement matrix.
    R : array_like, shape (m, m)
        Covariance of the measurement noise.
    transition : array_like, shape (M, M)
        Probability to go from the model of the row to the model of the column in one step.
    x0 : array_like, shape (..., n)
        State one step before the first measurement; leading axes broadcast against those of `z`.
    P0 : array_like, shape (..., n, n)
        Its covariance; it may be singular: a component can be known exactly.
    mode0 : array_like, shape (M,), optional
        Probabilities of the models one step before the first measurement; equal if None.

    Returns
    -------
    ImmTrack

    Raises
    ------
    ValueError
        If shapes do not fit, there is no model or no sample, a value is not finite (but for a NaN
        in `z`), also of what comes out, a matrix is not a covariance, `R` is so small that the
        covariance of an innovation is singular to rounding, or probabilities are negative or do not
        add to 1.

    Notes
    -----
    Blom and Bar-Shalom (1988); Bar-Shalom, Li, Kirubarajan (2001), Sec 11.6.6. With one model it is
    `kf`. Inside, probabilities are logarithms: a model too improbable for a float may come back.

    Examples
    --------
    A constant that may begin to wander:

    >>> track = imm(
    ...     [[0.0], [0.1], [9.0]], np.ones((2, 1, 1)), [[[0.0]], [[25.0]]], [[1]], [[1]],
    ...     [[0.95, 0.05], [0.05, 0.95]], [0.0], [[1.0]],
    ... )
    >>> (track.mode[:, 1] > 0.5).tolist()
    [False, False, True]
    """
    F = _checks.finite("F", F, (None, None, None))
    M, n = F.shape[-3], F.shape[-1]
    if F.shape[-2] != n or not M:
        raise ValueError(f"F must have shape (M, n, n) of at least one model, got {F.shape}")
    Q = _checks.covariance("Q", Q, n, definite=False)
    H = _checks.matrix("H", H, (None, n))
    m = H.shape[0]
    R = _checks.matrix("R", _checks.covariance("R", R, m), (m, m))
    transition = _probabilities("transition", transition, (M, M))
    mode0 = _probabilities("mode0", np.full(M, 1 / M) if mode0 is None else mode0, (M,))
    z = _checks.measured("z", z, (None, m))
    if not z.size:
        raise ValueError(f"z must hold at least one run and one sample, got shape {z.shape}")
    batch, samples = z.shape[:-2], z.shape[-2]
    F = _checks.each_sample("F", F, samples, (M, n, n))
    Q = _checks.each_sample("Q", Q, samples, (M, n, n))
    x0 = _checks.each_run("x0", _checks.finite("x0", x0, (n,)), batch, (n,))
    P0 = _checks.each_run("P0", _checks.covariance("P0", P0, n, definite=False), batch, (n, n))

    x = np.repeat(x0[..., None, :], M, axis=-2)
    P = np.repeat(P0[..., None, :, :], M, axis=-3)
    with np.errstate(divide="ignore"):  # the logarithm of 0 is what it should be
        log_mode, log_transition = np.log(np.broadcast_to(mode0, (*batch, M))), np.log(transition)

    def step(k, state):
        x, P, log_mode = _step(*state, z[..., k, :], F[k], Q[k], H, R, log_transition)
        mode = _shares(log_mode, axis=-1)
        return (x, P, log_mode), (*gaussian.mixture(x, P, mode), mode)

    track = ImmTrack(*recursion.scan(step, (x, P, log_mode), range(samples), len(batch)))
    _checks.estimates("F, Q, H, R, x0, P0, z", track.x, track.P, track.mode)
    return track


def _step(x, P, log_mode, z, F, Q, H, R, log_transition):
    # Joint probability of the model before (axis -2) and the model now (axis -1).
    joint = log_mode[..., :, None] + log_transition
    now = np.logaddexp.reduce(joint, axis=-2)
    # A model that cannot be reached has probability zero, but its state has to stay finite.
    joint = np.where(now[..., None, :] > -np.inf, joint, log_mode[..., :, None])
    weight = np.swapaxes(_shares(joint, axis=-2), -1, -2)
    x, P = gaussian.mixture(x[..., None, :, :], P[..., None, :, :, :], weight)

    x, P = gaussian.predict(x, P, F, Q)
    innovation = gaussian.innovation(x, z[..., None, :], H)
    x, P, S = gaussian.update(x, P, innovation, H, R)
    log_mode = now + gaussian.log_density(innovation, S)
    return x, P, log_mode - log_mode.max(axis=-1, keepdims=True)


def _shares(log_weight, axis):
    """Return weights that add to 1 along the axis; at least one of their logarithms is finite."""
    with np.errstate(under="ignore"):  # a weight of zero is what it should be
        weight = np.exp(log_weight - log_weight.max(axis=axis, keepdims=True))
        return weight / weight.sum(axis=axis, keepdims=True)


def _probabilities(name, value, shape):
    value = _checks.finite(name, value, shape)
    off = np.abs(value.sum(axis=-1) - 1).max()
    if value.ndim != len(shape) or (value < 0).any() or off > 1e-9:
        raise ValueError(f"{name} must have rows of probabilities that add to 1, got {value}")
    return value
