"""Errors of the initialization at all noise levels of Fig 4, under the reading that is the default.

Twenty seconds on two processors. 315 places of the target, 31 noise levels, and as many velocities
as the figure of Mittermaier et al. has markers at a level.
"""

from dataclasses import asdict

import numpy as np

from dopplerlib.systems.mittermaier2016 import SweepReading, noise_levels, run_noise_sweep

FILES = (".csv",)
PARAMETERS = {"seed": 4, **asdict(SweepReading())}


def parts():
    """Return the one part, of which each run is a level; a chunk draws all velocities anew."""
    return [({}, len(noise_levels()), 8)]


def compute(settings, seed, runs):
    """Return what the table holds at some levels."""
    return vars(run_noise_sweep(runs, rng=np.random.default_rng(seed)))


def contents(found):
    """Return the table: mean and median errors, and their bounds."""
    columns = dict(found[0])
    variances = columns.pop("variance")
    lines = [["variance_hz2", "series", *columns]]
    for level, variance in enumerate(variances):
        for series in range(len(columns["position"][level])):
            values = (column[level][series] for column in columns.values())
            lines.append([f"{variance:.6g}", series + 1, *(f"{value:.6g}" for value in values)])
    return ["".join(",".join(map(str, line)) + "\n" for line in lines)]
