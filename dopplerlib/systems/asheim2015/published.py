"""Values that the thesis states: settings of its text and of its code, and its results."""

from functools import cache

from ..._data import read_toml
from ..._hints import checked
from ..._records import record
from ...replication.documents import data_file
from ...replication.published import Published, read_published


@checked
@record
class Reported:
    """All that the thesis states and a computer can use.

    scenario: Settings, in m, s, Hz and dB: those of the thesis, and where it has none, ours.
    quoted: Results that it says in words and numbers.
    sources: Where each of them stands, and how it was obtained.
    """

    scenario: Published
    quoted: Published
    sources: dict[str, str]


@cache
def reported() -> Reported:
    """Return the values that the thesis states.

    Examples
    --------
    >>> reported().scenario.noise.snr_slope, reported().quoted.range.fused
    (12.0, 5.66)
    """
    return Reported(
        scenario=read_published(data_file("asheim2015", "scenario.toml")),
        quoted=read_published(data_file("asheim2015", "quoted.toml")),
        sources=read_toml("asheim2015", "sources.toml"),
    )
