"""Evidence on the whole chain: from IQ samples to a position, and what ten milliseconds hold."""

import numpy as np

from ...._hints import checked
from ....chain.simulation import simulate_baseband
from ....evaluation.intervals import quantile_interval
from ....replication.evidence import Readings
from ....signal.laws import integrated_snr_for_std
from ..chain_bounds import position_bound, position_bound_iq, record_length
from ..end_to_end import track_iq
from ..published import reported

_RUNS = 30
_CN0 = 1e6  # Hz, the echo of the chapters: 20 dB in a sample at 10 kHz. The paper prints none.
_RECORD = 0.01  # s, Table 2


@checked
def chain_evidence(rng: np.random.Generator) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    s = reported().scenario
    # As strong as it has to be for the noise of Section 4 in a window of one sampling interval.
    strong = integrated_snr_for_std(s.sigma_f, s.T) / s.T
    bounds = {
        "white shifts every millisecond": position_bound(_RECORD, s.T, strong),
        "two windows": position_bound(_RECORD, _RECORD / 2, strong),
        "the samples": position_bound_iq(_RECORD, strong, samples_per_second=1e5),
    }
    echoes = {"noise of Section 4 in 1 ms": strong, "60 dB in 1 Hz": _CN0}
    return _tracks(rng) | {
        "signal-constant-r": _loudness(),
        "table2-from-iq": Readings({n: float(np.trace(P) ** 0.5) for n, P in bounds.items()}),
        "start-rapid": Readings({n: 1e3 * record_length(0.05, cn0) for n, cn0 in echoes.items()}),
    }


def _loudness():
    """Return the growth of an echo's power as 1 / r^4, for the sensor at which it is least."""
    s = reported().scenario
    r = np.linalg.norm(s.truth[:, None, :3] - s.array.positions, axis=-1)
    return float(np.min((r[0] / r.min(axis=0)) ** 4))


def _tracks(rng):
    s = reported().scenario
    level = 10 * np.log10(_CN0 / 2000.0)
    iq = simulate_baseband(s, _RUNS, rng=rng, fs=2000.0, snr_db=level, factor=1)
    found = track_iq(iq)
    end = float(s.time[-1])
    error = 100 * np.abs(found.at(end)[0][:, 0] - s.truth[-1, 0])
    return {"range-from-iq": quantile_interval(error)}
