"""Documented deviations: gaps and contradictions of a document, and our choices."""

from .. import _checks, _toml
from .._records import record
from .._typing import FileSource
from ._cells import badge, link, table

KINDS = ("gap", "contradiction", "misprint", "departure")


@record
class Deviation:
    """One place where a document could not be followed, and our choice instead.

    Attributes
    ----------
    id : str
        Its name, unique in the document.
    where : str
        Section, equation, figure or table.
    kind : {"gap", "contradiction", "misprint", "departure"}
        Something is not stated; two statements do not agree; one cannot be meant as it stands; or
        it is clear, and something else is done here or beside it.
    document : str
        The statement of the document, in our words.
    choice : str
        Our choice.
    page, cell : str
        Chapter and cell where it matters.
    claims : tuple of str
        Claims that it bears on.
    """

    id: str
    where: str
    kind: str
    document: str
    choice: str
    page: str
    cell: str
    claims: tuple = ()


@record
class Deviations:
    """Documented deviations, shown as a table with links to cells of chapters.

    Attributes
    ----------
    entries : tuple of Deviation
        As the file has them.

    Raises
    ------
    ValueError
        If an entry is no `Deviation`, or one of an unknown kind.

    Examples
    --------
    >>> Deviations([Deviation("box", "Sec 3", "gap", "no box", "two meters", "start", "boxes")])
    1 deviations: 1 gap
    """

    entries: tuple

    def __post_init__(self):
        """Check the fields."""
        entries = _checks.records("entries", self.entries, Deviation)
        for one in entries:
            _checks.one_of("kind of an entry", one.kind, KINDS)
        object.__setattr__(self, "entries", entries)

    def __repr__(self):
        counts = [(kind, sum(one.kind == kind for one in self.entries)) for kind in KINDS]
        found = [f"{count} {kind}{'s' * (count != 1)}" for kind, count in counts if count]
        total = ", ".join(found) or "none"
        return f"{len(self.entries)} deviations: {total}"

    def _repr_markdown_(self):
        return table(("in the document", "here"), map(_row, self.entries))


def read_deviations(path: FileSource) -> Deviations:
    """Read the documented deviations from a document.

    Parameters
    ----------
    path : path-like or Traversable
        A ``deviations.toml``: a list of tables ``[[deviation]]`` with the attributes of
        `Deviation`.

    Returns
    -------
    Deviations

    Raises
    ------
    ValueError
        If the file cannot be read or is not TOML, a deviation lacks an entry, has one that is
        unknown or of the wrong kind, or a name is used twice. The message begins with the file's
        name.

    Examples
    --------
    >>> from dopplerlib._data import data
    >>> read_deviations(data("mittermaier2016", "deviations.toml")).entries[0].kind in KINDS
    True
    """
    with _toml.tables(path) as file:
        return Deviations(_toml.entries(file, "deviation", Deviation, _check))


def _check(where, made):
    for name in ("id", "where", "document", "choice", "page", "cell"):
        _checks.text(f"{name} of {where}", getattr(made, name), least=1)
    _checks.one_of(f"kind of {where}", made.kind, KINDS)
    _checks.instance(f"claims of {where}", made.claims, tuple)
    for claim in made.claims:
        _checks.text(f"claims of {where}", claim, least=1)


def _row(one):
    said = f"{badge('deviation', one.kind)} {one.where}.<br>{one.document}"
    return said, f"{one.choice}<br>{link(one)}"
