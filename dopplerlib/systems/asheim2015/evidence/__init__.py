"""Evidence for the claims of Åsheim (2015)."""

import numpy as np

from ...._hints import Runs, checked
from ...._lazy import attach
from ..scene import simulate_radars
from . import _formulas, _positions, _ranges, _surrogate

__getattr__, __dir__ = attach(__name__, __path__)


@checked
def evidence(*, rng: np.random.Generator, runs: Runs = 400) -> dict:
    """Return our numbers for every claim.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of all randomness.
    runs : int
        Number of simulated records, and of walks of each kind.

    Returns
    -------
    dict
        Evidence by the id of the claim; that on Chapter 6 is what SIMULATED walks say.
    """
    simulated, resampled, walking = rng.spawn(3)
    records = simulate_radars(runs, rng=simulated, duration=_ranges.LONG)
    tracks = _ranges.filtered(records)
    return {
        **_formulas.settings_and_formulas(),
        **_ranges.found(records, tracks, resampled),
        **_positions.found(records, tracks, resampled),
        **_surrogate.found(2 * runs, walking),
    }
