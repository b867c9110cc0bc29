"""Demands on a tracker of the workspace, beside the numbers that a study found.

The demands were written down before the study was made. Each has a limit, the times for which it
holds, and the value that comes nearest to the limit or lies farthest beyond it.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .. import _checks
from .._hints import Positive, checked
from .._typing import FloatArray
from ..evaluation.averages import average_interval
from ..evaluation.intervals import ConfidenceInterval, proportion_interval
from ..evaluation.table import Table
from .errors import ErrorSummary

_Z = 1.96  # standard errors on either side that hold 95 %
_MEDIAN = 1.17  # standard error of the median over that of the mean, of chi-square with six degrees


class _Demand(NamedTuple):
    text: str
    cases: str
    low: float  # limits of the value
    high: float
    first: float  # times in s, both inclusive
    last: float
    value: Callable[[ErrorSummary], tuple[FloatArray, Callable[[int], ConfidenceInterval]]]


def _with_error(value, error):
    """Return values, and a function of the time's index for their interval."""
    return value, lambda i: ConfidenceInterval(
        value[i], value[i] - _Z * error[i], value[i] + _Z * error[i]
    )


def _share(value, runs):
    # Exact: none of so many runs is not none of all.
    return value, lambda i: proportion_interval(np.arange(runs[i]) < round(value[i] * runs[i]))


def _nees(found):
    return _with_error(found.nees, found.nees_error)


def _median(found):
    return _with_error(found.nees_median, _MEDIAN * found.nees_error)


def _position(found):
    ratio = found.position / found.position_bound
    return _with_error(ratio, ratio * found.position_error)


def _velocity(found):
    ratio = found.velocity / found.velocity_bound
    return _with_error(ratio, ratio * found.velocity_error)


def _lost(found):
    return _share(found.lost, found.runs)


def _axes(found):
    """Return the share farthest from 95 %, of the six axes."""
    far = np.abs(found.axes - 0.95).argmax(axis=-1)
    return _share(np.take_along_axis(found.axes, far[:, None], axis=-1)[:, 0], found.runs)


_DEMANDS = (
    _Demand("mean NEES, from 0.1 s", "A", 5.7, 6.3, 0.1, 1, _nees),
    _Demand("mean NEES, from 0.2 s", "B", 5.7, 6.3, 0.2, 1, _nees),
    _Demand("mean NEES, from 0.02 s", "B", 4.7, 7.3, 0.02, 1, _nees),
    _Demand("median NEES, before 0.3 s", "C", 3.3, 7, 0.02, 0.28, _median),
    _Demand("mean NEES, before 0.3 s", "D", 3.3, 7, 0.02, 0.28, _nees),
    _Demand("mean NEES, from 0.6 s", "CD", 5.7, 6.3, 0.6, 1, _nees),
    _Demand("within 95 %, all axes, from 0.1 s", "AB", 0.92, 0.98, 0.1, 1, _axes),
    _Demand("position over bound, to 0.98 s", "A", 0, 1.2, 0.02, 0.98, _position),
    _Demand("position over bound, at 1 s", "A", 0, 1.35, 1, 1, _position),
    _Demand("velocity over bound, from 0.5 s", "A", 0, 1.25, 0.5, 1, _velocity),
    _Demand("position over bound, from 0.4 s", "B", 0, 1.2, 0.4, 1, _position),
    _Demand("position over bound, from 0.7 s", "C", 0, 1.15, 0.7, 1, _position),
    _Demand("position over bound, from 0.3 s", "D", 0, 1.15, 0.3, 1, _position),
    _Demand("fraction lost, at 0.5 s", "ABD", 0, 0.002, 0.5, 0.5, _lost),
    _Demand("fraction lost, at 0.5 s", "C", 0, 0.015, 0.5, 0.5, _lost),
    _Demand("fraction lost, at 1 s", "ABCD", 0, 0, 1, 1, _lost),
)


@checked
def demand_table(found: dict[str, ErrorSummary]) -> Table:
    """Return the demands beside the value nearest to the limit, or farthest beyond it.

    Parameters
    ----------
    found : dict of ErrorSummary
        Statistics of a tracker in each of the cases "A", "B", "C" and "D".

    Returns
    -------
    Table
        A row for each demand and case: the value with its 95 % interval, its time, the limits, and
        whether the value is within them.

    Examples
    --------
    >>> from dopplerlib.workspace.comparison import saved_comparison
    >>> saved = saved_comparison()
    >>> table = demand_table({case: saved[case, "bank", "right"] for case in "ABCD"})
    >>> table.rows["A: fraction lost, at 1 s"][-1]
    'yes'
    """
    rows = {}
    for demand in _DEMANDS:
        for case in demand.cases:
            one = _checks.instance(f"found[{case!r}]", found.get(case), ErrorSummary)
            value, interval = demand.value(one)
            there = np.flatnonzero(
                (one.time > demand.first - 1e-9) & (one.time < demand.last + 1e-9)
            )
            if not len(there):
                raise ValueError(f"found must reach {demand.first} s, got {one.time[-1]} s")
            beyond = np.maximum(value - demand.high, demand.low - value)[there]
            worst = there[beyond.argmax()]
            met = bool((beyond <= 0).all())
            limits = f"{demand.low:g} to {demand.high:g}" if demand.low else f"{demand.high:g}"
            rows[f"{case}: {demand.text}"] = interval(worst), one.time[worst], limits, met
    heads = "worst (95 % interval)", "at (s)", "limit", "met"
    return Table(rows, heads, (3, 2, 2, 2), corner="demand")


@checked
def coverage(found: ErrorSummary, first: Positive = 0.1) -> tuple[float, float]:
    """Return the fraction of times at which the mean NEES is in its 95 % interval.

    Parameters
    ----------
    found : ErrorSummary
        Statistics over runs.
    first : float
        Earliest time that counts, in s.

    Returns
    -------
    chi_square, empirical : float
        With the interval for means of chi-square values, and with the scatter of the runs.

    Notes
    -----
    The exact posterior is not Gaussian, and its NEES scatters more than chi-square: the first
    interval is too narrow for many runs even then. The times are correlated, so that the fraction
    is not that of independent tests.

    Examples
    --------
    >>> from dopplerlib.workspace.comparison import saved_comparison
    >>> coverage(saved_comparison()["A", "paper", "right"])
    (0.0, 0.0)
    """
    there = found.time > first - 1e-9
    n, mean = found.runs[there], found.nees[there]
    if not len(n):
        raise ValueError(f"first must be at most {found.time[-1]} s, got {first}")
    low, high = np.transpose([average_interval(6, count) for count in n])
    empirical = np.abs(mean - 6) <= _Z * found.nees_error[there]
    return float(np.mean((low <= mean) & (mean <= high))), float(np.mean(empirical))
