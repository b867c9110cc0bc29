"""A path fitted to the phases of all samples, from a state that the chain has found."""

from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Real, checked, exactly, up_to
from .._typing import FloatArray
from ..signal.impairments import correct_iq_imbalance, remove_mean
from .baseband import Baseband


@checked
@_checks.quiet
def fit_phases(
    iq: Baseband,
    x: Annotated[FloatArray, exactly(None, 6)],
    time: Real,
    steps: Annotated[int, up_to(1000)] = 3,
) -> FloatArray:
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
        If modules have no Q, a shape does not fit, a value is not finite, there are less than three
        samples, or the states are so far off that the steps do not stay finite.

    Notes
    -----
    All samples have the same weight, so the echo is taken to be equally strong, in all of them and
    in all modules.

    Examples
    --------
    >>> from dopplerlib import RadarArray, Scenario
    >>> from dopplerlib.chain.simulation import simulate_baseband
    >>> x0 = [0.8, 0.1, 0.1, -0.7, -0.1, 0.0]
    >>> scenario = Scenario(RadarArray.ring(6, 0.2), x0, 0.001, 101, 0.4, 0.4, np.eye(6))
    >>> iq = simulate_baseband(scenario, 1, rng=np.random.default_rng(1), fs=2e3, faults=False)
    >>> fit_phases(iq, [[0.73, 0.09, 0.1, -0.7, -0.1, 0.0]], 0.1).shape
    (1, 6)
    """
    if iq.without_q:
        raise ValueError("iq must be samples of modules with a Q, got modules without one")
    if iq.x.ndim != 3 or len(iq.x) != len(x):
        raise ValueError(f"x must have a state for each run of iq, got {len(x)} and {iq.x.shape}")
    x = x.copy()
    known = iq.first + np.arange(iq.x.shape[-1]) / iq.fs <= time + 1e-9
    if known.sum() < 3:
        raise ValueError(f"time must leave room for three samples, got {time}")
    y, valid = iq.samples()
    y = correct_iq_imbalance(remove_mean(y, valid), valid)[..., known]
    weight = valid[..., known].astype(float)[..., None]
    back = iq.first - iq.delay + np.arange(y.shape[-1]) / iq.fs - time
    per_meter = 4 * np.pi / iq.array.wavelength
    for run in range(len(x)):
        for _ in range(steps):
            path = x[run, :3] + back[:, None] * x[run, 3:]
            away = path - iq.array.positions[:, None]  # (N, n, 3)
            r = np.linalg.norm(away, axis=-1)
            _checks.estimates("x and time", r)
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
