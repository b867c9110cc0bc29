"""The files of `data/`, wherever the library runs: a checkout, an installed wheel, a zip file."""

import json
import tomllib
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory


def data(*names):
    """Return a file or folder of ``data/``: a Traversable, which is a `Path` unless it is zipped.

    A wheel carries ``data/`` inside the package; in a checkout it stands beside it.
    """
    folder = files(__package__) / "data"
    if not folder.is_dir():
        folder = Path(__file__).parents[1] / "data"
    return folder.joinpath(*names)


def read_toml(*names):
    """Return the tables of a TOML file of ``data/``, a new dict each time."""
    return tomllib.loads(_text(names))


def read_json(*names):
    """Return the content of a JSON file of ``data/``, new each time."""
    return json.loads(_text(names))


def read_lines(*names):
    """Return the lines of a file of ``data/``, as `numpy.genfromtxt` and `csv` take them."""
    return _text(names).splitlines()


def _text(names):
    return data(*names).read_text(encoding="utf-8-sig")


@contextmanager
def on_disk(document, *names):
    """Give a folder that holds these files of ``data/<document>``, for what cannot read a zip."""
    folder = data(document)
    if isinstance(folder, Path):
        yield folder
        return
    with TemporaryDirectory() as copies:
        for name in names:
            Path(copies, name).write_bytes((folder / name).read_bytes())
        yield Path(copies)
