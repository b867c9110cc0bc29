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


def items():
    """Return gate, start and number of each part."""
    return list(product(GATES, starts(), range(PARAMETERS["chunks"])))


def rows(items):
    """Yield the mean of the logarithms of a part's ratios, and that of their squares."""
    for gate, start, chunk in items:
        rng = np.random.default_rng([PARAMETERS["seed"], chunk])
        found = other_motion.turned_rings(gate, start, PARAMETERS["runs"], rng)
        moments = (found.mean(axis=0), (found**2).mean(axis=0))
        mean, square = (one.round(5).tolist() for one in moments)
        yield {"gate": gate, "start": start, "chunk": chunk, "mean": mean, "square": square}


def contents(rows):
    """Return all parts, a line for each."""
    parts = [f'  "{name}": {json.dumps(value)}' for name, value in PARAMETERS.items()]
    lines = ",\n".join("    " + json.dumps(row) for row in rows)
    parts.append(f'  "parts": [\n{lines}\n  ]')
    return ["{\n" + ",\n".join(parts) + "\n}\n"]
