"""Values that the document states or this book fills in, from ``data/valarmathi``."""

from functools import cache

from ..._data import read_toml
from ..._hints import checked
from ..._records import record
from ...replication.documents import data_file
from ...replication.published import Published, read_published


@checked
@record
class Reported:
    """All that the document states and a computer can use.

    stated: What the document states, in SI units and dB.
    chosen: What it leaves open and this book chooses.
    sources: Where each of them stands, and how it was obtained.
    """

    stated: Published
    chosen: Published
    sources: dict[str, str]


@cache
def reported() -> Reported:
    """Return the values that the document states, and those filled in.

    Examples
    --------
    >>> reported().stated.T, reported().chosen.fixed_window
    (0.003, 64)
    """
    tables = read_published(data_file("valarmathi", "scenario.toml"))
    return Reported(tables.stated, tables.chosen, read_toml("valarmathi", "sources.toml"))
