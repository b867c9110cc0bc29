"""Test whether the covariance of an initial estimate, which is of first order, is right."""

from typing import Literal

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, FloatArray
from ..estimation.initial_estimate import InitialEstimate
from ..model.doppler import doppler_shift
from ..model.links import DopplerLinks, sample_times
from ..model.radar_array import RadarArray


@checked
@_checks.quiet
def chi_square_rise(
    start: InitialEstimate,
    z: ArrayLike,
    array: RadarArray | DopplerLinks,
    sigma_f: ArrayLike,
    T: ArrayLike,
    likelihood: Literal["constant_velocity", "stationary"] = "constant_velocity",
) -> FloatArray:
    """Return the rise of chi-square one standard deviation off, along the widest direction.

    Parameters
    ----------
    start : InitialEstimate
        Initial estimate at the first sample, of these measurements.
    z : array_like, shape (..., K, N)
        Doppler measurements in Hz, as they were given to `ml_initialize`.
    array : RadarArray or DopplerLinks
        The N sensors, or links whose clocks are not others at each sample.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz.
    T : array_like, scalar or shape (K,)
        See `ml_initialize`.
    likelihood : {"constant_velocity", "stationary"}
        See `ml_initialize`.

    Returns
    -------
    ndarray, shape (..., 2)
        The rise on both sides, by the longest axis of `start.P`; NaN where `P` is not finite.

    Raises
    ------
    ValueError
        If an argument is not of the kind described, or a state one deviation off lies on a sensor.

    Notes
    -----
    Both are 1 if chi-square is quadratic, as `P` presumes, 0.95 after the loss "bisquare". A rise
    of several says that the likely states fill a curved valley, in which errors are larger than
    `P` says and in other directions.

    Examples
    --------
    >>> from dopplerlib import ml_initialize
    >>> array = RadarArray.linear(5, 0.4)
    >>> z = doppler_shift([0.5, 0.2, 0, -1, 0.5, 0], array)[None]
    >>> box = [0.1, -1, 0, -2, -2, 0], [2, 1, 0, 2, 2, 0]
    >>> start = ml_initialize(z, array, 0.01, 0.001, box)
    >>> chi_square_rise(start, z, array, 0.01, 0.001).round(1).tolist()
    [1.0, 1.0]
    """
    if isinstance(array, DopplerLinks) and array.clock_model == "epoch":
        raise ValueError("array must have clocks that stay or drift, got those of an epoch")
    z = _checks.measured("z", z, (None, len(array)))
    K, n = z.shape[-2], array.n if isinstance(array, DopplerLinks) else 6
    start_x, P = _checks.measured("start", start.x, (n,)), _checks.real("start", start.P)
    weights, scale = _checks.real("start", start.weights), _checks.real("start", start.scale)
    shapes = start_x.shape, P.shape, weights.shape, scale.shape
    lead = z.shape[:-2]
    if shapes != ((*lead, n), (*lead, n, n), z.shape, lead):
        raise ValueError(f"start must be that of z with shape {z.shape}, got {start_x.shape}")
    sigma_f = _checks.each_run(
        "sigma_f", _checks.deviation("sigma_f", sigma_f), (K, len(array)), ()
    )  # fmt: skip
    times = sample_times(array, K, T)
    F = np.tile(np.eye(n), (K, 1, 1))
    if isinstance(array, DopplerLinks):
        array = array.sampled(K, T)
        F = array.transition(times - times[0])
    moving = likelihood == "constant_velocity"
    F[:, :3, 3:6] = moving * (times - times[0])[:, None, None] * np.eye(3)
    finite = np.isfinite(P).all(axis=(-2, -1))
    variance, axes = np.linalg.eigh(np.where(finite[..., None, None], P, 0.0))
    step = np.sqrt(np.maximum(variance[..., -1:], 0.0)) * axes[..., -1]
    used = weights > 0
    costs = []
    for side in (0.0, -1.0, 1.0):
        x = np.where(finite[..., None], start_x + side * step, start_x)
        known = np.isfinite(x).all(axis=-1)
        # Where there is no start any state will do, one that is on no sensor.
        h = doppler_shift(np.einsum("kij,...j->...ki", F, x[known]), array)
        r = np.full(z.shape, np.nan)
        r[known] = (h - z[known]) / sigma_f / scale[known][..., None, None]
        cost = np.sum(np.where(used, r, 0.0) ** 2, axis=(-2, -1))
        _checks.estimates("start, z, array, sigma_f, T", cost[known & finite])
        costs.append(np.where(known & finite, cost, np.nan))
    return np.stack([costs[1] - costs[0], costs[2] - costs[0]], axis=-1)
