"""Sampling, noise and filter of the simulations of Section IV."""

from dataclasses import fields, replace
from functools import cache
from typing import Any

import numpy as np

from ..._hints import Count, Index, Positive, checked
from ..._records import record
from ..._typing import FloatArray
from ...signal.waveforms import ChirpRadar
from .published import reported


@checked
@record
class AutomotiveSettings:
    """Sampling, noise and filter; our choice where the document states no value.

    T: Sampling interval in s.
    samples: Number of samples K.
    skip: Samples at the start that the scores leave out.
    sigma_x, sigma_v: Standard deviation of a measured position in m and of a measured velocity in
        m/s, on each axis.
    w: Standard deviation of the velocity step that the filter assumes, on each axis, in m/s.
    carrier, bandwidth: Of the radar, in Hz.
    range_resolution: In m.

    Examples
    --------
    >>> s = automotive_settings()
    >>> s.with_(w=0.1).E_x.diagonal().round(2).tolist()
    [0.0, 0.01, 0.0, 0.01]
    """

    T: Positive
    samples: Count
    skip: Index
    sigma_x: Positive
    sigma_v: Positive
    w: Positive
    carrier: Positive
    bandwidth: Positive
    range_resolution: Positive

    @property
    def time(self) -> FloatArray:
        """Time of each sample in s, shape (K,); the first is 0."""
        return np.arange(self.samples) * self.T

    @property
    def radar(self) -> ChirpRadar:
        """The radar, as `dopplerlib.signal.waveforms` takes it; one measurement takes T."""
        return ChirpRadar(self.carrier, self.bandwidth, self.T)

    @property
    def wavelength(self) -> float:
        """Wavelength of the radar in m."""
        return self.radar.wavelength

    @property
    def E_z(self) -> FloatArray:
        """Covariance of the measurement noise, shape (4, 4)."""
        return np.diag([self.sigma_x, self.sigma_v] * 2) ** 2

    @property
    def E_x(self) -> FloatArray:
        """Covariance of the state noise on the velocities, shape (4, 4)."""
        return np.diag([0.0, self.w] * 2) ** 2

    def with_(self, **changes: Any) -> "AutomotiveSettings":
        """Return these settings with some changed."""
        unknown = sorted(set(changes) - {field.name for field in fields(self)})
        if unknown:
            raise ValueError(f"changes must be fields of the settings, got {unknown}")
        return replace(self, **changes)


@cache
def automotive_settings() -> AutomotiveSettings:
    """Return the settings of the simulations.

    Examples
    --------
    >>> automotive_settings().samples
    500
    """
    s = reported().scenario
    tables = s.sampling, s.noise, s.filter, s.score, s.radar
    return AutomotiveSettings(**{k: v for table in tables for k, v in table.table.items()})
