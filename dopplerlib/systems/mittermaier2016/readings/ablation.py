"""Causes of the overconfidence of the paper's filter, each with a switch.

`ekf` is what the paper prints. `ablated_ekf` is the same filter in plain NumPy, with the two sides
of linearization apart: where the tangent is taken, and how much the world bends away from it.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np

from .... import _checks
from ...._hints import (
    Array,
    Count,
    Covariance,
    Index,
    Measurements,
    Positive,
    Reals,
    Runs,
    States,
    between,
    checked,
    exactly,
    up_to,
)
from ...._records import record
from ...._typing import FloatArray
from ....estimation import recursion
from ....estimation.extended_kalman import ekf
from ....estimation.track import Track
from ....evaluation.consistency import nees
from ....model.doppler import doppler_jacobian, doppler_shift
from ....model.motion import constant_velocity
from ....model.radar_array import RadarArray
from ....model.simulation import simulate
from ..published import reported

Noise = Literal["shared", "per_axis"]


@checked
@_checks.quiet
def ablated_ekf(
    z: Measurements,
    array: RadarArray,
    x0: States,
    P0: Covariance,
    T: Positive,
    sigma_a: Positive,
    sigma_f: Positive,
    noise: Noise = "shared",
    *,
    path: Annotated[FloatArray, exactly(None, 6)] | None = None,
    tangent_at: Literal["estimate", "path"] = "estimate",
    curvature: Annotated[float, between(0, 1)] = 1.0,
    second_order: bool = False,
) -> Track:
    """Track a target like `ekf`, with the linearization under control.

    z (runs, K, N): Doppler measurements in Hz.
    array: The N sensors.
    x0 (6,) or (runs, 6): State one interval before the first sample, in m and m/s.
    P0 (6, 6): Its covariance.
    T, sigma_a, sigma_f: Sampling interval in s, standard deviations of the acceleration in m/s^2
        and of a measurement in Hz.
    noise: See `constant_velocity`.
    path (K, 6): A path known to the experimenter, usually the true one. Needed by the next two
        switches.
    tangent_at: Where the Jacobian is evaluated. With "path" it is the same in every run, and so is
        P.
    curvature: How much of the bend there is, from 1, the Doppler shift as it is, to 0: the shift is
        what the tangent says, as seen from the path. On the path nothing changes, whatever it is.
    second_order: Whether the filter knows of the bend to second order: the mean of what the tangent
        misses is added to the predicted measurement, and its covariance to S.
    Returns: P has the leading axis 1 if it is the same in every run, else ``runs``.
    Raises ValueError if `tangent_at` is unknown, a switch needs a path and there is none, or an
        argument has the wrong shape.

    Notes
    -----
    With curvature c, tangent H and the path x the predicted measurement is
    c h(x^) + (1 - c) [h(x) + H (x^ - x)]. The filter of second order is that of Jazwinski (1970),
    Section 9.3; its second derivatives are differences of the Jacobian.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> z, x0 = np.full((1, 3, 6), 100.0), [0.8, 0.1, 0.1, -0.7, -0.1, 0.0]
    >>> ablated_ekf(z, RadarArray.ring(6, 0.2), x0, 0.1 * np.eye(6), 0.001, 0.4, 0.4).x.shape
    (1, 3, 6)
    """
    _checks.check_shape("z", z, (len(array),))
    P = _checks.covariance("P0", P0, 6)[None]
    if path is not None:
        _checks.check_shape("path", path, (z.shape[1], 6))
        shift, slope = doppler_shift(path, array), doppler_jacobian(path, array)
    elif tangent_at == "path" or curvature != 1:
        raise ValueError(f"path must be given with {tangent_at=} and {curvature=}, got None")
    F, Q = constant_velocity(T, sigma_a, noise)
    R = sigma_f**2 * np.eye(len(array))
    x = _checks.each_run("x0", x0, (len(z),), (6,))
    eye = np.eye(len(array))

    def step(k, state):
        x, P = state
        x, P = x @ F.T, F @ P @ F.T + Q
        H = slope[k] if tangent_at == "path" else doppler_jacobian(x, array)
        predicted = curvature * doppler_shift(x, array) if curvature else 0.0
        if curvature != 1:
            straight = shift[k] + _times(H, x - path[k])
            predicted = predicted + (1 - curvature) * straight
        PHt = P @ np.swapaxes(H, -1, -2)
        straight_S = H @ PHt
        S = straight_S + R
        if second_order:
            mean, covariance = _missed(x, P, array)
            predicted, S = predicted + curvature * mean, S + curvature**2 * covariance
        # One decomposition of S for the gain and for NIS.
        HP = np.broadcast_to(np.swapaxes(PHt, -1, -2), (*S.shape[:-1], 6))
        both = np.concatenate([HP, np.broadcast_to(eye, S.shape)], axis=-1)
        try:
            solved = np.linalg.solve(S, both)
        except np.linalg.LinAlgError:
            raise ValueError(
                "P0, T, sigma_a and sigma_f must keep the innovation covariance regular, "
                f"got a singular one at sample {k}"
            ) from None
        gain, weight = np.swapaxes(solved[..., :6], -1, -2), solved[..., 6:]
        innovation = z[:, k] - predicted
        x = x + _times(gain, innovation)
        # I - K H would do if S were H P H' + R; this holds with more in S as well.
        A = np.eye(6) - gain @ H
        extra = S - straight_S
        P = A @ P @ np.swapaxes(A, -1, -2) + gain @ extra @ np.swapaxes(gain, -1, -2)
        nis = np.sum(innovation * _times(weight, innovation), axis=-1)
        return (x, P), (x, P, innovation, S, nis)

    x, P, innovation, S, nis = recursion.scan(step, (x, P), range(z.shape[1]), axis=1)
    _checks.estimates("z, x0, P0, T, sigma_a and sigma_f", x, nis)
    return Track(x, P, innovation, S, nis, np.ones(z.shape[:2], bool))


@checked
@record
class Consistency:
    """Estimates, NEES and NIS of many runs of one filter, thinned in time.

    time (M,): The times kept, in s from the first sample.
    truth (M, 6): True states.
    x (runs, M, 6): Estimates.
    P (runs or 1, M, 6, 6): Their covariances as the filter reports them.
    nees (runs, M): Normalized estimation error squared.
    nis (runs, M): Normalized innovation squared.
    nis_average (runs,): Average of NIS over all samples of the record, not only those kept.
    """

    time: Annotated[FloatArray, exactly(None)]
    truth: Annotated[FloatArray, exactly(None, 6)]
    x: Annotated[FloatArray, exactly(None, None, 6)]
    P: Annotated[FloatArray, exactly(None, None, 6, 6)]
    nees: Annotated[FloatArray, exactly(None, None, check=_checks.measured)]
    nis: Annotated[FloatArray, exactly(None, None, check=_checks.measured)]
    nis_average: Array


@checked
def consistency_runs(
    runs: Runs,
    *,
    rng: np.random.Generator,
    keep: Iterable[Index] | None = None,
    samples: Annotated[int, up_to(100_000)] | None = None,
    start: States | None = None,
    P0: Covariance | None = None,
    noise: Noise = "shared",
    sigma_a: Positive | None = None,
    sigma_f: Reals | None = None,
    chunk: Count = 500,
    **switches: Any,
) -> Consistency:
    """Run the simulation example without a gate, and compare its errors with their covariances.

    runs: Number of independent records.
    rng: Source of the measurement noise, see `simulate`: run 3 is the same in any number of runs.
    keep: Numbers of the samples to keep, from 0; all if None.
    samples: Length of the records; that of the scenario if None.
    start (6,) or (runs, 6): Estimate at the first sample; that of Table 2 if None.
    P0 (6, 6): Its covariance; that of the scenario, 0.1 I, if None.
    noise: See `constant_velocity`.
    sigma_a: Standard deviation of the push that the filter assumes, in m/s^2; that of the scenario
        if None.
    sigma_f: Standard deviation that the filter assumes, in Hz; that of the scenario if None.
    chunk: Runs filtered at a time, so that memory does not grow with `runs`.
    **switches: `tangent_at`, `curvature`, `second_order` of `ablated_ekf`, which is used if there
        are any; its path is the truth.
    Raises ValueError if an argument is refused by `simulate`, `ekf` or `ablated_ekf`.

    Examples
    --------
    >>> consistency_runs(2, rng=np.random.default_rng(1), samples=20, keep=[0, 19]).nees.shape
    (2, 2)
    """
    s = reported().scenario
    if samples is not None:
        s = replace(s, samples=samples)
    keep = np.arange(s.samples) if keep is None else np.array(keep, int)
    if not keep.size or keep.max() >= s.samples:
        raise ValueError(f"keep must hold some of the {s.samples} samples, got {keep}")
    start = reported().table2.x_ml if start is None else start
    F, _ = constant_velocity(s.T, s.sigma_a)
    before = np.broadcast_to(np.linalg.solve(F, start[..., None])[..., 0], (runs, 6))
    settings = (s.P0 if P0 is None else P0, s.T, s.sigma_a if sigma_a is None else sigma_a)
    sigma_f = s.sigma_f if sigma_f is None else sigma_f
    parts = []
    for first in range(0, runs, chunk):
        rows = slice(first, min(first + chunk, runs))
        truth, z = simulate(s, rows.stop - first, rng=rng)
        args = (z, s.array, before[rows], *settings, sigma_f, noise)
        if switches:
            track = ablated_ekf(*args, path=truth, **switches)
        else:
            track = ekf(*args, keep=("P",))
        average = track.nis.mean(axis=-1)
        track = replace(track, x=track.x[:, keep], P=track.P[:, keep], nis=track.nis[:, keep])
        parts.append((track.x, track.P, nees(track, truth[keep]), track.nis, average))
    x, P, squared, nis, average = (np.concatenate(part) for part in zip(*parts, strict=True))
    if P.shape[0] != runs:
        P = P[:1]
    return Consistency(s.time[keep], truth[keep], x, P, squared, nis, average)


def matched_P0() -> FloatArray:
    """Return a covariance of the start whose size is that of the errors that Table 2 prints.

    Returns (6, 6): Diagonal; the same variance for the three positions, in m^2, and for the three
        velocities, in m^2/s^2, so that the mean squares of the two errors are the published ones.
    """
    error = reported().table2.x_ml - reported().table2.x0
    variance = [np.mean(error[:3] ** 2)] * 3 + [np.mean(error[3:] ** 2)] * 3
    return np.diag(variance)


@checked
def range_claims(result: Consistency) -> tuple[FloatArray, FloatArray]:
    """Return the actual error of the range, and the standard deviation that the filter reports.

    result: Runs of one filter.
    Returns actual (M,): Size of the error along the line of sight from the origin, in m: the median
        over the runs of its absolute value, divided by that of a standard normal number, so that
        lost runs count no more than others.
        claimed (M,): Median over the runs of its standard deviation as the filter reports it, in m.

    Examples
    --------
    >>> result = consistency_runs(2, rng=np.random.default_rng(1), samples=20, keep=[0, 19])
    >>> [one.shape for one in range_claims(result)]
    [(2,), (2,)]
    """
    u = result.truth[:, :3] / np.linalg.norm(result.truth[:, :3], axis=-1, keepdims=True)
    error = np.sum((result.x - result.truth)[..., :3] * u, axis=-1)
    variance = np.einsum("mi,rmij,mj->rm", u, result.P[..., :3, :3], u)
    # 0.6745 is the upper quartile of a standard normal number.
    return np.median(np.abs(error), axis=0) / 0.6745, np.median(np.sqrt(variance), axis=0)


def _times(matrix, vector):
    if matrix.ndim == 2 or len(matrix) == 1:  # the same in every run: one product for all
        return vector @ matrix.reshape(matrix.shape[-2:]).T
    return (matrix @ vector[..., None])[..., 0]


def _missed(x, P, array):
    """Return mean (..., N) and covariance (..., N, N) of the second-order term."""
    step = 1e-5 * np.eye(6)
    bend = doppler_jacobian(x[..., None, :] + step, array)
    bend = (bend - doppler_jacobian(x[..., None, :] - step, array)) / 2e-5
    BP = bend.swapaxes(-3, -2) @ P[..., None, :, :]  # (..., N, 6, 6)
    mean = np.trace(BP, axis1=-2, axis2=-1) / 2
    flat = BP.reshape(*BP.shape[:-2], 36)
    turned = BP.swapaxes(-1, -2).reshape(flat.shape)
    return mean, flat @ turned.swapaxes(-1, -2) / 2
