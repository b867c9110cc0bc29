"""Errors of the simulation example with the ring turned, beside those with the ring as drawn.

Three minutes on two processors. Every gate and start of the text, from the same noise, in parts.
"""

import json
from itertools import product

import numpy as np

from dopplerlib.systems.mittermaier2016.evidence import _other_motion as other_motion
from dopplerlib.systems.mittermaier2016.evidence._runs import GATES, starts

FILES = (".json",)
PARAMETERS = {"seed": 2016, "chunks": 24, "runs": 500, "angles": list(other_motion.ANGLES)}


def parts():
    """Return gates and starts, of each of which a run is a chunk of records with the same noise."""
    chunks = PARAMETERS["chunks"]
    return [({"gate": gate, "start": start}, chunks, 1) for gate, start in product(GATES, starts())]


def compute(settings, seed, runs):
    """Return the mean of the logarithms of the ratios in some chunks, and that of their squares."""
    gate, start, records = (settings[name] for name in ("gate", "start", "runs"))
    found = [
        other_motion.turned_rings(gate, start, records, np.random.default_rng([seed, chunk]))
        for chunk in runs
    ]
    return {
        "mean": np.array([one.mean(axis=0) for one in found]),
        "square": np.array([(one**2).mean(axis=0) for one in found]),
    }


def contents(found):
    """Return all chunks, a line for each."""
    text = [f'  "{name}": {json.dumps(value)}' for name, value in PARAMETERS.items()]
    lines = [
        json.dumps(
            settings
            | {"chunk": chunk}
            | {name: moments[chunk].round(5).tolist() for name, moments in part.items()}
        )
        for (settings, *_), part in zip(parts(), found, strict=True)
        for chunk in range(PARAMETERS["chunks"])
    ]
    text.append('  "parts": [\n' + ",\n".join("    " + line for line in lines) + "\n  ]")
    return ["{\n" + ",\n".join(text) + "\n}\n"]
