"""Where a document leaves something open or contradicts itself, and what was chosen instead."""

import tomllib
from dataclasses import fields

from .._records import record

KINDS = ("gap", "contradiction", "misprint")


@record
class Deviation:
    """One place at which a document cannot be followed to the letter.

    Attributes
    ----------
    id : str
        Its name, unique in the document.
    where : str
        Section, equation, figure or table.
    kind : {"gap", "contradiction", "misprint"}
        Something is not told; two places do not agree; or one place cannot be meant as it stands.
    paper : str
        What the document says, in our words.
    choice : str
        What is done here.
    page, cell : str
        Chapter and cell where it matters.
    claims : tuple of str
        Claims that it bears on.
    """

    id: str
    where: str
    kind: str
    paper: str
    choice: str
    page: str
    cell: str
    claims: tuple = ()


@record
class Deviations:
    """Deviations that a notebook shows as a table, with links to the cells where they matter.

    Attributes
    ----------
    entries : tuple of Deviation
        As the file has them.
    """

    entries: tuple

    def __repr__(self):
        counts = [(kind, sum(one.kind == kind for one in self.entries)) for kind in KINDS]
        total = ", ".join(f"{count} {kind}{'s' * (count != 1)}" for kind, count in counts)
        return f"{len(self.entries)} deviations: {total}"

    def _repr_markdown_(self):
        head = ["| in the document | here |", "|---|---|"]
        return "\n".join(head + [_row(one) for one in self.entries])


def read_deviations(path):
    """Read the deviations from a document.

    Parameters
    ----------
    path : path-like
        A ``deviations.toml``: a list of tables ``[[deviation]]`` with the attributes of
        `Deviation`.

    Returns
    -------
    Deviations

    Raises
    ------
    ValueError
        If one lacks an entry, has one that is unknown or of the wrong kind, or a name is used
        twice.
    """
    with open(path, "rb") as file:
        tables = tomllib.load(file).get("deviation", [])
    known, entries = {field.name for field in fields(Deviation)}, []
    for table in tables:
        name = table.get("id", "without an id")
        if unknown := [key for key in table if key not in known]:
            raise ValueError(f"{path}: deviation {name!r} has an unknown entry {unknown[0]!r}")
        try:
            one = Deviation(**table)
        except TypeError as error:
            raise ValueError(f"{path}: deviation {name!r} is incomplete: {error}") from None
        if one.kind not in KINDS:
            raise ValueError(
                f"{path}: kind of deviation {name!r} must be one of {', '.join(KINDS)}, "
                f"got {one.kind!r}"
            )
        if name in [other.id for other in entries]:
            raise ValueError(f"{path}: the id of a deviation must be unique, got {name!r} twice")
        entries.append(one)
    if not entries:
        raise ValueError(f"{path} must hold a list of [[deviation]], got none")
    return Deviations(tuple(entries))


def _row(one):
    badge = f'<span class="verdict deviation-{one.kind}">{one.kind}</span>'
    paper = f"{badge} {one.where}.<br>{one.paper}"
    link = f'<a href="{one.page}.html#cell-{one.cell}">{one.page.replace("_", " ")}</a>'
    cells = paper, f"{one.choice}<br>{link}"
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"
