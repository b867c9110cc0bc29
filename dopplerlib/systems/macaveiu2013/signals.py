"""Targets and noise for the waveforms of Section II; all values are ours."""

from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import checked
from ..._typing import ComplexArray
from .published import KMH

SLOPES = (1.0, -1.0, 0.6, -0.3)  # of several chirps, in units of the bandwidth over T
CAR = np.stack([np.linspace(18, 22, 5), np.full(5, 10 * KMH)], axis=-1)  # five points, 10 km/h
PEDESTRIAN = np.array([[12.0, v] for v in (-1.5, -0.7, 0.2, 0.8, 1.5)])  # torso, arms and legs


@checked
def noisy_echoes(
    signal: Annotated[ComplexArray, _checks.finite_complex],
    snr_db: float,
    *,
    rng: np.random.Generator,
) -> ComplexArray:
    """Return a signal with white complex noise.

    signal (...): Sum of echoes, each of amplitude 1.
    snr_db: Power of one echo over that of the noise, for each sample, in dB.
    rng: Source of the noise.
    Returns (...)

    Examples
    --------
    >>> noisy_echoes([1.0, 1j], 60.0, rng=np.random.default_rng(1)).round(2).tolist()
    [(1+0j), 1j]
    """
    deviation = np.sqrt(0.5 * 10 ** (-_checks.one_number("snr_db", snr_db, _checks.decibels) / 10))
    shape = (2, *signal.shape)
    return signal + deviation * np.tensordot([1, 1j], rng.standard_normal(shape), 1)
