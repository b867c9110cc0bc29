"""The linear Kalman filter of Section III on the paths of Section IV (Figs 7 to 11)."""

import numpy as np

from ... import _checks
from ..._records import record
from ...estimation.linear_kalman import kf
from ...estimation.track import Track
from ...evaluation.consistency import nees
from ...model.motion import ncv_transition
from .published import Path2D, settings


@record
class Runs:
    """One path, measured and filtered many times.

    Attributes
    ----------
    path : Path2D
        The path.
    z : ndarray, shape (runs, K, 4)
        Measurements [x, v_x, y, v_y] in m and m/s.
    x : ndarray, shape (runs, K, 4)
        Estimates; the first is the first measurement.
    P : ndarray, shape (K, 4, 4)
        Their covariance as the filter believes it, the same in all runs.
    nis : ndarray, shape (runs, K)
        Normalized innovation squared; NaN at the first sample.
    """

    path: Path2D
    z: np.ndarray
    x: np.ndarray
    P: np.ndarray
    nis: np.ndarray

    @property
    def error(self):
        """Estimate minus truth, shape (runs, K, 4)."""
        return self.x - self.path.truth

    @property
    def nees(self):
        """Normalized estimation error squared, shape (runs, K)."""
        return nees(Track(self.x, self.P, None, None, self.nis, None), self.path.truth)

    @property
    def position_error(self):
        """Distance of the estimate from the true position in m, shape (runs, K)."""
        return np.hypot(self.error[..., 0], self.error[..., 2])


def track(path, runs, *, rng, s=None):
    """Measure and filter a path as the document does: H = I, start at the first measurement.

    Parameters
    ----------
    path : Path2D
        One of `paths`, or another one sampled alike.
    runs : int
        Number of independent records.
    rng : numpy.random.Generator
        Source of the measurement noise. Run 3 is the same for any number of runs.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    Runs

    Raises
    ------
    ValueError
        If `runs` is not a positive whole number, or `rng` is not a generator.

    Notes
    -----
    Macaveiu et al. (2013), Eqs 1 to 6.
    """
    _checks.instance("path", path, Path2D)
    s = settings() if s is None else s
    z = measure(path.truth, runs, rng=rng, s=s)
    H, E_z = np.eye(4), s.E_z
    one = kf(z[:, 1:], ncv_transition(s.T), s.E_x, H, E_z, x0=z[:, 0], P0=E_z)
    x = np.concatenate([z[:, :1], one.x], axis=1)
    P = np.concatenate([E_z[None], one.P[0]])
    nis = np.concatenate([np.full((runs, 1), np.nan), one.nis], axis=1)
    return Runs(path, z, x, P, nis)


def measure(truth, runs, *, rng, s=None):
    """Return measurements of all four components of a path, with noise (Eq 5).

    Parameters
    ----------
    truth : ndarray, shape (K, 4)
        True states.
    runs, rng, s
        See `track`.

    Returns
    -------
    ndarray, shape (runs, K, 4)

    Raises
    ------
    ValueError
        See `track`.
    """
    s = settings() if s is None else s
    runs = _checks.whole_number("runs", runs)
    _checks.generator("rng", rng)
    noise = np.stack([child.standard_normal(truth.shape) for child in rng.spawn(runs)])
    return truth + noise * [s.sigma_p, s.sigma_v, s.sigma_p, s.sigma_v]


def errors(paths, runs, *, rng, s=None):
    """Measure and filter several paths at once; return errors only, and fast.

    Parameters
    ----------
    paths : sequence of Path2D
        The paths.
    runs, rng, s
        See `track`; every path has noise of its own.

    Returns
    -------
    ndarray, shape (paths, runs, K, 4)
        Estimate minus truth, the same as `track` gives.

    Raises
    ------
    ValueError
        See `track`.
    """
    paths = _checks.records("paths", paths, Path2D)
    s = settings() if s is None else s
    children = rng.spawn(len(paths))
    z = [measure(path.truth, runs, rng=c, s=s) for path, c in zip(paths, children, strict=True)]
    return filtered(np.stack(z), s) - np.stack([path.truth for path in paths])[:, None]


def filtered(z, s=None):
    """Return the estimates of the filter, for one gain sequence and both axes at once.

    Parameters
    ----------
    z : ndarray, shape (..., K, 4)
        Measurements. Without noise, what comes out tells where the filter lags.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    ndarray, shape (..., K, 4)
    """
    s = settings() if s is None else s
    # Time first and the axes last, so that a step works on contiguous memory.
    z = z.reshape(*z.shape[:-1], 2, 2)
    z = np.ascontiguousarray(np.moveaxis(z, (-3, -1), (0, 1)))  # (K, 2, ..., 2)
    x = np.empty_like(z)
    x[0] = p, v = z[0]
    for k, K in enumerate(gain_sequence(s)[1:], start=1):
        x[k] = p, v = step(p, v, z[k], K, s.T)
    return np.moveaxis(x, (0, 1), (-3, -1)).reshape(*x.shape[2:-1], len(x), 4)


def step(p, v, z, K, T):
    """Return positions and velocities after one step of the filter: Eq 6 with H = I, on any axis.

    Parameters
    ----------
    p, v : ndarray, shape (...)
        Estimated positions and velocities.
    z : tuple of two ndarray, shape (...)
        Measured ones, one T later.
    K : ndarray, shape (2, 2)
        Gain.
    T : float
        Sampling interval in s.

    Returns
    -------
    p, v : ndarray, shape (...)
    """
    p = p + T * v
    nu_p, nu_v = z[0] - p, z[1] - v
    return p + (K[0, 0] * nu_p + K[0, 1] * nu_v), v + (K[1, 0] * nu_p + K[1, 1] * nu_v)


def gain_sequence(s=None):
    """Return the gains of the filter for one axis.

    Parameters
    ----------
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    ndarray, shape (K, 2, 2)
        They do not depend on the data. The first belongs to the start, and is the unit matrix.

    Notes
    -----
    Eq 6 for a 2 x 2 matrix written out, with K = P (P + E_z)^{-1}: thousands of calls make a map.
    """
    s = settings() if s is None else s
    R, q = (s.sigma_p**2, s.sigma_v**2), s.w**2
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
