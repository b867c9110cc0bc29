"""Evidence on the whole chain: from IQ samples to a position, and what ten milliseconds hold."""

from collections.abc import Callable

import numpy as np

from ....chain.simulation import simulate_baseband
from ....evaluation.intervals import quantile_interval
from ....replication.choices import Choice
from ....replication.evidence import sweep
from ....signal.laws import integrated_snr_for_std
from ..chain_bounds import position_bound, position_bound_iq, record_length
from ..end_to_end import track_iq
from ..published import reported

_RUNS = 30
_FS = 2000.0  # Hz, of the tracked records
_WINDOWS = {"0.4 Hz in 1 ms": 0.001, "0.4 Hz in 25 ms": 0.025}  # s
_CN0 = 1e6  # Hz, the echo of the chapters: 20 dB in a sample at 10 kHz


def chain_evidence(
    choice: Callable[..., tuple[Choice, ...]], rng: np.random.Generator
) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`; choices are asked for by name."""
    return {
        "signal-constant-r": sweep(choice("echo-law"), _growth),
        "table2-from-iq": sweep(choice("echo", "processing"), _ten_milliseconds),
        "start-rapid": sweep(
            choice("accuracy", "echo"),
            lambda error, echo: 1e3 * record_length(error, _strength(echo)),
        ),
        "range-from-iq": sweep(choice("echo-tracked"), _final_range, rng),
    }


def _strength(echo):
    """Return the power of an echo over that of the noise in 1 Hz."""
    if echo not in _WINDOWS:
        return _CN0
    return (
        float(integrated_snr_for_std(reported().scenario.sigma_f, _WINDOWS[echo])) / _WINDOWS[echo]
    )


def _growth(power):
    """Return the growth of an echo on the way of Table 2, for the sensor at which it is least."""
    s = reported().scenario
    r = np.linalg.norm(s.truth[:, None, :3] - s.array.positions, axis=-1)
    return float(np.min((r[0] / r.min(axis=0)) ** power))


def _ten_milliseconds(echo, processing):
    """Return the least root mean square error in m of a position from the record of a start."""
    s, cn0 = reported().scenario, _strength(echo)
    record = reported().quoted.mle_integration_time_s
    if processing == "the samples":
        P = position_bound_iq(record, cn0, samples_per_second=1e5)
    else:
        P = position_bound(record, s.T if processing != "two windows" else record / 2, cn0)
    return float(np.trace(P) ** 0.5)


def _final_range(rng, echo):
    """Return the median error of the final x in cm."""
    s, level = reported().scenario, 10 * np.log10(_strength(echo) / _FS)
    iq = simulate_baseband(s, _RUNS, rng=rng, fs=_FS, snr_db=level, factor=1)
    found = track_iq(iq).at(float(s.time[-1]))[0]
    return quantile_interval(100 * np.abs(found[:, 0] - s.truth[-1, 0]))
