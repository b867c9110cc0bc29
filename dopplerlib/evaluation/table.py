"""Tables of results, as HTML on a page and as aligned text elsewhere."""

from collections.abc import Mapping
from html import escape

import numpy as np

from .. import _checks
from .._records import record
from .intervals import ConfidenceInterval


@record
class Table:
    """A table of values, with the format of each column or row.

    Parameters
    ----------
    rows : dict
        Cells of each row by its label, which is shown as its text; one cell alone where there is
        one column. A cell is a number, a boolean (yes or no), an interval with its `value`, `low`
        and `high`, or text, shown as it is. NaN is shown as a dash.
    columns : sequence of str
        Names of the columns, each with its unit: "error of x (cm)". A single column may do
        without.
    digits : int, str, sequence or dict
        How numbers are written: decimals, or a format ("+.1f", ".1e", ".0%", ".3g"). One for all,
        one for each column, or some by the labels of their rows (the others get 2 decimals). A
        whole number has no decimals, unless a format is given. A format that begins with "±"
        writes an interval as its value ± half its length, which else is "2.5 (1.0 to 4.0)".
    corner : str
        Head of the column of labels.

    Raises
    ------
    ValueError
        If there is no row, a row has not one value for each column, a value is no cell, or `digits`
        does not fit.

    Examples
    --------
    >>> print(Table({"ours": (0.02, 1.8), "paper": (0.4, 2)}, ("x (cm)", "y (cm)"), digits=1))
           x (cm)  y (cm)
    ours      0.0     1.8
    paper     0.4       2
    >>> print(Table({"distance (m)": 1.25, "samples": 100}, digits={"distance (m)": ".1e"}))
    distance (m)  1.2e+00
    samples           100
    """

    rows: dict
    columns: tuple = ("",)
    digits: int | str | tuple | dict = 2
    corner: str = ""

    def __post_init__(self):
        columns = _checks.records("columns", self.columns, str)
        rows = _rows(self.rows, len(columns))
        digits = _digits(self.digits, list(rows), len(columns))
        _checks.instance("corner", self.corner, str)
        return {"rows": rows, "columns": columns, "digits": digits}

    @property
    def cells(self) -> list[list[str]]:
        """Texts of the table as a list of rows, the labels in front.

        The names of the columns are the first row, unless nothing has a name.
        """
        head = [self.corner, *self.columns]
        body = [
            [label, *map(_text, values, self._formats(label))]
            for label, values in self.rows.items()
        ]
        return [head, *body] if any(head) else body

    def _formats(self, label):
        if isinstance(self.digits, dict):
            return [self.digits.get(label, 2)] * len(self.columns)
        return self.digits

    def __str__(self):
        cells = self.cells
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = ([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])] for row in cells)
        return "\n".join("  ".join(line).rstrip() for line in lines)

    __repr__ = __str__

    def _repr_html_(self):
        body = [[escape(cell) for cell in row] for row in self.cells]
        head = body[: len(body) - len(self.rows)]
        lines = ['<table class="results">']
        if head:
            lines += ["<thead>", _row(head[0], 'scope="col"'), "</thead>"]
        lines += ["<tbody>", *map(_row, body[len(head) :]), "</tbody>", "</table>"]
        return "\n".join(lines)


def _rows(rows, columns):
    """Return rows of cells by their labels as text, or raise."""
    if not isinstance(rows, Mapping) or not rows:
        raise ValueError(f"rows must be a dict with at least one row, got {rows!r}")
    checked = {}
    for label, values in rows.items():
        name = f"rows[{label!r}]"
        if columns == 1 and not isinstance(values, (tuple, list, np.ndarray)):
            values = (values,)
        if not np.iterable(values) or isinstance(values, str):
            raise ValueError(f"{name} must be a sequence of values, got {values!r}")
        values = [_value(name, value) for value in values]
        if len(values) != columns:
            raise ValueError(
                f"{name} must have {columns} values, one for each column, got {len(values)}"
            )
        if str(label) in checked:
            raise ValueError(f"rows must have labels that differ as text, got {label!r} twice")
        checked[str(label)] = tuple(values)
    return checked


def _value(name, value):
    if isinstance(value, (str, ConfidenceInterval)):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    number = _checks.real(name, value)
    if number.ndim:
        raise ValueError(f"{name} must hold numbers and texts, got {value!r}")
    whole = isinstance(value, (int, np.integer))
    return int(value) if whole else float(number)


def _digits(digits, labels, columns):
    """Return formats, one for each column or by label, or raise."""
    if isinstance(digits, Mapping):
        formats = {str(label): _format(one) for label, one in digits.items()}
        strange = sorted(set(formats) - set(labels))
        if strange:
            raise ValueError(f"digits must be by labels of rows, got {strange[0]!r}")
        return formats
    alone = isinstance(digits, str) or not np.iterable(digits)
    formats = tuple(_format(one) for one in ([digits] * columns if alone else digits))
    if len(formats) != columns:
        raise ValueError(
            f"digits must be one or {columns}, one for each column, got {len(formats)}"
        )
    return formats


def _format(digits):
    if not isinstance(digits, str):
        return _checks.count("digits", digits, 100, least=0)
    try:
        for number in (1.0, 1):  # "1.0", say, is no format of a whole number
            format(number, digits.removeprefix("±"))
    except ValueError:
        raise ValueError(f"digits must be decimals or a format, got {digits!r}") from None
    return digits


def _row(cells, scope=None):
    first, *rest = cells
    tag = f"th {scope}" if scope else "td"
    others = "".join(f"<{tag}>{cell}</{tag[:2]}>" for cell in rest)
    return f'<tr><th scope="{"col" if scope else "row"}">{first}</th>{others}</tr>'


def _text(value, digits):
    if isinstance(value, str):
        return value
    written = digits if isinstance(digits, str) else f"z.{digits}f"  # z: no -0.0
    plain = written.removeprefix("±")
    if isinstance(value, ConfidenceInterval):
        one, low, high = (_number(end, plain) for end in (value.value, value.low, value.high))
        half = _number(value.half_width, plain.replace("+", ""))
        return f"{one} ± {half}" if plain != written else f"{one} ({low} to {high})"
    if isinstance(value, int) and not isinstance(digits, str):
        return str(value)
    return _number(value, plain)


def _number(value, written):
    return "–" if np.isnan(value) else format(value, written).replace("inf", "∞")
