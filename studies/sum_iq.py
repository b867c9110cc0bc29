"""Errors of the EKF and of a Gaussian sum behind the signal chain, at the paper's noise.

Two minutes on one processor. Records of IQ samples of the target of Table 2; shifts from windows
side by side, and from windows that overlap.
"""

import numpy as np

from dopplerlib.chain.simulation import simulate_baseband
from dopplerlib.systems import mittermaier2016 as paper

FILES = (".csv",)
PARAMETERS = {
    "seed": 2033,
    "runs": 300,
    "chunk": 10,
    "times": [0.5, 1.0],
    "window": 0.025,
    "hops": [0.025, 0.0025],
}
COLUMNS = "run,time,hop,error_ekf,nees_ekf,error_sum,nees_sum"


def items():
    """Return the first run of each part."""
    return list(range(0, PARAMETERS["runs"], PARAMETERS["chunk"]))


def rows(items):
    """Yield the lines of each part."""
    times, chunk = PARAMETERS["times"], PARAMETERS["chunk"]
    for first in items:
        iq, lines = records(first, chunk), []
        for hop in PARAMETERS["hops"]:
            found = paper.track_iq(iq, window=PARAMETERS["window"], hop=hop)
            alone, several = paper.track_errors(found, times), paper.sum_errors(found, times)
            columns = 1e3 * alone.error, alone.nees, 1e3 * several[0], several[1]
            for place, time in enumerate(times):
                for run in range(chunk):
                    numbers = ",".join(f"{c[place, run]:.4g}" for c in columns)
                    lines.append(f"{first + run},{time},{hop},{numbers}")
        yield lines


def records(first, runs):
    """Return the samples of the runs of a part, or of its first ones."""
    scenario = paper.reported().scenario
    level = 20 - 20 * np.log10(scenario.sigma_f / 0.1)  # 20 dB give 0.1 Hz in 25 ms
    rng = np.random.default_rng([PARAMETERS["seed"], first])
    return simulate_baseband(scenario, runs, rng=rng, snr_db=level)


def contents(rows):
    """Return a line for each run, time and hop; errors in mm."""
    return ["\n".join([COLUMNS, *(line for part in rows for line in part)]) + "\n"]
