"""IQ samples of six modules that never existed, with the true states of their target.

A second. Bit for bit the same everywhere: the samples are rounded to 16 bits.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from dopplerlib.chain.simulation import MODULE_FAULTS
from dopplerlib.systems.mittermaier2016 import SIMULATED, write_simulated_iq

FILES = (".sigmf-meta", ".sigmf-data", ".truth.csv")
PARAMETERS = SIMULATED | MODULE_FAULTS


def parts():
    """Return the one part: a single run."""
    return [({}, 1, 1)]


def compute(settings, seed, runs):
    """Return metadata, samples and truth, byte by byte."""
    with TemporaryDirectory() as folder:
        written = [Path(path).read_bytes() for path in write_simulated_iq(folder)]
    return {
        end: np.frombuffer(content, np.uint8)[None]
        for end, content in zip(FILES, written, strict=True)
    }


def contents(found):
    """Return metadata, samples and truth."""
    return [found[0][end].tobytes() for end in FILES]
