"""Reported numbers of a document, as records with their place in it."""

from typing import Any

import numpy as np

from .. import _checks, _toml
from .._records import record
from .._typing import FileSource

_OWN = ("file", "where", "table")  # fields, which no entry may hide


@record
class Published:
    """One table of reported numbers: entries are attributes, tables in it are records, too.

    Parameters
    ----------
    file : str
        Name of the file, and of the table in it.
    where : str
        Place in the document. "ours: ..." if it is not the document's, with the reason.
    table : dict
        Entries by name: a number, a text, a boolean; an array for a list of numbers; a tuple for
        another list; a `Published` for a table.

    Raises
    ------
    ValueError
        If a field is of another type, or an entry is called as a field is.

    Examples
    --------
    >>> noise = Published("scenario.toml [noise]", "Section 3", {"sigma_f": 0.4})
    >>> noise.sigma_f
    0.4
    >>> noise
    scenario.toml [noise], Section 3: sigma_f
    """

    file: str
    where: str
    table: dict

    def __post_init__(self):
        """Check the fields."""
        _checks.text("file", self.file, least=1)
        _checks.text("where", self.where, least=1)
        for name in _checks.instance("table", self.table, dict):
            if _checks.text("name of an entry", name, least=1) in _OWN:
                raise ValueError(f"name of an entry must not be {', '.join(_OWN)}, got {name!r}")

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):  # as copies and pickles ask, before there are fields
            raise AttributeError(name)
        if name in self.table:
            return self.table[name]
        known = ", ".join(self.table) or "nothing"
        raise AttributeError(f"{self.file} has no {name!r}, only {known}")

    def __repr__(self):
        return f"{self.file}, {self.where}: {', '.join(self.table)}"


def read_published(path: FileSource) -> Published:
    """Read the numbers that a document reports.

    Parameters
    ----------
    path : path-like or Traversable
        A TOML file of any tables. Each has an entry `where`, its place in the document; a table
        without one has that of the table around it. What is no number of the document says
        "ours: " and why.

    Returns
    -------
    Published

    Raises
    ------
    ValueError
        If the file cannot be read or is not TOML, `where` is missing or no text, a number is not
        finite, or an entry is called as a field of `Published` is. The message begins with the
        file's name.

    Examples
    --------
    >>> from dopplerlib.replication.documents import data_file
    >>> report = read_published(data_file("valarmathi", "scenario.toml"))
    >>> report.stated.T, report.chosen.windows[:3]
    (0.003, array([4, 5, 6]))
    >>> report.chosen.where
    'ours: the document leaves it open'
    """
    with _toml.tables(path) as table:
        # Files of packages have a name, texts have none.
        file = getattr(path, "name", None) or str(path).replace("\\", "/").rpartition("/")[2]
        return _published(file, (), table, None)


def _published(file, names, table, around):
    label = f"[{'.'.join(names)}]" if names else "the file"
    where = _checks.text(f"where of {label}", table.get("where", around), least=1)
    entries = {name: one for name, one in table.items() if name != "where"}
    made = {name: _value(file, (*names, name), one, where) for name, one in entries.items()}
    return Published(f"{file} {label}" if names else file, where, made)


def _value(file, names, value, where):
    if isinstance(value, dict):
        return _published(file, names, value, where)
    if isinstance(value, list):
        return _joined(tuple(_value(file, names, one, where) for one in value))
    if not isinstance(value, (bool, str)):
        _checks.one_number(".".join(names), value)
    return value


def _joined(values):
    """Return numbers, or arrays of one shape, as an array, and anything else as it is."""
    if len({one.shape if isinstance(one, np.ndarray) else _is_number(one) for one in values}) > 1:
        return values
    if not values or not (isinstance(values[0], np.ndarray) or _is_number(values[0])):
        return values
    return np.array(values)


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)
