"""Errors of the EKF and of a Gaussian sum behind the signal chain, at the paper's noise.

Two minutes on one processor. Records of IQ samples of the target of Table 2; shifts from windows
side by side, and from windows that overlap.
"""

import numpy as np

from dopplerlib.chain.simulation import simulate_baseband
from dopplerlib.systems import mittermaier2016 as paper

FILES = (".csv",)
PARAMETERS = {
    "seed": 6203,
    "runs": 300,
    "chunk": 10,
    "times": [0.5, 1.0],
    "window": 0.025,
    "hops": [0.025, 0.0025],
}
COLUMNS = "run,time,hop,error_ekf,nees_ekf,error_sum,nees_sum"


def parts():
    """Return the one part, of which each run is a chunk of records that are drawn together."""
    return [({}, PARAMETERS["runs"] // PARAMETERS["chunk"], 1)]


def compute(settings, seed, runs):
    """Return the errors of some chunks."""
    return {"columns": np.array([errors(run * settings["chunk"], settings) for run in runs])}


def errors(first, settings):
    """Return errors in mm and NEES of both trackers (hops, times, chunk, 4)."""
    iq, times, both = records(first, settings["chunk"]), settings["times"], []
    for hop in settings["hops"]:
        found = paper.track_iq(iq, window=settings["window"], hop=hop)
        alone, several = paper.track_errors(found, times), paper.sum_errors(found, times)
        columns = 1e3 * alone.error, alone.nees, 1e3 * several[0], several[1]
        both.append(np.stack(columns, axis=-1))
    return both


def records(first, runs):
    """Return the samples of the runs of a part, or of its first ones."""
    scenario = paper.reported().scenario
    level = 20 - 20 * np.log10(scenario.sigma_f / 0.1)  # 20 dB give 0.1 Hz in 25 ms
    rng = np.random.default_rng([PARAMETERS["seed"], first])
    return simulate_baseband(scenario, runs, rng=rng, snr_db=level)


def contents(found):
    """Return a line for each run, time and hop."""
    columns, hops, times = found[0]["columns"], PARAMETERS["hops"], PARAMETERS["times"]
    lines = [COLUMNS]
    for chunk, hop, time, run in np.ndindex(columns.shape[:-1]):
        values = ",".join(f"{value:.4g}" for value in columns[chunk, hop, time, run])
        number = chunk * PARAMETERS["chunk"] + run
        lines.append(f"{number},{times[time]},{hops[hop]},{values}")
    return ["\n".join(lines) + "\n"]
