"""Medians or means with their intervals, as a table for a page."""

import numpy as np

from .. import _checks
from .._records import record
from ..evaluation.intervals import mean_interval, proportion_interval, quantile_interval

_INTERVALS = {"median": quantile_interval, "mean": mean_interval}
_RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


@record
class IntervalTable:
    """Medians, or means, over runs that a notebook shows as a table.

    Attributes
    ----------
    rows : dict of str to dict of str to ndarray, shape (runs,)
        For each variant, by its name, the same quantities by theirs. Of booleans the table shows
        the share that is true.
    statistic : {"median", "mean"}
        Means are for counts, of which a median says little.

    Raises
    ------
    ValueError
        If there is no row, the rows do not hold the same quantities, or `statistic` is unknown.

    Examples
    --------
    >>> IntervalTable({"ours": {"error": np.arange(9.0)}}, "mean")
    means of 1 variants
    """

    rows: dict
    statistic: str = "median"

    def __post_init__(self):
        """Check the fields."""
        _checks.one_of("statistic", self.statistic, tuple(_INTERVALS))
        rows = _checks.instance("rows", self.rows, dict)
        names = [list(_checks.instance("rows", one, dict)) for one in rows.values()]
        if not names or not names[0]:
            raise ValueError(f"rows must hold a quantity of a variant, got {rows!r}")
        for other in names:
            if set(other) != set(names[0]):
                raise ValueError(f"rows must hold the same quantities, got {names[0]} and {other}")

    def __repr__(self):
        return f"{self.statistic}s of {len(self.rows)} variants"

    def _repr_markdown_(self):
        names = list(next(iter(self.rows.values())))
        lines = [["", *names], ["---"] * (len(names) + 1)]
        for label, quantities in self.rows.items():
            lines.append([label, *(self._cell(quantities[name]) for name in names)])
        return "\n".join(f"| {' | '.join(line)} |" for line in lines)

    def _cell(self, values):
        interval = _INTERVALS[self.statistic]
        estimate = (proportion_interval if np.asarray(values).dtype == bool else interval)(values)
        return f"{_short(estimate.value)}<br>({_short(estimate.low)} to {_short(estimate.high)})"


def _short(value):
    """Return two digits of a number, with a power of ten where zeros would be counted."""
    digits, power = f"{value:.1e}".split("e")
    power = int(power)
    if power >= 4:
        return f"{digits}·10{str(power).translate(_RAISED)}"
    return f"{value:.0f}" if power >= 2 else f"{value:.{1 - power}f}"
