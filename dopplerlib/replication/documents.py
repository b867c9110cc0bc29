"""The documents that are replicated, by their names, and their files."""

from importlib.resources.abc import Traversable

from .. import _checks
from .._data import data


def documents() -> tuple[str, ...]:
    """Return the names of all documents: the folders of ``data/`` that hold claims.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> documents()
    ('asheim2015', 'macaveiu2013', 'mittermaier2016', 'sombatsatien', 'valarmathi')
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
