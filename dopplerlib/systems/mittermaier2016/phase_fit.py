"""A path fitted to the phases of all samples, from a state that the chain has found."""

import numpy as np

from ... import _checks
from ...chain.baseband import Baseband
from ...signal.impairments import correct_iq_imbalance, remove_mean


def fit_phases(iq, x, time, steps=3):
    """Improve states with the phases of all samples up to a time.

    Parameters
    ----------
    iq : Baseband
        Samples with the leading axis ``runs``.
    x : array_like, shape (runs, 6)
        States at the time, so good that they explain the phase of each echo to less than half a
        turn over the whole record; its unknown start does not count.
    time : float
        Time on the clock in s.
    steps : int
        Steps of Gauss-Newton.

    Returns
    -------
    ndarray, shape (runs, 6)
        States at the time, for constant velocity.

    Raises
    ------
    ValueError
        If a shape does not fit, a value is not finite, or there are less than three samples.

    Notes
    -----
    The bound that this can reach is `position_bound_iq`. All samples have the same weight, so the
    echo is taken to be equally strong, in all of them and in all modules.
    """
    _checks.instance("iq", iq, Baseband)
    time = _checks.one_number("time", time)
    x = _checks.finite("x", x, (iq.x.shape[0], 6)).copy()
    known = iq.first + np.arange(iq.x.shape[-1]) / iq.fs <= time + 1e-9
    if known.sum() < 3:
        raise ValueError(f"time must leave room for three samples, got {time}")
    y, valid = iq.samples()
    y = correct_iq_imbalance(remove_mean(y, valid), valid)[..., known]
    weight = valid[..., known].astype(float)[..., None]
    back = iq.first - iq.delay + np.arange(y.shape[-1]) / iq.fs - time
    per_meter = 4 * np.pi / iq.array.wavelength
    for run in range(len(x)):
        for _ in range(_checks.whole_number("steps", steps)):
            path = x[run, :3] + back[:, None] * x[run, 3:]
            away = path - iq.array.positions[:, None]  # (N, n, 3)
            r = np.linalg.norm(away, axis=-1)
            turned = y[run] * np.exp(1j * per_meter * r)
            # What all samples of a sensor have in common is its unknown phase.
            mean = turned.mean(axis=-1, keepdims=True)
            mean = np.where(mean == 0, 1.0, mean)  # a module that measures nothing
            left = _centered(np.angle(turned / mean)[..., None], weight[run])
            toward = away / r[..., None]
            slopes = np.concatenate([toward, back[:, None] * toward], axis=-1)
            slopes = -per_meter * _centered(slopes, weight[run]).reshape(-1, 6)
            x[run] += np.linalg.lstsq(slopes, left.ravel(), rcond=None)[0]
    return x


def _centered(values, weight):
    """Return values about their mean over the valid samples of each sensor, and 0 at the others."""
    count = np.maximum(weight.sum(axis=1, keepdims=True), 1.0)
    return weight * (values - (weight * values).sum(axis=1, keepdims=True) / count)
