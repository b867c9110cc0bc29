"""Values that the document states or this book fills in, from ``data/macaveiu2013``."""

from functools import cache

from ..._data import read_toml
from ..._hints import checked
from ..._records import record
from ...replication.documents import data_file
from ...replication.published import Published, read_published

KMH = 1 / 3.6  # m/s


@checked
@record
class Reported:
    """All that the document states and a computer can use.

    scenario: The five paths, sampling, radar, noise and filter; what the document leaves open is
        ours.
    sources: Where it stands, and how it was obtained.
    """

    scenario: Published
    sources: dict[str, str]


@cache
def reported() -> Reported:
    """Return the values that the document states, and those filled in.

    Examples
    --------
    >>> reported().scenario.sampling.T, len(reported().scenario.path)
    (0.038, 5)
    """
    return Reported(
        scenario=read_published(data_file("macaveiu2013", "scenario.toml")),
        sources=read_toml("macaveiu2013", "sources.toml"),
    )
