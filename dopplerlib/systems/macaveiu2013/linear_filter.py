"""The linear Kalman filter of Section III on the paths of Section IV (Figs 7 to 11)."""

from collections.abc import Iterable
from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Array, Runs, checked, exactly, shaped
from ..._records import record
from ..._typing import FloatArray
from ...estimation.linear_kalman import kf
from ...estimation.track import Track
from ...evaluation.consistency import nees
from ...model.motion import ncv_transition
from .settings import AutomotiveSettings, automotive_settings
from .truth import Truth, VehiclePath

Measured = Annotated[FloatArray, exactly(None, None, 4)]  # [x, v_x, y, v_y] in runs, times


@checked
@record
class VehicleRuns:
    """One path, measured and filtered many times.

    path: The path.
    z (runs, K, 4): Measurements [x, v_x, y, v_y] in m and m/s.
    x (runs, K, 4): Estimates; the first is the first measurement.
    P (K, 4, 4): Their covariance as the filter reports it, the same in all runs.
    nis (runs, K): Normalized innovation squared; NaN at the first sample.

    Examples
    --------
    >>> path = VehiclePath(0, "at rest", [[0.0, 0.0, 5.0, 0.0]] * 20)
    >>> runs = track_vehicle(path, 3, rng=np.random.default_rng(1))
    >>> runs.nees.shape, runs.position_error.shape
    ((3, 20), (3, 20))
    """

    path: VehiclePath
    z: Measured
    x: Measured
    P: Annotated[FloatArray, shaped(4, 4)]
    nis: Array

    @property
    def error(self) -> FloatArray:
        """Estimate minus truth, shape (runs, K, 4)."""
        return self.x - self.path.truth

    @property
    def nees(self) -> FloatArray:
        """Normalized estimation error squared, shape (runs, K)."""
        return nees(Track(self.x, self.P, None, None, self.nis, None), self.path.truth)

    @property
    def position_error(self) -> FloatArray:
        """Distance of the estimate from the true position in m, shape (runs, K)."""
        return np.hypot(self.error[..., 0], self.error[..., 2])


@checked
def track_vehicle(
    path: VehiclePath,
    runs: Runs,
    *,
    rng: np.random.Generator,
    s: AutomotiveSettings | None = None,
) -> VehicleRuns:
    """Measure and filter a path as the document does: H = I, start at the first measurement.

    path: One of `vehicle_paths`, or another one sampled alike.
    runs: Number of independent records.
    rng: Source of the measurement noise. Run 3 is the same for any number of runs.
    s: Those of the data file if None.

    Notes
    -----
    Macaveiu et al. (2013), Eqs 1 to 6.

    Examples
    --------
    >>> path = VehiclePath(0, "at rest", [[0.0, 0.0, 5.0, 0.0]] * 20)
    >>> track_vehicle(path, 3, rng=np.random.default_rng(1)).x.shape
    (3, 20, 4)
    """
    s = automotive_settings() if s is None else s
    z = measure_vehicle(path.truth, runs, rng=rng, s=s)
    H, E_z = np.eye(4), s.E_z
    one = kf(z[:, 1:], ncv_transition(s.T), s.E_x, H, E_z, x0=z[:, 0], P0=E_z)
    x = np.concatenate([z[:, :1], one.x], axis=1)
    P = np.concatenate([E_z[None], one.P[0]])
    nis = np.concatenate([np.full((runs, 1), np.nan), one.nis], axis=1)
    return VehicleRuns(path, z, x, P, nis)


@checked
def measure_vehicle(
    truth: Truth, runs: Runs, *, rng: np.random.Generator, s: AutomotiveSettings | None = None
) -> FloatArray:
    """Return measurements of all four components of a path, with noise (Eq 5).

    truth (K, 4): True states.
    runs: Number of independent records.
    rng: Source of the measurement noise. Run 3 is the same for any number of runs.
    s: Those of the data file if None.
    Returns (runs, K, 4)
    Raises ValueError if an argument is not of the kind described, or the records would have more
        than ten million samples.

    Examples
    --------
    >>> measure_vehicle([[0.0, 0.0, 5.0, 0.0]] * 20, 3, rng=np.random.default_rng(1)).shape
    (3, 20, 4)
    """
    s = automotive_settings() if s is None else s
    _checks.count("runs times samples", runs * len(truth), 10**7)
    noise = np.stack([child.standard_normal(truth.shape) for child in rng.spawn(runs)])
    return truth + noise * [s.sigma_x, s.sigma_v, s.sigma_x, s.sigma_v]


