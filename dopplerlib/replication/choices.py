"""Choices: open points of a claim, each with its range and the reason for it."""

from datetime import date

from .. import _checks, _toml
from .._records import record
from .._typing import FileSource

KINDS = ("reading", "ours")


@record
class Choice:
    """Something that enters a verdict and that the document does not fix.

    A verdict is one over all `values`; values `beyond` them tell how far it stands.

    Attributes
    ----------
    id : str
        Its name, unique in the document.
    kind : {"reading", "ours"}
        The text can be read in each of these ways; or it says nothing, and we had to choose.
    meaning : str
        What is chosen.
    values : tuple of float or of str
        The declared range: all that a reasonable reader could take. The first and the last one of a
        limit are its ends.
    reason : str
        Why these, without a look at what they lead to.
    since : datetime.date
        When the range was declared.
    beyond : tuple of float or of str
        Values outside the range, which are tried as well.
    """

    id: str
    kind: str
    meaning: str
    values: tuple
    reason: str
    since: date
    beyond: tuple = ()


def read_choices(path: FileSource) -> tuple[Choice, ...]:
    """Read choices.

    Parameters
    ----------
    path : path-like or Traversable
        A ``choices.toml``: a list of tables ``[[choice]]`` with the attributes of `Choice`.

    Returns
    -------
    tuple of Choice

    Raises
    ------
    ValueError
        If the file cannot be read or is not TOML, a choice lacks an entry, has one that is unknown
        or of the wrong kind, or its name is used twice. The message begins with the file's name.

    Examples
    --------
    >>> from dopplerlib._data import data
    >>> next(one.values for one in read_choices(data("choices.toml")) if one.id == "much-more")
    (2.0, 10.0)
    """
    with _toml.tables(path) as file:
        return _toml.entries(file, "choice", Choice, check_choice)


def check_choice(where: str, choice: Choice) -> None:
    """Raise a ValueError, with `where` in it, unless a choice is one that a file may hold."""
    _checks.text("where", where)
    _checks.instance("choice", choice, Choice)
    for name in ("id", "meaning", "reason"):
        _checks.text(f"{name} of {where}", getattr(choice, name), least=1)
    _checks.one_of(f"kind of {where}", choice.kind, KINDS)
    _checks.instance(f"since of {where}", choice.since, date)
    for name, least in (("values", 1), ("beyond", 0)):
        if not isinstance(getattr(choice, name), tuple) or len(getattr(choice, name)) < least:
            raise ValueError(
                f"{name} of {where} must be a list of at least {least}, "
                f"got {getattr(choice, name)!r}"
            )
    values, both = choice.values + choice.beyond, f"values and beyond of {where}"
    if all(isinstance(one, str) for one in values):
        for one in values:
            _checks.text(both, one, least=1)
    else:
        _checks.finite(both, values)
    if len(set(values)) < len(values):
        raise ValueError(f"{both} must differ, got {values}")
