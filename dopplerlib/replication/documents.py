"""The replicated documents, by name: claims, choices, sentences and documented deviations."""

from functools import cache
from importlib.resources.abc import Traversable

from .. import _checks
from .._data import data
from .._records import record
from .choices import Choice, read_choices
from .claims import Claim, read_claims
from .deviations import Deviations, read_deviations
from .sentences import Sentences, read_sentences


@record
class Document:
    """Claims of a document, with what they rest on and what they leave open.

    Attributes
    ----------
    name : str
        Its name, that of its folder in ``data/``.
    claims : tuple of Claim
        Its claims.
    deviations : Deviations
        Where it leaves something open or contradicts itself.
    choices : tuple of Choice
        What its claims leave open: its own choices, and those that all documents share.
    sentences : Sentences, optional
        All that it says.

    Raises
    ------
    ValueError
        If a field is of another type.

    Examples
    --------
    >>> from dopplerlib.replication.deviations import Deviation
    >>> gap = Deviation("box", "Sec 3", "gap", "no box", "two meters", "start", "boxes")
    >>> len(Document("ours", (), Deviations([gap])).deviations.entries)
    1
    """

    name: str
    claims: tuple
    deviations: Deviations
    choices: tuple = ()
    sentences: Sentences | None = None

    def __post_init__(self):
        """Check the fields."""
        _checks.text("name", self.name, least=1)
        object.__setattr__(self, "claims", _checks.records("claims", self.claims, Claim))
        _checks.instance("deviations", self.deviations, Deviations)
        object.__setattr__(self, "choices", _checks.records("choices", self.choices, Choice))
        if self.sentences is not None:
            _checks.instance("sentences", self.sentences, Sentences)

    def choice(self, *names: str) -> tuple[Choice, ...]:
        """Return choices by their names, as `sweep` takes them.

        Parameters
        ----------
        *names : sequence of str
            Of choices.

        Returns
        -------
        tuple of Choice

        Raises
        ------
        ValueError
            If there is no such choice.

        Examples
        --------
        >>> read_document("mittermaier2016").choice("much-more")[0].values
        (2.0, 10.0)
        """
        known = {one.id: one for one in self.choices}
        return tuple(known[_checks.one_of("names", name, tuple(known))] for name in names)


def documents() -> tuple[str, ...]:
    """Return the names of all documents: the folders of ``data/`` that hold claims.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> "sombatsatien" in documents()
    True
    """
    folders = data().iterdir()
    return tuple(sorted(one.name for one in folders if one.joinpath("claims.toml").is_file()))


def data_file(document: str, name: str) -> Traversable:
    """Return a file of a document, wherever the library is installed.

    Parameters
    ----------
    document : str
        One of `documents`.
    name : str
        Of a file in its folder of ``data/``.

    Returns
    -------
    Traversable
        A `pathlib.Path` unless the library runs from a zip file.

    Raises
    ------
    ValueError
        If there is no such document or no such file.

    Examples
    --------
    >>> data_file("mittermaier2016", "claims.toml").name
    'claims.toml'
    """
    folder = data(_checks.one_of("document", document, documents()))
    names = tuple(sorted(one.name for one in folder.iterdir()))
    return folder.joinpath(_checks.one_of("name", name, names))


def read_document(name: str) -> Document:
    """Read the claims and documented deviations of a document.

    Parameters
    ----------
    name : str
        One of `documents`.

    Returns
    -------
    Document

    Raises
    ------
    ValueError
        If there is no such document, or one of its files is not as `read_claims` and
        `read_deviations` want it.

    Examples
    --------
    >>> paper = read_document("mittermaier2016")
    >>> paper.claims[0].id
    'sensitivity'
    """
    return _read(_checks.one_of("name", name, documents()))


@cache
def _read(name):
    """Read a document once in a process: its files hold some thousand tables."""
    own = data(name, "choices.toml")  # a document may have none of its own
    return Document(
        name,
        read_claims(data_file(name, "claims.toml")),
        read_deviations(data_file(name, "deviations.toml")),
        read_choices(data("choices.toml")) + (read_choices(own) if own.is_file() else ()),
        read_sentences(data_file(name, "sentences.toml")),
    )
