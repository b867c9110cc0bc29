"""All algorithms on all paths at all signal-to-noise ratios: a saved study, and each cell again."""

from collections.abc import Sequence
from functools import cache
from typing import Annotated

import numpy as np

from ... import _checks
from ..._data import read_lines, results
from ..._hints import Index, Probability, Runs, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...evaluation.intervals import ConfidenceInterval, proportion_interval
from .algorithms import ALGORITHMS, AlgorithmRuns, Number, run_algorithms
from .error_measures import MEASURES, _titled
from .published import reported
from .velocity_filter import _decibels
from .velocity_paths import PATHS, PathName
from .window_choice import WindowTable
from .window_simulation import window_table

SEED = 3
RUNS = 100
SNRS_DB = np.arange(-10.0, 41.0, 5.0)
CLIFF_RUNS = 100
CLIFF_SNRS_DB = np.arange(-8.0, -1.0)


@checked
@record
class FusionStudy:
    """Errors of every run of all algorithms on all paths at all signal-to-noise ratios.

    paths: Names of the paths.
    snrs_db (S,): Signal-to-noise ratios of a sample in dB.
    measures (paths, S, 6, runs): Of each run, those of `run_measures`.

    Examples
    --------
    >>> measures = {name: np.ones((1, 2, 6, 3)) for name in MEASURES}
    >>> study = FusionStudy(("path 1",), [0.0, 15.0], measures)
    >>> study.runs, study.of("cee", "path 1", 2).shape, len(study.summary("path 1", 15.0))
    (3, (2, 3), 6)
    """

    paths: tuple[str, ...]
    snrs_db: Annotated[FloatArray, exactly(None)]
    measures: dict[str, Annotated[FloatArray, exactly(None, None, 6, None)]]

    def __post_init__(self):
        """Check that the measures are those of all cells."""
        if tuple(self.measures) != MEASURES:
            raise ValueError(f"measures must be {MEASURES}, got {tuple(self.measures)}")
        shape = len(self.paths), len(self.snrs_db), 6
        for name, values in self.measures.items():
            if values.shape != (*shape, self.runs):
                raise ValueError(
                    f"measures[{name!r}] must have shape {(*shape, self.runs)}, got {values.shape}"
                )

    @property
    def runs(self) -> int:
        """Number of runs of each algorithm in each cell."""
        return self.measures["whole"].shape[-1]

    @checked
    def of(self, measure: str, path: str, algorithm: Number) -> FloatArray:
        """Return one measure of one algorithm on one path, shape (S, runs)."""
        _checks.one_of("measure", measure, tuple(self.measures))
        place = self.paths.index(_checks.one_of("path", path, self.paths))
        return self.measures[measure][place, :, algorithm - 1]

    @checked
    def summary(self, path: str, snr_db: float) -> dict[str, dict[str, FloatArray]]:
        """Return errors and delays of one cell, in the form of `AlgorithmRuns.summary`."""
        levels = self.snrs_db.tolist()
        j = levels.index(_checks.one_of("snr_db", snr_db, levels))
        return {
            name: _titled({m: self.of(m, path, number)[j] for m in self.measures})
            for number, name in ALGORITHMS.items()
        }


@checked
def study_table(seed: Index = SEED) -> WindowTable:
    """Return the table of windows that the study was made with.

    seed: That of the study.

    Examples
    --------
    >>> study_table().best.shape
    (7, 6)
    """
    return _table(seed)


@cache
def _table(seed):
    return window_table(rng=np.random.default_rng(seed))


@checked
def study_cell(
    path: PathName,
    snr_db: Annotated[float, _decibels],
    table: WindowTable,
    runs: Runs = RUNS,
    seed: Index = SEED,
) -> AlgorithmRuns:
    """Simulate one cell of the study.

    path: See `velocity_path`.
    snr_db: Signal-to-noise ratio of a sample in dB, not below -100.
    table: For the choice of windows.
    runs: Number of runs. The first are the same however many follow.
    seed: Of the study; together with path and ratio it fixes the random numbers.

    Examples
    --------
    >>> cee = np.array([[[1.0, 2.0], [2.0, 1.0]], [[1.0, 2.0], [1.0, 2.0]]])
    >>> table = WindowTable([0, 10], [0, 20], [8, 64], cee)
    >>> study_cell("path 2", 15.0, table, runs=1).velocity(1).shape
    (1, 4860)
    """
    if snr_db < -100:
        raise ValueError(f"snr_db must be at least -100, got {snr_db}")
    number = PATHS.index(path)
    rng = np.random.default_rng([seed, number, round(10 * (snr_db + 100))])
    return run_algorithms(path, snr_db, runs, table, rng=rng)


