"""Sentences of a document: for each one its claims, or the reason why it has none."""

from .. import _checks, _toml
from .._records import record
from .._typing import FileSource
from ._cells import table

_OTHERS = ("keys", "claims", "reason")


@record
class Sentence:
    """One statement of a document, or a part of it without one, an entry of ``sentences.toml``.

    Attributes
    ----------
    lines : tuple of int
        First and last line in the text at hand, from 1.
    where : str
        Section and paragraph, figure or table.
    says : str
        What it says, in our words.
    keys : tuple of str
        Numbers or a few words of the document by which it is found in those lines. Without any, the
        entry stands for all that these lines hold.
    claims : tuple of str
        Ids of the claims that rest on it.
    reason : str
        Why there is none.
    """

    lines: tuple
    where: str
    says: str
    keys: tuple = ()
    claims: tuple = ()
    reason: str = ""


@record
class Sentences:
    """All sentences of a document, shown as a table.

    Attributes
    ----------
    lines : int
        Number of lines of the text at hand.
    sha256 : str
        Hash of the text at hand, in hexadecimal digits.
    entries : tuple of Sentence
        In the order of the text; they cover every line.

    Raises
    ------
    ValueError
        If an entry is no `Sentence`, or a line is not covered.

    Examples
    --------
    >>> one = Sentence((1, 2), "Section 1", "The ring has six sensors.", claims=("ring",))
    >>> len(Sentences(2, "00" * 32, [one]).entries)
    1
    """

    lines: int
    sha256: str
    entries: tuple

    def __post_init__(self):
        """Check the fields."""
        lines = _checks.whole_number("lines", self.lines)
        _checks.text("sha256", self.sha256, least=64)
        entries = _checks.records("entries", self.entries, Sentence)
        covered: set[int] = set()
        for place, one in enumerate(entries, 1):
            _check_sentence(f"entries, sentence {place},", one, lines)
            covered |= set(range(one.lines[0], one.lines[1] + 1))
        if gaps := sorted(set(range(1, lines + 1)) - covered):
            raise ValueError(f"entries must cover every line, got none for line {gaps[0]}")
        object.__setattr__(self, "entries", entries)

    def __repr__(self):
        told = sum(bool(one.claims) for one in self.entries)
        return f"{len(self.entries)} sentences: {told} with claims, the others with the reason"

    def _repr_markdown_(self):
        rows = []
        for one in self.entries:
            links = [f'<a href="#claim-{claim}">{claim}</a>' for claim in one.claims]
            rows.append((one.where, one.says, ", ".join(links) or one.reason))
        return table(("where", "it says", "claims, or why none"), rows)

    def of(self, claim: str) -> tuple[Sentence, ...]:
        """Return the sentences that a claim rests on.

        Parameters
        ----------
        claim : str
            Id of a claim.

        Returns
        -------
        tuple of Sentence

        Raises
        ------
        ValueError
            If `claim` is no text.

        Examples
        --------
        >>> one = Sentence((1, 2), "Section 1", "The ring has six sensors.", claims=("ring",))
        >>> Sentences(2, "00" * 32, [one]).of("ring")[0].where
        'Section 1'
        """
        _checks.text("claim", claim)
        return tuple(one for one in self.entries if claim in one.claims)


def read_sentences(path: FileSource) -> Sentences:
    """Read the sentences of a document.

    Parameters
    ----------
    path : path-like or Traversable
        A ``sentences.toml``: a table ``[text]`` with `lines` and `sha256`, and a list of tables
        ``[[sentence]]`` with the attributes of `Sentence`.

    Returns
    -------
    Sentences

    Raises
    ------
    ValueError
        If the file cannot be read or is not TOML, an entry is missing, unknown or of the wrong
        kind, or lines are left out. The message begins with the file's name.

    Examples
    --------
    >>> from dopplerlib.replication.documents import data_file
    >>> read_sentences(data_file("sombatsatien", "sentences.toml")).lines
    379
    """
    with _toml.tables(path) as file:
        _toml.check_names("the file", file, ("text", "sentence"))
        _toml.check_names("text", file["text"], ("lines", "sha256"))
        entries = []
        for place, entry in enumerate(_checks.iterable("sentence", file["sentence"]), 1):
            where = f"sentence {place}"
            _toml.check_names(where, entry, ("lines", "where", "says"), _OTHERS)
            entries.append(Sentence(**entry))
        return Sentences(file["text"]["lines"], file["text"]["sha256"], entries)


def _check_sentence(where: str, one: Sentence, lines: int) -> None:
    place = _checks.instance(f"lines of {where}", one.lines, tuple)
    numbers = len(place) == 2 and all(map(_checks.is_whole, place))
    if not numbers or not 1 <= place[0] <= place[1] <= lines:
        raise ValueError(
            f"lines of {where} must be the first and the last of {lines} lines, got {one.lines}"
        )
    for name in ("where", "says"):
        _checks.text(f"{name} of {where}", getattr(one, name), least=1)
    _checks.text(f"reason of {where}", one.reason)
    for name in ("keys", "claims"):
        _checks.instance(f"{name} of {where}", getattr(one, name), tuple)
        for text in getattr(one, name):
            _checks.text(f"{name} of {where}", text, least=1)
    if bool(one.claims) == bool(one.reason):
        got = f"both {one.claims} and a reason" if one.claims else "neither"
        raise ValueError(f"{where} must have claims or the reason why it has none, got {got}")
