"""Likelihood of the dots of Fig 4 under every reading of its text.

Some minutes on two processors. Every reading of Mittermaier et al. is simulated from the same seed,
at some of the levels; the best one with either likelihood is repeated from another seed.
"""

import json
from dataclasses import asdict

import numpy as np

from dopplerlib.systems.mittermaier2016 import (
    reported,
    run_noise_sweep,
    scored_levels,
    sweep_readings,
    sweep_score,
)
from studies._rows import rows, texts

FILES = (".json",)
PARAMETERS = {"seed": 4, "draws": 24, "levels": list(scored_levels()), "seed_again": 11}


def parts():
    """Return the one part, of which each run is a reading."""
    return [({}, len(sweep_readings()), 1)]


def compute(settings, seed, runs):
    """Return the scores of some readings."""
    return texts(score(sweep_readings()[run], seed) for run in runs)


def score(reading, seed):
    """Return the fields of a reading, its score, and the interval of the score."""
    result = run_noise_sweep(
        scored_levels(),
        PARAMETERS["draws"],
        rng=np.random.default_rng(seed),
        reading=reading,
        bound=False,
    )
    values = sweep_score(result, reported().figure4, rng=np.random.default_rng(seed))
    rounded = (round(value, 1) for value in values)
    return asdict(reading) | dict(zip(("score", "low", "high"), rounded, strict=True))


def contents(found):
    """Return the table of scores."""
    scores = rows(*found)
    best = [
        max(range(len(scores)), key=lambda i: (scores[i]["likelihood"] == name, scores[i]["score"]))
        for name in ("constant_velocity", "stationary")
    ]
    again = [score(sweep_readings()[i], PARAMETERS["seed_again"]) for i in best]
    text = [f'  "{name}": {json.dumps(value)}' for name, value in PARAMETERS.items()]
    for name, table in {"again": again, "readings": scores}.items():
        lines = ",\n".join("    " + json.dumps(row) for row in table)
        text.append(f'  "{name}": [\n{lines}\n  ]')
    return ["{\n" + ",\n".join(text) + "\n}\n"]
