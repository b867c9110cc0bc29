"""Evidence on every claim of the paper, for the verdicts."""

from ... import _checks
from ._claims_chain import chain_evidence
from ._claims_printed import printed_evidence
from ._claims_signal import signal_evidence
from ._claims_start import start_evidence
from ._claims_tracking import tracking_evidence


def evidence(*, rng):
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
    _checks.generator("rng", rng)
    start, tracking, signal, chain = rng.spawn(4)
    return (
        printed_evidence()
        | signal_evidence(signal)
        | start_evidence(start)
        | tracking_evidence(tracking)
        | chain_evidence(chain)
    )
