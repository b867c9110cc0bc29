"""Evidence for the claims of Åsheim (2015)."""

import numpy as np

from ...._hints import Runs, checked
from ...._lazy import attach
from ..scene import simulate_radars
from . import _formulas, _positions, _ranges, _steps, _surrogate

__getattr__, __dir__ = attach(__name__, __path__)


@checked
def evidence(*, rng: np.random.Generator, runs: Runs = 600) -> dict:
    """Return our numbers for every claim.

    rng: Source of all randomness.
    runs: Number of simulated records, and of walks of each kind.
    Returns: Evidence by the id of the claim; that on Chapter 6 is what SIMULATED walks say.
    """
    simulated, ranges, positions, steps, walking = rng.spawn(5)
    records = simulate_radars(runs, rng=simulated, duration=_ranges.LONG)
    tracks = _ranges.filtered(records, max(1, runs // 3))
    return {
        **_formulas.settings_and_formulas(),
        **_ranges.found(records, tracks, ranges),
        **_positions.found(records, tracks, positions),
        **_steps.found(records, tracks, runs, steps),
        **_surrogate.found(records, tracks, 2 * runs, walking),
    }