@checked
def cell_measures(result: AlgorithmRuns) -> dict[tuple[int, str], FloatArray]:
    """Return the measures of every run.

    result: Runs of all algorithms. Of algorithms with one sensor the first one counts.
    Returns (runs,): By algorithm and measure; see `run_measures`.

    Examples
    --------
    >>> cee = np.array([[[1.0, 2.0], [2.0, 1.0]], [[1.0, 2.0], [1.0, 2.0]]])
    >>> table = WindowTable([0, 10], [0, 20], [8, 64], cee)
    >>> len(cell_measures(study_cell("path 2", 15.0, table, runs=1)))
    36
    """
    return {
        (algorithm, measure): values
        for algorithm in ALGORITHMS
        for measure, values in result.measures(algorithm).items()
    }


def saved_study() -> FusionStudy:
    """Read the study as ``make study NAME=velocity_fusion`` wrote it.

    Examples
    --------
    >>> saved_study().runs
    100
    """
    rows = np.loadtxt(
        read_lines("velocity_fusion.errors.csv", folder=results), delimiter=",", skiprows=1
    )
    snrs_db = np.unique(rows[:, 1])
    rows = rows.reshape(len(PATHS), len(snrs_db), len(ALGORITHMS), -1, rows.shape[1])
    return FusionStudy(PATHS, snrs_db, {name: rows[..., 3 + i] for i, name in enumerate(MEASURES)})


def saved_failures() -> dict[tuple[str, int], tuple[FloatArray, tuple[ConfidenceInterval, ...]]]:
    """Read the fractions of runs that fail where the errors begin to rise.

    Returns: By path and algorithm: signal-to-noise ratios in dB, and at each the fraction of runs
        whose error of the whole record is more than `failed_rmse` of `chosen`, with its interval.

    Examples
    --------
    >>> snrs_db, fractions = saved_failures()["path 1", 1]
    >>> len(snrs_db) == len(fractions)
    True
    """
    rows = np.loadtxt(
        read_lines("velocity_fusion.threshold.csv", folder=results), delimiter=",", skiprows=1
    )
    shares = {}
    for number, path in enumerate(PATHS, start=1):
        for algorithm in ALGORITHMS:
            part = rows[(rows[:, 0] == number) & (rows[:, 2] == algorithm)]
            shares[path, algorithm] = (
                part[:, 1],
                tuple(
                    proportion_interval(np.arange(runs) < failed) for runs, failed in part[:, 3:]
                ),
            )
    return shares


@checked
def failure_limit(
    snrs_db: Annotated[FloatArray, exactly(None)],
    shares: Sequence[ConfidenceInterval],
    limit: Probability | None = None,
) -> ConfidenceInterval:
    """Return the signal-to-noise ratio above which an algorithm does not fail.

    snrs_db (S,): Signal-to-noise ratios in dB, rising.
    shares (S,): Fraction of failed runs at each.
    limit: Fraction from which an algorithm has failed; `failed_share` of `chosen` if None.
    Returns: Where the fraction falls to the limit for the last time, in dB, by linear
        interpolation; and where the ends of its interval do.
    Raises ValueError if an argument is not of the kind described, or the fraction or an end of its
        interval does not pass the limit between the ratios.

    Examples
    --------
    >>> from dopplerlib.evaluation.intervals import ConfidenceInterval
    >>> shares = [ConfidenceInterval(p, p, p) for p in (1.0, 0.1, 0.0)]
    >>> failure_limit([0, 1, 2], shares, 0.05).value
    1.5
    """
    limit = reported().chosen.failed_share if limit is None else limit
    if len(shares) != len(snrs_db):
        raise ValueError(f"shares must be {len(snrs_db)} as ratios, got {len(shares)}")
    ends = []
    for end in ("value", "low", "high"):
        share = _checks.finite("shares", [getattr(one, end) for one in shares])
        above = np.flatnonzero(share > limit)
        if not len(above) or above[-1] == len(share) - 1:
            raise ValueError(f"shares must pass {limit} between the ratios, got {share.tolist()}")
        k = above[-1]
        part = (share[k] - limit) / (share[k] - share[k + 1])
        ends.append(float(snrs_db[k] + part * (snrs_db[k + 1] - snrs_db[k])))
    return ConfidenceInterval(*ends)
