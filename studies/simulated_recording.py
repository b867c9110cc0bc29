"""IQ samples of six modules that never existed, with the true states of their target.

A second. Bit for bit the same everywhere: the samples are rounded to 16 bits.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

from dopplerlib.chain.simulation import MODULE_FAULTS
from dopplerlib.systems.mittermaier2016 import SIMULATED, write_simulated_iq

FILES = (".sigmf-meta", ".sigmf-data", ".truth.csv")
PARAMETERS = SIMULATED | MODULE_FAULTS


def items():
    """Return what is computed in one go."""
    return ["all files"]


def rows(items):
    """Yield the name of what is written."""
    yield from items


def contents(rows):
    """Return metadata, samples and truth."""
    with TemporaryDirectory() as folder:
        return [Path(path).read_bytes() for path in write_simulated_iq(folder)]
