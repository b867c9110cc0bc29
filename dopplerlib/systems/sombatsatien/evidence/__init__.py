"""Evidence on every claim of the report, for the verdicts."""

import numpy as np

from ...._hints import Runs, checked
from ...._lazy import attach
from ....model.simulation import simulate
from ..descent import local_start
from ..published import reported
from ..variants import post_mortem
from .conclusions import conclusions_evidence
from .outcomes import outcomes_evidence
from .settings import settings_evidence

__getattr__, __dir__ = attach(__name__, __path__)


@checked
def evidence(*, rng: np.random.Generator, runs: Runs = 320) -> dict[str, object]:
    """Return our numbers for every claim of ``data/sombatsatien/claims.toml``.

    rng: Source of all noise.
    runs: Number of records, of which the repaired system takes a third. With 300 or fewer not even
        a number outside all of them is decided.
    Returns: What `judge_all` takes, by the id of the claim.
    Raises ValueError if `rng` is not a generator, or `runs` is not a positive whole number.
    """
    noise, rounding = rng.spawn(2)
    s, settings = reported().scenario, reported().start
    _, z = simulate(s, runs, rng=noise)
    box, first = (settings.lower, settings.upper), z[:, : settings.samples]
    start, misfit, _ = local_start(first, s.array, settings.guess, box)
    result = post_mortem(runs, rng=None, z=z, start=start)
    return (
        settings_evidence()
        | outcomes_evidence(result, misfit, rng=rounding)
        | conclusions_evidence(z, result)
    )
