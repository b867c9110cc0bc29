"""Tables of medians or means with confidence intervals."""

from typing import Literal

import numpy as np

from .. import _checks
from .._typing import ArrayLike
from ..evaluation.intervals import mean_interval, proportion_interval, quantile_interval
from ..evaluation.table import Table

_INTERVALS = {"median": quantile_interval, "mean": mean_interval}
_RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def interval_table(
    rows: dict[str, dict[str, ArrayLike]],
    statistic: Literal["median", "mean"] = "median",
    *,
    transposed: bool = False,
) -> Table:
    """Return a table of medians or means over runs, with two digits and 95 % intervals.

    Parameters
    ----------
    rows : dict of str to dict of str to array_like, shape (runs,)
        For each variant, by its name, the same quantities by theirs. Of booleans the table has the
        fraction that is true.
    statistic : {"median", "mean"}
        Means are for counts, of which a median says little.
    transposed : bool
        Whether the variants are the columns: for more quantities than a page is wide.

    Returns
    -------
    Table
        A row for each variant, a column for each quantity.

    Raises
    ------
    ValueError
        If there is no row, the rows do not hold the same quantities, or `statistic` is unknown.

    Examples
    --------
    >>> interval_table({"ours": {"error (m)": np.arange(9.0)}}, "mean")
    mean, 95 %         error (m)
    ours        4.0 (1.9 to 6.1)
    """
    interval = _INTERVALS[_checks.one_of("statistic", statistic, tuple(_INTERVALS))]
    rows = _checks.instance("rows", rows, dict)
    names = [list(_checks.instance("rows", one, dict)) for one in rows.values()]
    if not names or not names[0]:
        raise ValueError(f"rows must hold a quantity of a variant, got {rows!r}")
    for other in names:
        if set(other) != set(names[0]):
            raise ValueError(f"rows must hold the same quantities, got {names[0]} and {other}")

    def cell(label, name):
        values = rows[label][name]
        try:
            one = (proportion_interval if np.asarray(values).dtype == bool else interval)(values)
        except (ValueError, TypeError) as error:
            where = f"rows[{label!r}][{name!r}]"
            raise ValueError(f"{where} must hold a number for each run: {error}") from error
        return f"{_short(one.value)} ({_short(one.low)} to {_short(one.high)})"

    cells = {label: [cell(label, name) for name in names[0]] for label in rows}
    columns = names[0]
    if _checks.one_boolean("transposed", transposed):
        cells = dict(zip(names[0], zip(*cells.values(), strict=True), strict=True))
        columns = list(rows)
    return Table(cells, columns, corner=f"{statistic}, 95 %")


def _short(value):
    """Return two digits of a number, with a power of ten where zeros would be counted."""
    digits, power = f"{value:.1e}".split("e")
    power = int(power)
    if power >= 4:
        return f"{digits}·10{str(power).translate(_RAISED)}"
    return f"{value:.0f}" if power >= 2 else f"{value:.{1 - power}f}"
