"""Evidence for every claim of the document that can be checked."""

import numpy as np

from ...._hints import checked
from ...._lazy import attach
from ._comparisons import comparisons
from ._front_end import front_end
from ._limits import limits
from ._windows import windows

__getattr__, __dir__ = attach(__name__, __path__)


@checked
def evidence(*, rng: np.random.Generator) -> dict:
    """Collect the evidence for ``data/valarmathi/claims.toml``.

    rng: Source of randomness for windows and front end; comparisons and limits are those of the
        saved study.
    Returns: By the id of the claim; see `judge_all`.
    Raises ValueError if `rng` is not a generator.
    """
    for_windows, for_front_end = rng.spawn(2)
    return {
        **comparisons(),
        **limits(),
        **windows(for_windows),
        **front_end(for_front_end),
    }