@checked
def tracking_errors(
    paths: Iterable[VehiclePath],
    runs: Runs,
    *,
    rng: np.random.Generator,
    s: AutomotiveSettings | None = None,
) -> FloatArray:
    """Measure and filter several paths at once; return errors only, and fast.

    paths: The paths, of one length.
    runs: Number of independent records of each.
    rng: Source of the measurement noise; every path has noise of its own.
    s: Those of the data file if None.
    Returns (paths, runs, K, 4): Estimate minus truth, the same as `track_vehicle` gives.

    Examples
    --------
    >>> path = VehiclePath(0, "at rest", [[0.0, 0.0, 5.0, 0.0]] * 20)
    >>> tracking_errors([path, path], 3, rng=np.random.default_rng(1)).shape
    (2, 3, 20, 4)
    """
    s, paths = automotive_settings() if s is None else s, tuple(paths)
    lengths = [len(path.truth) for path in paths]
    if len(set(lengths)) != 1:
        raise ValueError(f"paths must be some of one length, got {lengths}")
    z = np.stack([
        measure_vehicle(path.truth, runs, rng=child, s=s)
        for path, child in zip(paths, rng.spawn(len(paths)), strict=True)
    ])  # fmt: skip
    return filter_vehicle(z, s) - np.stack([path.truth for path in paths])[:, None]


@checked
def filter_vehicle(
    z: Annotated[FloatArray, shaped(None, 4)], s: AutomotiveSettings | None = None
) -> FloatArray:
    """Return the estimates of the filter, for one gain sequence and both axes at once.

    z (..., K, 4): Measurements. Without noise, what comes out tells where the filter lags.
    s: Those of the data file if None; its number of samples is that of the measurements.
    Returns (..., K, 4)

    Examples
    --------
    >>> filter_vehicle([[0.0, 0.0, 5.0, 0.0]] * 3)[-1].round(9).tolist()
    [0.0, 0.0, 5.0, 0.0]
    """
    s = automotive_settings() if s is None else s
    if not z.shape[-2]:
        raise ValueError(f"z must have a sample, got shape {z.shape}")
    # Time first and the axes last, so that a step works on contiguous memory.
    z = z.reshape(*z.shape[:-1], 2, 2)
    z = np.ascontiguousarray(np.moveaxis(z, (-3, -1), (0, 1)))  # (K, 2, ..., 2)
    x = np.empty_like(z)
    x[0] = p, v = z[0]
    for k, K in enumerate(gain_sequence(s.with_(samples=len(z)))[1:], start=1):
        p = p + s.T * v
        nu_p, nu_v = z[k, 0] - p, z[k, 1] - v
        x[k] = p, v = p + (K[0, 0] * nu_p + K[0, 1] * nu_v), v + (K[1, 0] * nu_p + K[1, 1] * nu_v)
    return np.moveaxis(x, (0, 1), (-3, -1)).reshape(*x.shape[2:-1], len(x), 4)


@checked
def gain_sequence(s: AutomotiveSettings | None = None) -> FloatArray:
    """Return the gains of the filter for one axis.

    s: Those of the data file if None.
    Returns (K, 2, 2): They do not depend on the data. The first belongs to the start, and is the
        unit matrix.

    Notes
    -----
    Eq 6 for a 2 x 2 matrix written out, with K = P (P + E_z)^{-1}: thousands of calls make a map.

    Examples
    --------
    >>> gain_sequence().shape
    (500, 2, 2)
    """
    s = automotive_settings() if s is None else s
    R, q = (s.sigma_x**2, s.sigma_v**2), s.w**2
    pp, pv, vv = R[0], 0.0, R[1]  # P: the entries of a symmetric matrix
    gains = [[[1.0, 0.0], [0.0, 1.0]]]
    for _ in range(1, s.samples):
        pp, pv, vv = pp + 2 * s.T * pv + s.T**2 * vv, pv + s.T * vv, vv + q
        determinant = (pp + R[0]) * (vv + R[1]) - pv**2
        K = [
            [(pp * (vv + R[1]) - pv**2) / determinant, pv * R[0] / determinant],
            [pv * R[1] / determinant, (vv * (pp + R[0]) - pv**2) / determinant],
        ]
        pp, pv, vv = K[0][0] * R[0], K[0][1] * R[1], K[1][1] * R[1]  # P = K E_z, as H = I
        gains.append(K)
    return np.array(gains)
