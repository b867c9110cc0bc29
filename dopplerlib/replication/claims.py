"""Claims of a document, as records."""

from .. import _checks, _toml
from .._records import record
from .._typing import FileSource

KINDS = ("result", "assumption", "demand", "inference")
FORMS = ("number", "draw", "relation", "size")
WEIGHTS = ("finding", "arithmetic", "misprint")
RELATIONS = ("<", "<=", ">", ">=")
OPEN = ("underdetermined", "undecided")
# A result can be contradicted; what somebody assumes, demands or infers holds, or it fails.
OF_RESULTS = ("reproduced", "typical", "atypical", "contradicted", *OPEN)
OF_OTHERS = ("holds", "fails", *OPEN)
VERDICTS = (*OF_RESULTS[:4], *OF_OTHERS)


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
    form : {"number", "draw", "relation", "size"}
        A number that follows from what is given; the outcome of one random run; a statement that a
        quantity lies above or below a limit; or one that it is as large as published, within a
        factor.
    verdict : str
        The verdict on record, see `judge`. The tests compute it again.
    page, cell : str
        Chapter that shows the number, and the cell of it where the claim is tried.
    test : str
        A test that computes the number by another route, as ``path::name``.
    keys : tuple of str
        Numbers or a few words by which its place is found in the document.
    kind : {"result", "assumption", "demand", "inference"}
        What the document, or in an inference this book, says it as. Only a result can be
        contradicted.
    premises : str
        What has to be so for the claim to be one; it is judged in a world in which it is. "" if
        there is nothing.
    weight : {"finding", "arithmetic", "misprint"}
        Arithmetic on published numbers cannot fail, and a misprint is no finding: both are counted
        apart.
    choices : tuple of str
        Names of the choices over which the evidence is swept.
    published : float or tuple of float, optional
        The number stated, or the limit of a relation. None if it is a curve or a statistic of
        one, for which the evidence brings the number, or if the limit is one of our choices.
    limit : str, optional
        Name of the choice whose values are the limits of a relation, or the factors of a size.
    unit : str
        "" for a pure number.
    rounding : float
        Half a unit of the last digit stated.
    relation : {"<", "<=", ">", ">="}, optional
        How the quantity lies to the limit.
    note : str
        The contradiction, or the missing part; a reading in which the document is right comes
        first.
    surrogate : str
        Simulation that stands in for data which are not published, such as "a simulated walk". The
        verdict is then one on the simulation, and is counted apart. "" if there is none.
    """

    id: str
    where: str
    statement: str
    form: str
    verdict: str
    page: str
    cell: str
    test: str
    keys: tuple
    kind: str = "result"
    premises: str = ""
    weight: str = "finding"
    choices: tuple = ()
    published: float | tuple | None = None
    limit: str | None = None
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
    for name in ("unit", "note", "surrogate", "premises"):
        _checks.text(f"{name} of {where}", getattr(claim, name))
    for name in ("keys", "choices"):
        for one in _checks.instance(f"{name} of {where}", getattr(claim, name), tuple):
            _checks.text(f"{name} of {where}", one, least=1)
    if not claim.keys:
        raise ValueError(f"keys of {where} must say where it is found in the document, got none")
    for name, words in (("kind", KINDS), ("form", FORMS), ("weight", WEIGHTS)):
        _checks.one_of(f"{name} of {where}", getattr(claim, name), words)
    verdicts = OF_RESULTS if claim.kind == "result" else OF_OTHERS
    _checks.one_of(f"verdict of {where}", claim.verdict, verdicts)
    _check_numbers(where, claim)
    if claim.verdict in ("contradicted", "fails", *OPEN) and not claim.note:
        raise ValueError(f"note of {where} must say why it is {claim.verdict}, got none")


def _check_numbers(where, claim):
    if claim.published is not None:
        published = _checks.finite(f"published of {where}", claim.published)
        if published.ndim > (claim.form == "number") or not published.size:
            raise ValueError(
                f"published of {where} must be one number, or a list of them for a claim on "
                f"numbers, got an array of shape {published.shape}"
            )
    if _checks.one_number(f"rounding of {where}", claim.rounding) < 0:
        raise ValueError(f"rounding of {where} must not be negative, got {claim.rounding}")
    if claim.form == "relation":
        _checks.one_of(f"relation of {where}", claim.relation, RELATIONS)
    elif claim.relation is not None:
        raise ValueError(
            f"relation of {where} must be absent for other forms than a relation, "
            f"got {claim.relation!r}"
        )
    if claim.limit is None:
        if claim.form == "size":
            raise ValueError(f"limit of {where} must name the choice of its factor, got none")
        return
    _checks.text(f"limit of {where}", claim.limit, least=1)
    if claim.form not in ("relation", "size"):
        raise ValueError(f"limit of {where} must be absent for a {claim.form}, got {claim.limit!r}")
    if claim.form == "relation" and claim.published is not None:
        raise ValueError(
            f"published of {where} must be absent where the limit is a choice, "
            f"got {claim.published}"
        )
