"""The hint of a track whose runs are in one array, as the records of the rooms hold it."""

from typing import Annotated

import numpy as np

from .. import _checks
from ..estimation.track import Track


def _of_runs(name, value):
    """Return a track with states (runs, K, n), and with what belongs to them where it is there."""
    _checks.instance(name, value, Track)
    _array(f"{name}.x", value.x, (None, None, None), _checks.finite)
    runs, samples, n = value.x.shape
    _array(f"{name}.nis", value.nis, (runs, samples), _checks.measured)
    if value.P is not None:
        _array(f"{name}.P", value.P, (None, samples, n, n), _checks.finite)
    if value.innovation is not None:
        _array(f"{name}.innovation", value.innovation, (runs, samples, None), _checks.measured)
    return value


def _array(name, value, shape, check):
    if check(name, _checks.instance(name, value, np.ndarray), shape).ndim != len(shape):
        raise ValueError(f"{name} must have {len(shape)} axes, got shape {value.shape}")


Tracks = Annotated[Track, _of_runs]
