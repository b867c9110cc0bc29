"""Evidence on every claim of the paper, for the verdicts."""

import numpy as np

from ...._hints import checked
from ...._lazy import attach
from ....replication.documents import read_document
from ._chain import chain_evidence
from ._figure4 import figure4_evidence
from ._first_covariance import covariance_evidence
from ._maps import map_evidence
from ._other_motion import motion_evidence
from ._right_models import right_evidence
from ._signal import signal_evidence
from ._start import start_evidence
from ._stated import stated_evidence
from ._tracking import tracking_evidence


@checked
def evidence(*, rng: np.random.Generator) -> dict[str, object]:
    """Return our numbers for every claim of ``data/mittermaier2016/claims.toml``.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of all noise.

    Returns
    -------
    dict
        What `judge_all` takes, by the id of the claim.

    Raises
    ------
    ValueError
        If `rng` is not a generator.
    """
    choice = read_document("mittermaier2016").choice
    start, tracking, signal, chain, maps, sweep = rng.spawn(6)
    runs, covariances, right, motion = tracking.spawn(4)
    return (
        stated_evidence()
        | signal_evidence(choice, signal)
        | map_evidence(choice, maps)
        | figure4_evidence(choice, sweep)
        | start_evidence(choice, start)
        | tracking_evidence(runs)
        | covariance_evidence(covariances)
        | right_evidence(right)
        | motion_evidence(motion)
        | chain_evidence(choice, chain)
    )


__getattr__, __dir__ = attach(__name__, __path__)
