"""Values that the report states, from ``data/sombatsatien``."""

from functools import cache

from ..._data import read_toml
from ..._hints import checked
from ..._records import record
from ...model.scenario import Scenario
from ...replication.documents import data_file
from ...replication.published import Published, read_published


@checked
@record
class Reported:
    """All that the report states and a computer can use.

    scenario: The simulation.
    start: How the report finds its initial estimate: from the average of the first `samples`, by a
        search from `guess` between `lower` and `upper`; and the `estimate` that it found.
    noise: The `seed` of its noise, in NumPy's legacy generator.
    run: Results of its one run, in m and m/s.
    sources: Where those stand that do not say it themselves.
    """

    scenario: Scenario
    start: Published
    noise: Published
    run: Published
    sources: dict[str, str]


@cache
def reported() -> Reported:
    """Return the values that the report states.

    Examples
    --------
    >>> reported().run.final_x, reported().run.where
    (-0.1816, 'Section 4 and Fig 6, and the notebook')
    """
    tables = read_published(data_file("sombatsatien", "reported.toml"))
    return Reported(
        scenario=Scenario.from_toml(data_file("sombatsatien", "scenario.toml")),
        start=tables.start,
        noise=tables.noise,
        run=tables.run,
        sources=read_toml("sombatsatien", "sources.toml"),
    )
