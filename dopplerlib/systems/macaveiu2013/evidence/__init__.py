"""Our numbers for the claims of the document."""

import numpy as np

from ...._hints import checked
from ...._lazy import attach
from . import _filter, _scheme, _waveforms

__getattr__, __dir__ = attach(__name__, __path__)


@checked
def evidence(*, rng: np.random.Generator) -> dict:
    """Return our number for every claim of ``claims.toml``.

    rng: Source of all randomness.
    Returns: As `judge_all` takes it.
    Raises ValueError if `rng` is not a generator.
    """
    waves, filters, scheme = rng.spawn(3)
    return {**_waveforms.found(waves), **_filter.found(filters), **_scheme.found(scheme)}
