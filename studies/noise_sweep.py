"""Errors of the initialization at all noise levels of Fig 4, under the reading that is the default.

Forty seconds on two processors. 315 places of the target, 31 noise levels, and as many velocities
as the figure of Mittermaier et al. has markers at a level. Beside it, this reading and three others
on a coarse grid, at some of the levels.
"""

from dataclasses import asdict

import numpy as np

from dopplerlib.systems.mittermaier2016 import (
    SweepReading,
    coarse_readings,
    noise_levels,
    run_noise_sweep,
    scored_levels,
)

FILES = (".csv", ".coarse.csv")
PARAMETERS = {"seed": 4, **asdict(SweepReading()), "coarse_seed": 6}


def parts():
    """Return the readings, of which each run is a level; a chunk draws all velocities anew."""
    coarse = [({"coarse": name}, len(scored_levels()), 8) for name in coarse_readings()]
    return [({"coarse": ""}, len(noise_levels()), 8), *coarse]


def compute(settings, seed, runs):
    """Return what the tables hold at some levels."""
    if not (name := settings["coarse"]):
        return vars(run_noise_sweep(runs, rng=np.random.default_rng(seed)))
    levels = [scored_levels()[run] for run in runs]
    rng = np.random.default_rng(PARAMETERS["coarse_seed"])
    found = run_noise_sweep(levels, rng=rng, reading=coarse_readings()[name], bound=False)
    return {"position": found.position, "velocity": found.velocity}


def contents(found):
    """Return mean and median errors and their bounds, and mean errors on the coarse grid."""
    lines = ["reading,level,series,position,velocity"]
    for reading, errors in enumerate(found[1:], 1):
        for i, level in enumerate(scored_levels()):
            pairs = zip(errors["position"][i], errors["velocity"][i], strict=True)
            for series, (p, v) in enumerate(pairs, 1):
                lines.append(f"{reading},{level},{series},{p:.6g},{v:.6g}")
    return [_default(dict(found[0])), "".join(line + "\n" for line in lines)]


def _default(columns):
    variances = columns.pop("variance")
    lines = [["variance_hz2", "series", *columns]]
    for level, variance in enumerate(variances):
        for series in range(len(columns["position"][level])):
            values = (column[level][series] for column in columns.values())
            lines.append([f"{variance:.6g}", series + 1, *(f"{value:.6g}" for value in values)])
    return "".join(",".join(map(str, line)) + "\n" for line in lines)
