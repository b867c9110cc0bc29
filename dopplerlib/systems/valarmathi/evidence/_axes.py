"""Sweeps over the document's choices, by their names."""

from functools import cache

from ....replication.documents import read_document
from ....replication.evidence import sweep


@cache
def _document():
    return read_document("valarmathi")


def swept(names, function, rng=None):
    """Return the evidence for all values of some choices."""
    return sweep(_document().choice(*names.split()), function, rng)
