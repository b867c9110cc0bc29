"""The claims of a document, one by one."""

import tomllib
from dataclasses import fields

from .._records import record

VERDICTS = ("reproduced", "typical", "atypical", "contradicted", "underdetermined")
KINDS = ("deterministic", "random", "relation")
RELATIONS = ("<", "<=", ">", ">=")


@record
class Claim:
    """One claim of a document, as its ``claims.toml`` tells it.

    Attributes
    ----------
    id : str
        Its name, unique in the document.
    where : str
        Section, equation, figure or table.
    statement : str
        What is claimed, in our words.
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
        What contradicts it, or what is missing.
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


def read_claims(path):
    """Read the claims of a document.

    Parameters
    ----------
    path : path-like
        A ``claims.toml``: a list of tables ``[[claim]]`` with the attributes of `Claim`.

    Returns
    -------
    tuple of Claim

    Raises
    ------
    ValueError
        If a claim lacks an entry, has one that is unknown or of the wrong kind, or its name is
        used twice.
    """
    with open(path, "rb") as file:
        tables = tomllib.load(file).get("claim", [])
    claims = tuple(_claim(table, path) for table in tables)
    names = [claim.id for claim in claims]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{path}: the id of a claim must be unique, got {name!r} twice")
    if not claims:
        raise ValueError(f"{path} must hold a list of [[claim]], got none")
    return claims


def _claim(table, path):
    name = table.get("id", "without an id")
    known = {field.name for field in fields(Claim)}
    for key in table:
        if key not in known:
            raise ValueError(f"{path}: claim {name!r} has an unknown entry {key!r}")
    try:
        claim = Claim(**table)
    except TypeError as error:
        raise ValueError(f"{path}: claim {name!r} is incomplete: {error}") from None
    for key, choices in (("kind", KINDS), ("verdict", VERDICTS)):
        if getattr(claim, key) not in choices:
            raise ValueError(
                f"{path}: {key} of claim {name!r} must be one of {', '.join(choices)}, "
                f"got {getattr(claim, key)!r}"
            )
    if (claim.relation in RELATIONS) != (claim.kind == "relation"):
        raise ValueError(
            f"{path}: relation of claim {name!r} must be one of {' '.join(RELATIONS)} for a "
            f"relation and absent for other kinds, got {claim.relation!r}"
        )
    if claim.verdict in ("contradicted", "underdetermined") and not claim.note:
        raise ValueError(f"{path}: claim {name!r} is {claim.verdict}, so it needs a note")
    return claim
