"""What the report states, from ``data/sombatsatien``."""

from functools import cache, partial
from typing import Annotated

from ..._data import data, read_toml
from ..._hints import Count, Index, Positive, Real, State, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...model.scenario import Scenario

data_file = partial(data, "sombatsatien")


@checked
@record
class ReportedStart:
    """How the report finds an initial estimate, and the estimate that it found.

    Attributes
    ----------
    samples : int
        Number of first samples whose average is explained.
    guess : ndarray, shape (6,)
        Where the one search begins.
    lower, upper : ndarray, shape (6,)
        Bounds of the state.
    estimate : ndarray, shape (6,)
        The start that is printed.
    """

    samples: Count
    guess: State
    lower: State
    upper: State
    estimate: State

    @property
    def box(self) -> tuple:
        """Lower and upper bounds of the state, as a start takes them."""
        return self.lower, self.upper


@checked
@record
class ReportedRun:
    """What the report states of its one run, in m and m/s.

    Attributes
    ----------
    tracked : int
        Number of samples that the filter takes.
    position_rmse, velocity_rmse : float
        Root mean square errors over them.
    final_true_x, final_x : float
        Distance x at the last one, true and estimated.
    final_position_error : float
        There.
    final_velocity : ndarray, shape (3,)
        Estimated there.
    initial_position_error : float
        Read off a curve by the report itself.
    settled_position_error : ndarray, shape (2,)
        The same: between which values.
    """

    tracked: Count
    position_rmse: Positive
    velocity_rmse: Positive
    final_true_x: Real
    final_x: Real
    final_position_error: Positive
    final_velocity: Annotated[FloatArray, exactly(3)]
    initial_position_error: Positive
    settled_position_error: Annotated[FloatArray, exactly(2)]


@checked
@record
class Reported:
    """All that the report states and a computer can use.

    Attributes
    ----------
    scenario : Scenario
        The simulation.
    start : ReportedStart
        Its initial estimate.
    seed : int
        Of the noise, in NumPy's legacy generator.
    run : ReportedRun
        Its results.
    sources : dict of str to str
        Where each of them stands, and how it was obtained.
    """

    scenario: Scenario
    start: ReportedStart
    seed: Index
    run: ReportedRun
    sources: dict[str, str]


@cache
def reported() -> Reported:
    """Return what the report states.

    Returns
    -------
    Reported

    Examples
    --------
    >>> reported().run.final_x, reported().sources["run"]
    (-0.1816, 'Section 4 and Fig 6, and the notebook; errors at the start and settled read off')
    """
    tables = read_toml("sombatsatien", "reported.toml")
    return Reported(
        scenario=Scenario.from_toml(data_file("scenario.toml")),
        start=ReportedStart(**tables["start"]),
        seed=tables["noise"]["seed"],
        run=ReportedRun(**tables["result"]),
        sources=read_toml("sombatsatien", "sources.toml"),
    )
