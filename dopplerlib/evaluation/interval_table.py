"""Medians with their intervals, as a table for a page."""

from dataclasses import dataclass

from .intervals import quantile_interval

_RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class IntervalTable:
    """Medians over runs that a notebook shows as a table.

    Attributes
    ----------
    rows : dict of str to dict of str to ndarray, shape (runs,)
        For each variant, by its name, the same quantities by theirs.
    """

    rows: dict

    def __repr__(self):
        return f"medians of {len(self.rows)} variants"

    def _repr_markdown_(self):
        names = list(next(iter(self.rows.values())))
        lines = [["", *names], ["---"] * (len(names) + 1)]
        for label, quantities in self.rows.items():
            lines.append([label, *(_cell(quantities[name]) for name in names)])
        return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _cell(values):
    median = quantile_interval(values)
    return f"{_short(median.value)}<br>({_short(median.low)} to {_short(median.high)})"


def _short(value):
    """Return two digits of a number, with a power of ten where zeros would be counted."""
    digits, power = f"{value:.1e}".split("e")
    power = int(power)
    if power >= 4:
        return f"{digits}·10{str(power).translate(_RAISED)}"
    return f"{value:.0f}" if power >= 2 else f"{value:.{1 - power}f}"
