"""Sweeps over the document's choices, by their names."""

from ....replication.documents import read_document
from ....replication.evidence import sweep


def swept(names, function, rng=None):
    """Return the evidence for all values of some choices."""
    return sweep(read_document("valarmathi").choice(*names.split()), function, rng)
