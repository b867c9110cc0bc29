"""Claims of a document, as records."""

from .. import _checks, _toml
from .._records import record
from .._typing import FileSource

VERDICTS = ("reproduced", "typical", "atypical", "contradicted", "underdetermined")
KINDS = ("deterministic", "random", "relation")
RELATIONS = ("<", "<=", ">", ">=")


@record
class Claim:
    """One claim of a document, an entry of its ``claims.toml``.

    Attributes
    ----------
    id : str
        Its name, unique in the document.
    where : str
        Section, equation, figure or table.
    statement : str
        The claim, in our words.
    kind : {"deterministic", "random", "relation"}
        A number that follows from what is given; the outcome of one random run; or a statement
        that a quantity lies above or below a limit.
    verdict : {"reproduced", "typical", "atypical", "contradicted", "underdetermined"}
        The verdict on record. The tests compute it again.
    page, cell : str
        Chapter and cell that show it.
    test : str
        The test that would fail if it were otherwise, as ``path::name``.
    published : float or tuple of float, optional
        The number printed, or the limit of a relation. None if it is a curve or a statistic of
        one, for which the evidence brings the number.
    unit : str
        "" for a pure number.
    rounding : float
        Half a unit of the last digit printed.
    relation : {"<", "<=", ">", ">="}, optional
        How the quantity lies to the limit.
    note : str
        The contradiction, or the missing part.
    surrogate : str
        Simulation that stands in for data which are not published, such as "a simulated walk". The
        verdict is then one on the simulation, and is counted apart. "" if there is none.
    """

    id: str
    where: str
    statement: str
    kind: str
    verdict: str
    page: str
    cell: str
    test: str
    published: float | tuple | None = None
    unit: str = ""
    rounding: float = 0.0
    relation: str | None = None
    note: str = ""
    surrogate: str = ""


def read_claims(path: FileSource) -> tuple[Claim, ...]:
    """Read the claims of a document.

    Parameters
    ----------
    path : path-like or Traversable
        A ``claims.toml``: a list of tables ``[[claim]]`` with the attributes of `Claim`.

    Returns
    -------
    tuple of Claim

    Raises
    ------
    ValueError
        If the file cannot be read or is not TOML, a claim lacks an entry, has one that is unknown
        or of the wrong kind, or its name is used twice. The message begins with the file's name.

    Examples
    --------
    >>> from dopplerlib._data import data
    >>> read_claims(data("mittermaier2016", "claims.toml"))[0].id
    'sensitivity'
    """
    with _toml.tables(path) as file:
        return _toml.entries(file, "claim", Claim, check_claim)


def check_claim(where: str, claim: Claim) -> None:
    """Raise a ValueError, with `where` in it, unless a claim is one that a file may hold."""
    _checks.text("where", where)
    _checks.instance("claim", claim, Claim)
    for name in ("id", "where", "statement", "page", "cell", "test"):
        _checks.text(f"{name} of {where}", getattr(claim, name), least=1)
    for name in ("unit", "note", "surrogate"):
        _checks.text(f"{name} of {where}", getattr(claim, name))
    for name, choices in (("kind", KINDS), ("verdict", VERDICTS)):
        _checks.one_of(f"{name} of {where}", getattr(claim, name), choices)
    if claim.published is not None:
        published = _checks.finite(f"published of {where}", claim.published)
        if published.ndim > (claim.kind == "deterministic") or not published.size:
            raise ValueError(
                f"published of {where} must be one number, or a list of them for a deterministic "
                f"claim, got an array of shape {published.shape}"
            )
    if _checks.one_number(f"rounding of {where}", claim.rounding) < 0:
        raise ValueError(f"rounding of {where} must not be negative, got {claim.rounding}")
    if claim.kind == "relation":
        _checks.one_of(f"relation of {where}", claim.relation, RELATIONS)
    elif claim.relation is not None:
        raise ValueError(
            f"relation of {where} must be absent for other kinds than a relation, "
            f"got {claim.relation!r}"
        )
    if claim.verdict in ("contradicted", "underdetermined") and not claim.note:
        raise ValueError(f"note of {where} must say why it is {claim.verdict}, got none")
