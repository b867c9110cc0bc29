"""The noise of one radar: resolutions, signal-to-noise ratio, standard deviations (Chapter 5)."""

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np

from ... import _checks
from ..._hints import checked
from ..._typing import FloatArray
from ...model.ranging_noise import linear_snr, range_std
from .published import reported

FARTHEST = 240.0  # m: there Eq 5.1 has -2828 dB, and ratios end at -3000


def _near(name, value, shape=()):
    return _checks.bounded(name, _checks.finite(name, value, shape), (), FARTHEST)


Ranges = Annotated[FloatArray, _near]
Law = Annotated[Callable[..., Any], _checks.function]  # signal-to-noise ratio in dB of the range


def resolutions() -> tuple[float, float]:
    """Return the resolutions in range and in velocity, Eqs 5.3 and 5.5 with correct exponents.

    Returns range_resolution: c T_pulse / 2 in m.
        velocity_resolution: Half a wavelength over the time of integration in m/s.

    Examples
    --------
    >>> [round(one, 4) for one in resolutions()]
    [0.15, 0.0214]
    """
    n = reported().scenario.noise
    wavelength = n.speed_of_light / n.frequency
    return n.speed_of_light * n.pulse / 2, wavelength / (2 * n.integration)


@checked
def snr(d: Ranges) -> FloatArray:
    """Return the signal-to-noise ratio at a range, Eq 5.1.

    d (...): Range in m.
    Returns (...): In dB.
    Raises ValueError if `d` is not finite or beyond 240 m.

    Examples
    --------
    >>> float(snr(1.0))
    40.0
    """
    n = reported().scenario.noise
    return linear_snr(d, n.snr_at_zero, n.snr_slope)


@checked
def noise_std(d: Ranges, law: Law | None = None) -> FloatArray:
    """Return the standard deviations of range and range rate at a range, Eqs 5.4 and 5.6.

    d (...): Range in m.
    law: Signal-to-noise ratio in dB as a function of the range; that of Eq 5.1 if None.
    Returns (..., 2): In m and m/s.
    Raises ValueError if an argument is not of the kind described, or a range is beyond 240 m.

    Examples
    --------
    >>> noise_std(4.0).round(3).tolist()
    [0.067, 0.01]
    """
    snr_db = _checks.called("law", law or snr, d)
    return np.stack([range_std(one, snr_db) for one in resolutions()], axis=-1)
