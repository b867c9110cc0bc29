"""Simulated measurements of a scenario."""

import numpy as np

from .._hints import Count, checked
from .._typing import FloatArray
from .doppler import doppler_shift
from .scenario import Scenario


@checked
def simulate(
    scenario: Scenario, runs: Count, *, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Return the true path and noisy Doppler measurements of it.

    Parameters
    ----------
    scenario : Scenario
        Sensors, path and noise.
    runs : int
        Number of independent records.
    rng : numpy.random.Generator
        Source of randomness. Every run draws from a child of its own, so run 3 is the same
        whether 10 or 10 000 runs are asked for.

    Returns
    -------
    truth : ndarray, shape (K, 6)
        True states in m and m/s, the same in every run.
    z : ndarray, shape (runs, K, N)
        Doppler measurements in Hz.

    Notes
    -----
    Mittermaier et al. (2016), Eqs 5 and 8: zero-mean white Gaussian noise, independent between
    sensors.

    Examples
    --------
    >>> from dopplerlib import RadarArray, Scenario
    >>> scenario = Scenario(
    ...     RadarArray.ring(6, 0.2), x0=[0.8, 0.1, 0.1, -0.7, 0, 0],
    ...     T=0.001, samples=100, sigma_f=0.4, sigma_a=0.4, P0=0.1 * np.eye(6),
    ... )
    >>> truth, z = simulate(scenario, 5, rng=np.random.default_rng(1))
    >>> truth.shape, z.shape
    ((100, 6), (5, 100, 6))
    """
    truth = scenario.truth
    z = np.empty((runs, scenario.samples, len(scenario.array)))
    for child, record in zip(rng.spawn(runs), z, strict=True):
        child.standard_normal(out=record)
    z *= scenario.sigma_f
    z += doppler_shift(truth, scenario.array)
    return truth, z
