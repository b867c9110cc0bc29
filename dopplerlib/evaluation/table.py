"""A table of results that a notebook shows: as HTML on a page, as aligned text elsewhere."""

from collections.abc import Mapping
from html import escape

import numpy as np

from .. import _checks
from .._records import record


@record
class Table:
    """Rows of values under named columns, each column with its number of decimals.

    Parameters
    ----------
    rows : dict
        Values of each row by its label, which is shown as its text: numbers, or text that is shown
        as it is. A number that is not finite is shown as a dash.
    columns : sequence of str
        Names of the columns, each with its unit: "error of x (cm)".
    digits : int or sequence of int
        Decimals of the numbers, one for all columns or one for each. A whole number is shown
        without decimals, whatever it says.
    corner : str
        What the labels of the rows are.

    Raises
    ------
    ValueError
        If there is no row, a row has not one value for each column, a value is neither a number
        nor text, or `digits` does not fit.

    Examples
    --------
    >>> print(Table({"ours": (0.02, 1.8), "paper": (0.4, 2)}, ("x (cm)", "y (cm)"), digits=1))
           x (cm)  y (cm)
    ours      0.0     1.8
    paper     0.4       2
    """

    rows: dict
    columns: tuple
    digits: int | tuple = 2
    corner: str = ""

    def __post_init__(self):
        columns = _checks.records("columns", self.columns, str)
        rows = _rows(self.rows, len(columns))
        digits = self.digits if np.iterable(self.digits) else [self.digits] * len(columns)
        digits = tuple(_checks.count("digits", value, 100, least=0) for value in digits)
        if len(digits) != len(columns):
            raise ValueError(
                f"digits must be one number or {len(columns)}, one for each column, "
                f"got {len(digits)}"
            )
        _checks.instance("corner", self.corner, str)
        for name, value in (("rows", rows), ("columns", columns), ("digits", digits)):
            object.__setattr__(self, name, value)

    @property
    def cells(self) -> list[list[str]]:
        """Texts of the table as a list of rows, the head first, the labels in front."""
        body = [
            [label, *(_text(*one) for one in zip(values, self.digits, strict=True))]
            for label, values in self.rows.items()
        ]
        return [[self.corner, *self.columns], *body]

    def __str__(self):
        cells = self.cells
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = ([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])] for row in cells)
        return "\n".join("  ".join(line) for line in lines)

    __repr__ = __str__

    def _repr_html_(self):
        head, *body = ([escape(cell) for cell in row] for row in self.cells)
        lines = ['<table class="results">', "<thead>", _row(head, 'scope="col"'), "</thead>"]
        lines += ["<tbody>", *(_row(row) for row in body), "</tbody>", "</table>"]
        return "\n".join(lines)


def _rows(rows, columns):
    """Return rows of Python numbers and texts by their labels as text, or raise."""
    if not isinstance(rows, Mapping) or not rows:
        raise ValueError(f"rows must be a dict with at least one row, got {rows!r}")
    checked = {}
    for label, values in rows.items():
        if not np.iterable(values) or isinstance(values, str):
            raise ValueError(f"rows[{label!r}] must be a sequence of values, got {values!r}")
        values = [_value(f"rows[{label!r}]", value) for value in values]
        if len(values) != columns:
            raise ValueError(
                f"rows[{label!r}] must have {columns} values, one for each column, "
                f"got {len(values)}"
            )
        checked[str(label)] = tuple(values)
    return checked


def _value(name, value):
    if isinstance(value, str):
        return value
    number = _checks.real(name, value)
    if number.ndim:
        raise ValueError(f"{name} must hold numbers and texts, got {value!r}")
    whole = isinstance(value, (int, np.integer))
    return int(value) if whole else float(number)


def _row(cells, scope=None):
    first, *rest = cells
    tag = f"th {scope}" if scope else "td"
    others = "".join(f"<{tag}>{cell}</{tag[:2]}>" for cell in rest)
    return f'<tr><th scope="{"col" if scope else "row"}">{first}</th>{others}</tr>'


def _text(value, digits):
    if isinstance(value, str):
        return value
    if isinstance(value, int):
        return str(value)
    return f"{value:.{digits}f}" if np.isfinite(value) else "–"
